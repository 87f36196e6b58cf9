"""Drafts by task category."""
