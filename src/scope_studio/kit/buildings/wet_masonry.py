"""Walls and roofs of old streets after rain: brick, painted render, dressed stone, slates and clay tiles."""

from __future__ import annotations

import bpy

from scope_studio.kit.core.shading import Shader, Value

Rgb = tuple[float, float, float]

BRICKS: dict[str, Rgb] = {
    "red": (0.245, 0.075, 0.048),
    "dark red": (0.150, 0.050, 0.038),
    "buff": (0.36, 0.265, 0.160),
    "brown": (0.150, 0.082, 0.055),
}
RENDERS: dict[str, Rgb] = {
    "white": (0.68, 0.675, 0.65),
    "cream": (0.62, 0.545, 0.385),
    "pink": (0.56, 0.335, 0.300),
    "pale blue": (0.30, 0.40, 0.47),
    "pale green": (0.34, 0.42, 0.32),
    "grey": (0.30, 0.305, 0.305),
    "ochre": (0.50, 0.315, 0.105),
}
STONES: dict[str, Rgb] = {"honey": (0.40, 0.30, 0.175), "grey": (0.29, 0.28, 0.26)}


def wall(kind: str, colour: str) -> bpy.types.Material:
    """Return the material of a wall.

    ``kind`` is "brick", "render" or "stone". ``colour`` is a key of ``BRICKS``, ``RENDERS`` or ``STONES``.
    """
    name = f"wall {kind} {colour}"
    existing = bpy.data.materials.get(name)
    if existing is not None:
        return existing
    s = Shader(name)
    coords = s.object_coords()
    x, y, z = s.xyz(coords)
    if kind == "render":
        base, height = RENDERS[colour], s.noise(coords, 34.0, 4.0)
        tint: Value = s.mix(s.ramp(s.noise(coords, 0.9, 6.0, 0.6), 0.35, 0.7, 0.0, 0.35), base, tuple(c * 0.80 for c in base))
        depth, rough = 0.004, 0.72
    else:
        tint, height = _courses(s, kind, colour, x, y, z)
        depth, rough = (0.012, 0.80) if kind == "brick" else (0.016, 0.75)
    tint = _weather(s, coords, z, tint, 0.55 if kind == "render" else 0.4)
    return s.surface(base_color=tint, roughness=rough, normal=s.bump(height, 0.55, depth))


def _courses(s: Shader, kind: str, colour: str, x: Value, y: Value, z: Value) -> tuple[Value, Value]:
    """Return the colour and the bump height of brickwork or ashlar, for walls along the x or y axis."""
    base = BRICKS[colour] if kind == "brick" else STONES[colour]
    size = (0.225, 0.075, 0.0055) if kind == "brick" else (0.62, 0.30, 0.006)
    plane = s.node("ShaderNodeCombineXYZ")
    s.set_input(plane.inputs[0], s.math("ADD", x, y))
    s.set_input(plane.inputs[1], z)
    brick = s.node("ShaderNodeTexBrick")
    s.set_input(brick.inputs["Vector"], plane.outputs[0])
    settings = {"Scale": 1.0, "Mortar Size": size[2], "Mortar Smooth": 0.25, "Brick Width": size[0], "Row Height": size[1]}
    for key, value in {**settings, "Bias": -0.15}.items():
        brick.inputs[key].default_value = value
    spread = 0.55 if kind == "brick" else 0.82
    s.set_input(brick.inputs["Color1"], base)
    s.set_input(brick.inputs["Color2"], tuple(c * spread for c in base))
    s.set_input(brick.inputs["Mortar"], (0.20, 0.19, 0.17) if kind == "brick" else tuple(c * 0.5 for c in base))
    grain = s.noise(s.object_coords(), 26.0, 5.0)
    tint = s.mix(s.ramp(grain, 0.3, 0.75, 0.0, 0.4), brick.outputs["Color"], tuple(c * 0.6 for c in base))
    return tint, s.math(
        "ADD", s.math("MULTIPLY", s.math("SUBTRACT", 1.0, brick.outputs["Fac"]), 1.0), s.math("MULTIPLY", grain, 0.5)
    )


