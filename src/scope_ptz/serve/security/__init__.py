"""Authentication and authorisation for the server's clients."""
