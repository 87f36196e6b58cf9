"""Fixed structures: an overbridge with its embankments, sheds, houses, a barn, a pylon, timber fences."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence

import bpy

from scope_ptz.studio.kit.mesh import Point, box, from_data, join, text, tube
from scope_ptz.studio.kit.shading import Shader, plain
from scope_ptz.studio.kit.stage import Built, TextMark

Rgb = tuple[float, float, float]


def concrete_material(name: str = "structural concrete", tone: Rgb = (0.36, 0.345, 0.315)) -> bpy.types.Material:
    """Board-marked concrete with rain streaks, lifts every 1.2 m and dirt near the ground."""
    found = bpy.data.materials.get(name)
    if found is not None:
        return found
    s = Shader(name)
    p = s.object_coords()
    _, _, z = s.xyz(p)
    blotch = s.noise(p, 0.7, detail=7.0, roughness=0.62)
    streak = s.noise(s.scaled(p, (2.6, 2.6, 0.10)), 1.0, detail=5.0, roughness=0.6)
    fine = s.noise(p, 14.0, detail=3.0)
    colour = s.mix(s.ramp(blotch, 0.28, 0.72), tuple(c * 0.72 for c in tone), tone)
    colour = s.mix(s.ramp(streak, 0.50, 0.72, 0.0, 0.60), colour, (0.085, 0.082, 0.074))
    joint = s.ramp(s.math("PINGPONG", z, 0.6), 0.004, 0.016, 0.45, 0.0)
    colour = s.mix(joint, colour, (0.12, 0.115, 0.10))
    low = s.math("ADD", z, s.math("MULTIPLY", blotch, 1.2))
    colour = s.mix(s.ramp(low, 0.6, 1.3, 0.55, 0.0), colour, (0.10, 0.095, 0.075))
    return s.surface(base_color=colour, roughness=0.88, normal=s.bump(s.math("ADD", fine, blotch), 0.15, 0.01))


def overbridge(
    *, span_m: float, width_m: float = 9.0, deck_m: float = 6.9, number: str = "", banner: Sequence[str] = ()
) -> Built:
    """A two-span concrete road bridge along x, its pier at the origin; a number plate and a banner on both faces.

    ``deck_m`` is the height of the road surface on it. Abutments stand at both ends of ``span_m``.
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
    parts.append(box("centre line", (span_m + 9, 0.10, 0.01), (0, 0, deck_m - 0.036), plain("old paint", (0.5, 0.5, 0.48), 0.8), bevel_m=0))
    parts += _rails(span_m, edge, deck_m)
    marks: list[TextMark] = []
    for side, facing in ((-1, "-Y"), (1, "+Y")):
        y = side * (edge + 0.235)
        if number:
            parts.append(box("number plate", (1.05, 0.03, 0.42), (-side * 9.0, y, deck_m - 0.28), plain("plate white", (0.75, 0.75, 0.73))))
            letters, mark = text("number", number, 0.20, (-side * 9.0, y + side * 0.02, deck_m - 0.28), plain("plate black", (0.01, 0.01, 0.01)), facing=facing)
            parts.append(letters)
            marks.append(mark)
        if banner:
            made, written = _banner(banner, side, facing, edge, deck_m)
            parts += made
            marks += written
    return Built.of("overbridge", parts, marks)


def _piers(edge: float, under: float, concrete: bpy.types.Material) -> list[bpy.types.Object]:
    parts = [box("crosshead", (1.3, 2 * edge - 1.2, 0.9), (0, 0, under - 1.05), concrete, bevel_m=0.06)]
    for k in (-1, 0, 1):
        parts.append(box("pier", (0.85, 1.15, under - 1.4), (0, k * (edge - 1.9), (under - 1.4) / 2), concrete, bevel_m=0.28, segments=4))
    return parts


