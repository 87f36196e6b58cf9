"""Capture a twin of a site: sweep a camera, register the pictures, and write a pack without ground truth."""
