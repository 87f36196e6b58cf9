"""Clients for model servers: endpoints, requests and failures.

HTTP libraries are not imported before the first request, so that commands that do not use a server start quickly.
"""
