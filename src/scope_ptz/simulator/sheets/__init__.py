"""The sheets that hold a viewpoint's pictures."""
