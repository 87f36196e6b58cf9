"""Materials of people: skin with facial features, hair, cloth, reflective vests.

Their masks use the "rest" attribute, the position on the upright figure.
"""

from __future__ import annotations

import bpy

from scope_studio.kit.core.finishes import PALETTE, Colour
from scope_studio.kit.core.shading import Shader, Value
from scope_studio.kit.people.heads import EYES

REST = "rest"
"""Name of a vector attribute of points: the position on the upright figure or, for heads, in head coordinates."""

SKIN_TONES: list[Colour] = [
    (0.56, 0.33, 0.235),
    (0.48, 0.265, 0.175),
    (0.37, 0.195, 0.115),
    (0.235, 0.115, 0.062),
    (0.14, 0.068, 0.038),
    (0.085, 0.041, 0.024),
]

HAIR: dict[str, Colour] = {
    "black": (0.008, 0.007, 0.007),
    "brown": (0.040, 0.020, 0.010),
    "light brown": (0.11, 0.060, 0.028),
    "blond": (0.34, 0.22, 0.095),
    "ginger": (0.24, 0.072, 0.018),
    "grey": (0.21, 0.21, 0.21),
    "white": (0.50, 0.50, 0.49),
}


def _rest(s: Shader) -> Value:
    """Return the rest coordinates of the shading point."""
    return s.node("ShaderNodeAttribute", attribute_name=REST).outputs["Vector"]


def _ellipsoid_mask(
    s: Shader, coords: Value, centre: tuple[float, float, float], radii: tuple[float, float, float], soft: float = 0.35
) -> Value:
    """Return a mask that is 1 inside an ellipsoid in rest coordinates and 0 outside."""
    scaled = s.scaled(coords, tuple(1 / r for r in radii), tuple(-c / r for c, r in zip(centre, radii, strict=True)))
    length = s.node("ShaderNodeVectorMath", operation="LENGTH")
    s.set_input(length.inputs[0], scaled)
    return s.ramp(length.outputs["Value"], 1.0 - soft, 1.0, 1.0, 0.0)


def skin(tone: int, hair: str | None, *, stubble: bool) -> bpy.types.Material:
    """Return the material of the skin of head and hands. Eyes, brows, lips and stubble are masks in head coordinates."""
    name = f"skin {tone} {hair} {stubble}"
    if name in bpy.data.materials:
        return bpy.data.materials[name]
    s = Shader(name)
    base = SKIN_TONES[tone]
    coords = _rest(s)
    dark = tuple(c * 0.35 for c in base)
    colour: Value = s.mix(
        s.ramp(s.noise(coords, 34.0, 3.0), 0.35, 0.7, 0.0, 0.35), base, (base[0] * 0.92, base[1] * 0.70, base[2] * 0.66)
    )
    for side in (-1, 1):
        colour = s.mix(
            s.math("MULTIPLY", _ellipsoid_mask(s, coords, (side * 0.042, 0.075, -0.026), (0.024, 0.03, 0.020), 0.9), 0.18),
            colour,
            (base[0], base[1] * 0.6, base[2] * 0.55),
        )
    if stubble:
        beard = s.math("MULTIPLY", _ellipsoid_mask(s, coords, (0, 0.045, -0.086), (0.07, 0.062, 0.042), 0.5), 0.55)
        colour = s.mix(beard, colour, HAIR[hair or "brown"])
    colour = s.mix(
        s.math("MULTIPLY", _ellipsoid_mask(s, coords, (0, 0.090, -0.0605), (0.0235, 0.02, 0.0095), 0.4), 0.55),
        colour,
        (base[0] * 0.62, base[1] * 0.36, base[2] * 0.36),
    )
    colour = s.mix(
        s.math("MULTIPLY", _ellipsoid_mask(s, coords, (0, 0.095, -0.0612), (0.021, 0.02, 0.0018), 0.5), 0.8), colour, dark
    )
    for x, y, z in EYES:
        side = 1 if x > 0 else -1
        colour = s.mix(
            s.math("MULTIPLY", _ellipsoid_mask(s, coords, (x, y, z + 0.001), (0.023, 0.03, 0.013), 0.7), 0.45), colour, dark
        )
        colour = s.mix(_ellipsoid_mask(s, coords, (x, y, z), (0.0125, 0.03, 0.0052), 0.3), colour, (0.48, 0.45, 0.42))
        colour = s.mix(_ellipsoid_mask(s, coords, (x, y, z + 0.0008), (0.0058, 0.03, 0.0056), 0.3), colour, (0.015, 0.010, 0.008))
        colour = s.mix(_ellipsoid_mask(s, coords, (x, y, z + 0.0052), (0.0142, 0.03, 0.0020), 0.4), colour, (0.02, 0.013, 0.010))
        brow = _ellipsoid_mask(s, coords, (x + side * 0.002, y, z + 0.0175), (0.0185, 0.04, 0.0042), 0.4)
        colour = s.mix(s.math("MULTIPLY", brow, 0.85), colour, tuple(c * 0.7 for c in HAIR[hair or "brown"]))
    pores = s.bump(s.noise(coords, 220.0, 2.0), 0.12, 0.002)
    return s.surface(
        base_color=colour, roughness=0.52, subsurface_weight=0.06, subsurface_radius=(0.012, 0.005, 0.003), normal=pores
    )


