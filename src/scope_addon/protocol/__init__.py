"""Connections to a SCOPE server. Nothing here imports ``bpy``, so it can be tested without Blender."""
