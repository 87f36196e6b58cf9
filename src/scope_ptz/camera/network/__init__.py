"""Code shared by network camera drivers: HTTP with protected credentials, pictures, streams, settling, and a dead man's switch."""
