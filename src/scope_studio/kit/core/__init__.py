"""Meshes, materials and the stage: what every object is made with."""
