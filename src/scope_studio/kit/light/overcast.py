"""An overcast sky just after rain: a low layer of grey cloud, soft light from all sides, and haze."""

from __future__ import annotations

import math

import bpy
from mathutils import Vector

from scope_studio.kit.core.shading import Shader, Value


class _WorldShader(Shader):
    """A ``Shader`` that writes into the node tree of a world."""

    def __init__(self, world: bpy.types.World) -> None:
        self.tree = world.node_tree
        self.tree.nodes.clear()


def setup(
    scene: bpy.types.Scene,
    *,
    strength: float = 1.0,
    sun_strength: float = 0.9,
    sun_bearing_deg: float = 215.0,
    exposure: float = 0.50,
) -> None:
    """Set a grey world, a weak sun and the view transform of ``scene``."""
    world = bpy.data.worlds.new("Overcast")
    scene.world = world
    s = _WorldShader(world)
    x, y, z = s.xyz(s.node("ShaderNodeTexCoord").outputs["Generated"])
    height = s.math("MAXIMUM", z, 0.0)
    visible_sky = _stratus(s, x, y, height)
    diffuse_light = s.mix(s.ramp(z, 0.0, 0.9), (0.62, 0.66, 0.70), (0.88, 0.92, 0.98))
    diffuse_light = s.mix(s.ramp(z, -0.25, 0.0), (0.10, 0.10, 0.10), diffuse_light)
    path = s.node("ShaderNodeLightPath")
    is_visible_ray = s.math("MAXIMUM", path.outputs["Is Camera Ray"], path.outputs["Is Glossy Ray"])
    background = s.node("ShaderNodeBackground")
    s.set_input(background.inputs["Color"], s.mix(is_visible_ray, diffuse_light, visible_sky))
    background.inputs["Strength"].default_value = strength
    s.tree.links.new(background.outputs[0], s.node("ShaderNodeOutputWorld").inputs["Surface"])
    world.cycles.sampling_method = "MANUAL"
    world.cycles.sample_map_resolution = 256
    _sun(scene, sun_bearing_deg, sun_strength)
    scene.display_settings.display_device = "sRGB"
    scene.view_settings.view_transform = "AgX"
    scene.view_settings.look = "AgX - High Contrast"
    scene.view_settings.exposure = exposure
    scene.view_settings.gamma = 1.0


def _stratus(s: Shader, x: Value, y: Value, height: Value) -> Value:
    """Return the colour of stratus cloud: pale and dark bands that converge towards the horizon, with a brighter gap."""
    depth = s.math("ADD", height, 0.16)
    plane = s.node("ShaderNodeCombineXYZ")
    s.set_input(plane.inputs[0], s.math("DIVIDE", x, depth))
    s.set_input(plane.inputs[1], s.math("DIVIDE", y, depth))
    p = plane.outputs[0]
    bands = s.noise(s.scaled(p, (0.55, 0.8, 1)), 0.7, detail=7.0, roughness=0.52, distortion=0.5)
    wisps = s.noise(p, 1.7, detail=8.0, roughness=0.58, distortion=0.3)
    grey = s.mix(s.ramp(bands, 0.34, 0.66), (0.40, 0.43, 0.47), (0.86, 0.88, 0.90))
    grey = s.mix(s.ramp(wisps, 0.52, 0.72, 0.0, 0.5), grey, (0.46, 0.49, 0.53))
    gap = s.math("MULTIPLY", s.ramp(bands, 0.60, 0.72), s.ramp(wisps, 0.55, 0.42))
    grey = s.mix(s.math("MULTIPLY", gap, 0.7), grey, (1.15, 1.13, 1.08))
    return s.mix(s.ramp(height, 0.0, 0.22, 0.85, 0.0), grey, (0.66, 0.70, 0.74))


def _sun(scene: bpy.types.Scene, bearing_deg: float, strength: float) -> None:
    """Add a weak, large sun lamp."""
    light = bpy.data.lights.new("Veiled sun", "SUN")
    light.energy = strength
    light.angle = math.radians(28)
    light.color = (1.0, 0.97, 0.92)
    lamp = bpy.data.objects.new("Veiled sun", light)
    scene.collection.objects.link(lamp)
    bearing, elevation = math.radians(bearing_deg), math.radians(52)
    sun_direction = Vector((math.sin(bearing) * math.cos(elevation), math.cos(bearing) * math.cos(elevation), math.sin(elevation)))
    lamp.rotation_euler = sun_direction.to_track_quat("Z", "Y").to_euler()