def _weather(s: Shader, coords: Value, z: Value, tint: Value, amount: float) -> Value:
    """Return ``tint`` with patches of soot, rain streaks, and damp near the pavement."""
    moved = s.node("ShaderNodeVectorMath", operation="ADD")
    s.set_input(moved.inputs[0], coords)
    s.set_input(moved.inputs[1], s.math("MULTIPLY", s.random(), 53.0))
    p = moved.outputs[0]
    soot = s.ramp(s.noise(p, 0.55, 6.0, 0.62), 0.44, 0.78, 0.0, amount)
    streaks = s.ramp(s.noise(s.scaled(p, (5.5, 5.5, 0.30)), 1.0, 4.0), 0.50, 0.78, 0.0, amount * 0.8)
    damp = s.ramp(s.math("ADD", z, s.ramp(s.noise(p, 1.4, 4.0), 0.3, 0.7, -0.4, 0.4)), 0.1, 0.9, amount, 0.0)
    mask = s.math("MAXIMUM", s.math("MAXIMUM", soot, streaks), damp)
    return s.mix(mask, tint, s.mix(0.72, tint, (0.045, 0.043, 0.038)))


def roofing(kind: str) -> bpy.types.Material:
    """Return the material of a wet roof with courses of "slate" or "clay" tiles."""
    name = f"roof {kind}"
    existing = bpy.data.materials.get(name)
    if existing is not None:
        return existing
    s = Shader(name)
    coords = s.object_coords()
    x, _, z = s.xyz(coords)
    base = (0.062, 0.068, 0.078) if kind == "slate" else (0.185, 0.072, 0.042)
    plane = s.node("ShaderNodeCombineXYZ")
    s.set_input(plane.inputs[0], x)
    s.set_input(plane.inputs[1], z)
    tile = s.node("ShaderNodeTexBrick")
    s.set_input(tile.inputs["Vector"], plane.outputs[0])
    size = {"Brick Width": 0.28, "Row Height": 0.145, "Mortar Size": 0.006, "Mortar Smooth": 0.1, "Scale": 1.0}
    for key, value in size.items():
        tile.inputs[key].default_value = value
    s.set_input(tile.inputs["Color1"], base)
    s.set_input(tile.inputs["Color2"], tuple(c * 0.62 for c in base))
    s.set_input(tile.inputs["Mortar"], tuple(c * 0.25 for c in base))
    moss = s.ramp(s.noise(coords, 1.1, 7.0, 0.65), 0.56, 0.74, 0.0, 0.75)
    tint = s.mix(moss, tile.outputs["Color"], (0.060, 0.068, 0.026))
    tint = s.mix(s.ramp(s.noise(coords, 0.4, 4.0), 0.45, 0.7, 0.0, 0.4), tint, tuple(c * 0.5 for c in base))
    step = s.ramp(s.math("FLOORED_MODULO", z, 0.145), 0.0, 0.145)
    wet = s.ramp(s.noise(coords, 2.2, 4.0), 0.35, 0.65, 0.30, 0.62)
    return s.surface(base_color=tint, roughness=wet, normal=s.bump(s.math("SUBTRACT", tile.outputs["Fac"], step), -0.7, 0.016))


def trim(colour: Rgb = (0.62, 0.61, 0.57)) -> bpy.types.Material:
    """Return the material of painted joinery or stone trim, with dirt."""
    name = f"trim {colour[0]:.2f} {colour[1]:.2f} {colour[2]:.2f}"
    existing = bpy.data.materials.get(name)
    if existing is not None:
        return existing
    s = Shader(name)
    coords = s.object_coords()
    tint = s.mix(s.ramp(s.noise(coords, 2.4, 6.0, 0.62), 0.42, 0.78, 0.0, 0.5), colour, tuple(c * 0.55 for c in colour))
    streak = s.ramp(s.noise(s.scaled(coords, (14.0, 14.0, 0.6)), 1.0, 3.0), 0.52, 0.8, 0.0, 0.4)
    return s.surface(base_color=s.mix(streak, tint, tuple(c * 0.45 for c in colour)), roughness=0.5)
