"""A dual carriageway with its central reserve."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import bpy
import numpy as np

from scope_studio.kit.core.mesh import from_data
from scope_studio.kit.core.shading import Shader, Value
from scope_studio.kit.core.stage import Built
from scope_studio.kit.ground import markings


@dataclass(frozen=True)
class Carriageway:
    """A dual carriageway along y that bends in the distance. Offsets are measured from the centre line of the central reserve.

    Each side is paved from the offset ``reserve_m`` to ``edge_m``, and its lanes, ``lane_m`` wide, begin at ``first_lane_m``. The
    road is straight up to the distance ``straight_m`` from the origin, and then bends with ``radius_m`` until ``length_m``.
    """

    reserve_m: float = 1.55
    edge_m: float = 15.5
    first_lane_m: float = 2.0
    lane_m: float = 3.5
    straight_m: float = 230.0
    radius_m: float = 1500.0
    length_m: float = 950.0
    lines: Sequence[markings.Line] = field(default_factory=tuple)
    patches: Sequence[markings.Patch] = field(default_factory=tuple)

    def centre_x(self, y: float) -> float:
        """Return the x coordinate of the road's centre line at ``y``. The road bends left in the north and right in the south."""
        beyond = max(0.0, abs(y) - self.straight_m)
        return -math.copysign(1.0, y) * beyond * beyond / (2 * self.radius_m)


