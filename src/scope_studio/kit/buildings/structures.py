"""Fixed structures: an overbridge with its embankments, a pylon, timber fences."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import bpy
from mathutils import Vector

from scope_studio.kit.buildings.wall_materials import concrete_material
from scope_studio.kit.core.mesh import Point, box, from_data, join, text, tube
from scope_studio.kit.core.shading import Shader, plain
from scope_studio.kit.core.stage import Built, TextMark

Rgb = tuple[float, float, float]


def overbridge(*, span_m: float, width_m: float = 9.0, deck_m: float = 6.9, number: str = "", banner: Sequence[str] = ()) -> Built:
    """Build a two-span concrete road bridge along x, with its pier at the origin.

    Both faces have a number plate and a banner. ``deck_m`` is the height of the road surface on the bridge, and ``span_m`` is the
    distance between the abutments.
    """
    concrete = concrete_material()
    half, edge = span_m / 2, width_m / 2
    under = deck_m - 1.25
    parts = [box("deck", (span_m + 3.0, width_m - 0.9, 1.1), (0, 0, deck_m - 0.65), concrete, bevel_m=0.03)]
    for k in range(5):
        y = (k - 2) * (width_m - 2.2) / 4
        parts.append(box("beam", (span_m + 1.0, 0.55, 0.75), (0, y, under - 0.28), concrete, bevel_m=0.04))
    for side in (-1, 1):
        y = side * edge
        parts.append(box("edge beam", (span_m + 9, 0.45, 0.62), (0, y, deck_m - 0.28), concrete, bevel_m=0.04))
        parts.append(box("parapet", (span_m + 9, 0.24, 0.85), (0, y, deck_m + 0.44), concrete, bevel_m=0.03))
        parts.append(box("kerb", (span_m + 9, 1.1, 0.14), (0, side * (edge - 0.65), deck_m + 0.02), concrete, bevel_m=0.03))
    parts += _piers(edge, under, concrete)
    parts += _abutments(half, edge, deck_m, under, concrete)
    road = Shader("bridge road")
    tone = road.noise(road.object_coords(), 0.8, detail=6.0)
    asphalt = road.surface(base_color=road.mix(tone, (0.045, 0.045, 0.045), (0.085, 0.083, 0.080)), roughness=0.9)
    parts.append(box("surface", (span_m + 9, width_m - 2.2, 0.06), (0, 0, deck_m - 0.07), asphalt, bevel_m=0.0))
    parts.append(
        box("centre line", (span_m + 9, 0.10, 0.01), (0, 0, deck_m - 0.036), plain("old paint", (0.5, 0.5, 0.48), 0.8), bevel_m=0)
    )
    parts += _rails(span_m, edge, deck_m)
    marks: list[TextMark] = []
    for side, facing in ((-1, "-Y"), (1, "+Y")):
        y = side * (edge + 0.235)
        if number:
            parts.append(
                box("number plate", (1.05, 0.03, 0.42), (side * 16.0, y, deck_m - 0.28), plain("plate white", (0.75, 0.75, 0.73)))
            )
            letters, mark = text(
                "number",
                number,
                0.20,
                (side * 16.0, y + side * 0.02, deck_m - 0.28),
                plain("plate black", (0.01, 0.01, 0.01)),
                facing=facing,
            )
            parts.append(letters)
            marks.append(mark)
        if banner:
            objects, banner_marks = _banner(banner, side, facing, edge, deck_m)
            parts += objects
            marks += banner_marks
    return Built.of("overbridge", parts, marks)


def _piers(edge: float, under: float, concrete: bpy.types.Material) -> list[bpy.types.Object]:
    """Create the piers in the middle of the span."""
    parts = [box("crosshead", (1.3, 2 * edge - 1.2, 0.9), (0, 0, under - 1.05), concrete, bevel_m=0.06)]
    for k in (-1, 0, 1):
        parts.append(
            box("pier", (0.85, 1.15, under - 1.4), (0, k * (edge - 1.9), (under - 1.4) / 2), concrete, bevel_m=0.28, segments=4)
        )
    return parts


def _abutments(half: float, edge: float, deck_m: float, under: float, concrete: bpy.types.Material) -> list[bpy.types.Object]:
    """Create the abutments: bank seats on paved slopes, and wing walls that retain the embankments."""
    parts = []
    for side in (-1, 1):
        parts.append(box("bank seat", (1.4, 2 * edge - 0.2, 2.2), (side * (half + 0.4), 0, under - 1.3), concrete, bevel_m=0.05))
        inner, outer = side * (half - 6.2), side * half
        slope = [(inner, -edge, 0.0), (inner, edge, 0.0), (outer, edge, under - 1.6), (outer, -edge, under - 1.6)]
        parts.append(from_data("paved slope", slope, [(0, 1, 2, 3)], paving_material()))
        for y in (-edge, edge):
            wing = [
                (inner, y, -0.1),
                (outer, y, under - 1.6),
                (outer, y, deck_m - 0.5),
                (side * (half + 6), y, deck_m - 0.5),
                (side * (half + 6), y, -0.1),
            ]
            thick = [(x, yy - math.copysign(0.4, y), z) for x, yy, z in wing]
            faces = [(0, 1, 2, 3, 4), (9, 8, 7, 6, 5)] + [(k, (k + 1) % 5, (k + 1) % 5 + 5, k + 5) for k in range(5)]
            parts.append(from_data("wing wall", [*wing, *thick], faces, concrete))
    return parts


def paving_material() -> bpy.types.Material:
    """Return the material of square concrete blocks, 0.3 m wide, on a slope."""
    s = Shader("slope paving")
    _, y, z = s.xyz(s.object_coords())
    joint = s.math("MINIMUM", s.math("PINGPONG", y, 0.15), s.math("PINGPONG", s.math("MULTIPLY", z, 1.7), 0.15))
    blotch = s.noise(s.object_coords(), 0.9, detail=6.0)
    colour = s.mix(s.ramp(blotch, 0.3, 0.7), (0.14, 0.135, 0.12), (0.27, 0.26, 0.235))
    colour = s.mix(s.ramp(joint, 0.004, 0.016, 0.8, 0.0), colour, (0.05, 0.055, 0.035))
    return s.surface(base_color=colour, roughness=0.92)


def _rails(span_m: float, edge: float, deck_m: float) -> list[bpy.types.Object]:
    """Create the handrails on both parapets."""
    steel = plain("galvanised", (0.42, 0.44, 0.45), 0.45, 0.7)
    parts = []
    reach = span_m / 2 + 4.4
    for y in (-edge, edge):
        objects = [tube("rail", [(-reach, y, deck_m + 1.12), (reach, y, deck_m + 1.12)], 0.04, steel)]
        count = int(reach * 2 / 2.2)
        for k in range(count + 1):
            x = -reach + 2 * reach * k / count
            objects.append(box("post", (0.07, 0.05, 0.30), (x, y, deck_m + 0.98), steel, bevel_m=0))
        parts.append(join("rails", objects))
    return parts


def _banner(
    lines: Sequence[str], side: int, facing: str, edge: float, deck_m: float
) -> tuple[list[bpy.types.Object], list[TextMark]]:
    """Create a banner, a vinyl sheet tied to the parapet. ``side`` -1 is the south face."""
    y = side * (edge + 0.145)
    x = -side * 9.0
    width = max(len(line) for line in lines) * 0.27 + 0.9
    parts = [box("banner", (width, 0.02, 0.84), (x, y, deck_m + 0.47), plain("banner vinyl", (0.70, 0.71, 0.68), 0.5))]
    marks = []
    ink = plain("banner ink", (0.02, 0.055, 0.16), 0.5)
    for index, line in enumerate(lines):
        cap = 0.25 if index == 0 else 0.14
        z = deck_m + 0.65 - 0.38 * index
        letters, mark = text("banner text", line, cap, (x, y + side * 0.014, z), ink, facing=facing)
        parts.append(letters)
        marks.append(mark)
    return parts, marks


def approach(*, length_m: float, width_m: float, height_m: float, side: int, grass: bpy.types.Material) -> Built:
    """Build the embankment that carries the road up to the bridge, from ``height_m`` at x = 0 down to the ground.

    It extends towards +x if ``side`` is 1, and towards -x if ``side`` is -1.
    """
    steps, edge = 14, width_m / 2
    points: list[Point] = []
    for i in range(steps + 1):
        t = i / steps
        z = height_m * (1 - t * t * (3 - 2 * t)) + 0.03
        x = side * length_m * t
        foot = edge + 2.0 * z + 0.4
        points += [(x, -foot, -0.1), (x, -edge, z), (x, edge, z), (x, foot, -0.1)]
    toe = len(points)
    points += [(-side * 10.0, -edge, -0.1), (-side * 10.0, edge, -0.1)]
    bank: list[tuple[int, ...]] = [(0, toe, 1), (2, toe + 1, 3)]
    road = []
    for i in range(steps):
        a = 4 * i
        bank += [(a, a + 1, a + 5, a + 4), (a + 2, a + 3, a + 7, a + 6)]
        road.append((a + 1, a + 2, a + 6, a + 5))
    s = Shader("minor road")
    tone = s.noise(s.position(), 0.5, detail=7.0)
    _, y, _ = s.xyz(s.object_coords())
    verge = s.ramp(s.math("ADD", s.math("ABSOLUTE", y), s.math("MULTIPLY", tone, 0.5)), 3.3, 3.45)
    centre = s.ramp(s.math("ABSOLUTE", y), 0.04, 0.06, 1.0, 0.0)
    colour = s.mix(tone, (0.05, 0.05, 0.05), (0.095, 0.092, 0.088))
    colour = s.mix(centre, colour, (0.45, 0.45, 0.43))
    asphalt = s.surface(base_color=s.mix(verge, colour, (0.07, 0.10, 0.03)), roughness=0.92)
    flip = [face[::-1] for face in bank] if side < 0 else bank
    up = [face[::-1] for face in road] if side < 0 else road
    return Built.of("approach", [from_data("bank", points, flip, grass), from_data("minor road", points, up, asphalt)])


def pylon(height_m: float = 30.0) -> Built:
    """Build a lattice transmission tower with its arms across x."""
    bars: list[Bar] = []

    def half(z: float) -> float:
        return 3.0 * (1 - z / height_m) ** 1.4 + 0.45

    levels = [height_m * t for t in (0, 0.16, 0.31, 0.44, 0.55, 0.64, 0.72, 0.80, 0.88, 0.96)]
    for z0, z1 in pairwise(levels):
        a, b = half(z0), half(z1)
        low = [(-a, -a, z0), (a, -a, z0), (a, a, z0), (-a, a, z0)]
        high = [(-b, -b, z1), (b, -b, z1), (b, b, z1), (-b, b, z1)]
        for k in range(4):
            n = (k + 1) % 4
            bars += [(low[k], high[k], 0.10), (low[k], high[n], 0.05), (low[n], high[k], 0.05)]
    for fraction, reach in ((0.66, 5.5), (0.80, 6.6), (0.93, 4.8)):
        z = height_m * fraction
        for side in (-1, 1):
            tip = (side * reach, 0.0, z + 0.3)
            bars += [((side * half(z), y, z), tip, 0.07) for y in (-0.5, 0.5)]
            bars += [((side * half(z), 0.0, z + 1.6), tip, 0.07), (tip, (side * reach, 0.0, z - 1.6), 0.11)]
    return Built.of("pylon", [lattice("pylon", bars, plain("pylon steel", (0.30, 0.31, 0.32), 0.55, 0.5))])


Bar = tuple[Point, Point, float]
"""Start, end and half thickness of a straight bar."""


def lattice(name: str, bars: Sequence[Bar], material: bpy.types.Material) -> bpy.types.Object:
    """Create one mesh of square bars."""
    points: list[Point] = []
    faces: list[tuple[int, ...]] = []
    for start, end, radius in bars:
        a, b = Vector(start), Vector(end)
        u = (b - a).orthogonal().normalized() * radius
        v = (b - a).cross(u).normalized() * radius
        o = len(points)
        points += [tuple(p + d) for p in (a, b) for d in (u, v, -u, -v)]
        faces += [(o + k, o + (k + 1) % 4, o + 4 + (k + 1) % 4, o + 4 + k) for k in range(4)]
    return from_data(name, points, faces, material)


def post_and_rail(length_m: float = 9.0) -> Built:
    """Build a timber boundary fence along x, with posts every 1.8 m and four rails."""
    s = Shader("weathered timber")
    grain = s.noise(s.scaled(s.object_coords(), (0.6, 9, 9)), 2.0, detail=5.0)
    wood = s.surface(base_color=s.mix(grain, (0.085, 0.068, 0.050), (0.23, 0.20, 0.165)), roughness=0.9)
    parts = []
    count = round(length_m / 1.8)
    for k in range(count):
        parts.append(box("post", (0.10, 0.12, 1.35), (-length_m / 2 + 1.8 * k, 0, 0.62), wood, bevel_m=0.012, segments=1))
    for z in (0.30, 0.58, 0.86, 1.12):
        parts.append(box("rail", (length_m, 0.04, 0.09), (0, 0.075, z), wood, bevel_m=0.008, segments=1))
    return Built.of("post and rail fence", [join("post and rail fence", parts)])
