"""Blender, as used by the main program: its environment, the client of the worker process, and the baking of viewpoint packs."""
