"""What the user sees in Blender: preferences, the banner and the sidebar, operators, and the picture of a run."""
