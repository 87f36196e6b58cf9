"""Sessions with cameras on a ``scope serve`` server."""
