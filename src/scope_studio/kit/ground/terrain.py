"""Land around a highway: verges, fields, and low hills out to the horizon."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import bpy

from scope_studio.kit.core.mesh import from_data
from scope_studio.kit.core.shading import Shader, Value
from scope_studio.kit.core.stage import Built
from scope_studio.kit.ground.highway import Carriageway


def terrain(road: Carriageway, bare_areas: Sequence[tuple[float, float, float, float]], *, extent_m: float = 3200.0) -> Built:
    """Build the land. It is flat next to the road, with rolling fields farther away and hills at the horizon.

    Args:
        bare_areas: Rectangles of worn ground without grass, as (x0, x1, y0, y1) in metres.
    """
    rings = [0.0, 20.0, 40.0, 60.0, 80.0, 100.0, 125.0, 150.0]
    while rings[-1] < extent_m:
        rings.append(rings[-1] * 1.07)
    spokes = 160
    height = hills(road)
    points = [(0.0, 0.0, -0.03)]
    for radius in rings[1:]:
        for k in range(spokes):
            a = 2 * math.pi * k / spokes
            x, y = radius * math.sin(a), radius * math.cos(a)
            points.append((x, y, height(x, y)))
    faces: list[Sequence[int]] = [(0, 1 + (k + 1) % spokes, 1 + k) for k in range(spokes)]
    for ring in range(len(rings) - 2):
        for k in range(spokes):
            a, b = 1 + ring * spokes + k, 1 + ring * spokes + (k + 1) % spokes
            faces.append((a, b, b + spokes, a + spokes))
    return Built.of("terrain", [from_data("terrain", points, faces, land_material(road, bare_areas), smooth=True)])


def hills(road: Carriageway) -> Callable[[float, float], float]:
    """Return a function that maps (x, y) to the height of the land above the road, all in metres.

    The height is 0 near the road and rises to about 90 m at a distance of 2 to 3 km.
    """

    def height(x: float, y: float) -> float:
        r = math.hypot(x, y)
        offset_m = abs(x - road.centre_x(max(-road.length_m, min(road.length_m, y))))
        roll_weight = _smooth(offset_m, 70.0, 280.0) * _smooth(r, 120.0, 420.0)
        roll = 4.0 * math.sin(x / 97.0 + 0.4) * math.cos(y / 121.0 - 0.9) + 2.2 * math.sin((x + 1.7 * y) / 63.0)
        bearing = math.atan2(x, y)
        ridge = 34 + 16 * math.sin(3 * bearing + 0.7) + 9 * math.sin(7 * bearing + 2.1) + 5 * math.sin(13 * bearing)
        ridge_weight = _smooth(r, 500.0, 1900.0) + 0.75 * _smooth(r, 1900.0, 3000.0)
        return -0.03 + roll_weight * roll + max(_smooth(offset_m, 80.0, 420.0), _smooth(r, 900.0, 1200.0)) * ridge * ridge_weight

    return height


def _smooth(value: float, low: float, high: float) -> float:
    """Return 0 below ``low``, 1 above ``high``, and a smooth transition between them."""
    t = max(0.0, min(1.0, (value - low) / (high - low)))
    return t * t * (3 - 2 * t)


def land_material(road: Carriageway, bare_areas: Sequence[tuple[float, float, float, float]]) -> bpy.types.Material:
    """Return the material of the land: grass and worn ground near the road, and fields beyond."""
    s = Shader("land")
    p = s.position()
    x, y, _ = s.xyz(p)
    large = s.noise(p, 0.045, detail=5.0)
    medium = s.noise(p, 0.55, detail=6.0, roughness=0.62)
    fine = s.noise(p, 7.0, detail=5.0, roughness=0.7)
    grass = s.mix(s.ramp(medium, 0.3, 0.7), (0.050, 0.082, 0.019), (0.105, 0.135, 0.038))
    grass = s.mix(s.ramp(fine, 0.35, 0.75), grass, (0.125, 0.140, 0.052))
    grass = s.mix(s.math("MULTIPLY", s.ramp(large, 0.45, 0.65), 0.45), grass, (0.17, 0.150, 0.070))
    tufts = s.noise(p, 1.9, detail=4.0, roughness=0.6)
    grass = s.mix(s.ramp(tufts, 0.48, 0.66, 0.0, 0.55), grass, (0.048, 0.078, 0.018))
    clover = s.ramp(s.noise(p, 0.16, detail=5.0, roughness=0.65), 0.52, 0.60, 0.0, 0.5)
    grass = s.mix(clover, grass, (0.062, 0.105, 0.026))
    fields = _fields(s, p, large, medium)
    abs_x = s.math("ABSOLUTE", x)
    colour = s.mix(s.ramp(s.math("ADD", abs_x, s.math("MULTIPLY", y, 0.04)), 58, 62), grass, fields)
    soil = s.mix(s.ramp(fine, 0.3, 0.7), (0.105, 0.083, 0.058), (0.185, 0.158, 0.122))
    soil = s.mix(s.ramp(s.voronoi(p, 6.0), 0.10, 0.30, 0.35, 0.0), soil, (0.24, 0.22, 0.19))
    soil = s.mix(s.ramp(s.noise(p, 0.3, detail=5.0), 0.45, 0.62, 0.0, 0.75), soil, (0.088, 0.070, 0.050))
    edge_noise = s.math("MULTIPLY", s.math("SUBTRACT", medium, 0.5), 3.2)
    for x0, x1, y0, y1 in bare_areas:
        mask = s.math(
            "MULTIPLY",
            s.band(s.math("ADD", x, edge_noise), x0, x1, 0.5),
            s.band(s.math("ADD", y, edge_noise), y0, y1, 0.5),
        )
        wear = s.ramp(medium, 0.28, 0.40, 0.55, 1.0)
        colour = s.mix(s.math("MULTIPLY", mask, wear), colour, soil)
    edge = s.ramp(s.math("ADD", abs_x, s.math("MULTIPLY", edge_noise, 0.12)), road.edge_m + 0.10, road.edge_m + 0.45, 1.0, 0.0)
    colour = s.mix(s.math("MULTIPLY", edge, s.ramp(abs_x, 100, 101, 1.0, 0.0)), colour, (0.12, 0.105, 0.08))
    height = s.math("ADD", fine, s.math("MULTIPLY", medium, 2.0))
    return s.surface(base_color=colour, roughness=0.95, specular_ior_level=0.1, normal=s.bump(height, 0.5, 0.05))


def _fields(s: Shader, p: Value, large: Value, medium: Value) -> Value:
    """Return the colour of fields: crops, stubble and ploughed land in Voronoi cells, with tractor tracks."""
    cell = s.node("ShaderNodeTexVoronoi", distance="CHEBYCHEV")
    s.set_input(cell.inputs["Vector"], s.scaled(p, (0.0055, 0.0042, 0.0), (0.37, 0.21, 0)))
    cell.inputs["Scale"].default_value = 1.0
    cell.inputs["Randomness"].default_value = 0.75
    index, shade, _ = s.xyz(cell.outputs["Color"])
    colour = s.mix(s.ramp(index, 0.40, 0.41), (0.075, 0.125, 0.030), (0.135, 0.165, 0.045))
    colour = s.mix(s.ramp(index, 0.66, 0.67), colour, (0.30, 0.235, 0.095))
    colour = s.mix(s.ramp(index, 0.84, 0.85), colour, (0.135, 0.098, 0.066))
    colour = s.mix(s.math("MULTIPLY", shade, 0.35), colour, (0.09, 0.12, 0.035))
    wheels = s.math("PINGPONG", s.xyz(p)[0], 9.0)
    tramline = s.math("MULTIPLY", s.band(wheels, 0.4, 0.95, 0.1), s.ramp(index, 0.40, 0.41))
    colour = s.mix(s.math("MULTIPLY", tramline, 0.45), colour, (0.10, 0.085, 0.05))
    return s.mix(s.math("MULTIPLY", s.ramp(medium, 0.35, 0.7), 0.3), colour, s.mix(large, (0.05, 0.08, 0.02), (0.2, 0.19, 0.08)))
