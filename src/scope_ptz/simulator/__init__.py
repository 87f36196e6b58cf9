"""Worlds to look at: packs, re-projection, actors, the scene clock, and the exact ground truth of a view."""
