"""The sheets that contain a viewpoint's pictures."""
