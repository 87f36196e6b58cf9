"""Dusk: a deep blue sky with a warm horizon, lamplight, evening haze, and a long exposure.

Soft light comes from the whole sky, without a sun. Every lamp is an area light of at least 0.3 m, because smaller lights cause
noise at low sample counts. These lights are invisible to the camera, which sees the emissive lens of the lamp instead.
"""

from __future__ import annotations

import math

import bpy
from mathutils import Vector

from scope_studio.kit.core.shading import Shader, Value

GLOW_BEARING_DEG = 312.0
"""Bearing of the sunset glow, in degrees clockwise from north."""

ZENITH = (0.050, 0.095, 0.235)
MID_SKY = (0.150, 0.225, 0.400)
COOL_HORIZON = (0.300, 0.320, 0.400)
WARM_HORIZON = (1.10, 0.520, 0.220)
HAZE = (0.135, 0.155, 0.205)
"""Linear RGB colours of the sky (at the zenith, halfway up, and at the horizon away from and near the glow) and of the haze."""

SODIUM = (1.0, 0.56, 0.20)
LED = (0.86, 0.93, 1.0)
WARM = (1.0, 0.80, 0.56)
"""Linear RGB colours of lamp light, by type of lamp."""

DIMMED_PREFIXES = ("paint ", "vehicle lamp", "sheet ")
"""Name prefixes of slightly emissive materials, such as reflective sheeting. Without dimming, they would look like lit lamps."""


class _WorldShader(Shader):
    """A ``Shader`` that writes into the node tree of a world."""

    def __init__(self, world: bpy.types.World) -> None:
        self.tree = world.node_tree
        self.tree.nodes.clear()


def setup(scene: bpy.types.Scene, *, sky_strength: float = 0.36, exposure: float = 1.5) -> None:
    """Set the evening sky, the view transform, and light path limits that reduce noise at eight samples."""
    _world(scene, sky_strength)
    scene.display_settings.display_device = "sRGB"
    scene.view_settings.view_transform = "AgX"
    scene.view_settings.look = "AgX - Medium High Contrast"
    scene.view_settings.exposure = exposure
    scene.view_settings.gamma = 1.0
    scene.cycles.use_light_tree = True
    scene.cycles.sample_clamp_indirect = 1.5
    scene.cycles.max_bounces = 5
    scene.cycles.diffuse_bounces = 2
    scene.cycles.glossy_bounces = 2


def _world(scene: bpy.types.Scene, strength: float) -> None:
    """Build the world. Camera and mirror rays see clouds; diffuse light comes from a smooth gradient, which needs fewer samples."""
    world = bpy.data.worlds.new("Dusk")
    scene.world = world
    s = _WorldShader(world)
    x, y, z = s.xyz(s.node("ShaderNodeTexCoord").outputs["Generated"])
    height = s.math("MAXIMUM", z, 0.0)
    bearing = math.radians(GLOW_BEARING_DEG)
    toward_glow = s.math("ADD", s.math("MULTIPLY", x, math.sin(bearing)), s.math("MULTIPLY", y, math.cos(bearing)))
    horizon = s.mix(s.ramp(toward_glow, -0.25, 1.0), COOL_HORIZON, WARM_HORIZON)
    clear_sky = s.mix(s.ramp(height, 0.0, 0.26), horizon, MID_SKY)
    clear_sky = s.mix(s.ramp(height, 0.14, 0.85), clear_sky, ZENITH)
    visible_sky = _clouds(s, x, y, height, toward_glow, clear_sky)
    diffuse_light = s.mix(s.ramp(z, -0.1, 0.9), (0.42, 0.42, 0.50), (0.30, 0.37, 0.56))
    diffuse_light = s.mix(s.ramp(s.math("SUBTRACT", toward_glow, z), 0.0, 1.0, 0.0, 0.6), diffuse_light, (0.85, 0.55, 0.36))
    diffuse_light = s.mix(s.ramp(z, -0.25, 0.0), (0.07, 0.07, 0.08), diffuse_light)
    path = s.node("ShaderNodeLightPath")
    is_visible_ray = s.math("MAXIMUM", path.outputs["Is Camera Ray"], path.outputs["Is Glossy Ray"])
    background = s.node("ShaderNodeBackground")
    s.set_input(background.inputs["Color"], s.mix(is_visible_ray, diffuse_light, visible_sky))
    background.inputs["Strength"].default_value = strength
    s.tree.links.new(background.outputs[0], s.node("ShaderNodeOutputWorld").inputs["Surface"])
    world.cycles.sampling_method = "MANUAL"
    world.cycles.sample_map_resolution = 256