def hair(colour: str) -> bpy.types.Material:
    """Return the material of hair."""
    name = f"hair {colour}"
    if name in bpy.data.materials:
        return bpy.data.materials[name]
    s = Shader(name)
    strands = s.noise(s.scaled(_rest(s), (190.0, 60.0, 22.0)), 1.0, 3.0)
    base = HAIR[colour]
    tint = s.mix(s.ramp(strands, 0.3, 0.7), tuple(c * 0.55 for c in base), tuple(c * 1.5 for c in base))
    return s.surface(base_color=tint, roughness=0.48, normal=s.bump(strands, 0.7, 0.006))


def _woven_cloth(s: Shader, colour: str) -> tuple[Value, Value, Value]:
    """Return the colour, fold height and weave height of plain cloth.

    The colour is paler where the cloth is worn, soiled in patches, and dark in the folds.
    """
    coords = s.object_coords()
    base = PALETTE[colour]
    folds = s.noise(s.scaled(coords, (7.0, 7.0, 13.0)), 1.0, 3.0, 0.5, 0.15)
    worn = s.mix(s.ramp(s.noise(coords, 5.0, 5.0), 0.40, 0.75, 0.0, 0.25), base, tuple(c * 0.72 + 0.05 for c in base))
    soil = s.mix(s.ramp(s.noise(coords, 8.0, 6.0, 0.65), 0.58, 0.82, 0.0, 0.28), worn, (0.10, 0.085, 0.068))
    tone = s.mix(s.ramp(folds, 0.25, 0.5, 0.30, 0.0), soil, tuple(c * 0.3 for c in base))
    return tone, folds, s.noise(coords, 420.0, 1.0)


def cloth(colour: str, *, bands: tuple[float, ...] = ()) -> bpy.types.Material:
    """Return the material of woven cloth. ``bands`` are the positions (m) of reflective tape, 5 cm wide, along the limb."""
    name = f"garment {colour} {bands}"
    if name in bpy.data.materials:
        return bpy.data.materials[name]
    s = Shader(name)
    tone, folds, weave = _woven_cloth(s, colour)
    _, _, z = s.xyz(_rest(s))
    for position in bands:
        tone = s.mix(s.band(z, position - 0.026, position + 0.026, 0.0015), tone, (0.62, 0.63, 0.64))
    bump = s.bump(s.math("ADD", folds, s.math("MULTIPLY", weave, 0.08)), 0.7, 0.03)
    emission = 0.14 if colour.startswith("hi-vis") else 0.0
    return s.surface(base_color=tone, roughness=0.88, normal=bump, emission_color=tone, emission_strength=emission)


