"""Code that network camera drivers share: HTTP with safe credentials, pictures, streams, settling, and a dead man's switch."""
