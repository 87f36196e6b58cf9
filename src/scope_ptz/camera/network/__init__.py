"""What the drivers of network cameras share: HTTP with pinned credentials, pictures, streams, settling, and a dead man's switch."""