def top(colour: str, style: str, inner: str, low: float) -> bpy.types.Material:
    """Return the material of the body of an upper garment. Its hem is at height ``low``.

    ``style`` is "jumper" (with a ribbed hem), "jacket" (open over an ``inner`` shirt, with a zip and pockets) or "shirt" (with
    buttons and a paler collar).
    """
    name = f"top {colour} {style} {inner} {low:.2f}"
    if name in bpy.data.materials:
        return bpy.data.materials[name]
    s = Shader(name)
    tone, folds, weave = _woven_cloth(s, colour)
    x, y, z = s.xyz(_rest(s))
    abs_x, front = s.math("ABSOLUTE", x), s.ramp(y, 0.0, 0.012)
    dark = tuple(c * 0.45 for c in PALETTE[colour])
    height = s.math("ADD", folds, s.math("MULTIPLY", weave, 0.08))
    if style == "jumper":
        angle = s.math("ARCTAN2", y, x)
        ribs = s.math("SINE", s.math("MULTIPLY", angle, 90.0))
        rib_zone = s.math("MAXIMUM", s.ramp(z, low + 0.066, low + 0.060), s.ramp(z, 1.494, 1.498))
        tone = s.mix(s.math("MULTIPLY", rib_zone, s.ramp(ribs, -0.5, 0.5, 0.5, 0.15)), tone, dark)
    if style == "jacket":
        opening = s.math("SUBTRACT", s.math("MULTIPLY", s.math("SUBTRACT", z, 1.18), 0.21), abs_x)
        shirt = s.math("MULTIPLY", s.ramp(opening, -0.002, 0.002), front)
        edge = s.math("MULTIPLY", s.band(opening, -0.012, 0.0), front)
        tone = s.mix(edge, tone, dark)
        tone = s.mix(shirt, tone, PALETTE[inner])
        height = s.math("SUBTRACT", height, s.math("MULTIPLY", shirt, 0.5))
        zip_line = s.math("MULTIPLY", s.math("MULTIPLY", s.band(abs_x, -0.01, 0.004, 0.001), s.ramp(z, 1.185, 1.18)), front)
        tone = s.mix(zip_line, tone, (0.03, 0.03, 0.03))
        slant = s.math("ADD", abs_x, s.math("MULTIPLY", z, 0.35))
        pocket = s.math("MULTIPLY", s.math("MULTIPLY", s.band(slant, 0.470, 0.477, 0.001), s.band(z, 0.97, 1.10)), front)
        tone = s.mix(pocket, tone, dark)
        tone = s.mix(s.math("MULTIPLY", s.band(z, low + 0.045, low + 0.050), 0.8), tone, dark)
    if style == "shirt":
        buttons = s.math("MULTIPLY", s.band(abs_x, 0.014, 0.0165, 0.001), front)
        tone = s.mix(s.math("MULTIPLY", buttons, 0.7), tone, dark)
        tone = s.mix(s.ramp(z, 1.492, 1.496, 0.0, 0.8), tone, tuple(c * 0.6 + 0.25 for c in PALETTE[colour]))
    emission = 0.14 if colour.startswith("hi-vis") else 0.0
    return s.surface(
        base_color=tone, roughness=0.88, normal=s.bump(height, 0.7, 0.03), emission_color=tone, emission_strength=emission
    )


def vest(colour: str, lining: str) -> bpy.types.Material:
    """Return the material of a high-visibility vest with reflective tape, a zip, and an open neck that shows ``lining``."""
    name = f"vest {colour} over {lining}"
    if name in bpy.data.materials:
        return bpy.data.materials[name]
    s = Shader(name)
    coords = _rest(s)
    x, y, z = s.xyz(coords)
    abs_x = s.math("ABSOLUTE", x)
    base = PALETTE[f"hi-vis {colour}"]
    folds = s.noise(s.scaled(coords, (7.0, 7.0, 10.0)), 1.0, 3.0, 0.5, 0.15)
    grime = s.mix(s.ramp(s.noise(coords, 7.0, 6.0, 0.65), 0.55, 0.8, 0.0, 0.30), base, tuple(c * 0.45 + 0.02 for c in base))
    tone = s.mix(s.ramp(folds, 0.28, 0.5, 0.30, 0.0), grime, tuple(c * 0.45 for c in base))
    hoops = s.math("MAXIMUM", s.band(z, 0.950, 1.003), s.band(z, 1.120, 1.173))
    braces = s.math("MULTIPLY", s.band(abs_x, 0.078, 0.128), s.ramp(z, 1.168, 1.172))
    tape = s.math("MAXIMUM", hoops, braces)
    trim = PALETTE["hi-vis yellow" if colour == "orange" else "hi-vis orange"]
    edge = s.math("MAXIMUM", s.band(z, 0.940, 1.013), s.band(z, 1.110, 1.183))
    edge = s.math("MAXIMUM", edge, s.math("MULTIPLY", s.band(abs_x, 0.068, 0.138), s.ramp(z, 1.168, 1.172)))
    out = s.mix(s.math("MULTIPLY", edge, 0.85), tone, trim)
    silver = s.mix(s.ramp(s.noise(coords, 12.0, 4.0), 0.3, 0.7), (0.54, 0.55, 0.56), (0.74, 0.75, 0.76))
    out = s.mix(tape, out, silver)
    front = s.ramp(y, 0.0, 0.01)
    out = s.mix(s.math("MULTIPLY", s.band(abs_x, -0.01, 0.006, 0.001), front), out, (0.03, 0.03, 0.03))
    neck = s.math("SUBTRACT", s.math("MULTIPLY", s.math("SUBTRACT", z, 1.325), 0.55), abs_x)
    collar = s.math("MULTIPLY", s.ramp(neck, -0.002, 0.002), s.ramp(y, 0.0, 0.03))
    out = s.mix(collar, out, PALETTE[lining])
    glow = s.math("SUBTRACT", 0.16, s.math("MULTIPLY", collar, 0.16))
    return s.surface(
        base_color=out,
        roughness=s.ramp(tape, 0.0, 1.0, 0.82, 0.36),
        normal=s.bump(folds, 0.55, 0.03),
        emission_color=out,
        emission_strength=glow,
    )
