"""A distribution warehouse: clad front with dock openings, lit hall, canopy, and an office wing with rooms behind its windows.

Fronts face +y, with the outer face of the wall on y = 0; the building extends towards -y. Positions along the front are x,
which grows to the left for someone who looks at the front.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from itertools import pairwise

import bpy

from scope_studio.kit.buildings.wall_materials import cladding_material
from scope_studio.kit.core.finishes import concrete, glass, paint, pane, steel
from scope_studio.kit.core.shading import Shader, plain
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built
from scope_studio.kit.light.glow import glowing_face, lit_lens

DOCK_SILL_M, DOCK_WIDE_M, DOCK_TALL_M = 1.20, 2.9, 3.0
Opening = tuple[float, float, float, float]
"""x from, x to, z from, z to."""


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
    """Add a wall on y = 0 from ``x0`` to ``x1`` with rectangular holes. It is cut into upright strips at the edges of the holes."""
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
    """Build the warehouse: front with openings, other walls, parapet, low roof with roof lights and vents, and the hall inside.

    The hall's floor is at dock height, but at yard level where x is below ``ramp_to``. Its back wall is 13 m behind the front.
    """
    s = Solid("warehouse")
    skin, trim = cladding_material("warehouse cladding", colour, 0.25), plain("warehouse band", band, 0.45)
    w, h = width / 2, height
    wall(s, -w, w, 1.3, h, openings, skin)
    wall(s, -w, w, 0.0, 1.3, openings, concrete(light=False), 0.30)
    s.box((width + 0.2, 0.10, 0.55), (0, 0.05, h + 0.10), trim, 0.01)
    s.box((width + 0.24, 0.36, 0.08), (0, -0.06, h + 0.40), paint("light grey", dirt=0.4), 0.01)
    for x in (-w, w):
        s.box((0.22, depth, h - 1.3), (x, -depth / 2, 1.3 + (h - 1.3) / 2), skin, 0.0)
        s.box((0.30, depth, 1.3), (x, -depth / 2, 0.65), concrete(light=False), 0.0)
        s.box((0.34, depth, 0.55), (x, -depth / 2, h + 0.10), trim, 0.01)
    s.box((width, 0.22, h), (0, -depth, h / 2), skin, 0.0)
    s.box((width + 0.2, 0.30, 0.55), (0, -depth, h + 0.10), trim, 0.01)
    _roof(s, w, depth, h)
    _hall(s, w, h, ramp_to)
    return s.built()


def _roof(s: Solid, w: float, depth: float, h: float) -> None:
    """Add two shallow roof slopes with emissive roof lights, smoke vents and plant."""
    sheet_, glowing = cladding_material("warehouse roof", (0.20, 0.21, 0.22), 0.33), roof_light()
    rise = 1.3
    for y0, y1, z0, z1 in ((-0.2, -depth / 2, h, h + rise), (-depth / 2, -depth, h + rise, h)):
        s.add([(-w, y0, z0), (w, y0, z0), (w, y1, z1), (-w, y1, z1)], [(0, 3, 2, 1) if y1 > y0 else (0, 1, 2, 3)], sheet_)
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
    """Return translucent roof sheet over a lit hall."""
    found = bpy.data.materials.get("roof light")
    if found is not None:
        return found
    s = Shader("roof light")
    ribs = s.ramp(s.math("PINGPONG", s.xyz(s.object_coords())[0], 0.16), 0.02, 0.08, 0.7, 1.0)
    return s.surface(
        base_color=(0.5, 0.5, 0.45),
        roughness=0.4,
        emission_color=(1.0, 0.88, 0.62),
        emission_strength=s.math("MULTIPLY", ribs, 0.42),
    )


def _hall(s: Solid, w: float, h: float, ramp_to: float) -> None:
    """Add what is visible through the open docks: floor, lamps, racking with cartons, and a back wall."""
    rng = random.Random("hall")
    pale, deep = plain("hall wall", (0.42, 0.43, 0.42), 0.8), -13.0
    s.box((w - 0.3 - ramp_to, 12.8, DOCK_SILL_M), ((ramp_to + w - 0.3) / 2, deep / 2 - 0.1, DOCK_SILL_M / 2), concrete(), 0.0)
    s.box((2 * w - 0.6, 0.1, h), (0, deep, h / 2), pale, 0.0)
    s.box((2 * w - 0.6, 12.8, 0.1), (0, deep / 2, h - 0.35), plain("hall ceiling", (0.25, 0.26, 0.27), 0.8), 0.0)
    blue, orange = paint("blue", dirt=0.2), paint("orange", dirt=0.2)
    boards = [
        plain(f"hall carton {k}", c, 0.85)
        for k, c in enumerate(((0.34, 0.22, 0.12), (0.42, 0.30, 0.17), (0.24, 0.26, 0.30), (0.45, 0.44, 0.42)))
    ]
    x = -w + 3.0
    while x < w - 4.0:
        for px in (x, x + 2.7):
            s.box((0.09, 0.9, 5.0), (px, deep + 1.4, 3.7), blue, 0.0)
        for level in range(3):
            z = 1.22 + 1.75 * level
            if level:
                s.box((2.7, 0.9, 0.12), (x + 1.35, deep + 1.4, z - 0.06), orange, 0.0)
            for k in range(2):
                if rng.random() < 0.85:
                    tall = rng.uniform(0.8, 1.45)
                    s.box((1.12, 0.95, tall), (x + 0.70 + 1.3 * k, deep + 1.45, z + tall / 2 + 0.02), rng.choice(boards), 0.01)
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
    """Build flat-cut letters on a rail, emissive white when lit. The wall behind is y = 0, their middle is z = 0."""
    s = Solid("wall letters")
    face = glowing_face("white", 1.5) if lit else paint("white", dirt=0.25)
    width, _ = s.text(body, cap, (0, 0.12, 0), face, facing="+Y")
    for z in (-cap * 0.22, cap * 0.22):
        s.box((width, 0.05, 0.06), (0, 0.05, z), steel(dark=True), 0.0)
    return s.built()


def window(*, wide: float = 1.5, tall: float = 1.3, lit: bool = True, blind: float = 0.0, seed: int = 0) -> Built:
    """Build a framed window, either dark or with a shallow lit room behind it.

    The room has a ceiling lamp, shelves, and a desk with a screen. The wall is y = 0, with a hole cut for the window. ``blind``
    is the share of the height that a blind covers.
    """
    s = Solid("window")
    rng = random.Random(f"window {seed}")
    frame = paint("dark grey", dirt=0.2)
    for x in (-wide / 2, wide / 2):
        s.box((0.07, 0.16, tall + 0.07), (x, -0.06, 0), frame, 0.005)
    for z in (-tall / 2, tall / 2):
        s.box((wide, 0.16, 0.07), (0, -0.06, z), frame, 0.005)
    s.box((0.05, 0.08, tall), (0, -0.06, 0), frame, 0.004)
    s.box((wide + 0.2, 0.14, 0.05), (0, 0.05, -tall / 2 - 0.05), paint("light grey", dirt=0.4), 0.008)
    if not lit:
        s.box((wide, 0.02, tall), (0, -0.07, 0), glass(), 0.0)
        return s.built()
    s.box((wide, 0.01, tall), (0, -0.07, 0), pane(0.12), 0.0)
    deep, warm = 2.2, rng.choice([(0.95, 0.76, 0.50), (0.86, 0.84, 0.74), (0.80, 0.86, 0.90)])
    room = _room_wall(warm)
    a, b, low, high = -wide / 2 - 0.3, wide / 2 + 0.3, -tall / 2 - 0.6, tall / 2 + 0.25
    corners = [(x, y, z) for y in (-0.12, -deep) for x, z in ((a, low), (b, low), (b, high), (a, high))]
    s.add(corners, [(4, 5, 6, 7), (0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4)], room)
    s.add(corners, [(3, 7, 6, 2)], lit_lens("warm", 0.9))
    s.box((0.9, 0.25, 0.02), (0, -deep * 0.55, high - 0.03), lit_lens("led", 3.0), 0.0)
    dark = plain("room furniture", (0.06, 0.05, 0.045), 0.7)
    s.box((wide * 0.7, 0.6, 0.05), (rng.uniform(-0.1, 0.1), -0.8, -tall / 2 + 0.05), dark, 0.01)
    x = rng.uniform(-0.4, 0.4)
    s.box((0.55, 0.03, 0.34), (x, -0.75, -tall / 2 + 0.35), dark, 0.005)
    s.box((0.5, 0.004, 0.29), (x, -0.765, -tall / 2 + 0.35), glowing_face("blue", 0.9), 0.0)
    for k in range(rng.randrange(2, 5)):
        s.box((0.16, 0.25, rng.uniform(0.3, 0.9)), (a + 0.25 + 0.28 * k, -deep + 0.2, low + 0.9), dark, 0.01)
    s.box(
        (rng.uniform(0.4, 0.8), 0.02, 0.5),
        (rng.uniform(-0.2, 0.4), -deep + 0.03, 0.25),
        plain("room board", (0.30, 0.32, 0.36), 0.6),
        0.0,
    )
    if blind:
        cover = plain("room blind", (0.50, 0.46, 0.38), 0.8)
        for k in range(int(tall * blind / 0.07)):
            s.box((wide - 0.06, 0.012, 0.055), (0, -0.13, tall / 2 - 0.05 - 0.07 * k), cover, 0.0)
    return s.built()


def _room_wall(warm: tuple[float, float, float]) -> bpy.types.Material:
    name = f"room wall {warm[0]:.2f}"
    found = bpy.data.materials.get(name)
    if found is not None:
        return found
    s = Shader(name)
    z = s.xyz(s.object_coords())[2]
    shade = s.ramp(s.math("ADD", z, s.math("MULTIPLY", s.noise(s.object_coords(), 1.2), 0.5)), -1.2, 1.2, 0.28, 0.75)
    return s.surface(base_color=tuple(c * 0.5 for c in warm), roughness=0.9, emission_color=warm, emission_strength=shade)


def wing(*, width: float, depth: float, height: float, openings: Sequence[Opening], colour: tuple[float, float, float]) -> Built:
    """Build an office wing with openings for windows in its front (y = 0), flat roof, parapet and plinth."""
    s = Solid("office")
    skin = office_panel(colour)
    wall(s, -width / 2, width / 2, 0.0, height, openings, skin)
    for x in (-width / 2, width / 2):
        s.box((0.22, depth, height), (x, -depth / 2, height / 2), skin, 0.0)
    s.box((width, 0.22, height), (0, -depth, height / 2), skin, 0.0)
    s.box((width, depth, 0.15), (0, -depth / 2, height - 0.2), concrete(light=False), 0.0)
    for y in (0.02, -depth - 0.02):
        s.box((width + 0.3, 0.34, 0.30), (0, y, height), paint("blue", dirt=0.3), 0.01)
    for x in (-width / 2, width / 2):
        s.box((0.34, depth, 0.30), (x, -depth / 2, height), paint("blue", dirt=0.3), 0.01)
    s.box((width + 0.08, 0.05, 0.30), (0, 0.02, 0.15), concrete(light=False), 0.0)
    s.box((1.6, 1.0, 0.8), (width * 0.2, -depth * 0.5, height + 0.4), paint("light grey", dirt=0.4), 0.03)
    return s.built()


def office_panel(colour: tuple[float, float, float]) -> bpy.types.Material:
    """Return flat composite panels, 1.2 m wide, with dark joints and rain marks."""
    found = bpy.data.materials.get("office panel")
    if found is not None:
        return found
    s = Shader("office panel")
    p = s.object_coords()
    x, y, z = s.xyz(p)
    joint = s.math(
        "MAXIMUM",
        *(
            s.ramp(s.math("PINGPONG", axis, size / 2), 0.006, 0.014, 1.0, 0.0)
            for axis, size in ((s.math("ADD", x, y), 1.2), (z, 1.05))
        ),
    )
    stain = s.ramp(s.noise(s.scaled(p, (1.5, 1.5, 0.15)), 1.0, detail=5.0), 0.5, 0.75, 0.0, 0.35)
    tint = s.mix(stain, colour, tuple(c * 0.45 for c in colour))
    return s.surface(base_color=s.mix(joint, tint, (0.03, 0.03, 0.03)), roughness=0.45)


def door(*, glazed: bool = True, lit: bool = True, tall: float = 2.2, wide: float = 1.1) -> Built:
    """Build a personnel door on y = 0, standing on z = 0. When glazed and lit, it has a bright room behind it."""
    s = Solid("door")
    frame = paint("dark grey", dirt=0.2)
    for x in (-wide / 2 - 0.05, wide / 2 + 0.05):
        s.box((0.10, 0.16, tall + 0.1), (x, 0.02, tall / 2), frame, 0.006)
    s.box((wide + 0.2, 0.16, 0.10), (0, 0.02, tall + 0.05), frame, 0.006)
    if glazed:
        s.box((wide, 0.02, tall), (0, 0.02, tall / 2), glowing_room() if lit else glass(), 0.0)
        for z in (0.12, tall * 0.48, tall - 0.06):
            s.box((wide, 0.07, 0.10), (0, 0.04, z), frame, 0.006)
        s.rod((wide * 0.36, 0.10, 0.85), (wide * 0.36, 0.10, 1.35), 0.018, steel())
    else:
        s.box((wide, 0.05, tall), (0, 0.04, tall / 2), paint("blue", dirt=0.35), 0.006)
        s.rod((wide * 0.2, 0.10, 1.0), (wide * 0.38, 0.10, 1.0), 0.014, steel())
    return s.built()


def glowing_room() -> bpy.types.Material:
    """Return the image of a lit lobby behind a door: bright above, darker at the floor, with blurred furniture."""
    found = bpy.data.materials.get("glowing lobby")
    if found is not None:
        return found
    s = Shader("glowing lobby")
    x, _, z = s.xyz(s.object_coords())
    tone = s.mix(s.ramp(z, 0.2, 2.2), (0.42, 0.33, 0.22), (1.0, 0.88, 0.66))
    shape = s.math("MULTIPLY", s.band(x, -0.42, 0.05, 0.04), s.band(z, 0.0, 0.95, 0.05))
    tone = s.mix(s.math("MULTIPLY", shape, 0.75), tone, (0.06, 0.045, 0.035))
    return s.surface(base_color=(0.02, 0.02, 0.02), roughness=0.1, emission_color=tone, emission_strength=0.75)
