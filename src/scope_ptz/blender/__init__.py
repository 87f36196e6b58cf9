"""Blender from the main program's side: its environment, the worker's client, and the bake of viewpoint packs."""
