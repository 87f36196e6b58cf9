"""Office wings: wall panels, windows with rooms behind them, and doors. Fronts face +y, with the wall on y = 0."""

from __future__ import annotations

import random
from collections.abc import Sequence

import bpy

from scope_studio.kit.buildings.warehouse import Opening, wall
from scope_studio.kit.core.finishes import concrete, glass, paint, pane, steel
from scope_studio.kit.core.shading import Shader, plain
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built
from scope_studio.kit.light.glow import glowing_face, lit_lens


def window(*, width: float = 1.5, height: float = 1.3, lit: bool = True, blind: float = 0.0, seed: int = 0) -> Built:
    """Build a framed window, either dark or with a shallow lit room behind it.

    The room has a ceiling lamp, shelves, and a desk with a screen. The wall is the plane y = 0; it must have a hole for
    the window. ``blind`` is the fraction of the height that a blind covers.
    """
    s = Solid("window")
    rng = random.Random(f"window {seed}")
    frame = paint("dark grey", dirt=0.2)
    for x in (-width / 2, width / 2):
        s.box((0.07, 0.16, height + 0.07), (x, -0.06, 0), frame, 0.005)
    for z in (-height / 2, height / 2):
        s.box((width, 0.16, 0.07), (0, -0.06, z), frame, 0.005)
    s.box((0.05, 0.08, height), (0, -0.06, 0), frame, 0.004)
    s.box((width + 0.2, 0.14, 0.05), (0, 0.05, -height / 2 - 0.05), paint("light grey", dirt=0.4), 0.008)
    if not lit:
        s.box((width, 0.02, height), (0, -0.07, 0), glass(), 0.0)
        return s.built()
    s.box((width, 0.01, height), (0, -0.07, 0), pane(0.12), 0.0)
    depth, warm = 2.2, rng.choice([(0.95, 0.76, 0.50), (0.86, 0.84, 0.74), (0.80, 0.86, 0.90)])
    room = _room_wall(warm)
    a, b, low, high = -width / 2 - 0.3, width / 2 + 0.3, -height / 2 - 0.6, height / 2 + 0.25
    corners = [(x, y, z) for y in (-0.12, -depth) for x, z in ((a, low), (b, low), (b, high), (a, high))]
    s.add(corners, [(4, 5, 6, 7), (0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4)], room)
    s.add(corners, [(3, 7, 6, 2)], lit_lens("warm", 0.9))
    s.box((0.9, 0.25, 0.02), (0, -depth * 0.55, high - 0.03), lit_lens("led", 3.0), 0.0)
    dark = plain("room furniture", (0.06, 0.05, 0.045), 0.7)
    s.box((width * 0.7, 0.6, 0.05), (rng.uniform(-0.1, 0.1), -0.8, -height / 2 + 0.05), dark, 0.01)
    x = rng.uniform(-0.4, 0.4)
    s.box((0.55, 0.03, 0.34), (x, -0.75, -height / 2 + 0.35), dark, 0.005)
    s.box((0.5, 0.004, 0.29), (x, -0.765, -height / 2 + 0.35), glowing_face("blue", 0.9), 0.0)
    for k in range(rng.randrange(2, 5)):
        s.box((0.16, 0.25, rng.uniform(0.3, 0.9)), (a + 0.25 + 0.28 * k, -depth + 0.2, low + 0.9), dark, 0.01)
    s.box(
        (rng.uniform(0.4, 0.8), 0.02, 0.5),
        (rng.uniform(-0.2, 0.4), -depth + 0.03, 0.25),
        plain("room board", (0.30, 0.32, 0.36), 0.6),
        0.0,
    )
    if blind:
        cover = plain("room blind", (0.50, 0.46, 0.38), 0.8)
        for k in range(int(height * blind / 0.07)):
            s.box((width - 0.06, 0.012, 0.055), (0, -0.13, height / 2 - 0.05 - 0.07 * k), cover, 0.0)
    return s.built()


