"""Town ground: stone slabs with bands of setts, sett carriageways, kerbs, tram rails, manhole covers and tree grates."""

from __future__ import annotations

import math

import bpy

from scope_studio.kit.core.finishes import lens, paint, steel
from scope_studio.kit.core.mesh import from_data
from scope_studio.kit.core.shading import Shader, Value
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built

Rgb = tuple[float, float, float]
Area = tuple[float, float, float, float]
"""Rectangle, given by its west, east, south and north edges in metres."""


def _courses(
    s: Shader, coords: Value, size: tuple[float, float], joint_m: float, low: Rgb, high: Rgb, joint: Rgb
) -> tuple[Value, Value]:
    """Return the colour of rectangular stones in bond, each with a different tone, and a mask that is 1 in the joints."""
    node = s.node("ShaderNodeTexBrick")
    s.set_input(node.inputs["Vector"], coords)
    settings = {"Scale": 1.0, "Mortar Size": joint_m, "Mortar Smooth": 0.35, "Brick Width": size[0], "Row Height": size[1]}
    for key, value in settings.items():
        node.inputs[key].default_value = value
    for key, colour in {"Color1": low, "Color2": high, "Mortar": joint}.items():
        s.set_input(node.inputs[key], colour)
    return node.outputs["Color"], node.outputs["Fac"]


def _jitter(s: Shader, p: Value, amount_m: float, scale: float) -> Value:
    """Return positions shifted by slight noise, so that the courses look laid by hand."""
    noise = s.node("ShaderNodeTexNoise")
    s.set_input(noise.inputs["Vector"], p)
    noise.inputs["Scale"].default_value = scale
    shifted = s.node("ShaderNodeVectorMath", operation="MULTIPLY_ADD")
    s.set_input(shifted.inputs[0], noise.outputs["Color"])
    shifted.inputs[1].default_value = (2 * amount_m, 2 * amount_m, 0.0)
    s.set_input(shifted.inputs[2], p)
    return shifted.outputs[0]


def _worn_stone(s: Shader, p: Value, colour: Value, joints: Value, grain: float = 0.35) -> bpy.types.Material:
    """Return the material of worn stone, with stains, chewing gum, and relief of the joints and pits."""
    _x, _y, _ = s.xyz(p)
    stains = s.noise(p, 0.16, 7.0, 0.62)
    colour = s.mix(s.ramp(stains, 0.40, 0.72, 0.0, 0.42), colour, (0.085, 0.078, 0.068))
    spills = s.ramp(s.noise(p, 0.9, 6.0, 0.6, 0.8), 0.60, 0.66, 0.0, 0.42)
    colour = s.mix(spills, colour, (0.055, 0.050, 0.044))
    gum = s.voronoi(s.scaled(p, (1, 1, 0)), 2.6)
    gum_density = s.ramp(s.noise(p, 0.5), 0.50, 0.60)
    colour = s.mix(s.math("MULTIPLY", s.ramp(gum, 0.045, 0.06, 0.6, 0.0), gum_density), colour, (0.05, 0.048, 0.045))
    fine = s.noise(p, 26.0, 4.0, 0.7)
    colour = s.mix(s.ramp(fine, 0.3, 0.75, 0.0, grain), colour, (0.12, 0.11, 0.10))
    moss = s.math("MULTIPLY", joints, s.ramp(s.noise(p, 0.35, 4.0), 0.52, 0.66))
    colour = s.mix(moss, colour, (0.045, 0.058, 0.022))
    height = s.math("SUBTRACT", s.math("MULTIPLY", fine, 0.25), joints)
    rough = s.ramp(stains, 0.35, 0.7, 0.62, 0.86)
    return s.surface(base_color=colour, roughness=rough, normal=s.bump(height, 0.55, 0.012))


