"""Model servers: addresses, requests and failures.

No HTTP library is imported before the first request, so commands that need no server start fast.
"""
