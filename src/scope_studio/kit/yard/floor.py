"""The floor of a freight yard: asphalt and jointed concrete, damp in places, and painted markings, which are thin meshes."""

from __future__ import annotations

import math
from collections.abc import Sequence

import bpy

from scope_studio.kit.core.mesh import from_data
from scope_studio.kit.core.shading import Shader, Value
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built

Rect = tuple[float, float, float, float]
"""Rectangle, given by its west, east, south and north edges in metres."""

MARKING_HEIGHT_M = 0.004
"""Height of markings above the floor, in metres."""


def asphalt(name: str = "yard asphalt", *, tone: float = 1.0) -> bpy.types.Material:
    """Return the material of worn asphalt with oil stains, cracks, and damp hollows that reflect the sky."""
    existing = bpy.data.materials.get(name)
    if existing is not None:
        return existing
    s = Shader(name)
    p = s.position()
    grain = s.xyz(s.voronoi(p, 55.0, output="Color"))[0]
    blotch = s.noise(p, 0.22, detail=7.0, roughness=0.62)
    fine = s.noise(p, 5.0, detail=4.0, roughness=0.65)
    value = s.math("ADD", 0.070 * tone, s.math("MULTIPLY", s.math("SUBTRACT", blotch, 0.5), 0.075 * tone))
    value = s.math("ADD", value, s.math("MULTIPLY", s.math("SUBTRACT", fine, 0.5), 0.030 * tone))
    value = s.math("ADD", value, s.math("MULTIPLY", s.math("SUBTRACT", grain, 0.5), 0.024 * tone))
    oil = s.ramp(s.noise(p, 0.8, detail=5.0, roughness=0.7), 0.60, 0.72, 1.0, 0.45)
    value = s.math("MULTIPLY", value, oil)
    value = s.math("MULTIPLY", value, s.ramp(_cracks(s, p), 0, 1, 1.0, 0.40, smooth=False))
    colour: Value = s.node("ShaderNodeCombineColor")
    for index, warmth in enumerate((1.03, 1.0, 0.97)):
        s.set_input(colour.inputs[index], s.math("MAXIMUM", s.math("MULTIPLY", value, warmth), 0.008))
    return _damp_floor(s, p, colour.outputs[0], blotch, s.math("ADD", s.math("MULTIPLY", grain, 0.5), fine))


def slabs(name: str = "yard concrete", *, joint_m: float = 6.0) -> bpy.types.Material:
    """Return the material of concrete slabs with sealed joints, dark stains, tyre marks and damp hollows."""
    existing = bpy.data.materials.get(name)
    if existing is not None:
        return existing
    s = Shader(name)
    p = s.position()
    x, y, _ = s.xyz(p)
    blotch = s.noise(p, 0.30, detail=7.0, roughness=0.62)
    fine = s.noise(p, 8.0, detail=4.0, roughness=0.65)
    cell = s.node("ShaderNodeTexWhiteNoise", noise_dimensions="2D")
    corner = s.node("ShaderNodeCombineXYZ")
    for index, axis in enumerate((x, y)):
        s.set_input(corner.inputs[index], s.math("FLOOR", s.math("DIVIDE", axis, joint_m)))
    s.set_input(cell.inputs["Vector"], corner.outputs[0])
    tone = s.math("ADD", s.math("MULTIPLY", s.ramp(blotch, 0.25, 0.75), 0.65), s.math("MULTIPLY", cell.outputs["Value"], 0.35))
    colour = s.mix(tone, (0.115, 0.112, 0.104), (0.245, 0.238, 0.222))
    colour = s.mix(s.ramp(fine, 0.3, 0.7, 0.0, 0.30), colour, (0.09, 0.088, 0.082))
    dirt = s.ramp(s.noise(p, 1.3, detail=6.0, roughness=0.7), 0.55, 0.70, 0.0, 0.6)
    colour = s.mix(dirt, colour, (0.055, 0.053, 0.050))
    tyre = s.noise(s.scaled(p, (0.9, 0.06, 1.0)), 1.0, detail=3.0, distortion=1.5)
    colour = s.mix(s.ramp(tyre, 0.54, 0.66, 0.0, 0.55), colour, (0.040, 0.040, 0.041))
    for axis in (x, y):
        near = s.math("PINGPONG", s.math("ADD", axis, joint_m / 2), joint_m / 2)
        joint = s.ramp(s.math("SUBTRACT", joint_m / 2, near), 0.010, 0.022, 1.0, 0.0)
        colour = s.mix(joint, colour, (0.018, 0.018, 0.018))
    return _damp_floor(s, p, colour, blotch, fine)


