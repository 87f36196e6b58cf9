"""Understand what refers to earlier moves: corrections, "again", "a bit more", "too far", "undo" and "go back"."""
