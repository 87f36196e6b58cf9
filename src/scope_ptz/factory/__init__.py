"""Specs to objects: cameras, planners, perception and evaluation contexts are built here and nowhere else."""
