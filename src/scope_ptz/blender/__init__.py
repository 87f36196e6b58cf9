"""Use Blender from the main program: its environment, the client for the worker process, and baking of viewpoint packs."""
