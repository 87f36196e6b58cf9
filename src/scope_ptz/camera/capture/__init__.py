"""Capture a twin of a site: sweep a camera, register the pictures, and write them as a pack without ground truth."""
