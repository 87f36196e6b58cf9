"""Measuring a camera from its own pictures: rotations, fields of view, latency and settling, and the profile that keeps them."""
