"""Parametric objects, materials and light to build scenes with.

``core`` contains the modelling tools: meshes, materials, lettering, the stage. ``light``, ``ground`` and ``nature`` are for
the surroundings. ``buildings``, ``furniture``, ``signs``, ``vehicles``, ``people``, ``works`` and ``yard`` contain the objects.

A builder function models its object at the origin, standing on z = 0 and facing +y, and returns it as a ``Built``. Lengths are
in metres.
"""
