"""Daylight: a partly cloudy sky, a soft sun, haze, and the view transform."""

from __future__ import annotations

import math

import bpy
from mathutils import Vector

from scope_studio.kit.core.shading import Shader, Value

HORIZON = (0.62, 0.74, 0.88)
ZENITH = (0.10, 0.26, 0.62)
HAZE = (0.50, 0.60, 0.70)
"""Colour of the haze over distant objects. It is slightly darker than the horizon, so that distant hills remain visible."""


class _WorldShader(Shader):
    """A ``Shader`` that writes into the node tree of a world."""

    def __init__(self, world: bpy.types.World) -> None:
        self.tree = world.node_tree
        self.tree.nodes.clear()


def setup(
    scene: bpy.types.Scene,
    *,
    sun_bearing_deg: float = 236.0,
    sun_elevation_deg: float = 40.0,
    sun_strength: float = 4.6,
    sky_strength: float = 0.85,
    cloud_cover: float = 0.5,
    exposure: float = 0.30,
) -> None:
    """Set the world, sun and view transform of ``scene``. The sun's bearing is measured clockwise from north."""
    _world(scene, sky_strength, cloud_cover)
    _sun(sun_bearing_deg, sun_elevation_deg, sun_strength)
    scene.display_settings.display_device = "sRGB"
    scene.view_settings.view_transform = "AgX"
    scene.view_settings.look = "AgX - High Contrast"
    scene.view_settings.exposure = exposure
    scene.view_settings.gamma = 1.0


def _sun(bearing_deg: float, elevation_deg: float, strength: float) -> None:
    """Add the sun lamp."""
    light = bpy.data.lights.new("Sun", "SUN")
    light.energy = strength
    light.angle = math.radians(2.5)
    light.color = (1.0, 0.945, 0.86)
    lamp = bpy.data.objects.new("Sun", light)
    bpy.context.scene.collection.objects.link(lamp)
    bearing, elevation = math.radians(bearing_deg), math.radians(elevation_deg)
    sun_direction = Vector((math.sin(bearing) * math.cos(elevation), math.cos(bearing) * math.cos(elevation), math.sin(elevation)))
    lamp.rotation_euler = sun_direction.to_track_quat("Z", "Y").to_euler()


def _world(scene: bpy.types.Scene, strength: float, cover: float) -> None:
    """Build the world. Camera and mirror rays see clouds; diffuse light comes from a smooth gradient, which needs fewer samples."""
    world = bpy.data.worlds.new("Sky")
    scene.world = world
    s = _WorldShader(world)
    direction = s.node("ShaderNodeTexCoord").outputs["Generated"]
    x, y, z = s.xyz(direction)
    height = s.math("MAXIMUM", z, 0.0)
    clear_sky = s.mix(s.ramp(s.math("POWER", height, 0.55), 0.0, 0.85), HORIZON, ZENITH)
    visible_sky = _clouds(s, x, y, height, clear_sky, cover)
    diffuse_light = s.mix(s.ramp(z, -0.1, 0.9), (0.74, 0.78, 0.82), (0.52, 0.66, 0.90))
    diffuse_light = s.mix(s.ramp(z, -0.25, 0.0), (0.20, 0.21, 0.17), diffuse_light)
    path = s.node("ShaderNodeLightPath")
    is_visible_ray = s.math("MAXIMUM", path.outputs["Is Camera Ray"], path.outputs["Is Glossy Ray"])
    background = s.node("ShaderNodeBackground")
    s.set_input(background.inputs["Color"], s.mix(is_visible_ray, diffuse_light, visible_sky))
    background.inputs["Strength"].default_value = strength
    s.tree.links.new(background.outputs[0], s.node("ShaderNodeOutputWorld").inputs["Surface"])
    world.cycles.sampling_method = "MANUAL"
    world.cycles.sample_map_resolution = 256