def slab_material(name: str = "square paving", *, pitch_m: float = 7.2) -> bpy.types.Material:
    """Return the material of buff and grey slabs between dark bands of setts, ``pitch_m`` apart, in world coordinates."""
    existing = bpy.data.materials.get(name)
    if existing is not None:
        return existing
    s = Shader(name)
    p = s.position()
    x, y, _ = s.xyz(p)
    slab, slab_joint = _courses(s, p, (0.9, 0.6), 0.009, (0.285, 0.240, 0.178), (0.205, 0.184, 0.150), (0.095, 0.085, 0.072))
    tint = s.ramp(s.noise(p, 1.9, 2.0), 0.35, 0.65, 0.0, 0.35)
    slab = s.mix(tint, slab, (0.30, 0.275, 0.235))
    sett, sett_joint = _courses(s, _jitter(s, p, 0.006, 9.0), (0.20, 0.10), 0.008, (0.15, 0.145, 0.14), (0.085, 0.083, 0.082),
                                (0.045, 0.041, 0.036))  # fmt: skip
    lines = [s.ramp(s.math("PINGPONG", c, pitch_m / 2), 0.298, 0.302, 1.0, 0.0, smooth=False) for c in (x, y)]
    band = s.math("MAXIMUM", lines[0], lines[1])
    joints = _blend(s, band, slab_joint, sett_joint)
    return _worn_stone(s, p, s.mix(band, slab, sett), joints)


def flag_material(name: str = "pavement flags") -> bpy.types.Material:
    """Return the material of a pavement of grey concrete and stone flags."""
    existing = bpy.data.materials.get(name)
    if existing is not None:
        return existing
    s = Shader(name)
    p = s.position()
    colour, joints = _courses(s, p, (0.75, 0.6), 0.008, (0.25, 0.24, 0.22), (0.18, 0.175, 0.165), (0.08, 0.075, 0.068))
    return _worn_stone(s, p, colour, joints)


def sett_material(name: str = "street setts", *, turn_deg: float = 0.0) -> bpy.types.Material:
    """Return the material of worn granite setts, some of them in a warmer tone."""
    existing = bpy.data.materials.get(name)
    if existing is not None:
        return existing
    s = Shader(name)
    p = s.position()
    turned = s.node("ShaderNodeMapping")
    s.set_input(turned.inputs["Vector"], p)
    turned.inputs["Rotation"].default_value = (0.0, 0.0, math.radians(turn_deg))
    wavy = _jitter(s, turned.outputs[0], 0.012, 5.0)
    colour, joints = _courses(s, wavy, (0.19, 0.12), 0.009, (0.20, 0.19, 0.175), (0.105, 0.102, 0.098), (0.05, 0.045, 0.038))
    warm = s.ramp(s.noise(s.scaled(p, (6.0, 9.0, 1.0)), 1.0, 1.0), 0.5, 0.62, 0.0, 0.5)
    return _worn_stone(s, p, s.mix(warm, colour, (0.20, 0.155, 0.125)), joints, 0.2)


def _blend(s: Shader, factor: Value, a: Value, b: Value) -> Value:
    """Mix two numbers: ``a`` where the factor is 0, ``b`` where it is 1."""
    node = s.node("ShaderNodeMix", data_type="FLOAT")
    for socket, value in zip((0, 2, 3), (factor, a, b), strict=True):
        s.set_input(node.inputs[socket], value)
    return node.outputs[0]


def floor(name: str, areas: list[Area], z: float, material: bpy.types.Material) -> Built:
    """Build flat rectangles at height ``z`` with one material."""
    points, faces = [], []
    for west, east, south, north in areas:
        base = len(points)
        points += [(west, south, z), (east, south, z), (east, north, z), (west, north, z)]
        faces.append((base, base + 1, base + 2, base + 3))
    return Built.of(name, [from_data(name, points, faces, material)])


