"""High street: the layout that the modules of the scene share. The street runs along y, and traffic drives on the left."""

from __future__ import annotations

import math
from dataclasses import dataclass

from scope_studio.kit.ground.wet_street import KERB_M

WEST_KERB, EAST_KERB = -3.2, 5.4
"""x coordinates of the edges of the carriageway. The easternmost 2.2 m are parking bays."""
WEST_FRONT, EAST_FRONT = -7.4, 9.6
"""x coordinates of the fronts of the two rows of shops."""
ROW_END = 48.0
"""The rows of shops extend from y = -ROW_END to ROW_END."""
CROSS_STREET_KERBS = (52.0, 59.0)
"""Distances from y = 0 to the near and far kerbs of the cross streets (Church Road in the north, Mill Lane in the south)."""
FAR_FRONT = 63.0
"""Distance from y = 0 to the fronts of the houses on the far side of the cross streets."""
BAY_X = 4.28
"""x coordinate of the centre line of the parking bays."""
NORTHBOUND_X, SOUTHBOUND_X = -1.6, 1.55
"""x coordinates of the centre lines of the two lanes."""
ZEBRA = (11.6, 15.2)
"""y coordinates of the southern and northern edges of the zebra crossing."""


@dataclass(frozen=True)
class Plot:
    """Position of a building or an object: the centre of its front at pavement height, and the bearing that it faces."""

    x: float
    y: float
    bearing_deg: float
    z: float = KERB_M

    def at(self, x: float, y: float, z: float = 0.0) -> tuple[float, float, float]:
        """Return the world position of a point given in local coordinates."""
        a = math.radians(self.bearing_deg)
        return (self.x + x * math.cos(a) + y * math.sin(a), self.y - x * math.sin(a) + y * math.cos(a), self.z + z)
