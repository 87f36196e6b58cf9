"""Streets after rain: wet asphalt with puddles and paint, and paved footways with kerbs."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from scope_studio.kit.core.mesh import from_data
from scope_studio.kit.core.shading import Shader, Value
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built
from scope_studio.kit.ground.markings import Stencil

KERB_M = 0.12
"""Height of the footways above the road, in metres."""

PAINT_HEIGHT_M = 0.004
"""Height of paint above the road, in metres."""

Outline = Sequence[tuple[float, float]]


def carriageway(half_m: float, gutters: Sequence[Stencil]) -> Built:
    """Build a square of asphalt on z = 0, twice ``half_m`` wide, with standing water along the ``gutters``."""
    h = half_m
    sheet = from_data("asphalt", [(-h, -h, 0), (h, -h, 0), (h, h, 0), (-h, h, 0)], [(0, 1, 2, 3)], _asphalt(gutters))
    return Built.of("asphalt", [sheet])


def _asphalt(gutters: Sequence[Stencil]) -> bpy.types.Material:
    """Return the material of wet asphalt with puddles, which are larger along the gutters."""
    s = Shader("wet asphalt")
    p = s.position()
    x, y, _ = s.xyz(p)
    stones = s.xyz(s.voronoi(p, 70.0, output="Color"))[0]
    fine, medium, broad = s.noise(p, 8.0, 4.0, 0.65), s.noise(p, 0.9, 5.0, 0.6), s.noise(p, 0.13, 4.0)
    tone = s.math("ADD", 0.024, s.math("MULTIPLY", stones, 0.022))
    tone = s.math("ADD", tone, s.math("MULTIPLY", s.math("SUBTRACT", medium, 0.5), 0.020))
    tone = s.math("ADD", tone, s.math("MULTIPLY", s.math("SUBTRACT", broad, 0.45), 0.035))
    grey = s.node("ShaderNodeCombineColor")
    for socket, warmth in zip(grey.inputs, (1.0, 1.0, 1.03), strict=True):
        s.set_input(socket, s.math("MULTIPLY", tone, warmth))
    colour: Value = s.mix(_patchwork(s, p, fine), grey.outputs[0], (0.012, 0.012, 0.0125))
    low = s.math("ADD", s.noise(p, 0.34, 4.0, 0.5, 0.4), s.math("MULTIPLY", _gutter_mask(s, gutters, x, y), 0.085))
    puddle = s.ramp(low, 0.585, 0.615)
    damp = s.ramp(low, 0.40, 0.60)
    rough = s.mix(damp, (0.46, 0.46, 0.46), (0.20, 0.20, 0.20))
    rough = s.mix(puddle, rough, (0.035, 0.035, 0.035))
    colour = s.mix(s.math("MULTIPLY", puddle, 0.55), colour, (0.010, 0.010, 0.010))
    bumps = s.math("ADD", s.math("MULTIPLY", stones, 0.6), fine)
    flat = s.math("SUBTRACT", 1.0, puddle)
    normal = s.bump(s.math("MULTIPLY", bumps, flat), 0.16, 0.004)
    return s.surface(base_color=colour, roughness=rough, specular_ior_level=0.55, normal=normal)


def _patchwork(s: Shader, p: Value, fine: Value) -> Value:
    """Return a mask of trenches filled with newer, darker asphalt. They are cells of a stretched Chebyshev Voronoi pattern."""
    cell = s.node("ShaderNodeTexVoronoi", distance="CHEBYCHEV")
    s.set_input(cell.inputs["Vector"], s.scaled(p, (0.30, 0.085, 0.0)))
    cell.inputs["Scale"].default_value = 1.0
    return s.math("MULTIPLY", s.ramp(s.xyz(cell.outputs["Color"])[0], 0.80, 0.81), s.ramp(fine, 0.2, 0.7, 0.6, 0.9))


def markings(bars: Sequence[Stencil], colour: str) -> Built:
    """Build worn "white" or "yellow" road paint over rectangles in world coordinates (u = x, v = y)."""
    points, faces = [], []
    for bar in bars:
        n = len(points)
        points += [
            (bar.u0, bar.v0, PAINT_HEIGHT_M),
            (bar.u1, bar.v0, PAINT_HEIGHT_M),
            (bar.u1, bar.v1, PAINT_HEIGHT_M),
            (bar.u0, bar.v1, PAINT_HEIGHT_M),
        ]
        faces.append((n, n + 1, n + 2, n + 3))
    return Built.of("road paint", [from_data("road paint", points, faces, road_paint(colour))])


def road_paint(colour: str) -> bpy.types.Material:
    """Return the material of thermoplastic paint under a film of water. Asphalt shows through where the paint is worn."""
    existing = bpy.data.materials.get(f"road paint {colour}")
    if existing is not None:
        return existing
    s = Shader(f"road paint {colour}")
    p = s.position()
    tint = {"white": (0.56, 0.56, 0.53), "yellow": (0.60, 0.37, 0.022)}[colour]
    fine, wear = s.noise(p, 8.0, 4.0, 0.65), s.noise(p, 2.6, 6.0, 0.72)
    base = s.mix(s.ramp(fine, 0.35, 0.7, 0.0, 0.45), tint, tuple(c * 0.45 for c in tint))
    worn = s.ramp(s.math("ADD", wear, s.math("MULTIPLY", s.noise(p, 40.0, 2.0), 0.2)), 0.42, 0.54, 0.8, 0.0)
    colour_out = s.mix(worn, base, (0.030, 0.030, 0.031))
    return s.surface(base_color=colour_out, roughness=s.ramp(s.noise(p, 1.3), 0.35, 0.65, 0.12, 0.34))


def _gutter_mask(s: Shader, gutters: Sequence[Stencil], x: Value, y: Value) -> Value:
    """Return a mask with soft edges that is 1 along the gutters."""
    total: Value = 0.0
    for bar in gutters:
        mask = s.math("MULTIPLY", s.band(x, bar.u0, bar.u1, 0.35), s.band(y, bar.v0, bar.v1, 0.35))
        total = s.math("MAXIMUM", total, mask)
    return total


def footway(outline: Outline, *, slab: tuple[float, float] = (0.60, 0.45)) -> Built:
    """Build paving over a convex outline (anticlockwise), with its top at ``KERB_M`` and granite kerbs on all sides."""
    s = Solid("footway")
    ring = [(x, y, KERB_M) for x, y in outline]
    s.add(ring, [tuple(range(len(ring)))], _paving(slab))
    stone = _kerbstone()
    inner = _inset(outline, 0.15)
    n = len(ring)
    low = [(x, y, -0.02) for x, y in outline]
    brow = [(x, y, KERB_M - 0.015) for x, y in outline]
    lip = [(x, y, KERB_M + 0.004) for x, y in _inset(outline, 0.018)]
    back = [(x, y, KERB_M + 0.004) for x, y in inner]
    faces = [(k * n + i, k * n + (i + 1) % n, (k + 1) * n + (i + 1) % n, (k + 1) * n + i) for k in range(3) for i in range(n)]
    s.add([*low, *brow, *lip, *back], faces, stone)
    return s.built()


def _inset(outline: Outline, by_m: float) -> list[tuple[float, float]]:
    """Return a convex outline, inset by ``by_m`` metres."""
    corners = []
    n = len(outline)
    for i in range(n):
        (x0, y0), (x1, y1), (x2, y2) = outline[i - 1], outline[i], outline[(i + 1) % n]
        ax, ay, bx, by = x1 - x0, y1 - y0, x2 - x1, y2 - y1
        la, lb = (ax * ax + ay * ay) ** 0.5, (bx * bx + by * by) ** 0.5
        nx, ny = -ay / la - by / lb, ax / la + bx / lb
        scale = 2 * by_m / max(1e-6, nx * nx + ny * ny)
        corners.append((x1 + nx * scale, y1 + ny * scale))
    return corners


def _paving(slab: tuple[float, float]) -> bpy.types.Material:
    """Return the material of wet concrete flags in running bond, with blotches, chewing gum and small puddles."""
    s = Shader(f"wet paving {slab[0]:.2f}")
    p = s.position()
    brick = s.node("ShaderNodeTexBrick")
    s.set_input(brick.inputs["Vector"], s.scaled(p, (1.0, 1.0, 0.0)))
    settings = {
        "Scale": 1.0,
        "Mortar Size": 0.007,
        "Mortar Smooth": 0.2,
        "Brick Width": slab[0],
        "Row Height": slab[1],
        "Bias": 0.0,
    }
    for key, value in settings.items():
        brick.inputs[key].default_value = value
    s.set_input(brick.inputs["Color1"], (0.150, 0.145, 0.134))
    s.set_input(brick.inputs["Color2"], (0.088, 0.085, 0.080))
    s.set_input(brick.inputs["Mortar"], (0.022, 0.022, 0.019))
    medium, fine = s.noise(p, 0.8, 6.0, 0.62), s.noise(p, 14.0, 4.0, 0.65)
    colour = s.mix(s.ramp(medium, 0.35, 0.70, 0.0, 0.55), brick.outputs["Color"], (0.055, 0.053, 0.050))
    colour = s.mix(s.ramp(fine, 0.35, 0.75, 0.0, 0.3), colour, (0.20, 0.195, 0.18))
    gum = s.ramp(s.voronoi(p, 1.9), 0.035, 0.045, 0.7, 0.0)
    colour = s.mix(gum, colour, (0.045, 0.044, 0.042))
    low = s.noise(p, 0.55, 4.0, 0.5, 0.3)
    puddle = s.ramp(low, 0.605, 0.625)
    rough = s.mix(s.ramp(low, 0.40, 0.60), (0.48, 0.48, 0.48), (0.24, 0.24, 0.24))
    rough = s.mix(puddle, rough, (0.04, 0.04, 0.04))
    colour = s.mix(s.math("MULTIPLY", puddle, 0.5), colour, (0.02, 0.02, 0.02))
    height = s.math("SUBTRACT", s.math("MULTIPLY", fine, 0.25), brick.outputs["Fac"])
    normal = s.bump(s.math("MULTIPLY", height, s.math("SUBTRACT", 1.0, puddle)), 0.5, 0.008)
    return s.surface(base_color=colour, roughness=rough, specular_ior_level=0.5, normal=normal)


def _kerbstone() -> bpy.types.Material:
    """Return the material of wet granite kerb stones."""
    existing = bpy.data.materials.get("wet kerb")
    if existing is not None:
        return existing
    s = Shader("wet kerb")
    p = s.position()
    x, y, _ = s.xyz(p)
    speckle = s.xyz(s.voronoi(p, 110.0, output="Color"))[0]
    colour = s.mix(s.ramp(speckle, 0.2, 0.9), (0.12, 0.118, 0.115), (0.25, 0.245, 0.235))
    joint = s.ramp(s.math("FLOORED_MODULO", s.math("ADD", x, y), 0.91), 0.004, 0.012, 1.0, 0.0)
    colour = s.mix(s.math("MAXIMUM", joint, s.ramp(s.noise(p, 3.0, 5.0), 0.45, 0.75, 0.0, 0.55)), colour, (0.04, 0.039, 0.036))
    return s.surface(base_color=colour, roughness=s.ramp(s.noise(p, 2.0), 0.35, 0.65, 0.2, 0.45))
