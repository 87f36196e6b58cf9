"""Authentication and authorisation of the server's clients."""
