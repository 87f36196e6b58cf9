"""Code that network camera drivers share: HTTP with pinned credentials, pictures, streams, settling, and a dead man's switch."""
