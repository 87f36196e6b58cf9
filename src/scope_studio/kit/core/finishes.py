"""Materials of manufactured objects: painted metal, plastic, steel, reflective sheeting, concrete, rubber, wood, canvas, lamps.

Each function returns one material per colour, which is created on first use. Dirt and wear depend on object coordinates. Objects
are modelled standing on z = 0, so that splashes appear near the ground. A random offset of the coordinates for each object makes
linked copies look different.
"""

from __future__ import annotations

from collections.abc import Callable

import bpy

from scope_studio.kit.core.shading import Shader, Value

Colour = tuple[float, float, float]

PALETTE: dict[str, Colour] = {
    "white": (0.80, 0.80, 0.78),
    "cream": (0.72, 0.66, 0.50),
    "light grey": (0.48, 0.49, 0.50),
    "grey": (0.22, 0.23, 0.24),
    "dark grey": (0.055, 0.058, 0.062),
    "black": (0.012, 0.012, 0.013),
    "red": (0.58, 0.016, 0.014),
    "dark red": (0.24, 0.012, 0.014),
    "orange": (0.86, 0.140, 0.005),
    "hi-vis orange": (1.0, 0.195, 0.012),
    "amber": (1.0, 0.36, 0.010),
    "yellow": (0.90, 0.59, 0.012),
    "hi-vis yellow": (0.62, 0.90, 0.020),
    "green": (0.012, 0.19, 0.055),
    "dark green": (0.010, 0.070, 0.030),
    "blue": (0.010, 0.085, 0.42),
    "light blue": (0.10, 0.32, 0.62),
    "navy": (0.010, 0.016, 0.050),
    "brown": (0.12, 0.055, 0.022),
    "pink": (0.66, 0.18, 0.24),
    "purple": (0.14, 0.03, 0.24),
    "beige": (0.42, 0.33, 0.21),
    "khaki": (0.16, 0.14, 0.075),
    "denim": (0.040, 0.075, 0.16),
    "silver": (0.52, 0.53, 0.54),
}
"""Linear RGB values by plain colour name."""

DIRT: Colour = (0.085, 0.070, 0.052)


def _get_or_create(name: str, make: Callable[[Shader], bpy.types.Material]) -> bpy.types.Material:
    """Return the material with this name. ``make`` creates it on first use."""
    existing = bpy.data.materials.get(name)
    return existing if existing is not None else make(Shader(name))


def _coords(s: Shader) -> Value:
    """Return object coordinates with a random offset for each object."""
    node = s.node("ShaderNodeVectorMath", operation="ADD")
    s.set_input(node.inputs[0], s.object_coords())
    s.set_input(node.inputs[1], s.math("MULTIPLY", s.random(), 37.0))
    return node.outputs[0]


def with_dirt(s: Shader, colour: Value, amount: float, splash_m: float = 0.35) -> Value:
    """Return ``colour`` with dirt: patches, rain streaks, and splashes near the ground."""
    coords = _coords(s)
    patches = s.ramp(s.noise(coords, 3.2, 6.0, 0.62), 0.48, 0.80, 0.0, amount)
    streaks = s.ramp(s.noise(s.scaled(coords, (22.0, 22.0, 0.9)), 1.0, 3.0), 0.55, 0.85, 0.0, amount * 0.7)
    _, _, z = s.xyz(s.object_coords())
    splash = s.math("MULTIPLY", s.ramp(z, 0.0, splash_m, 1.0, 0.0), s.ramp(s.noise(coords, 9.0, 5.0), 0.3, 0.7, 0.1, amount * 1.6))
    return s.mix(s.math("MAXIMUM", s.math("MAXIMUM", patches, streaks), splash), colour, DIRT)


def paint(colour: str, *, dirt: float = 0.30, roughness: float = 0.38) -> bpy.types.Material:
    """Return the material of painted metal or moulded plastic."""

    def make(s: Shader) -> bpy.types.Material:
        fade = s.mix(s.ramp(s.noise(_coords(s), 5.0, 4.0), 0.35, 0.7, 0.0, 0.10), PALETTE[colour], (0.6, 0.6, 0.58))
        rough = s.ramp(s.noise(_coords(s), 14.0), 0.3, 0.7, roughness - 0.06, roughness + 0.14)
        return s.surface(base_color=with_dirt(s, fade, dirt), roughness=rough)

    return _get_or_create(f"paint {colour} {dirt:.2f} {roughness:.2f}", make)


