"""Highway works: the road, the land around it, the bridge and the buildings."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

import bpy

from scope_studio.kit.buildings import detached, structures
from scope_studio.kit.core.mesh import from_data
from scope_studio.kit.core.shading import Shader
from scope_studio.kit.core.stage import Stage
from scope_studio.kit.ground import highway, markings, terrain

Height = Callable[[float, float], float]

ROAD = highway.Carriageway(
    lines=(
        markings.Line(2.15, 0.20),
        markings.Line(5.5, 0.13, 2.0, 7.0),
        markings.Line(9.0, 0.13, 2.0, 7.0),
        markings.Line(12.5, 0.20),
    ),
    patches=(
        markings.Patch("milled", -12.40, -9.25, 30.0, 52.0),
        markings.Patch("fresh", -12.40, -9.25, -4.0, 30.0),
        markings.Patch("repair", 3.1, 4.5, 8.0, 15.5),
        markings.Patch("repair", -6.4, -5.6, -34.0, -26.5),
        markings.Patch("repair", 9.4, 12.2, 38.0, 47.0),
        markings.Patch("repair", -14.9, -13.1, -24.0, -19.0),
        markings.Patch("repair", -4.9, -2.6, 57.0, 61.0),
    ),
)
COMPOUND = (-44.4, -22.6, -24.4, 4.0)
"""Positions in metres of the west, east, south and north fences of the site compound."""
BRIDGE_Y = 85.0
"""y coordinate of the centre line of the bridge."""
DECK_HEIGHT_M = 6.9
"""Height in metres of the road on the bridge."""


def build(stage: Stage) -> None:
    """Place the road, land, bridge and buildings."""
    height = terrain.hills(ROAD)
    bare_areas = [
        (COMPOUND[0] - 2, COMPOUND[1] + 1.5, COMPOUND[2] - 2, COMPOUND[3] + 1),
        (-38.0, -27.0, 2.0, 17.0),
        (-38.0, -15.0, 12.0, 21.0),
        (-24.0, -15.0, 18.0, 56.0),
    ]
    stage.put(terrain.terrain(ROAD, bare_areas), (0, 0, 0))
    stage.put(highway.carriageways(ROAD), (0, 0, 0))
    _bridge(stage)
    _yard()
    _buildings(stage, height)


def _bridge(stage: Stage) -> None:
    bridge = structures.overbridge(
        span_m=44.0, deck_m=DECK_HEIGHT_M, number="B17  42/6", banner=("HARROWFIELD SUMMER FAIR", "SATURDAY 14 JUNE  10 AM TO 4 PM")
    )
    stage.place(bridge, "bridge", "concrete overbridge", (0, BRIDGE_Y, 0), material="concrete", colour="grey")
    grass = bpy.data.materials["land"]
    for side in (-1, 1):
        bank = structures.approach(length_m=125, width_m=9, height_m=DECK_HEIGHT_M - 0.04, side=side, grass=grass)
        stage.put(bank, (side * 27.5, BRIDGE_Y, 0))


def _yard() -> None:
    s = Shader("yard asphalt")
    p = s.position()
    tone = s.noise(p, 0.25, detail=7.0, roughness=0.62)
    colour = s.mix(s.ramp(tone, 0.3, 0.7), (0.060, 0.059, 0.057), (0.125, 0.122, 0.116))
    x, y, _ = s.xyz(p)
    bay = s.math("MULTIPLY", s.ramp(s.math("PINGPONG", y, 1.3), 0.04, 0.06, 1.0, 0.0), s.band(x, 46.0, 50.5, 0.03))
    yard = s.surface(base_color=s.mix(s.math("MULTIPLY", bay, 0.7), colour, (0.5, 0.5, 0.48)), roughness=0.9)
    from_data("yard", [(38, -62, 0.01), (118, -62, 0.01), (118, 62, 0.01), (38, 62, 0.01)], [(0, 1, 2, 3)], yard)


def _buildings(stage: Stage, height: Height) -> None:
    white, dark = (0.62, 0.63, 0.62), (0.05, 0.07, 0.09)
    sheds = [
        (
            detached.shed(
                width_m=46,
                depth_m=30,
                height_m=9.5,
                colour=(0.16, 0.27, 0.42),
                trim=white,
                lettering="MERIDIAN FREIGHT",
                docks=4,
                windows=5,
            ),
            (76.0, 28.0),
            "blue",
            "blue warehouse",
        ),
        (
            detached.shed(
                width_m=38,
                depth_m=26,
                height_m=8.0,
                colour=(0.50, 0.50, 0.47),
                trim=(0.36, 0.05, 0.04),
                lettering="ASHDOWN TILES",
                docks=3,
                windows=4,
            ),
            (74.0, -26.0),
            "grey",
            "grey warehouse",
        ),
        (
            detached.shed(
                width_m=30, depth_m=22, height_m=7.0, colour=(0.10, 0.20, 0.13), trim=dark, lettering="COLDSTORE 3", docks=3
            ),
            (112.0, -52.0),
            "green",
            "green warehouse",
        ),
    ]
    for built, (x, y), colour, name in sheds:
        stage.place(built, "building", name, (x, y, 0.0), -90, colour=colour, material="metal cladding", kind="warehouse")
    red, buff, brown = (0.26, 0.085, 0.055), (0.36, 0.27, 0.17), (0.20, 0.075, 0.055)
    slate, clay = (0.085, 0.09, 0.10), (0.22, 0.085, 0.055)
    houses = [
        (-74.0, 30.0, 118, red, slate, (0.02, 0.10, 0.05)),
        (-86.0, 44.0, 118, buff, clay, (0.30, 0.03, 0.02)),
        (-70.0, 62.0, 150, brown, clay, (0.03, 0.06, 0.20)),
        (-98.0, 20.0, 100, red, clay, (0.5, 0.5, 0.48)),
        (-112.0, 52.0, 120, buff, slate, (0.02, 0.02, 0.02)),
        (-90.0, 78.0, 160, red, slate, (0.2, 0.12, 0.03)),
    ]
    for k, (x, y, bearing, brick, roof, door) in enumerate(houses):
        colour = "buff" if brick is buff else "red"
        built = detached.house(brick=brick, roof=roof, door=door, seed=k)
        stage.place(
            built, "building", f"{colour} brick house", (x, y, height(x, y)), bearing, colour=colour, material="brick", kind="house"
        )
    x, y = -128.0, -62.0
    stage.place(
        detached.barn(), "building", "timber barn", (x, y, height(x, y)), 60, colour="brown", material="timber", kind="barn"
    )
    _power_line(stage, height)


def _power_line(stage: Stage, height: Height) -> None:
    """Place a line of pylons that crosses the road far to the south, with sagging wires."""
    prototype = structures.pylon()
    feet = [(-430.0, -160.0), (-185.0, -205.0), (75.0, -252.0), (330.0, -300.0)]
    bearing = math.degrees(math.atan2(-(feet[1][1] - feet[0][1]), feet[1][0] - feet[0][0]))
    points: list[tuple[float, float, float]] = []
    faces: list[tuple[int, ...]] = []
    for k, (x, y) in enumerate(feet):
        built = prototype if k == 0 else prototype.copy()
        stage.place(built, "pylon", "electricity pylon", (x, y, height(x, y) - 0.3), bearing + 90, colour="grey", material="steel")
    across = (math.sin(math.radians(bearing + 180)), math.cos(math.radians(bearing + 180)))
    for (x0, y0), (x1, y1) in pairwise(feet):
        for fraction, reach in ((0.66, 5.5), (0.80, 6.6), (0.93, 4.8)):
            for side in (-1, 1):
                base = len(points)
                for i in range(25):
                    t = i / 24
                    x, y = x0 + (x1 - x0) * t + across[0] * reach * side, y0 + (y1 - y0) * t + across[1] * reach * side
                    z = (height(x0, y0) * (1 - t) + height(x1, y1) * t) + 30 * fraction - 1.6 - 28.0 * t * (1 - t)
                    points += [(x, y, z - 0.02), (x, y, z + 0.02)]
                faces += [(base + 2 * i, base + 2 * i + 2, base + 2 * i + 3, base + 2 * i + 1) for i in range(24)]
    from_data("wires", points, faces, Shader("wire").surface(base_color=(0.05, 0.05, 0.05), roughness=0.6))
