"""Vehicle materials: paints, glass, lamps. Details such as lamps and door gaps are drawn by the shader of the paint."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy

from scope_studio.kit.core import shading

PAINTS: dict[str, tuple[float, float, float]] = {
    "white": (0.78, 0.78, 0.76),
    "black": (0.010, 0.010, 0.012),
    "silver": (0.50, 0.52, 0.53),
    "grey": (0.12, 0.125, 0.13),
    "light grey": (0.36, 0.37, 0.37),
    "red": (0.46, 0.010, 0.012),
    "dark red": (0.14, 0.006, 0.010),
    "blue": (0.012, 0.10, 0.48),
    "dark blue": (0.006, 0.018, 0.085),
    "light blue": (0.20, 0.43, 0.66),
    "green": (0.012, 0.19, 0.045),
    "dark green": (0.006, 0.055, 0.022),
    "yellow": (0.82, 0.49, 0.003),
    "orange": (0.68, 0.125, 0.003),
    "brown": (0.10, 0.045, 0.020),
    "beige": (0.50, 0.42, 0.29),
    "purple": (0.11, 0.018, 0.20),
}
"""Linear RGB of the paint colours, by plain name."""

_METALLIC = {"silver", "grey", "light grey", "blue", "dark blue", "dark red", "dark green", "brown"}
Range = tuple[float, float]
ANY: Range = (-99.0, 99.0)
"""A range without limits."""


@dataclass(frozen=True)
class Patch:
    """A detail drawn on the paint where ``|x|``, y and z are inside the ranges (metres, object coordinates).

    ``y_per_z`` slants vertical lines; ``z_per_x`` and ``z_per_y`` slant horizontal ones. A ``round`` patch is the ellipse that
    fits its x and z ranges.
    """

    colour: tuple[float, float, float]
    x: Range = ANY
    y: Range = ANY
    z: Range = ANY
    roughness: float = 0.5
    emission: float = 0.0
    y_per_z: float = 0.0
    y_per_x: float = 0.0
    z_per_x: float = 0.0
    z_per_y: float = 0.0
    round: bool = False


GAP = (0.004, 0.004, 0.004)
TRIM = (0.016, 0.016, 0.017)
HEADLAMP = (0.72, 0.75, 0.78)
REAR_LAMP = (0.55, 0.006, 0.008)
AMBER = (0.80, 0.22, 0.01)


def paint(
    model: str,
    colour: str,
    patches: Sequence[Patch] = (),
    *,
    dirt_top_m: float = 0.55,
    dirt: float = 0.55,
    gloss: float = 0.45,
) -> bpy.types.Material:
    """Return the material of lacquered paint, with the model's patches and road dirt that fades out at ``dirt_top_m``.

    ``gloss`` is the weight of the lacquer. It is less than 1, so that reflections of a white sky do not hide the colour.
    """
    name = f"paint {model} {colour}"
    existing = bpy.data.materials.get(name)
    if existing is not None:
        return existing
    # Creating hundreds of nodes takes a second, and copying them a millisecond, so all colours copy the same pattern.
    pattern = bpy.data.materials.get(f"paint {model}") or _pattern(f"paint {model}", patches, dirt_top_m, dirt, gloss)
    material = pattern.copy()
    material.name = name
    nodes = material.node_tree.nodes
    nodes["Colour"].outputs[0].default_value = (*PAINTS[colour], 1.0)
    nodes["Flake"].outputs[0].default_value = 0.35 if colour in _METALLIC else 0.0
    return material


def _pattern(name: str, patches: Sequence[Patch], dirt_top_m: float, dirt: float, gloss: float) -> bpy.types.Material:
    """Return the material that all colours of a model copy: patches, dirt and lacquer."""
    sh = shading.Shader(name)
    coords = sh.object_coords()
    x, y, z = sh.xyz(coords)
    x = sh.math("ABSOLUTE", x)
    base: shading.Value = sh.node("ShaderNodeRGB", name="Colour").outputs[0]
    metal: shading.Value = sh.node("ShaderNodeValue", name="Flake").outputs[0]
    rough: shading.Value = 0.32
    coat: shading.Value = gloss
    glow: shading.Value = (0.0, 0.0, 0.0)
    for patch in patches:
        mask = _patch_mask(sh, patch, x, y, z)
        base = sh.mix(mask, base, patch.colour)
        rough = _blend(sh, mask, rough, patch.roughness)
        metal = _blend(sh, mask, metal, 0.0)
        if patch.roughness > 0.5:
            coat = _blend(sh, mask, coat, 0.0)
        if patch.emission:
            glow = sh.mix(mask, glow, tuple(c * patch.emission for c in patch.colour))
    height = sh.ramp(z, 0.15, dirt_top_m, dirt, 0.0)
    grime = sh.math("MULTIPLY", height, sh.ramp(sh.noise(coords, 4.0), 0.3, 0.7, 0.35, 1.0))
    return sh.surface(
        specular_ior_level=0.3,
        base_color=sh.mix(grime, base, (0.085, 0.075, 0.062)),
        roughness=sh.math("ADD", rough, grime, clamp=True),
        metallic=metal,
        coat_weight=sh.math("MULTIPLY", coat, sh.ramp(grime, 0, 0.4, 1, 0)),
        coat_roughness=0.04,
        emission_color=glow,
        emission_strength=1.0,
    )


def _blend(sh: shading.Shader, factor: shading.Value, a: shading.Value, b: shading.Value) -> shading.Value:
    """Mix two numbers: ``a`` where the factor is 0, ``b`` where it is 1."""
    node = sh.node("ShaderNodeMix", data_type="FLOAT")
    for socket, value in zip((0, 2, 3), (factor, a, b), strict=True):
        sh.set_input(node.inputs[socket], value)
    return node.outputs[0]


def _within(sh: shading.Shader, value: shading.Value, limits: Range) -> shading.Value:
    """Return a mask that is 1 between the limits and 0 elsewhere. It has hard edges and fewer nodes than ``Shader.band``."""
    node = sh.node("ShaderNodeMath", operation="COMPARE")
    for socket, number in enumerate((value, sum(limits) / 2, (limits[1] - limits[0]) / 2)):
        sh.set_input(node.inputs[socket], number)
    return node.outputs[0]


def _patch_mask(sh: shading.Shader, patch: Patch, x: shading.Value, y: shading.Value, z: shading.Value) -> shading.Value:
    """Return a mask that is 1 inside a patch."""
    if patch.y_per_z:
        y = sh.math("SUBTRACT", y, sh.math("MULTIPLY", z, patch.y_per_z))
    if patch.y_per_x:
        y = sh.math("SUBTRACT", y, sh.math("MULTIPLY", x, patch.y_per_x))
    if patch.z_per_x:
        z = sh.math("SUBTRACT", z, sh.math("MULTIPLY", x, patch.z_per_x))
    if patch.z_per_y:
        z = sh.math("SUBTRACT", z, sh.math("MULTIPLY", y, patch.z_per_y))
    if patch.round:
        u, v = (sh.ramp(c, *r, -1.0, 1.0, smooth=False) for c, r in ((x, patch.x), (z, patch.z)))
        square = sh.math("ADD", sh.math("MULTIPLY", u, u), sh.math("MULTIPLY", v, v))
        masks = [_within(sh, y, patch.y), sh.math("LESS_THAN", square, 0.95)]
    else:
        masks = [_within(sh, v, r) for v, r in ((x, patch.x), (y, patch.y), (z, patch.z)) if r != ANY]
    mask = masks[0]
    for other in masks[1:]:
        mask = sh.math("MULTIPLY", mask, other)
    return mask


def upright_gap(y: float, z: Range, *, x: Range = (0.5, 9.0), y_per_z: float = 0.0, width: float = 0.009) -> Patch:
    """Return the edge of a door: a vertical dark line on the sides at ``y``. If slanted, it is at ``y`` where z = 0."""
    return Patch(GAP, x=x, y=(y - width / 2, y + width / 2), z=z, y_per_z=y_per_z, roughness=0.9)


def level_gap(z: float, y: Range, *, x: Range = (0.5, 9.0), z_per_y: float = 0.0, width: float = 0.009) -> Patch:
    """Return the lower edge of a door, or a crease: a horizontal dark line on the sides. If slanted, it is at ``z`` where y = 0."""
    return Patch(GAP, x=x, y=y, z=(z - width / 2, z + width / 2), z_per_y=z_per_y, roughness=0.9)


def glass() -> bpy.types.Material:
    """Return the material of dark glass, for windows without an interior."""
    return shading.plain("vehicle glass", (0.012, 0.015, 0.017), 0.03)


def clear_glass(tint: float = 0.55) -> bpy.types.Material:
    """Return the material of glass through which the interior is visible.

    ``tint`` is its opacity. If it is greater than 0.5, instance masks treat the glass as opaque.
    """
    name = f"vehicle clear glass {tint:.2f}"
    return bpy.data.materials.get(name) or shading.Shader(name).surface(
        base_color=(0.006, 0.009, 0.010), roughness=0.02, alpha=tint
    )


def black_trim() -> bpy.types.Material:
    """Return the material of black plastic trim."""
    return shading.plain("vehicle black trim", TRIM, 0.55)


def lamp(colour: str) -> bpy.types.Material:
    """Return the material of a lamp cover: "white", "red", "amber", or "beacon" (a lit orange warning light)."""
    rgb, glow = {
        "white": (HEADLAMP, 0.35),
        "red": (REAR_LAMP, 0.25),
        "amber": (AMBER, 0.2),
        "beacon": ((0.95, 0.17, 0.002), 0.55),
    }[colour]
    name = f"vehicle lamp {colour}"
    return bpy.data.materials.get(name) or shading.Shader(name).surface(
        base_color=rgb, roughness=0.12, emission_color=rgb, emission_strength=glow, coat_weight=1.0
    )


def paint_slot(number: int = 0) -> bpy.types.Material:
    """Return the placeholder material that ``bodywork.finish`` replaces with the paint of the vehicle."""
    return shading.plain(f"vehicle paint slot {number}", (0.5, 0.5, 0.5))


def ink(colour: str) -> bpy.types.Material:
    """Return the material of lettering in a paint's colour. "display" is the emissive amber of a destination display."""
    if colour == "display":
        amber, name = (1.0, 0.50, 0.03), "vehicle display letters"
        return bpy.data.materials.get(name) or shading.Shader(name).surface(
            base_color=amber, emission_color=amber, emission_strength=1.6
        )
    return shading.plain(f"vehicle lettering {colour}", PAINTS[colour], 0.6)
