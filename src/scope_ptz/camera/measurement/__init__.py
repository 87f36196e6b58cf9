"""Measure a camera from its own pictures (rotations, fields of view, latency, settling times), and store a profile."""