def steel(*, dark: bool = False) -> bpy.types.Material:
    """Return the material of weathered galvanised steel with its crystal pattern."""

    def make(s: Shader) -> bpy.types.Material:
        coords = _coords(s)
        spangle = s.voronoi(coords, 38.0, output="Color")
        value = s.ramp(spangle, 0.0, 1.0, 0.24 if not dark else 0.09, 0.36 if not dark else 0.15, smooth=False)
        weather = s.ramp(s.noise(coords, 4.0, 5.0), 0.35, 0.7)
        base = s.mix(weather, s.mix(value, (0, 0, 0), (1, 1, 1.02)), (0.27, 0.28, 0.29) if not dark else (0.10, 0.10, 0.11))
        return s.surface(base_color=with_dirt(s, base, 0.25), metallic=0.55, roughness=s.ramp(spangle, 0.0, 1.0, 0.42, 0.58))

    return _get_or_create("steel dark" if dark else "steel", make)


def sheet(colour: str, *, dirt: float = 0.16) -> bpy.types.Material:
    """Return the material of retroreflective sheeting: an even, slightly emissive colour with a faint cell pattern and dirt."""

    def make(s: Shader) -> bpy.types.Material:
        cells = s.ramp(s.voronoi(s.object_coords(), 160.0, "DISTANCE_TO_EDGE"), 0.0, 0.12, 0.90, 1.0)
        base = s.mix(1.0, PALETTE[colour], s.mix(cells, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)), "MULTIPLY")
        dirty = with_dirt(s, base, dirt, 0.0)
        return s.surface(base_color=dirty, roughness=0.34, emission_color=dirty, emission_strength=0.10)

    return _get_or_create(f"sheet {colour} {dirt:.2f}", make)


def glow(colour: str, strength: float = 6.0) -> bpy.types.Material:
    """Return the emissive material of a lit lamp."""
    c = PALETTE[colour]
    return _get_or_create(
        f"glow {colour} {strength:g}",
        lambda s: s.surface(base_color=c, emission_color=c, emission_strength=strength, roughness=0.3),
    )


def lens(colour: str) -> bpy.types.Material:
    """Return the material of an unlit lamp behind coloured plastic, or of dark glass."""
    return _get_or_create(f"lens {colour}", lambda s: s.surface(base_color=PALETTE[colour], roughness=0.08, coat_weight=0.6))


def glass() -> bpy.types.Material:
    """Return the material of dark, opaque glazing, which imitates windows seen from outside by day."""
    return _get_or_create("glazing", lambda s: s.surface(base_color=(0.018, 0.021, 0.023), roughness=0.04))


def clear_glass() -> bpy.types.Material:
    """Return the material of clear, mostly transparent glass with a green tint."""
    return _get_or_create("clear pane", lambda s: s.surface(base_color=(0.55, 0.62, 0.60), roughness=0.04, alpha=0.22))


def rubber() -> bpy.types.Material:
    """Return the material of dirty black rubber."""
    return _get_or_create("rubber", lambda s: s.surface(base_color=with_dirt(s, (0.018, 0.018, 0.018), 0.5, 0.2), roughness=0.75))


def concrete(*, light: bool = True) -> bpy.types.Material:
    """Return the material of cast concrete, with blotches, air holes and vertical stains."""

    def make(s: Shader) -> bpy.types.Material:
        coords = _coords(s)
        blotch = s.ramp(s.noise(coords, 2.6, 7.0, 0.65), 0.3, 0.72)
        tone = 1.0 if light else 0.6
        low, high = (0.23 * tone, 0.225 * tone, 0.21 * tone), (0.44 * tone, 0.435 * tone, 0.41 * tone)
        holes = s.ramp(s.voronoi(coords, 42.0), 0.06, 0.16)
        base = s.mix(s.ramp(holes, 0.0, 1.0, 0.55, 0.0), s.mix(blotch, low, high), (0.07, 0.068, 0.06))
        grain = s.math("ADD", s.math("MULTIPLY", s.noise(coords, 90.0, 3.0), 0.4), holes)
        return s.surface(base_color=with_dirt(s, base, 0.42, 0.25), roughness=0.86, normal=s.bump(grain, 0.25, 0.004))

    return _get_or_create("concrete light" if light else "concrete dark", make)


