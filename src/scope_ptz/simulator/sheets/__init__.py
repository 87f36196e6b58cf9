"""Sheets that contain a viewpoint's pictures."""
