"""Wrappers that run planners, perception and tools as Inspect models and tools, so that the log contains every request."""