def _abutments(half: float, edge: float, deck_m: float, under: float, concrete: bpy.types.Material) -> list[bpy.types.Object]:
    """Bank seats on paved slopes, and wing walls that hold the embankments."""
    parts = []
    for side in (-1, 1):
        parts.append(box("bank seat", (1.4, 2 * edge - 0.2, 2.2), (side * (half + 0.4), 0, under - 1.3), concrete, bevel_m=0.05))
        inner, outer = side * (half - 6.2), side * half
        slope = [(inner, -edge, 0.0), (inner, edge, 0.0), (outer, edge, under - 1.6), (outer, -edge, under - 1.6)]
        parts.append(from_data("paved slope", slope, [(0, 1, 2, 3)], paving_material()))
        for y in (-edge, edge):
            wing = [(inner, y, -0.1), (outer, y, under - 1.6), (outer, y, deck_m - 0.5), (side * (half + 6), y, deck_m - 0.5), (side * (half + 6), y, -0.1)]
            thick = [(x, yy - math.copysign(0.4, y), z) for x, yy, z in wing]
            faces = [(0, 1, 2, 3, 4), (9, 8, 7, 6, 5)] + [(k, (k + 1) % 5, (k + 1) % 5 + 5, k + 5) for k in range(5)]
            parts.append(from_data("wing wall", [*wing, *thick], faces, concrete))
    return parts


def paving_material() -> bpy.types.Material:
    """Square concrete setts, 0.3 m, on a slope."""
    s = Shader("slope paving")
    x, y, z = s.xyz(s.object_coords())
    joint = s.math("MINIMUM", s.math("PINGPONG", y, 0.15), s.math("PINGPONG", s.math("MULTIPLY", z, 1.7), 0.15))
    blotch = s.noise(s.object_coords(), 0.9, detail=6.0)
    colour = s.mix(s.ramp(blotch, 0.3, 0.7), (0.14, 0.135, 0.12), (0.27, 0.26, 0.235))
    colour = s.mix(s.ramp(joint, 0.004, 0.016, 0.8, 0.0), colour, (0.05, 0.055, 0.035))
    return s.surface(base_color=colour, roughness=0.92)


def _rails(span_m: float, edge: float, deck_m: float) -> list[bpy.types.Object]:
    steel = plain("galvanised", (0.42, 0.44, 0.45), 0.45, 0.7)
    parts = []
    reach = span_m / 2 + 4.4
    for y in (-edge, edge):
        made = [tube("rail", [(-reach, y, deck_m + 1.12), (reach, y, deck_m + 1.12)], 0.04, steel)]
        count = int(reach * 2 / 2.2)
        for k in range(count + 1):
            x = -reach + 2 * reach * k / count
            made.append(box("post", (0.07, 0.05, 0.30), (x, y, deck_m + 0.98), steel, bevel_m=0))
        parts.append(join("rails", made))
    return parts


def _banner(lines: Sequence[str], side: int, facing: str, edge: float, deck_m: float) -> tuple[list[bpy.types.Object], list[TextMark]]:
    """A tied vinyl sheet on the parapet; ``side`` -1 is the south face."""
    y = side * (edge + 0.145)
    x = side * 5.6
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
    """An embankment carrying the bridge's road from x = 0 at ``height_m`` down to the ground, towards +x (side 1) or -x."""
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


def cladding_material(name: str, colour: Rgb, pitch_m: float = 0.2) -> bpy.types.Material:
    """Profiled metal sheet with vertical ribs, dirt below and rain marks."""
    found = bpy.data.materials.get(name)
    if found is not None:
        return found
    s = Shader(name)
    p = s.object_coords()
    x, y, z = s.xyz(p)
    rib = s.math("PINGPONG", s.math("ADD", x, y), pitch_m / 2)
    wave = s.ramp(rib, pitch_m * 0.12, pitch_m * 0.30)
    tint = s.mix(wave, tuple(c * 0.72 for c in colour), colour)
    stain = s.noise(s.scaled(p, (1.5, 1.5, 0.12)), 1.0, detail=5.0)
    tint = s.mix(s.ramp(stain, 0.5, 0.75, 0.0, 0.4), tint, tuple(c * 0.45 for c in colour))
    tint = s.mix(s.ramp(z, 0.0, 1.2, 0.4, 0.0), tint, (0.10, 0.09, 0.075))
    return s.surface(base_color=tint, roughness=0.48, metallic=0.0, normal=s.bump(wave, 0.5, 0.03))


