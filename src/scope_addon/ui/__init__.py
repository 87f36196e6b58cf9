"""The user interface in Blender: preferences, banner, sidebar, operators, and the picture of a run."""
