"""Wrappers that run planners, perception and tools through Inspect, so that the log contains every request."""
