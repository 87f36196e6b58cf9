"""Model servers: addresses, requests and failures.

No HTTP library is imported before the first request, so that commands that use no server start fast.
"""
