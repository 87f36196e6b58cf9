"""Station square: paving, carriageways, tram tracks, manhole covers, and the countryside around the town."""

from __future__ import annotations

import math

import bpy

from scope_studio.kit.core.mesh import from_data
from scope_studio.kit.core.shading import Shader
from scope_studio.kit.core.stage import Stage
from scope_studio.kit.furniture import roadside
from scope_studio.kit.ground import paving

ROAD_Z_M = -0.10
"""Height in metres of the carriageways. The square and the pavements are at z = 0."""
SQUARE = (-36.0, 23.5, -11.8, 40.0)
"""West, east, south and north edges of the square in metres."""
APPROACH = (23.5, 32.5)
"""x coordinates of the west and east edges of the station approach."""
STREET = (-25.5, -11.8)
"""y coordinates of the south and north edges of the street."""
TRACKS = (-14.0, -17.4)
"""y coordinates of the eastbound and westbound tracks."""


def build(stage: Stage) -> None:
    """Place paving, tracks, manhole covers and the land around the town."""
    _surfaces(stage)
    _tracks(stage)
    _manhole_covers(stage)
    _hills()


def _surfaces(stage: Stage) -> None:
    slabs, flags = paving.slab_material(), paving.flag_material()
    setts, approach_setts = paving.sett_material(), paving.sett_material("approach setts", turn_deg=90.0)
    stage.put(paving.floor("square", [SQUARE], 0.0, slabs), (0, 0, 0))
    pavements = [
        (32.5, 48.0, -11.8, 40.0),
        (-33.8, 35.8, -34.0, STREET[0]),
        (-120.0, -36.0, -11.8, 40.0),
        (48.0, 120.0, -11.8, 40.0),
        (-120.0, -43.8, -34.0, STREET[0]),
        (45.8, 120.0, -34.0, STREET[0]),
        (-36.0, -33.8, -90.0, STREET[0]),
        (-46.0, -43.8, -90.0, STREET[0]),
        (35.8, 38.0, -90.0, STREET[0]),
        (45.8, 48.0, -90.0, STREET[0]),
    ]
    stage.put(paving.floor("pavements", pavements, 0.0, flags), (0, 0, 0))
    streets = [(-120.0, 120.0, STREET[0], STREET[1])]
    stage.put(paving.floor("street", streets, ROAD_Z_M, setts), (0, 0, 0))
    lanes = [(*APPROACH, STREET[1], 40.0), (-43.8, -36.0, -90.0, STREET[0]), (38.0, 45.8, -90.0, STREET[0])]
    stage.put(paving.floor("lanes", lanes, ROAD_Z_M, approach_setts), (0, 0, 0))
    east = SQUARE[1]
    lines = [
        ((-120.0, STREET[1] + 0.08), (east - 0.08, STREET[1] + 0.08)),
        ((east - 0.08, STREET[1] + 0.08), (east - 0.08, 24.0)),
        ((32.58, STREET[1] + 0.08), (32.58, 24.0)),
        ((32.58, STREET[1] + 0.08), (120.0, STREET[1] + 0.08)),
        ((-33.8, STREET[0] - 0.08), (35.8, STREET[0] - 0.08)),
        ((-120.0, STREET[0] - 0.08), (-46.0, STREET[0] - 0.08)),
        ((48.0, STREET[0] - 0.08), (120.0, STREET[0] - 0.08)),
        ((-35.9, -90.0), (-35.9, STREET[0])),
        ((-43.9, -90.0), (-43.9, STREET[0])),
        ((37.9, -90.0), (37.9, STREET[0])),
        ((45.9, -90.0), (45.9, STREET[0])),
    ]
    stage.put(paving.kerbs(lines), (0, 0, 0))


def _tracks(stage: Stage) -> None:
    rail = paving.tram_rail(230.0)
    first = True
    for y in TRACKS:
        for side in (-1, 1):
            built = rail if first else rail.copy()
            stage.put(built, (0, y + side * 0.75, ROAD_Z_M), 0 if side > 0 else 180)
            first = False


def _manhole_covers(stage: Stage) -> None:
    for text, x, y in (("WATER", 5.4, -9.2), ("GAS", -9.6, 1.4), ("WATER", 18.2, 17.3), ("TELECOM", 7.2, -26.9)):
        stage.place(paving.manhole_cover(text), "manhole cover", "round manhole cover", (x, y, 0.002), 0, material="iron")
    grate = roadside.drain()
    for k, (x, y) in enumerate(
        ((-22.0, -12.2), (2.0, -12.2), (24.0, -4.0), (24.0, 9.0), (32.0, 2.0), (-6.0, -25.1), (16.0, -25.1))
    ):
        stage.place(grate if k == 0 else grate.copy(), "drain", "drain grate", (x, y, ROAD_Z_M), 0, material="iron")


def _hills() -> None:
    """Create farmland that rises to wooded hills: a ring-shaped mesh that hides the horizon in every direction."""
    s = Shader("far country")
    p = s.position()
    fields = s.voronoi(s.scaled(p, (0.006, 0.0085, 0.0)), 1.0, output="Color")
    tone = s.ramp(s.xyz(fields)[0], 0.0, 1.0)
    green = s.mix(tone, (0.075, 0.120, 0.032), (0.165, 0.180, 0.062))
    woods = s.ramp(s.noise(p, 0.0045, 5.0, 0.6), 0.50, 0.56)
    colour = s.mix(woods, green, (0.030, 0.052, 0.020))
    edges = s.ramp(s.voronoi(s.scaled(p, (0.006, 0.0085, 0.0)), 1.0, "DISTANCE_TO_EDGE"), 0.02, 0.05, 0.75, 0.0)
    land = s.surface(base_color=s.mix(edges, colour, (0.028, 0.046, 0.018)), roughness=0.95)
    points: list[tuple[float, float, float]] = [(0.0, 0.0, -0.35)]
    faces: list[tuple[int, ...]] = []
    radii = (110.0, 200.0, 320.0, 480.0, 680.0, 950.0, 1300.0, 1800.0, 2600.0)
    count = 72
    for r in radii:
        for k in range(count):
            a = 2 * math.pi * k / count
            swell = max(0.0, r - 260.0) / 1500.0
            wave = 0.55 + 0.45 * math.sin(2.0 * a + 0.7) * math.cos(3.0 * a + r * 0.0016) + 0.18 * math.sin(7 * a + r * 0.004)
            points.append((r * math.cos(a), r * math.sin(a), -0.35 + 95.0 * min(1.0, swell) * wave))
    faces += [(0, 1 + k, 1 + (k + 1) % count) for k in range(count)]
    for i in range(len(radii) - 1):
        for k in range(count):
            a, b = 1 + i * count + k, 1 + i * count + (k + 1) % count
            faces.append((a, a + count, b + count, b))
    bpy.context.view_layer.update()
    from_data("far country", points, faces, land, smooth=True)
