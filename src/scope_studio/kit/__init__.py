"""Parametric objects, materials and lights for building scenes.

``core`` contains the modelling tools: meshes, materials, lettering, the stage. ``light``, ``ground`` and ``nature`` model
the surroundings. ``buildings``, ``furniture``, ``signs``, ``vehicles``, ``people``, ``works`` and ``yard`` contain the objects.

A builder function models its object at the origin, standing on z = 0 and facing +y, and returns it as a ``Built``. Lengths are
in metres. Parameters named ``cap``, ``cap_m`` or ``cap_height`` are the height of capital letters, ``ink`` is the colour of
lettering, and ``dirt`` is the amount of dirt from 0 to 1. In function bodies, ``s`` is the ``Solid`` or ``Shader`` under
construction, and ``k`` counts repeated parts.
"""
