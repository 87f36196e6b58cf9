"""Drafts by task category: one module per category, plus the pairs of an absence and a presence, and comparisons of presets."""
