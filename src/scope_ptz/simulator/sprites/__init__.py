"""The stored pictures of moving actors: reading and selecting them."""
