"""Procedural modelling inside Blender: object kit, scenes, render worker.

The main program finds this package by its location and starts its worker; it never imports it.
"""