def shed(
    *, width_m: float, depth_m: float, height_m: float, colour: Rgb, trim: Rgb, lettering: str = "", docks: int = 3, windows: int = 0
) -> Built:
    """An industrial shed facing north: low-pitched roof, plinth, loading doors, an office strip, a name over the doors."""
    tag = f"{colour[0]:.2f} {colour[1]:.2f} {colour[2]:.2f}"
    skin = cladding_material(f"cladding {tag}", colour)
    edge = plain(f"trim {trim[0]:.2f} {trim[1]:.2f} {trim[2]:.2f}", trim, 0.45)
    w, d, h = width_m / 2, depth_m / 2, height_m
    ridge = h + depth_m * 0.06
    walls = [(-w, -d, 0), (w, -d, 0), (w, d, 0), (-w, d, 0), (-w, -d, h), (w, -d, h), (w, d, h), (-w, d, h), (-w, 0, ridge), (w, 0, ridge)]
    parts = [
        from_data("walls", walls, [(0, 1, 5, 4), (2, 3, 7, 6), (1, 2, 6, 9, 5), (3, 0, 4, 8, 7)], skin),
        from_data("roof", [(-w - 0.2, -d - 0.3, h), (w + 0.2, -d - 0.3, h), (w + 0.2, d + 0.3, h), (-w - 0.2, d + 0.3, h), (-w - 0.2, 0, ridge + 0.03), (w + 0.2, 0, ridge + 0.03)], [(0, 1, 5, 4), (4, 5, 2, 3)], cladding_material("roof sheet", (0.33, 0.35, 0.36), 0.33)),
        box("plinth", (width_m + 0.12, depth_m + 0.12, 0.9), (0, 0, 0.45), concrete_material()),
        box("eaves", (width_m + 0.5, 0.25, 0.55), (0, d + 0.1, h - 0.1), edge),
        box("eaves", (width_m + 0.5, 0.25, 0.55), (0, -d - 0.1, h - 0.1), edge),
    ]
    for x in (-w, w):
        parts.append(box("corner", (0.25, 0.25, h), (x, d, h / 2), edge))
    s = Shader("shutter")
    _, _, z = s.xyz(s.object_coords())
    slat = s.ramp(s.math("PINGPONG", z, 0.12), 0.01, 0.05)
    shutter = s.surface(base_color=s.mix(slat, (0.15, 0.16, 0.17), (0.42, 0.43, 0.44)), roughness=0.5, normal=s.bump(slat, 0.4, 0.02))
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
        cap = min(1.3, width_m * 0.72 / (0.85 * len(lettering)))
        letters, mark = text("lettering", lettering, cap, (0, d + 0.10, h - 1.45), plain("sign white", (0.8, 0.8, 0.78), 0.4), facing="+Y", thickness_m=0.08)
        parts.append(letters)
        marks.append(mark)
    return Built.of("shed", parts, marks)


def brick_material(name: str, colour: Rgb) -> bpy.types.Material:
    found = bpy.data.materials.get(name)
    if found is not None:
        return found
    s = Shader(name)
    x, y, z = s.xyz(s.object_coords())
    plane = s.node("ShaderNodeCombineXYZ")
    s.feed(plane.inputs[0], s.math("ADD", x, y))
    s.feed(plane.inputs[1], z)
    brick = s.node("ShaderNodeTexBrick")
    s.feed(brick.inputs["Vector"], plane.outputs[0])
    for key, value in {"Scale": 1.0, "Mortar Size": 0.006, "Brick Width": 0.225, "Row Height": 0.075, "Bias": -0.2}.items():
        brick.inputs[key].default_value = value
    s.feed(brick.inputs["Color1"], colour)
    s.feed(brick.inputs["Color2"], tuple(c * 0.62 for c in colour))
    s.feed(brick.inputs["Mortar"], (0.30, 0.28, 0.25))
    blotch = s.noise(s.object_coords(), 0.8, detail=5.0)
    tint = s.mix(s.ramp(blotch, 0.4, 0.75, 0.0, 0.45), brick.outputs["Color"], (0.11, 0.085, 0.07))
    return s.surface(base_color=tint, roughness=0.9)


def tile_material(name: str, colour: Rgb) -> bpy.types.Material:
    found = bpy.data.materials.get(name)
    if found is not None:
        return found
    s = Shader(name)
    p = s.object_coords()
    _, _, z = s.xyz(p)
    course = s.ramp(s.math("PINGPONG", z, 0.09), 0.005, 0.05)
    blotch = s.noise(p, 1.6, detail=6.0)
    tint = s.mix(s.ramp(blotch, 0.3, 0.7), tuple(c * 0.6 for c in colour), colour)
    tint = s.mix(course, tuple(c * 0.5 for c in colour), tint)
    return s.surface(base_color=tint, roughness=0.85, normal=s.bump(course, 0.5, 0.03))