def _room_wall(warm: tuple[float, float, float]) -> bpy.types.Material:
    name = f"room wall {warm[0]:.2f}"
    existing = bpy.data.materials.get(name)
    if existing is not None:
        return existing
    s = Shader(name)
    z = s.xyz(s.object_coords())[2]
    shade = s.ramp(s.math("ADD", z, s.math("MULTIPLY", s.noise(s.object_coords(), 1.2), 0.5)), -1.2, 1.2, 0.28, 0.75)
    return s.surface(base_color=tuple(c * 0.5 for c in warm), roughness=0.9, emission_color=warm, emission_strength=shade)


def wing(*, width: float, depth: float, height: float, openings: Sequence[Opening], colour: tuple[float, float, float]) -> Built:
    """Build an office wing with a flat roof, a parapet, a plinth, and openings for windows in its front (y = 0)."""
    s = Solid("office")
    finish = office_panel(colour)
    wall(s, -width / 2, width / 2, 0.0, height, openings, finish)
    for x in (-width / 2, width / 2):
        s.box((0.22, depth, height), (x, -depth / 2, height / 2), finish, 0.0)
    s.box((width, 0.22, height), (0, -depth, height / 2), finish, 0.0)
    s.box((width, depth, 0.15), (0, -depth / 2, height - 0.2), concrete(light=False), 0.0)
    for y in (0.02, -depth - 0.02):
        s.box((width + 0.3, 0.34, 0.30), (0, y, height), paint("blue", dirt=0.3), 0.01)
    for x in (-width / 2, width / 2):
        s.box((0.34, depth, 0.30), (x, -depth / 2, height), paint("blue", dirt=0.3), 0.01)
    s.box((width + 0.08, 0.05, 0.30), (0, 0.02, 0.15), concrete(light=False), 0.0)
    s.box((1.6, 1.0, 0.8), (width * 0.2, -depth * 0.5, height + 0.4), paint("light grey", dirt=0.4), 0.03)
    return s.built()


def office_panel(colour: tuple[float, float, float]) -> bpy.types.Material:
    """Return the material of flat composite panels, 1.2 m wide, with dark joints and rain streaks."""
    existing = bpy.data.materials.get("office panel")
    if existing is not None:
        return existing
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


def door(*, glazed: bool = True, lit: bool = True, height: float = 2.2, width: float = 1.1) -> Built:
    """Build a personnel door on the plane y = 0, standing on z = 0. If it is glazed and lit, a bright room is visible behind it."""
    s = Solid("door")
    frame = paint("dark grey", dirt=0.2)
    for x in (-width / 2 - 0.05, width / 2 + 0.05):
        s.box((0.10, 0.16, height + 0.1), (x, 0.02, height / 2), frame, 0.006)
    s.box((width + 0.2, 0.16, 0.10), (0, 0.02, height + 0.05), frame, 0.006)
    if glazed:
        s.box((width, 0.02, height), (0, 0.02, height / 2), glowing_room() if lit else glass(), 0.0)
        for z in (0.12, height * 0.48, height - 0.06):
            s.box((width, 0.07, 0.10), (0, 0.04, z), frame, 0.006)
        s.rod((width * 0.36, 0.10, 0.85), (width * 0.36, 0.10, 1.35), 0.018, steel())
    else:
        s.box((width, 0.05, height), (0, 0.04, height / 2), paint("blue", dirt=0.35), 0.006)
        s.rod((width * 0.2, 0.10, 1.0), (width * 0.38, 0.10, 1.0), 0.014, steel())
    return s.built()


def glowing_room() -> bpy.types.Material:
    """Return a material that imitates a lit lobby behind a door: bright at the top, dark at the floor, with blurred furniture."""
    existing = bpy.data.materials.get("glowing lobby")
    if existing is not None:
        return existing
    s = Shader("glowing lobby")
    x, _, z = s.xyz(s.object_coords())
    tone = s.mix(s.ramp(z, 0.2, 2.2), (0.42, 0.33, 0.22), (1.0, 0.88, 0.66))
    shape = s.math("MULTIPLY", s.band(x, -0.42, 0.05, 0.04), s.band(z, 0.0, 0.95, 0.05))
    tone = s.mix(s.math("MULTIPLY", shape, 0.75), tone, (0.06, 0.045, 0.035))
    return s.surface(base_color=(0.02, 0.02, 0.02), roughness=0.1, emission_color=tone, emission_strength=0.75)
