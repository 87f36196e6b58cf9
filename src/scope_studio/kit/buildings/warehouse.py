"""A distribution warehouse: a metal-clad front with dock openings, a lit hall, and a canopy.

The front faces +y. The outer face of its wall is on y = 0, and the building extends towards -y. Positions along
the front are values of x, which increases to the left for a viewer in front of it.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from itertools import pairwise

import bpy

from scope_studio.kit.buildings.wall_materials import cladding_material
from scope_studio.kit.core.finishes import concrete, paint, steel
from scope_studio.kit.core.shading import Shader, plain
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built
from scope_studio.kit.light.glow import glowing_face, lit_lens

DOCK_SILL_M, DOCK_WIDTH_M, DOCK_HEIGHT_M = 1.20, 2.9, 3.0
"""Height of the sill of a dock opening, and width and height of the opening, in metres."""
Opening = tuple[float, float, float, float]
"""Opening in a wall: lowest and highest x, lowest and highest z (metres)."""


def wall(
    s: Solid,
    x0: float,
    x1: float,
    z0: float,
    z1: float,
    openings: Sequence[Opening],
    material: bpy.types.Material,
    depth: float = 0.22,
) -> None:
    """Add a wall with openings on y = 0, from ``x0`` to ``x1``. It consists of strips between the edges of the openings."""
    cuts = sorted({x0, x1, *(x for a, b, _, _ in openings for x in (a, b) if x0 < x < x1)})
    for a, b in pairwise(cuts):
        holes = sorted((c, d) for p, q, c, d in openings if p < (a + b) / 2 < q)
        low = z0
        for c, d in [*holes, (z1, z1)]:
            if c - low > 1e-3:
                s.box((b - a, depth, c - low), ((a + b) / 2, -depth / 2, (low + c) / 2), material, 0.0)
            low = max(low, d)


def shell(
    *,
    width: float,
    depth: float,
    height: float,
    openings: Sequence[Opening],
    colour: tuple[float, float, float],
    band: tuple[float, float, float],
    ramp_to: float,
) -> Built:
    """Build the warehouse: walls with front openings, a parapet, a low-pitched roof with roof lights and vents, and the hall.

    The hall's floor is at dock height where x is at least ``ramp_to``, and at yard level elsewhere. Its back wall is 13 m behind
    the front.
    """
    s = Solid("warehouse")
    finish, trim = cladding_material("warehouse cladding", colour, 0.25), plain("warehouse band", band, 0.45)
    w, h = width / 2, height
    wall(s, -w, w, 1.3, h, openings, finish)
    wall(s, -w, w, 0.0, 1.3, openings, concrete(light=False), 0.30)
    s.box((width + 0.2, 0.10, 0.55), (0, 0.05, h + 0.10), trim, 0.01)
    s.box((width + 0.24, 0.36, 0.08), (0, -0.06, h + 0.40), paint("light grey", dirt=0.4), 0.01)
    for x in (-w, w):
        s.box((0.22, depth, h - 1.3), (x, -depth / 2, 1.3 + (h - 1.3) / 2), finish, 0.0)
        s.box((0.30, depth, 1.3), (x, -depth / 2, 0.65), concrete(light=False), 0.0)
        s.box((0.34, depth, 0.55), (x, -depth / 2, h + 0.10), trim, 0.01)
    s.box((width, 0.22, h), (0, -depth, h / 2), finish, 0.0)
    s.box((width + 0.2, 0.30, 0.55), (0, -depth, h + 0.10), trim, 0.01)
    _roof(s, w, depth, h)
    _hall(s, w, h, ramp_to)
    return s.built()


def _roof(s: Solid, w: float, depth: float, h: float) -> None:
    """Add two shallow roof slopes with emissive roof lights, smoke vents and ventilation units."""
    roof_sheet, glowing = cladding_material("warehouse roof", (0.20, 0.21, 0.22), 0.33), roof_light()
    rise = 1.3
    for y0, y1, z0, z1 in ((-0.2, -depth / 2, h, h + rise), (-depth / 2, -depth, h + rise, h)):
        s.add([(-w, y0, z0), (w, y0, z0), (w, y1, z1), (-w, y1, z1)], [(0, 3, 2, 1) if y1 > y0 else (0, 1, 2, 3)], roof_sheet)
        count = int(2 * w / 6.5)
        for k in range(count):
            x = -w + 4 + (2 * w - 8) * k / (count - 1)
            points = []
            for t in (0.25, 0.75):
                y, z = y0 + (y1 - y0) * t, z0 + (z1 - z0) * t + 0.05
                points += [(x - 0.5, y, z), (x + 0.5, y, z)]
            s.add(points, [(0, 1, 3, 2)], glowing)
    for k, x in enumerate((-w * 0.6, -w * 0.1, w * 0.45, w * 0.8)):
        with s.at(x, -depth * 0.30 - 3.0 * (k % 2), h + 0.75):
            s.box((1.7, 1.1, 0.9), (0, 0, 0.35), paint("light grey", dirt=0.4), 0.03)
            s.lathe([(0.40, 0.0), (0.40, 0.08)], plain("roof fan", (0.02, 0.02, 0.02), 0.7), (0, 0, 0.80), steps=20)
            for i in range(6):
                s.box((1.5, 0.012, 0.03), (0, 0.556, 0.08 + 0.11 * i), steel(dark=True), 0.0)
    for x in (-w * 0.35, w * 0.2, w * 0.62):
        s.lathe(
            [(0.25, 0.0), (0.25, 1.0), (0.42, 1.05), (0.30, 1.35), (0.05, 1.42)],
            steel(),
            (x, -depth * 0.5, h + rise - 0.1),
            steps=18,
        )


def roof_light() -> bpy.types.Material:
    """Return the material of a translucent roof sheet over a lit hall."""
    existing = bpy.data.materials.get("roof light")
    if existing is not None:
        return existing
    s = Shader("roof light")
    ribs = s.ramp(s.math("PINGPONG", s.xyz(s.object_coords())[0], 0.16), 0.02, 0.08, 0.7, 1.0)
    return s.surface(
        base_color=(0.5, 0.5, 0.45),
        roughness=0.4,
        emission_color=(1.0, 0.88, 0.62),
        emission_strength=s.math("MULTIPLY", ribs, 0.42),
    )


def _hall(s: Solid, w: float, h: float, ramp_to: float) -> None:
    """Add the interior that is visible through the open docks: floor, lamps, racks with cartons, and a back wall."""
    rng = random.Random("hall")
    pale, back_y = plain("hall wall", (0.42, 0.43, 0.42), 0.8), -13.0
    s.box((w - 0.3 - ramp_to, 12.8, DOCK_SILL_M), ((ramp_to + w - 0.3) / 2, back_y / 2 - 0.1, DOCK_SILL_M / 2), concrete(), 0.0)
    s.box((2 * w - 0.6, 0.1, h), (0, back_y, h / 2), pale, 0.0)
    s.box((2 * w - 0.6, 12.8, 0.1), (0, back_y / 2, h - 0.35), plain("hall ceiling", (0.25, 0.26, 0.27), 0.8), 0.0)
    blue, orange = paint("blue", dirt=0.2), paint("orange", dirt=0.2)
    boxes = [
        plain(f"hall carton {k}", c, 0.85)
        for k, c in enumerate(((0.34, 0.22, 0.12), (0.42, 0.30, 0.17), (0.24, 0.26, 0.30), (0.45, 0.44, 0.42)))
    ]
    x = -w + 3.0
    while x < w - 4.0:
        for px in (x, x + 2.7):
            s.box((0.09, 0.9, 5.0), (px, back_y + 1.4, 3.7), blue, 0.0)
        for level in range(3):
            z = 1.22 + 1.75 * level
            if level:
                s.box((2.7, 0.9, 0.12), (x + 1.35, back_y + 1.4, z - 0.06), orange, 0.0)
            for k in range(2):
                if rng.random() < 0.85:
                    height = rng.uniform(0.8, 1.45)
                    s.box((1.12, 0.95, height), (x + 0.70 + 1.3 * k, back_y + 1.45, z + height / 2 + 0.02), rng.choice(boxes), 0.01)
        x += 2.85
    for k in range(int(2 * w / 6.0)):
        for y in (-3.0, -8.0):
            s.box((1.8, 0.30, 0.08), (-w + 4 + 6.0 * k, y, h - 0.46), lit_lens("led", 4.0), 0.01)


def canopy(width: float, reach: float = 3.2, height: float = 5.0) -> Built:
    """Build a steel canopy on brackets over the docks, with its fascia at the front edge."""
    s = Solid("canopy")
    s.box((width, reach, 0.14), (0, reach / 2, height), cladding_material("canopy sheet", (0.30, 0.32, 0.34), 0.3), 0.01)
    s.box((width + 0.1, 0.08, 0.42), (0, reach, height), paint("blue", dirt=0.3), 0.01)
    for x in (-width / 2, width / 2):
        s.box((0.08, reach, 0.42), (x, reach / 2, height), paint("blue", dirt=0.3), 0.01)
    count = round(width / 5.2)
    for k in range(count + 1):
        x = -width / 2 + 0.1 + (width - 0.2) * k / count
        s.rod((x, 0.05, height - 1.1), (x, reach - 0.4, height - 0.12), 0.05, steel())
        s.box((0.12, reach, 0.16), (x, reach / 2, height - 0.13), steel(), 0.01)
    return s.built()


def letters(body: str, cap: float, *, lit: bool = True) -> Built:
    """Build flat letters with the cap height ``cap`` on a rail, emissive white if lit.

    The wall is the plane y = 0. The letters are centred on z = 0.
    """
    s = Solid("wall letters")
    face = glowing_face("white", 1.5) if lit else paint("white", dirt=0.25)
    width, _ = s.text(body, cap, (0, 0.12, 0), face, facing="+Y")
    for z in (-cap * 0.22, cap * 0.22):
        s.box((width, 0.05, 0.06), (0, 0.05, z), steel(dark=True), 0.0)
    return s.built()