def house(*, brick: Rgb, roof: Rgb, door: Rgb, width_m: float = 10.0, depth_m: float = 7.5, seed: int = 0) -> Built:
    """A two-storey house facing north: brick walls, gabled tile roof, chimney, framed windows on all four sides."""
    rng = random.Random(f"house-{seed}")
    tag = f"{brick[0]:.2f} {roof[0]:.2f}"
    wall, tile = brick_material(f"brick {tag}", brick), tile_material(f"tiles {tag}", roof)
    frame, glass = plain("window frame", (0.60, 0.60, 0.58), 0.5), plain("dark glazing", (0.018, 0.024, 0.030), 0.06)
    w, d, h = width_m / 2, depth_m / 2, 5.3
    ridge = h + d * 0.85
    walls = [(-w, -d, 0), (w, -d, 0), (w, d, 0), (-w, d, 0), (-w, -d, h), (w, -d, h), (w, d, h), (-w, d, h), (-w, 0, ridge), (w, 0, ridge)]
    parts = [from_data("walls", walls, [(0, 1, 5, 4), (2, 3, 7, 6), (1, 2, 6, 9, 5), (3, 0, 4, 8, 7)], wall)]
    for side in (-1, 1):
        lower, upper = (side * (d + 0.45), h - 0.38), (0.0, ridge + 0.08)
        quad = [(-w - 0.3, *lower), (w + 0.3, *lower), (w + 0.3, *upper), (-w - 0.3, *upper)]
        thick = [(x, y, z - 0.14) for x, y, z in quad]
        faces = [(0, 1, 2, 3), (7, 6, 5, 4), (0, 4, 5, 1), (1, 5, 6, 2), (3, 2, 6, 7), (0, 3, 7, 4)]
        parts.append(from_data("roof", [*quad, *thick], faces, tile))
        parts.append(box("gutter", (width_m + 0.7, 0.12, 0.12), (0, side * (d + 0.46), h - 0.46), plain("gutter", (0.03, 0.03, 0.03))))
    chimney_x = rng.choice([-1, 1]) * w * 0.7
    parts.append(box("chimney", (0.9, 0.6, 1.9), (chimney_x, 0, ridge + 0.55), wall))
    for k in (-1, 1):
        parts.append(box("pot", (0.24, 0.24, 0.45), (chimney_x + 0.2 * k, 0, ridge + 1.7), plain("pot", (0.30, 0.13, 0.07)), bevel_m=0.05))
    blind = plain("blind", (0.55, 0.53, 0.48), 0.8)
    for side in (-1, 1):
        for x in (-w * 0.62, w * 0.05, w * 0.66):
            for z in (1.55, 4.05):
                if side == 1 and x == w * 0.05 and z < 2:
                    continue
                parts += _window((x, side * d, z), side, frame, glass, blind if rng.random() < 0.3 else None)
    parts.append(box("door", (0.95, 0.08, 2.05), (w * 0.05, d + 0.02, 1.05), plain(f"door {door[0]:.2f} {door[1]:.2f}", door, 0.35)))
    parts.append(box("porch", (1.7, 0.9, 0.12), (w * 0.05, d + 0.45, 2.45), tile))
    return Built.of("house", parts)


def _window(
    at: Point, side: int, frame: bpy.types.Material, glass: bpy.types.Material, blind: bpy.types.Material | None
) -> list[bpy.types.Object]:
    x, y, z = at
    parts = [
        box("pane", (1.25, 0.04, 1.15), (x, y + side * 0.012, z), glass, bevel_m=0),
        box("sill", (1.5, 0.16, 0.08), (x, y + side * 0.06, z - 0.63), frame),
        box("lintel", (1.5, 0.05, 0.20), (x, y + side * 0.02, z + 0.70), plain("lintel", (0.42, 0.40, 0.36), 0.9)),
    ]
    for dx, dz, size in ((0, 0.58, (1.3, 0.07, 0.07)), (0, -0.58, (1.3, 0.07, 0.07)), (-0.62, 0, (0.07, 0.07, 1.2)), (0.62, 0, (0.07, 0.07, 1.2)), (0, 0, (0.05, 0.07, 1.2))):
        parts.append(box("frame", size, (x + dx, y + side * 0.025, z + dz), frame, bevel_m=0))
    if blind is not None:
        parts.append(box("blind", (1.15, 0.02, 0.5), (x, y + side * 0.036, z + 0.3), blind, bevel_m=0))
    return parts