def kerb_material() -> bpy.types.Material:
    """Return the material of granite kerb stones."""
    existing = bpy.data.materials.get("granite kerb")
    if existing is not None:
        return existing
    s = Shader("granite kerb")
    p = s.position()
    x, y, _ = s.xyz(p)
    along = s.math("PINGPONG", s.math("ADD", x, y), 0.45)
    gap = s.ramp(along, 0.004, 0.008, 1.0, 0.0)
    speckle = s.noise(p, 60.0, 2.0)
    colour = s.mix(s.ramp(speckle, 0.4, 0.65), (0.30, 0.29, 0.28), (0.17, 0.165, 0.16))
    return s.surface(base_color=s.mix(gap, colour, (0.05, 0.045, 0.04)), roughness=0.75, normal=s.bump(speckle, 0.2, 0.004))


def kerbs(lines: list[tuple[tuple[float, float], tuple[float, float]]], *, drop_m: float = 0.10) -> Built:
    """Build kerb stones, 0.16 m wide, along axis-parallel lines. Their tops are at z = 0.005; their faces are ``drop_m`` high."""
    s = Solid("kerbs")
    for (x0, y0), (x1, y1) in lines:
        size = (abs(x1 - x0) + 0.16, abs(y1 - y0) + 0.16, drop_m + 0.05)
        s.box(size, ((x0 + x1) / 2, (y0 + y1) / 2, 0.005 - size[2] / 2), kerb_material(), 0.015)
    return s.built()


def tram_rail(length_m: float) -> Built:
    """Build one grooved rail along x, with its head at z = 0.004."""
    s = Solid("tram rail")
    bright, dark = steel(), lens("black")
    s.box((length_m, 0.16, 0.01), (0, 0, -0.003), steel(dark=True), 0.0)
    s.box((length_m, 0.055, 0.010), (0, -0.035, 0.001), bright, 0.002)
    s.box((length_m, 0.034, 0.008), (0, 0.012, 0.0005), dark, 0.0)
    s.box((length_m, 0.022, 0.010), (0, 0.040, 0.0005), bright, 0.002)
    return s.built()


def manhole_cover(text: str = "WATER") -> Built:
    """Build a round cast-iron cover, 0.62 m in diameter, with a chequered face."""
    s = Solid("manhole cover")
    iron = steel(dark=True)
    s.lathe([(0.37, -0.01), (0.37, 0.006), (0.33, 0.007)], iron, steps=40)
    s.lathe([(0.325, -0.01), (0.325, 0.003)], lens("black"), steps=40)
    s.lathe([(0.31, -0.01), (0.31, 0.006)], iron, steps=40)
    for i in range(-4, 5):
        for j in range(-4, 5):
            if math.hypot(i, j) < 4.4 and j != 0:
                with s.at(i * 0.062, j * 0.062, 0.0085, turn=45 if (i + j) % 2 else -45):
                    s.box((0.045, 0.014, 0.006), (0, 0, 0), iron, 0.002)
    s.text(text, 0.045, (0, 0, 0.0075), paint("light grey"), facing="+Z")
    return s.built()


def tree_grate(side_m: float = 1.5) -> Built:
    """Build a square cast-iron grate with rings of slots around an opening for the trunk."""
    s = Solid("tree grate")
    iron = steel(dark=True)
    half = side_m / 2
    s.box((side_m, side_m, 0.008), (0, 0, -0.001), paint("brown", roughness=0.9), 0.0)
    for sign in (-1, 1):
        s.box((side_m, 0.06, 0.02), (0, sign * (half - 0.03), 0.008), iron, 0.004)
        s.box((0.06, side_m - 0.12, 0.02), (sign * (half - 0.03), 0, 0.008), iron, 0.004)
    for k in range(32):
        with s.at(turn=360 * k / 32):
            reach = (half - 0.05) / max(abs(math.cos(2 * math.pi * k / 32)), abs(math.sin(2 * math.pi * k / 32)))
            s.box((reach - 0.28, 0.022, 0.016), ((reach + 0.28) / 2, 0, 0.010), iron, 0.0)
    for r in (0.29, 0.48, 0.66):
        ring = [(r * math.cos(a), r * math.sin(a), 0.012) for a in (2 * math.pi * k / 32 for k in range(32))]
        s.tube(ring, 0.012, iron, sides=4, closed=True)
    return s.built()
