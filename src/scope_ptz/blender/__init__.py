"""Blender as the main program uses it: its environment, the client of the worker process, and the baking of viewpoint packs."""