def barn(*, width_m: float = 22.0, depth_m: float = 12.0, height_m: float = 5.2) -> Built:
    """An open-fronted farm barn facing north, timber above block walls, with a rusty roof and straw bales inside."""
    wood = cladding_material("barn boards", (0.105, 0.080, 0.058), 0.15)
    rust = cladding_material("barn roof", (0.22, 0.125, 0.085), 0.25)
    w, d, h = width_m / 2, depth_m / 2, height_m
    ridge = h + depth_m * 0.16
    walls = [(-w, -d, 0), (w, -d, 0), (w, d, 0), (-w, d, 0), (-w, -d, h), (w, -d, h), (w, d, h), (-w, d, h), (-w, 0, ridge), (w, 0, ridge)]
    parts = [
        from_data("walls", walls, [(0, 1, 5, 4), (1, 2, 6, 9, 5), (3, 0, 4, 8, 7)], wood),
        from_data("roof", [(-w - 0.4, -d - 0.5, h - 0.1), (w + 0.4, -d - 0.5, h - 0.1), (w + 0.4, d + 0.5, h - 0.1), (-w - 0.4, d + 0.5, h - 0.1), (-w - 0.4, 0, ridge), (w + 0.4, 0, ridge)], [(0, 1, 5, 4), (4, 5, 2, 3)], rust),
    ]
    steel = plain("barn steel", (0.12, 0.12, 0.12), 0.6)
    for k in range(5):
        parts.append(box("post", (0.25, 0.25, h), (-w + k * width_m / 4, d, h / 2), steel))
    straw = plain("straw", (0.34, 0.26, 0.10), 0.95)
    for k in range(6):
        for z in (0.6, 1.8):
            parts.append(box("bale", (2.3, 1.15, 1.15), (-w + 2.2 + k * 2.45, d - 3.0, z), straw, bevel_m=0.08))
    return Built.of("barn", parts)


def pylon(height_m: float = 30.0) -> Built:
    """A lattice transmission tower, arms across x."""
    steel = plain("pylon steel", (0.30, 0.31, 0.32), 0.55, 0.5)
    parts = []

    def half(z: float) -> float:
        t = z / height_m
        return 3.0 * (1 - t) ** 1.4 + 0.45

    levels = [height_m * t for t in (0, 0.16, 0.31, 0.44, 0.55, 0.64, 0.72, 0.80, 0.88, 0.96)]
    for z0, z1 in zip(levels, levels[1:], strict=False):
        a, b = half(z0), half(z1)
        low = [(-a, -a, z0), (a, -a, z0), (a, a, z0), (-a, a, z0)]
        high = [(-b, -b, z1), (b, -b, z1), (b, b, z1), (-b, b, z1)]
        for k in range(4):
            n = (k + 1) % 4
            parts.append(tube("leg", [low[k], high[k]], 0.10, steel, sides=4))
            parts.append(tube("brace", [low[k], high[n]], 0.05, steel, sides=4))
            parts.append(tube("brace", [low[n], high[k]], 0.05, steel, sides=4))
    for share, reach in ((0.66, 5.5), (0.80, 6.6), (0.93, 4.8)):
        z = height_m * share
        for side in (-1, 1):
            for y in (-0.5, 0.5):
                parts.append(tube("arm", [(side * half(z), y, z), (side * reach, 0, z + 0.3)], 0.07, steel, sides=4))
            parts.append(tube("arm", [(side * half(z), 0, z + 1.6), (side * reach, 0, z + 0.3)], 0.07, steel, sides=4))
            parts.append(tube("insulator", [(side * reach, 0, z + 0.3), (side * reach, 0, z - 1.6)], 0.11, plain("insulator", (0.10, 0.07, 0.05), 0.2), sides=6))
    return Built.of("pylon", [join("pylon", parts)])


def post_and_rail(length_m: float = 9.0) -> Built:
    """A timber boundary fence along x: posts every 1.8 m, four rails."""
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


def concrete_pad(size: tuple[float, float]) -> Built:
    return Built.of("pad", [box("pad", (*size, 0.16), (0, 0, 0.0), concrete_material(), bevel_m=0.02)])