def _cracks(s: Shader, p: Value) -> Value:
    warp = s.node("ShaderNodeVectorMath", operation="ADD")
    s.set_input(warp.inputs[0], p)
    s.set_input(warp.inputs[1], s.noise(p, 0.9, detail=5.0))
    distance = s.voronoi(warp.outputs[0], 0.30, feature="DISTANCE_TO_EDGE")
    return s.math("MULTIPLY", s.ramp(distance, 0.0008, 0.0042, 1.0, 0.0), s.ramp(s.noise(p, 0.05, detail=3.0), 0.48, 0.58))


def _damp_floor(s: Shader, p: Value, colour: Value, blotch: Value, height: Value) -> bpy.types.Material:
    """Return the floor material with damp hollows, which are darker and smoother than the rest."""
    hollow = s.noise(p, 0.13, detail=4.0, roughness=0.55)
    puddle = s.ramp(s.math("ADD", hollow, s.math("MULTIPLY", s.math("SUBTRACT", blotch, 0.5), 0.22)), 0.57, 0.63)
    damp = s.ramp(hollow, 0.40, 0.60)
    colour = s.mix(s.math("MULTIPLY", damp, 0.35), colour, (0.020, 0.020, 0.021))
    colour = s.mix(s.math("MULTIPLY", puddle, 0.55), colour, (0.012, 0.012, 0.013))
    rough = s.ramp(damp, 0.0, 1.0, 0.80, 0.48, smooth=False)
    rough = s.math("ADD", s.math("MULTIPLY", rough, s.math("SUBTRACT", 1.0, puddle)), s.math("MULTIPLY", puddle, 0.13))
    bump = s.node("ShaderNodeBump")
    bump.inputs["Distance"].default_value = 0.004
    s.set_input(bump.inputs["Strength"], s.ramp(puddle, 0.0, 1.0, 0.30, 0.02))
    s.set_input(bump.inputs["Height"], height)
    return s.surface(base_color=colour, roughness=rough, specular_ior_level=0.5, normal=bump.outputs[0])


def paint(colour: str) -> bpy.types.Material:
    """Return the material of white, yellow, green or blue road paint, slightly dirty and partly worn off."""
    existing = bpy.data.materials.get(f"yard paint {colour}")
    if existing is not None:
        return existing
    rgb = {"white": (0.56, 0.56, 0.53), "yellow": (0.62, 0.40, 0.03), "green": (0.05, 0.24, 0.10), "blue": (0.03, 0.13, 0.36)}
    s = Shader(f"yard paint {colour}")
    p = s.position()
    wear = s.ramp(s.noise(p, 2.4, detail=6.0, roughness=0.72), 0.33, 0.47, 0.70, 0.08)
    grime = s.ramp(s.noise(p, 0.5, detail=5.0), 0.4, 0.7, 0.0, 0.35)
    base = s.mix(grime, rgb[colour], (0.12, 0.115, 0.105))
    fine = s.noise(p, 30.0, detail=3.0)
    chips = s.ramp(fine, 0.38, 0.46, 0.6, 0.0)
    return s.surface(base_color=s.mix(s.math("MAXIMUM", wear, chips), base, (0.055, 0.054, 0.052)), roughness=0.62)


def floor(name: str, rect: Rect, material: bpy.types.Material, z: float = 0.0) -> Built:
    """Build a flat rectangle of paving."""
    west, east, south, north = rect
    points = [(west, south, z), (east, south, z), (east, north, z), (west, north, z)]
    return Built.of(name, [from_data(name, points, [(0, 1, 2, 3)], material)])


