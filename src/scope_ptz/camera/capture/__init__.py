"""Capture a site from a real camera: sweep it, register the pictures, and write a pack without ground truth."""
