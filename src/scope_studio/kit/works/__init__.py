"""Road works: barriers, plant, stock."""