def flat(s: Solid, outline: Sequence[tuple[float, float]], material: bpy.types.Material, z: float = MARKING_HEIGHT_M) -> None:
    """Add one painted shape, as a single face that points up."""
    area = sum(outline[i - 1][0] * outline[i][1] - outline[i][0] * outline[i - 1][1] for i in range(len(outline)))
    ring = list(outline) if area > 0 else list(outline)[::-1]
    s.add([(x, y, z) for x, y in ring], [tuple(range(len(ring)))], material)


def line(s: Solid, a: tuple[float, float], b: tuple[float, float], width: float, material: bpy.types.Material) -> None:
    """Add a painted line."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    length = math.hypot(dx, dy)
    nx, ny = -dy / length * width / 2, dx / length * width / 2
    flat(s, [(a[0] + nx, a[1] + ny), (a[0] - nx, a[1] - ny), (b[0] - nx, b[1] - ny), (b[0] + nx, b[1] + ny)], material)


def arrow(colour: str = "white", *, length: float = 4.0, turn: str = "ahead") -> Built:
    """Build a lane arrow along +y: "ahead", "left" or "right"."""
    s = Solid("painted arrow")
    ink = paint(colour)
    half = length / 2
    if turn == "ahead":
        flat(s, [(-0.09, -half), (0.09, -half), (0.09, half * 0.35), (-0.09, half * 0.35)], ink)
        flat(s, [(-0.42, half * 0.35), (0.42, half * 0.35), (0.0, half)], ink)
        return s.built()
    k = -1.0 if turn == "left" else 1.0
    flat(s, [(-0.09, -half), (0.09, -half), (0.09, half * 0.35), (-0.09, half * 0.35)], ink)
    flat(
        s, [(-0.09 * k, half * 0.35), (0.62 * k, half * 0.35), (0.62 * k, half * 0.35 + 0.30), (-0.09 * k, half * 0.35 + 0.30)], ink
    )
    flat(s, [(0.60 * k, half * 0.35 - 0.30), (1.15 * k, half * 0.35 + 0.15), (0.60 * k, half * 0.35 + 0.60)], ink)
    return s.built()


def hatch(width: float, depth: float, *, colour: str = "yellow", pitch: float = 1.0) -> Built:
    """Build a hatched keep-clear area, centred on the origin: a border with diagonal bars."""
    s = Solid("hatched zone")
    ink, w, d = paint(colour), width / 2, depth / 2
    for a, b in (((-w, -d), (w, -d)), ((w, -d), (w, d)), ((w, d), (-w, d)), ((-w, d), (-w, -d))):
        line(s, a, b, 0.12, ink)
    steps = int((width + depth) / pitch)
    for k in range(1, steps):
        c = -w - d + k * pitch  # the bar is on the line x - y = c
        ends = [
            (x, y) for x, y in ((-w, -w - c), (w, w - c), (-d + c, -d), (d + c, d)) if abs(x) <= w + 1e-6 and abs(y) <= d + 1e-6
        ]
        if len(ends) >= 2 and math.dist(ends[0], ends[-1]) > 0.2:
            line(s, min(ends), max(ends), 0.11, ink)
    return s.built()


def words(lines: Sequence[str], cap: float, *, colour: str = "white") -> Built:
    """Build lettering on the floor. It is upright for a viewer who looks towards +y."""
    s = Solid("painted words")
    for k, body in enumerate(lines):
        s.text(body, cap, (0, (len(lines) / 2 - k - 0.5) * cap * 1.5, MARKING_HEIGHT_M), paint(colour), facing="+Z", bold=True)
    return s.built()


def bay(number: str, *, width: float = 2.5, depth: float = 5.0, cap: float = 0.62, colour: str = "white") -> Built:
    """Build a parking bay open towards -y: a rectangle of floor, lines on three sides, and the number near the open end."""
    s = Solid(f"bay {number}")
    w, d = width / 2, depth / 2
    flat(s, [(-w, -d), (w, -d), (w, d), (-w, d)], asphalt("bay asphalt", tone=0.82), MARKING_HEIGHT_M / 2)
    ink = paint(colour)
    for x in (-w, w):
        line(s, (x, -d), (x, d), 0.10, ink)
    line(s, (-w, d), (w, d), 0.10, ink)
    s.text(number, cap, (0, -d + 0.35 + cap / 2, MARKING_HEIGHT_M), ink, facing="+Z")
    return s.built()
