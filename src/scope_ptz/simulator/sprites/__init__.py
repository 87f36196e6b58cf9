"""Stored pictures of moving actors: reading them, choosing between them, and drawing them into a view."""
