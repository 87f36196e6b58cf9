"""Model servers: addresses, requests and failures.

No HTTP library is imported before the first request, so that commands without a server start fast.
"""
