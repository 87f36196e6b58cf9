"""What runs inside Blender: the object kit, the scenes, and the bake. Nothing in the main program imports this package."""
