"""Model servers: where they are, how they are asked, and how they fail.

Nothing of an HTTP library is imported before the first request, so commands that need no server start at once.
"""
