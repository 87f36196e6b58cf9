"""The server: cameras, runs and conversations that many clients share, behind an HTTP API."""
