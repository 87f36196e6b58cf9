"""Shared code of network camera drivers: HTTP with pinned credentials, pictures, streams, settling, and a dead man's switch."""
