"""Detached buildings: industrial sheds, brick houses, a barn. Fronts face north."""

from __future__ import annotations

import random

import bpy

from scope_studio.kit.buildings.wall_materials import brick_material, cladding_material, concrete_material, tile_material
from scope_studio.kit.core.mesh import Point, box, from_data, text
from scope_studio.kit.core.shading import Shader, plain
from scope_studio.kit.core.stage import Built, TextMark

Rgb = tuple[float, float, float]


def shed(
    *,
    width_m: float,
    depth_m: float,
    height_m: float,
    colour: Rgb,
    trim: Rgb,
    lettering: str = "",
    docks: int = 3,
    windows: int = 0,
) -> Built:
    """Build an industrial shed facing north, with a low-pitched roof, loading doors, office windows and a name over the doors."""
    tag = f"{colour[0]:.2f} {colour[1]:.2f} {colour[2]:.2f}"
    finish = cladding_material(f"cladding {tag}", colour)
    edge = plain(f"trim {trim[0]:.2f} {trim[1]:.2f} {trim[2]:.2f}", trim, 0.45)
    w, d, h = width_m / 2, depth_m / 2, height_m
    ridge = h + depth_m * 0.06
    walls = [
        (-w, -d, 0),
        (w, -d, 0),
        (w, d, 0),
        (-w, d, 0),
        (-w, -d, h),
        (w, -d, h),
        (w, d, h),
        (-w, d, h),
        (-w, 0, ridge),
        (w, 0, ridge),
    ]
    parts = [
        from_data("walls", walls, [(0, 1, 5, 4), (2, 3, 7, 6), (1, 2, 6, 9, 5), (3, 0, 4, 8, 7)], finish),
        from_data(
            "roof",
            [
                (-w - 0.2, -d - 0.3, h),
                (w + 0.2, -d - 0.3, h),
                (w + 0.2, d + 0.3, h),
                (-w - 0.2, d + 0.3, h),
                (-w - 0.2, 0, ridge + 0.03),
                (w + 0.2, 0, ridge + 0.03),
            ],
            [(0, 1, 5, 4), (4, 5, 2, 3)],
            cladding_material("roof sheet", (0.33, 0.35, 0.36), 0.33),
        ),
        box("plinth", (width_m + 0.12, depth_m + 0.12, 0.9), (0, 0, 0.45), concrete_material()),
        box("eaves", (width_m + 0.5, 0.25, 0.55), (0, d + 0.1, h - 0.1), edge),
        box("eaves", (width_m + 0.5, 0.25, 0.55), (0, -d - 0.1, h - 0.1), edge),
    ]
    for x in (-w, w):
        parts.append(box("corner", (0.25, 0.25, h), (x, d, h / 2), edge))
    s = Shader("shutter")
    _, _, z = s.xyz(s.object_coords())
    slat = s.ramp(s.math("PINGPONG", z, 0.12), 0.01, 0.05)
    shutter = s.surface(
        base_color=s.mix(slat, (0.15, 0.16, 0.17), (0.42, 0.43, 0.44)), roughness=0.5, normal=s.bump(slat, 0.4, 0.02)
    )
    for k in range(docks):
        x = -w * 0.75 + k * (width_m * 0.62 / max(1, docks))
        parts.append(box("shutter", (4.0, 0.08, 4.4), (x, d + 0.09, 2.2), shutter))
        for side in (-1, 1):
            parts.append(box("door frame", (0.2, 0.16, 4.6), (x + side * 2.05, d + 0.1, 2.3), edge))
        parts.append(box("door head", (4.3, 0.16, 0.25), (x, d + 0.1, 4.55), edge))
    glass = plain("dark glazing", (0.018, 0.024, 0.030), 0.06)
    frame = plain("window frame", (0.60, 0.60, 0.58), 0.5)
    for k in range(windows):
        x = w * 0.42 + k * 1.75
        for z0 in (1.9, min(5.0, h - 2.2)):
            parts.append(box("window", (1.4, 0.06, 1.2), (x, d + 0.08, z0), glass, bevel_m=0))
            parts.append(box("sill", (1.55, 0.18, 0.08), (x, d + 0.12, z0 - 0.64), frame))
            parts.append(box("mullion", (0.06, 0.10, 1.2), (x, d + 0.09, z0), frame, bevel_m=0))
    marks: list[TextMark] = []
    if lettering:
        ink = edge if sum(colour) > 1.2 else plain("sign white", (0.8, 0.8, 0.78), 0.4)
        cap = min(1.3, width_m * 0.72 / (0.85 * len(lettering)))
        letters, mark = text("lettering", lettering, cap, (0, d + 0.10, h - 1.45), ink, facing="+Y", thickness_m=0.08)
        parts.append(letters)
        marks.append(mark)
    return Built.of("shed", parts, marks)


