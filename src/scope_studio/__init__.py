"""Procedural modelling inside Blender: an object kit, the built-in scenes, and the render worker.

The main program never imports this package. It starts the worker as a process, by the path of ``worker.py``.
"""
