"""Procedural modelling inside Blender: an object kit, the built-in scenes, and the render worker.

The main program never imports this package. It runs ``worker.py`` as a separate process.
"""
