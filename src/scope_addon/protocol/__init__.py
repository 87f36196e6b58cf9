"""Connections to a SCOPE server. This package does not import ``bpy``, so it can be tested without Blender."""
