"""Materials of walls and roofs: metal cladding, concrete, brick, tiles, render, dressed stone."""

from __future__ import annotations

import bpy

from scope_studio.kit.core.shading import Shader

Rgb = tuple[float, float, float]


def cladding_material(name: str, colour: Rgb, pitch_m: float = 0.2) -> bpy.types.Material:
    """Return the material of metal sheet with vertical ribs, rain streaks, and dirt near the ground."""
    existing = bpy.data.materials.get(name)
    if existing is not None:
        return existing
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


def brick_material(name: str, colour: Rgb) -> bpy.types.Material:
    """Return the material of brickwork in running bond, with pale mortar and stains."""
    existing = bpy.data.materials.get(name)
    if existing is not None:
        return existing
    s = Shader(name)
    x, y, z = s.xyz(s.object_coords())
    plane = s.node("ShaderNodeCombineXYZ")
    s.set_input(plane.inputs[0], s.math("ADD", x, y))
    s.set_input(plane.inputs[1], z)
    brick = s.node("ShaderNodeTexBrick")
    s.set_input(brick.inputs["Vector"], plane.outputs[0])
    for key, value in {"Scale": 1.0, "Mortar Size": 0.006, "Brick Width": 0.225, "Row Height": 0.075, "Bias": -0.2}.items():
        brick.inputs[key].default_value = value
    s.set_input(brick.inputs["Color1"], colour)
    s.set_input(brick.inputs["Color2"], tuple(c * 0.62 for c in colour))
    s.set_input(brick.inputs["Mortar"], (0.30, 0.28, 0.25))
    blotch = s.noise(s.object_coords(), 0.8, detail=5.0)
    tint = s.mix(s.ramp(blotch, 0.4, 0.75, 0.0, 0.45), brick.outputs["Color"], (0.11, 0.085, 0.07))
    return s.surface(base_color=tint, roughness=0.9)


def tile_material(name: str, colour: Rgb) -> bpy.types.Material:
    """Return the material of a tiled roof."""
    existing = bpy.data.materials.get(name)
    if existing is not None:
        return existing
    s = Shader(name)
    p = s.object_coords()
    _, _, z = s.xyz(p)
    course = s.ramp(s.math("PINGPONG", z, 0.09), 0.005, 0.05)
    blotch = s.noise(p, 1.6, detail=6.0)
    tint = s.mix(s.ramp(blotch, 0.3, 0.7), tuple(c * 0.6 for c in colour), colour)
    tint = s.mix(course, tuple(c * 0.5 for c in colour), tint)
    return s.surface(base_color=tint, roughness=0.85, normal=s.bump(course, 0.5, 0.03))


def concrete_material(name: str = "structural concrete", tone: Rgb = (0.36, 0.345, 0.315)) -> bpy.types.Material:
    """Return the material of concrete cast in layers 1.2 m high, with rain streaks and dirt near the ground."""
    existing = bpy.data.materials.get(name)
    if existing is not None:
        return existing
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


def stucco(name: str, colour: Rgb) -> bpy.types.Material:
    """Return the material of painted render, with trowel marks, rain streaks, and damp near the ground."""
    existing = bpy.data.materials.get(name)
    if existing is not None:
        return existing
    s = Shader(name)
    p = s.object_coords()
    _, _, z = s.xyz(p)
    patch = s.ramp(s.noise(p, 0.5, 6.0, 0.6), 0.35, 0.72, 0.0, 0.28)
    base = s.mix(patch, colour, tuple(c * 0.62 for c in colour))
    streak = s.ramp(s.noise(s.scaled(p, (5.0, 5.0, 0.22)), 1.0, 5.0), 0.52, 0.80, 0.0, 0.45)
    base = s.mix(streak, base, tuple(c * 0.45 for c in colour))
    damp = s.math("MULTIPLY", s.ramp(z, 0.0, 1.1, 0.75, 0.0), s.ramp(s.noise(p, 1.6, 5.0), 0.3, 0.65))
    base = s.mix(damp, base, (0.12, 0.105, 0.085))
    trowel = s.noise(p, 9.0, 6.0, 0.65)
    return s.surface(base_color=base, roughness=0.88, normal=s.bump(trowel, 0.22, 0.01))


def ashlar(name: str, colour: Rgb, block: tuple[float, float] = (0.72, 0.36)) -> bpy.types.Material:
    """Return the material of dressed stone in courses. ``block`` is the width and height in metres of a block."""
    existing = bpy.data.materials.get(name)
    if existing is not None:
        return existing
    s = Shader(name)
    p = s.object_coords()
    x, y, z = s.xyz(p)
    plane = s.node("ShaderNodeCombineXYZ")
    s.set_input(plane.inputs[0], s.math("ADD", x, y))
    s.set_input(plane.inputs[1], z)
    stones = s.node("ShaderNodeTexBrick")
    s.set_input(stones.inputs["Vector"], plane.outputs[0])
    for key, value in {"Scale": 1.0, "Mortar Size": 0.007, "Brick Width": block[0], "Row Height": block[1]}.items():
        stones.inputs[key].default_value = value
    s.set_input(stones.inputs["Color1"], colour)
    s.set_input(stones.inputs["Color2"], tuple(c * 0.80 for c in colour))
    s.set_input(stones.inputs["Mortar"], tuple(c * 0.42 for c in colour))
    soot = s.ramp(s.noise(s.scaled(p, (1.4, 1.4, 0.35)), 1.0, 6.0, 0.62), 0.44, 0.80, 0.0, 0.55)
    base = s.mix(soot, stones.outputs["Color"], tuple(c * 0.38 for c in colour))
    grain = s.noise(p, 30.0, 4.0, 0.7)
    height = s.math("SUBTRACT", s.math("MULTIPLY", grain, 0.3), stones.outputs["Fac"])
    return s.surface(base_color=base, roughness=0.88, normal=s.bump(height, 0.5, 0.012))
