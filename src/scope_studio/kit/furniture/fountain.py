"""A fountain with a basin, an inscribed plinth, and a bronze material for its statue."""

from __future__ import annotations

import math
from collections.abc import Sequence

import bpy

from scope_studio.kit.buildings.wall_materials import ashlar
from scope_studio.kit.core.finishes import paint
from scope_studio.kit.core.lettering import extent
from scope_studio.kit.core.shading import Shader, plain
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built


def fountain_basin(radius: float = 3.0) -> Built:
    """Build a stone basin with a moulded rim, water, and eight low jets.

    A base in the centre, 1.5 m square and 0.6 m high, supports a pedestal.
    """
    s = Solid("fountain")
    stone = _basin_stone()
    s.lathe(
        [
            (radius + 0.25, 0.0),
            (radius + 0.25, 0.10),
            (radius + 0.10, 0.14),
            (radius + 0.06, 0.42),
            (radius + 0.16, 0.48),
            (radius + 0.16, 0.56),
            (radius - 0.16, 0.57),
            (radius - 0.18, 0.30),
        ],
        stone,
        steps=64,
    )
    s.lathe([(radius - 0.15, 0.30), (radius - 0.15, 0.40)], _water(), steps=64)
    s.box((1.5, 1.5, 0.6), (0, 0, 0.30), stone, 0.03)
    jet = plain("water jet", (0.62, 0.70, 0.74), 0.25)
    for k in range(8):
        a = 2 * math.pi * (k + 0.5) / 8
        u, v = math.cos(a), math.sin(a)
        for j in range(3):
            reach, lift = 0.85 + 0.10 * j, 0.75 + 0.08 * j
            path = [
                (u * (radius - 0.3 - reach * t), v * (radius - 0.3 - reach * t), 0.42 + lift * 4 * t * (1 - t))
                for t in (i / 9 for i in range(10))
            ]
            s.tube(path, 0.008, jet, sides=5, radius_b=0.022)
        s.lathe([(0.10, 0.405), (0.02, 0.45)], jet, (u * (radius - 1.25), v * (radius - 1.25), 0), steps=10)
    return s.built()


def _basin_stone() -> bpy.types.Material:
    return ashlar("fountain stone", (0.42, 0.39, 0.33), (1.6, 0.6))


def _water() -> bpy.types.Material:
    s = Shader("fountain water")
    p = s.object_coords()
    ripple = s.noise(p, 6.0, 4.0, 0.6, 0.8)
    return s.surface(base_color=(0.030, 0.075, 0.078), roughness=0.06, normal=s.bump(ripple, 0.5, 0.03), specular_ior_level=0.6)


def plinth(lines: Sequence[str], *, height: float = 2.2, side: float = 1.1) -> Built:
    """Build a stone pedestal with a moulded foot and cap, and an inscribed slate tablet on its +y face."""
    s = Solid("plinth")
    stone = _basin_stone()
    s.box((side + 0.5, side + 0.5, 0.35), (0, 0, 0.17), stone, 0.04)
    s.box((side + 0.25, side + 0.25, 0.18), (0, 0, 0.43), stone, 0.05)
    s.box((side, side, height - 0.5), (0, 0, height / 2 + 0.15), stone, 0.02)
    s.box((side + 0.28, side + 0.28, 0.16), (0, 0, height - 0.08), stone, 0.04)
    s.box(
        (side - 0.14, 0.02, 0.95), (0, side / 2 + 0.004, height / 2 + 0.18), plain("slate tablet", (0.07, 0.075, 0.08), 0.5), 0.01
    )
    gold = paint("yellow", dirt=0.08, roughness=0.3)
    for k, line in enumerate(lines):
        cap = min(0.13 if k == 0 else 0.10, (side - 0.24) / extent(line, 1.0))
        s.text(line, cap, (0, side / 2 + 0.016, height / 2 + 0.46 - 0.22 * k), gold)
    return s.built()


def apply_bronze(built: Built) -> Built:
    """Replace all materials of ``built`` with weathered bronze, and return ``built``."""
    metal = _bronze()
    for obj in built.objects:
        for slot in obj.material_slots:
            slot.link = "OBJECT"
            slot.material = metal
    return built


def _bronze() -> bpy.types.Material:
    material = bpy.data.materials.get("statue bronze")
    if material is None:
        s = Shader("statue bronze")
        p = s.object_coords()
        _, _, z = s.xyz(s.node("ShaderNodeNewGeometry").outputs["Normal"])
        patina = s.math("MULTIPLY", s.ramp(z, -0.1, 0.7), s.ramp(s.noise(p, 5.0, 6.0, 0.65), 0.38, 0.62, 0.25, 0.95))
        colour = s.mix(patina, (0.055, 0.035, 0.020), (0.16, 0.30, 0.23))
        material = s.surface(base_color=colour, metallic=0.55, roughness=0.48)
    return material