def _clouds(s: Shader, x: Value, y: Value, height: Value, toward_glow: Value, clear_sky: Value) -> Value:
    """Return the sky colour with thin evening clouds, dark above and lit from below on the side of the sunset."""
    depth = s.math("ADD", height, 0.10)
    plane = s.node("ShaderNodeCombineXYZ")
    s.set_input(plane.inputs[0], s.math("DIVIDE", x, depth))
    s.set_input(plane.inputs[1], s.math("DIVIDE", y, depth))
    p = s.scaled(plane.outputs[0], (0.55, 1.0, 1.0))
    lumps = s.noise(p, 0.75, detail=8.0, roughness=0.58, distortion=0.3)
    mask = s.math("MULTIPLY", s.ramp(lumps, 0.50, 0.66), s.ramp(height, 0.02, 0.10, 0.25, 0.85))
    lit = s.math("MULTIPLY", s.ramp(toward_glow, 0.1, 0.95), s.ramp(height, 0.05, 0.45, 1.0, 0.1))
    body = s.mix(lit, (0.105, 0.130, 0.195), (0.62, 0.30, 0.22))
    edge = s.mix(lit, (0.185, 0.225, 0.320), (1.05, 0.56, 0.34))
    return s.mix(mask, clear_sky, s.mix(s.ramp(lumps, 0.55, 0.68), edge, body))


def lamplight(
    position: tuple[float, float, float],
    power_w: float,
    colour: tuple[float, float, float] = LED,
    *,
    size_m: float = 0.5,
    aim: tuple[float, float, float] = (0.0, 0.0, -1.0),
    spread_deg: float = 150.0,
    stretch: float = 1.0,
) -> None:
    """Add the light of a lamp: a disc-shaped area light that shines along ``aim``. The lamp itself is modelled elsewhere.

    ``stretch`` is the ratio of height to width. If it is not 1, the disc is an ellipse.
    """
    light = bpy.data.lights.new("lamp light", "AREA")
    light.shape = "ELLIPSE" if stretch != 1.0 else "DISK"
    light.size = size_m
    if stretch != 1.0:
        light.size_y = size_m * stretch
    light.energy = power_w
    light.color = colour
    light.spread = math.radians(spread_deg)
    lamp = bpy.data.objects.new("lamp light", light)
    bpy.context.scene.collection.objects.link(lamp)
    lamp.location = position
    lamp.rotation_euler = Vector(aim).to_track_quat("-Z", "Y").to_euler()
    lamp.visible_camera = False


def finish_materials(*, visibility_m: float = 1500.0, skip: tuple[str, ...] = ()) -> None:
    """Finish the scene's materials: add evening haze, dim materials that are not lamps, and exclude meshes from light sampling.

    Args:
        visibility_m: Distance in metres at which haze replaces 63% of an object's light.
        skip: Names of materials to leave unchanged.
    """
    for material in bpy.data.materials:
        if material.name in skip or material.node_tree is None:
            continue
        material.cycles.emission_sampling = "NONE"
        if material.name.startswith(DIMMED_PREFIXES):
            _dim(material.node_tree)
        _add_haze(material.node_tree, visibility_m)


def _dim(tree: bpy.types.NodeTree) -> None:
    """Reduce the emission of a material to 5%."""
    for node in tree.nodes:
        if node.type == "BSDF_PRINCIPLED":
            node.inputs["Emission Strength"].default_value *= 0.05


def _add_haze(tree: bpy.types.NodeTree, visibility_m: float) -> None:
    """Mix a material with the colour of the haze by distance, for camera rays only."""
    output = next((n for n in tree.nodes if n.type == "OUTPUT_MATERIAL" and n.is_active_output), None)
    if output is None or not output.inputs["Surface"].is_linked:
        return
    source = output.inputs["Surface"].links[0].from_socket
    distance = tree.nodes.new("ShaderNodeCameraData").outputs["View Distance"]
    camera_ray = tree.nodes.new("ShaderNodeLightPath").outputs["Is Camera Ray"]

    def math_node(operation: str, a: Value, b: Value | None = None) -> Value:
        node = tree.nodes.new("ShaderNodeMath")
        node.operation = operation
        for socket, value in zip(node.inputs, (a, b), strict=False):
            if isinstance(value, bpy.types.NodeSocket):
                tree.links.new(value, socket)
            elif value is not None:
                socket.default_value = value
        return node.outputs[0]

    fraction = math_node("SUBTRACT", 1.0, math_node("EXPONENT", math_node("MULTIPLY", distance, -1.0 / visibility_m)))
    glow = tree.nodes.new("ShaderNodeEmission")
    glow.inputs["Color"].default_value = (*HAZE, 1.0)
    mixed = tree.nodes.new("ShaderNodeMixShader")
    tree.links.new(math_node("MULTIPLY", fraction, camera_ray), mixed.inputs[0])
    tree.links.new(source, mixed.inputs[1])
    tree.links.new(glow.outputs[0], mixed.inputs[2])
    tree.links.new(mixed.outputs[0], output.inputs["Surface"])