def house(*, brick: Rgb, roof: Rgb, door: Rgb, width_m: float = 10.0, depth_m: float = 7.5, seed: int = 0) -> Built:
    """Build a two-storey brick house facing north, with a gabled tile roof, a chimney, and framed windows at the front and back."""
    rng = random.Random(f"house-{seed}")
    tag = f"{brick[0]:.2f} {roof[0]:.2f}"
    wall, tile = brick_material(f"brick {tag}", brick), tile_material(f"tiles {tag}", roof)
    frame, glass = plain("window frame", (0.60, 0.60, 0.58), 0.5), plain("dark glazing", (0.018, 0.024, 0.030), 0.06)
    w, d, h = width_m / 2, depth_m / 2, 5.3
    ridge = h + d * 0.85
    walls = [
        (-w, -d, 0),
        (w, -d, 0),
        (w, d, 0),
        (-w, d, 0),
        (-w, -d, h),
        (w, -d, h),
        (w, d, h),
        (-w, d, h),
        (-w, 0, ridge),
        (w, 0, ridge),
    ]
    parts = [from_data("walls", walls, [(0, 1, 5, 4), (2, 3, 7, 6), (1, 2, 6, 9, 5), (3, 0, 4, 8, 7)], wall)]
    for side in (-1, 1):
        lower, upper = (side * (d + 0.45), h - 0.38), (0.0, ridge + 0.08)
        quad = [(-w - 0.3, *lower), (w + 0.3, *lower), (w + 0.3, *upper), (-w - 0.3, *upper)]
        thick = [(x, y, z - 0.14) for x, y, z in quad]
        faces = [(0, 1, 2, 3), (7, 6, 5, 4), (0, 4, 5, 1), (1, 5, 6, 2), (3, 2, 6, 7), (0, 3, 7, 4)]
        parts.append(from_data("roof", [*quad, *thick], faces, tile))
        parts.append(
            box("gutter", (width_m + 0.7, 0.12, 0.12), (0, side * (d + 0.46), h - 0.46), plain("gutter", (0.03, 0.03, 0.03)))
        )
    chimney_x = rng.choice([-1, 1]) * w * 0.7
    parts.append(box("chimney", (0.9, 0.6, 1.9), (chimney_x, 0, ridge + 0.55), wall))
    for k in (-1, 1):
        parts.append(
            box("pot", (0.24, 0.24, 0.45), (chimney_x + 0.2 * k, 0, ridge + 1.7), plain("pot", (0.30, 0.13, 0.07)), bevel_m=0.05)
        )
    blind = plain("blind", (0.55, 0.53, 0.48), 0.8)
    for side in (-1, 1):
        for x in (-w * 0.62, w * 0.05, w * 0.66):
            for z in (1.55, 4.05):
                if side == 1 and x == w * 0.05 and z < 2:
                    continue
                parts += _window((x, side * d, z), side, frame, glass, blind if rng.random() < 0.3 else None)
    parts.append(
        box("door", (0.95, 0.08, 2.05), (w * 0.05, d + 0.02, 1.05), plain(f"door {door[0]:.2f} {door[1]:.2f}", door, 0.35))
    )
    parts.append(box("porch", (1.7, 0.9, 0.12), (w * 0.05, d + 0.45, 2.45), tile))
    return Built.of("house", parts)


def _window(
    at: Point, side: int, frame: bpy.types.Material, glass: bpy.types.Material, blind: bpy.types.Material | None
) -> list[bpy.types.Object]:
    """Create a framed window at a position, on the front (``side`` 1) or the back (-1)."""
    x, y, z = at
    parts = [
        box("pane", (1.25, 0.04, 1.15), (x, y + side * 0.012, z), glass, bevel_m=0),
        box("sill", (1.5, 0.16, 0.08), (x, y + side * 0.06, z - 0.63), frame),
        box("lintel", (1.5, 0.05, 0.20), (x, y + side * 0.02, z + 0.70), plain("lintel", (0.42, 0.40, 0.36), 0.9)),
    ]
    for dx, dz, size in (
        (0, 0.58, (1.3, 0.07, 0.07)),
        (0, -0.58, (1.3, 0.07, 0.07)),
        (-0.62, 0, (0.07, 0.07, 1.2)),
        (0.62, 0, (0.07, 0.07, 1.2)),
        (0, 0, (0.05, 0.07, 1.2)),
    ):
        parts.append(box("frame", size, (x + dx, y + side * 0.025, z + dz), frame, bevel_m=0))
    if blind is not None:
        parts.append(box("blind", (1.15, 0.02, 0.5), (x, y + side * 0.036, z + 0.3), blind, bevel_m=0))
    return parts


def barn(*, width_m: float = 22.0, depth_m: float = 12.0, height_m: float = 5.2) -> Built:
    """Build an open-fronted barn facing north, with boarded walls, a rusty roof, and straw bales inside."""
    wood = cladding_material("barn boards", (0.105, 0.080, 0.058), 0.15)
    rust = cladding_material("barn roof", (0.22, 0.125, 0.085), 0.25)
    w, d, h = width_m / 2, depth_m / 2, height_m
    ridge = h + depth_m * 0.16
    walls = [
        (-w, -d, 0),
        (w, -d, 0),
        (w, d, 0),
        (-w, d, 0),
        (-w, -d, h),
        (w, -d, h),
        (w, d, h),
        (-w, d, h),
        (-w, 0, ridge),
        (w, 0, ridge),
    ]
    parts = [
        from_data("walls", walls, [(0, 1, 5, 4), (1, 2, 6, 9, 5), (3, 0, 4, 8, 7)], wood),
        from_data(
            "roof",
            [
                (-w - 0.4, -d - 0.5, h - 0.1),
                (w + 0.4, -d - 0.5, h - 0.1),
                (w + 0.4, d + 0.5, h - 0.1),
                (-w - 0.4, d + 0.5, h - 0.1),
                (-w - 0.4, 0, ridge),
                (w + 0.4, 0, ridge),
            ],
            [(0, 1, 5, 4), (4, 5, 2, 3)],
            rust,
        ),
    ]
    steel = plain("barn steel", (0.12, 0.12, 0.12), 0.6)
    for k in range(5):
        parts.append(box("post", (0.25, 0.25, h), (-w + k * width_m / 4, d, h / 2), steel))
    straw = plain("straw", (0.34, 0.26, 0.10), 0.95)
    for k in range(6):
        for z in (0.6, 1.8):
            parts.append(box("bale", (2.3, 1.15, 1.15), (-w + 2.2 + k * 2.45, d - 3.0, z), straw, bevel_m=0.08))
    return Built.of("barn", parts)