def timber(*, fresh: bool = True) -> bpy.types.Material:
    """Return the material of sawn softwood with the grain along the local x axis."""

    def make(s: Shader) -> bpy.types.Material:
        coords = s.scaled(_coords(s), (2.0, 26.0, 26.0))
        grain = s.noise(coords, 1.0, 6.0, 0.6, 0.8)
        low, high = ((0.20, 0.105, 0.042), (0.44, 0.28, 0.13)) if fresh else ((0.10, 0.085, 0.07), (0.24, 0.20, 0.16))
        return s.surface(
            base_color=with_dirt(s, s.mix(s.ramp(grain, 0.3, 0.7), low, high), 0.3),
            roughness=0.8,
            normal=s.bump(grain, 0.3, 0.004),
        )

    return _get_or_create("timber fresh" if fresh else "timber worn", make)


def granular(name: str, low: Colour, high: Colour, grain_scale: float) -> bpy.types.Material:
    """Return the material of loose ground such as sand, gravel or soil."""

    def make(s: Shader) -> bpy.types.Material:
        coords = s.object_coords()
        stones = s.voronoi(coords, grain_scale, output="Color")
        depth = s.voronoi(coords, grain_scale)
        damp = s.ramp(s.noise(coords, 1.6, 5.0), 0.38, 0.66)
        base = s.mix(s.math("MULTIPLY", s.math("ADD", stones, damp), 0.5), low, high)
        return s.surface(base_color=base, roughness=0.92, normal=s.bump(depth, 0.9, 0.6 / grain_scale))

    return _get_or_create(name, make)


def cloth(colour: str, roughness: float = 0.9) -> bpy.types.Material:
    """Return the material of creased cloth, such as canvas or tarpaulin."""

    def make(s: Shader) -> bpy.types.Material:
        coords = _coords(s)
        creases = s.noise(coords, 7.0, 5.0, 0.6, 0.6)
        return s.surface(base_color=with_dirt(s, PALETTE[colour], 0.25), roughness=roughness, normal=s.bump(creases, 0.6, 0.02))

    return _get_or_create(f"cloth {colour} {roughness:.2f}", make)


def pane(reflectance: float = 0.25) -> bpy.types.Material:
    """Return the material of clear glass that transmits most of the light and reflects the fraction ``reflectance``."""
    name = f"pane {reflectance:.2f}"
    existing = bpy.data.materials.get(name)
    if existing is not None:
        return existing
    s = Shader(name)
    clear, mirror = s.node("ShaderNodeBsdfTransparent"), s.node("ShaderNodeBsdfGlossy")
    clear.inputs["Color"].default_value = (0.86, 0.92, 0.92, 1.0)
    mirror.inputs["Roughness"].default_value = 0.03
    mixed = s.node("ShaderNodeMixShader")
    mixed.inputs[0].default_value = reflectance
    s.tree.links.new(clear.outputs[0], mixed.inputs[1])
    s.tree.links.new(mirror.outputs[0], mixed.inputs[2])
    output = next(n for n in s.tree.nodes if n.type == "OUTPUT_MATERIAL")
    s.tree.links.new(mixed.outputs[0], output.inputs["Surface"])
    return s.material


def stripes(name: str, colour: str, second_colour: str, pitch_m: float) -> bpy.types.Material:
    """Return the material of canvas that is striped along the local x axis and lets a third of the light through."""
    existing = bpy.data.materials.get(name)
    if existing is not None:
        return existing
    s = Shader(name)
    p = s.object_coords()
    x, _, _ = s.xyz(p)
    mask = s.math("GREATER_THAN", s.math("PINGPONG", s.math("ADD", x, 50.0 * pitch_m), pitch_m), pitch_m / 2)
    stain = s.ramp(s.noise(p, 1.7, 5.0), 0.5, 0.75, 0.0, 0.22)
    base = s.mix(stain, s.mix(mask, PALETTE[colour], PALETTE[second_colour]), (0.16, 0.14, 0.11))
    s.surface(base_color=base, roughness=0.9, normal=s.bump(s.noise(p, 5.0, 4.0), 0.3, 0.02))
    translucent = s.node("ShaderNodeBsdfTranslucent")
    s.set_input(translucent.inputs["Color"], base)
    mixed = s.node("ShaderNodeMixShader")
    mixed.inputs[0].default_value = 0.32
    s.tree.links.new(s.bsdf.outputs[0], mixed.inputs[1])
    s.tree.links.new(translucent.outputs[0], mixed.inputs[2])
    output = next(n for n in s.tree.nodes if n.type == "OUTPUT_MATERIAL")
    s.tree.links.new(mixed.outputs[0], output.inputs["Surface"])
    return s.material
