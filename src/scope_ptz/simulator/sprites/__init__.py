"""Stored pictures of moving actors: reading them and choosing among them."""
