"""Blender seen from the main program: its environment, the worker's client, and the bake of viewpoint packs."""
