"""Parametric objects, materials and light to build scenes with.

``core`` has the tools to model with: meshes, materials, lettering, the stage. ``light``, ``ground`` and ``nature`` make the
surroundings. ``buildings``, ``furniture``, ``signs``, ``vehicles``, ``people``, ``works`` and ``yard`` hold the objects.

A builder function models its object at the origin, standing on z = 0 and facing +y, and returns it as a ``Built``. Lengths are
in metres.
"""