def strip(
    name: str, road: Carriageway, u0: float, u1: float, z: float, material: bpy.types.Material, *, crown_m: float = 0.0
) -> bpy.types.Object:
    """Create a ribbon along the road between two offsets, with road coordinates (u and v in metres) in its UV map."""
    half = road.length_m
    near = np.arange(-road.straight_m, road.straight_m + 1, 10.0)
    far = np.arange(road.straight_m + 10, half + 1, 15.0)
    vs = [float(v) for v in np.concatenate([-far[::-1], near, far])]
    points = [(road.centre_x(v) + u, v, z + (crown_m if u == u0 else 0.0)) for v in vs for u in (u0, u1)]
    faces = [(2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2) for i in range(len(vs) - 1)]
    obj = from_data(name, points, faces, material)
    layer = obj.data.uv_layers.new(name="road")
    for loop in obj.data.loops:
        layer.data[loop.index].uv = ((u0, u1)[loop.vertex_index % 2], vs[loop.vertex_index // 2])
    return obj


def carriageways(road: Carriageway) -> Built:
    """Build both carriageways with their painted lines, and the paved central reserve."""
    asphalt = asphalt_material(road)
    concrete = slab_material()
    parts = [
        strip("northbound", road, -road.edge_m, -road.reserve_m, 0.0, asphalt),
        strip("southbound", road, road.reserve_m, road.edge_m, 0.0, asphalt),
        strip("reserve", road, -road.reserve_m, road.reserve_m, 0.07, concrete),
    ]
    for side in (-1, 1):
        kerb = strip("reserve kerb", road, side * road.reserve_m, side * road.reserve_m, 0.0, concrete)
        for index, vertex in enumerate(kerb.data.vertices):
            vertex.co.z = 0.07 if index % 2 else -0.02
        parts.append(kerb)
    return Built.of("carriageways", parts)


def asphalt_material(road: Carriageway) -> bpy.types.Material:
    """Return the material of worn asphalt in road coordinates, with wheel tracks, oil, seams, cracks, patches and paint."""
    s = Shader("asphalt carriageway")
    uv = s.node("ShaderNodeUVMap", uv_map="road").outputs[0]
    u, v, _ = s.xyz(uv)
    grain = s.voronoi(uv, 60.0, output="Color")
    grain_value = s.xyz(grain)[0]
    blotch = s.noise(uv, 0.35, detail=6.0, roughness=0.6)
    fine = s.noise(uv, 6.0, detail=4.0, roughness=0.65)
    streaks = s.noise(s.scaled(uv, (1.6, 0.05, 1)), 1.0, detail=4.0)
    tone = s.math("ADD", 0.068, s.math("MULTIPLY", s.math("SUBTRACT", blotch, 0.5), 0.055))
    tone = s.math("ADD", tone, s.math("MULTIPLY", s.math("SUBTRACT", fine, 0.5), 0.030))
    tone = s.math("ADD", tone, s.math("MULTIPLY", s.math("SUBTRACT", streaks, 0.5), 0.030))
    tone = s.math("ADD", tone, s.math("MULTIPLY", s.math("SUBTRACT", grain_value, 0.5), 0.026))
    side = s.math("SUBTRACT", s.math("ABSOLUTE", u), road.first_lane_m)
    lane = s.math("SUBTRACT", s.math("FLOORED_MODULO", side, road.lane_m), road.lane_m / 2)
    across = s.math("ABSOLUTE", lane)
    track = s.ramp(s.math("ABSOLUTE", s.math("SUBTRACT", across, 0.85)), 0.10, 0.48, 1.0, 0.0)
    in_lanes = s.ramp(side, 3 * road.lane_m - 0.3, 3 * road.lane_m + 0.1, 1.0, 0.0)
    track = s.math("MULTIPLY", track, in_lanes)
    tone = s.math("MULTIPLY", tone, s.ramp(track, 0, 1, 1.0, 0.74, smooth=False))
    oil = s.math("MULTIPLY", s.ramp(across, 0.05, 0.40, 1.0, 0.0), s.ramp(streaks, 0.42, 0.62))
    tone = s.math("MULTIPLY", tone, s.ramp(s.math("MULTIPLY", oil, in_lanes), 0, 1, 1.0, 0.66, smooth=False))
    tone = s.math("MULTIPLY", tone, s.ramp(side, 3 * road.lane_m, 3 * road.lane_m + 0.2, 1.0, 1.16))
    dust = s.math("MULTIPLY", s.ramp(side, 12.3, 13.5), s.ramp(blotch, 0.35, 0.6, 0.2, 1.0))
    tone = s.math("MULTIPLY", tone, s.ramp(_cracks(s, uv), 0, 1, 1.0, 0.42, smooth=False))
    seam = s.ramp(s.math("ABSOLUTE", s.math("SUBTRACT", s.math("ABSOLUTE", u), 12.25)), 0.01, 0.035, 0.5, 1.0)
    tone = s.math("MULTIPLY", tone, seam)
    colour: Value = s.node("ShaderNodeCombineColor")
    for index, warmth in enumerate((1.03, 1.0, 0.965)):
        s.set_input(colour.inputs[index], s.math("MULTIPLY", tone, warmth))
    colour = s.mix(s.math("MULTIPLY", dust, 0.55), colour.outputs[0], (0.115, 0.100, 0.078))
    white = s.mix(s.ramp(fine, 0.35, 0.7), (0.50, 0.50, 0.47), (0.66, 0.66, 0.63))
    mask = markings.paint(s, u, v, road.lines)
    colour = s.mix(mask, colour, s.mix(s.math("MULTIPLY", track, 0.3), white, (0.2, 0.2, 0.2)))
    colour, rough = _patches(s, road.patches, u, v, uv, grain_value, fine, blotch, colour, s.ramp(track, 0, 1, 0.86, 0.72))
    height = s.math("ADD", s.math("MULTIPLY", grain_value, 0.5), fine)
    return s.surface(base_color=colour, roughness=rough, specular_ior_level=0.3, normal=s.bump(height, 0.22, 0.004))


def _cracks(s: Shader, uv: Value) -> Value:
    """Return a mask of thin irregular cracks, dense in a few places and absent elsewhere."""
    warp = s.noise(uv, 0.9, detail=5.0)
    node = s.node("ShaderNodeVectorMath", operation="ADD")
    s.set_input(node.inputs[0], s.scaled(uv, (1.0, 0.6, 1.0)))
    s.set_input(node.inputs[1], warp)
    distance = s.voronoi(node.outputs[0], 0.34, feature="DISTANCE_TO_EDGE")
    thin = s.ramp(distance, 0.0008, 0.0045, 1.0, 0.0)
    return s.math("MULTIPLY", thin, s.ramp(s.noise(uv, 0.06, detail=3.0), 0.50, 0.58))


def _patches(
    s: Shader,
    patches: Sequence[markings.Patch],
    u: Value,
    v: Value,
    uv: Value,
    grain: Value,
    fine: Value,
    blotch: Value,
    colour: Value,
    rough: Value,
) -> tuple[Value, Value]:
    """Apply the patches to the colour and roughness of the asphalt, and return both."""
    repair = s.mix(fine, (0.030, 0.030, 0.031), (0.052, 0.051, 0.050))
    fresh = s.mix(s.math("MULTIPLY", s.math("ADD", fine, grain), 0.5), (0.010, 0.010, 0.011), (0.026, 0.026, 0.027))
    groove = s.ramp(s.math("PINGPONG", u, 0.03), 0.004, 0.022)
    milled = s.mix(s.math("MULTIPLY", blotch, groove), (0.060, 0.056, 0.052), (0.150, 0.138, 0.122))
    seal = (0.012, 0.012, 0.013)
    jitter = s.ramp(s.noise(uv, 3.0, detail=3.0), 0.3, 0.7, -0.02, 0.02)
    u, v = s.math("ADD", u, jitter), s.math("ADD", v, jitter)
    for patch in patches:
        body = {"repair": repair, "fresh": fresh, "milled": milled}[patch.kind]
        if patch.kind != "milled":
            colour = s.mix(markings.inside(s, u, v, patch, grow_m=0.06), colour, seal)
        mask = markings.inside(s, u, v, patch)
        colour = s.mix(mask, colour, body)
        rough = s.math("MULTIPLY", rough, s.ramp(mask, 0, 1, 1.0, 0.78 if patch.kind == "fresh" else 1.0))
    return colour, rough


def slab_material() -> bpy.types.Material:
    """Return the material of weathered concrete paving with joints every 5 m, and dirt and weeds along its edges."""
    s = Shader("reserve concrete")
    uv = s.node("ShaderNodeUVMap", uv_map="road").outputs[0]
    u, v, _ = s.xyz(uv)
    blotch = s.noise(uv, 0.6, detail=7.0, roughness=0.65)
    colour = s.mix(s.ramp(blotch, 0.3, 0.7), (0.13, 0.125, 0.115), (0.25, 0.24, 0.22))
    joint = s.ramp(s.math("PINGPONG", v, 2.5), 0.01, 0.03, 1.0, 0.0)
    colour = s.mix(joint, colour, (0.04, 0.045, 0.03))
    dirt = s.ramp(s.math("ADD", s.math("ABSOLUTE", u), s.math("MULTIPLY", blotch, 0.6)), 1.45, 1.9)
    colour = s.mix(dirt, colour, (0.075, 0.066, 0.05))
    weeds = s.ramp(s.noise(uv, 1.3, detail=5.0), 0.60, 0.66)
    colour = s.mix(s.math("MULTIPLY", weeds, dirt), colour, (0.055, 0.085, 0.025))
    return s.surface(base_color=colour, roughness=0.9, normal=s.bump(blotch, 0.2, 0.01))
