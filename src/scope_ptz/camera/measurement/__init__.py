"""Measure a camera from its own pictures (rotations, fields of view, latency and settling), and store the results in a profile."""
