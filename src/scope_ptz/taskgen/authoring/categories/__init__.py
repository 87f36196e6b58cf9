"""Drafts by task category: one module per category, plus modules for absence/presence pairs and for preset comparisons."""