def _clouds(s: Shader, x: Value, y: Value, height: Value, clear_sky: Value, cover: float) -> Value:
    """Return the sky colour with a flat layer of cumulus: noise that converges towards the horizon, with grey undersides."""
    depth = s.math("ADD", height, 0.11)
    plane = s.node("ShaderNodeCombineXYZ")
    s.set_input(plane.inputs[0], s.math("DIVIDE", x, depth))
    s.set_input(plane.inputs[1], s.math("DIVIDE", y, depth))
    p = plane.outputs[0]
    lumps = s.noise(p, 0.62, detail=9.0, roughness=0.56, distortion=0.25)
    sunward = s.noise(s.scaled(p, (1, 1, 1), (0.16, 0.11, 0)), 0.62, detail=5.0, roughness=0.56, distortion=0.25)
    edge = 0.58 - 0.18 * cover
    mask = s.ramp(lumps, edge, edge + 0.09)
    mask = s.math("MULTIPLY", mask, s.ramp(height, 0.01, 0.09, 0.45, 1.0))
    lit = s.ramp(s.math("SUBTRACT", lumps, sunward), -0.10, 0.10)
    thickness = s.ramp(lumps, edge + 0.05, edge + 0.26)
    body = s.mix(lit, (0.62, 0.68, 0.78), (1.25, 1.23, 1.20))
    body = s.mix(s.math("MULTIPLY", thickness, 0.55), body, (0.58, 0.62, 0.69))
    body = s.mix(s.ramp(height, 0.01, 0.20, 0.5, 0.0), body, HORIZON)
    return s.mix(mask, clear_sky, body)


def finish_materials(*, visibility_m: float = 3600.0, skip: tuple[str, ...] = ()) -> None:
    """Finish the scene's materials: add aerial haze, and exclude meshes from light sampling, which would only add noise.

    Args:
        visibility_m: Distance in metres at which haze replaces 63% of an object's light.
        skip: Names of materials to leave unchanged.
    """
    for material in bpy.data.materials:
        if material.name in skip or material.node_tree is None:
            continue
        material.cycles.emission_sampling = "NONE"
        _add_haze(material.node_tree, visibility_m)


def _add_haze(tree: bpy.types.NodeTree, visibility_m: float) -> None:
    """Mix a material with the colour of the haze by distance."""
    output = next((n for n in tree.nodes if n.type == "OUTPUT_MATERIAL" and n.is_active_output), None)
    if output is None or not output.inputs["Surface"].is_linked:
        return
    source = output.inputs["Surface"].links[0].from_socket
    distance = tree.nodes.new("ShaderNodeCameraData").outputs["View Distance"]
    camera_ray = tree.nodes.new("ShaderNodeLightPath").outputs["Is Camera Ray"]
    scaled = tree.nodes.new("ShaderNodeMath")
    scaled.operation = "MULTIPLY"
    scaled.inputs[1].default_value = -1.0 / visibility_m
    decay = tree.nodes.new("ShaderNodeMath")
    decay.operation = "EXPONENT"
    fraction = tree.nodes.new("ShaderNodeMath")
    fraction.operation = "SUBTRACT"
    fraction.inputs[0].default_value = 1.0
    factor = tree.nodes.new("ShaderNodeMath")
    factor.operation = "MULTIPLY"
    glow = tree.nodes.new("ShaderNodeEmission")
    glow.inputs["Color"].default_value = (*HAZE, 1.0)
    mixed = tree.nodes.new("ShaderNodeMixShader")
    for a, b in [
        (distance, scaled.inputs[0]),
        (scaled.outputs[0], decay.inputs[0]),
        (decay.outputs[0], fraction.inputs[1]),
        (fraction.outputs[0], factor.inputs[0]),
        (camera_ray, factor.inputs[1]),
        (factor.outputs[0], mixed.inputs[0]),
        (source, mixed.inputs[1]),
        (glow.outputs[0], mixed.inputs[2]),
        (mixed.outputs[0], output.inputs["Surface"]),
    ]:
        tree.links.new(a, b)
