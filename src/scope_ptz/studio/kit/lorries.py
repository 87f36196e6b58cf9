"""Heavy vehicles: box lorry, tipper, tanker and coach."""

from __future__ import annotations

import math

import bpy
from mathutils import Matrix

from scope_ptz.studio.kit import bodywork as bw
from scope_ptz.studio.kit import shading, wheels
from scope_ptz.studio.kit.bodywork import AMBER, GAP, HEADLAMP, REAR_LAMP, TRIM, Patch
from scope_ptz.studio.kit.parts import Flat, Parts
from scope_ptz.studio.kit.stage import Built

_DARK_PAINTS = {"black", "blue", "dark blue", "red", "dark red", "green", "dark green", "grey", "purple", "brown"}


def _contrast(colour: str) -> str:
    return "white" if colour in _DARK_PAINTS else "dark blue"


def _chassis_paint() -> bpy.types.Material:
    return shading.plain("lorry chassis", (0.030, 0.030, 0.032), 0.6)


def _aluminium() -> bpy.types.Material:
    return shading.plain("lorry aluminium", (0.50, 0.51, 0.52), 0.38, 0.7)


def _mirrored(parts: Parts, sign: int) -> None:
    """Work on the right-hand side, or on its mirror image."""
    parts.matrix = Matrix.Scale(sign, 4, (1, 0, 0))


def _cab(parts: Parts, front_y: float, *, depth: float = 1.72, width: float = 2.40, top: float = 2.86) -> None:
    """A day cab with its front face at ``front_y``: body, glazing, grille, bumper, lamps, steps, mirrors, visor."""
    half, y, back = width / 2, front_y, front_y - depth
    body: list[Flat] = [
        (back, 1.02), (y - 0.35, 1.02), (y - 0.05, 0.90), (y - 0.01, 1.30), (y - 0.03, 1.72), (y - 0.19, 2.58),
        (y - 0.32, top - 0.08), (y - 0.55, top), (back + 0.10, top + 0.04), (back, top - 0.05),
    ]  # fmt: skip
    parts.prism(body, -half, half, bw.paint_slot(), bevel_m=0.06, segments=3, smooth=True)
    trim, glass = bw.black_trim(), bw.glass()
    lean = math.atan2(0.16, 0.86)
    parts.matrix = Matrix.Translation((0, y - 0.105, 2.15)) @ Matrix.Rotation(lean, 4, "X")
    parts.box((width - 0.16, 0.03, 0.90), (0, 0.0, 0), trim, bevel_m=0.012)
    parts.box((width - 0.22, 0.03, 0.83), (0, 0.008, 0), glass, bevel_m=0.012)
    for x in (-0.55, 0.15):
        parts.tube([(x, 0.03, -0.42), (x + 0.62, 0.034, -0.36)], 0.011, trim, sides=4)
    parts.matrix = Matrix.Identity(4)
    parts.box((width - 0.10, 0.26, 0.03), (0, y + 0.03, 2.70), shading.plain("lorry visor", (0.01, 0.011, 0.012), 0.15), bevel_m=0.01)
    parts.box((width - 0.30, 0.04, 0.62), (0, y - 0.005, 1.30), trim, bevel_m=0.015)
    for k in range(5):
        parts.box((width - 0.42, 0.05, 0.055), (0, y + 0.012, 1.09 + 0.105 * k), bw.paint_slot() if k == 4 else _chassis_paint(), bevel_m=0.015)
    parts.box((0.34, 0.03, 0.07), (0, y + 0.03, 1.62), _aluminium(), bevel_m=0.01)
    parts.prism([(y - 0.62, 0.36), (y + 0.08, 0.36), (y + 0.12, 0.52), (y + 0.08, 0.92), (y - 0.30, 0.92), (y - 0.34, 0.60), (y - 0.62, 0.55)],
                -half - 0.01, half + 0.01, bw.paint_slot(), bevel_m=0.04, segments=2)  # fmt: skip
    parts.box((width - 0.9, 0.05, 0.16), (0, y + 0.11, 0.74), trim)
    for sign in (-1, 1):
        _mirrored(parts, sign)
        x = half + 0.004
        side: list[Flat] = [(y - 0.24, 1.66), (y - 0.36, 2.52), (back + 0.52, 2.56), (back + 0.50, 1.74), (y - 0.95, 1.74), (y - 1.02, 1.66)]
        inner = [(a + (0.035 if a < y - 0.6 else -0.045), b + (0.035 if b < 2 else -0.035)) for a, b in side]
        parts.prism(side, x - 0.02, x + 0.006, trim)
        parts.prism(inner, x - 0.02, x + 0.012, glass)
        for gy in (y - 0.17, back + 0.42):
            parts.box((0.008, 0.012, 1.50), (x, gy, 1.80), wheels.shade(), bevel_m=0.0)
        parts.box((0.008, 1.14, 0.012), (x, y - 0.74, 1.04), wheels.shade(), bevel_m=0.0)
        parts.box((0.03, 0.18, 0.035), (x + 0.012, back + 0.58, 1.50), trim)
        parts.tube([(x + 0.03, back + 0.38, 1.2), (x + 0.06, back + 0.38, 1.25), (x + 0.06, back + 0.38, 2.0), (x + 0.03, back + 0.38, 2.05)], 0.014, trim)
        for k, z in enumerate((0.46, 0.74)):
            parts.box((0.26, 0.46, 0.05), (half - 0.13, y - 0.38 - 0.04 * k, z), _chassis_paint())
        parts.box((0.04, 0.10, 0.45), (half - 0.02, y - 0.62, 0.60), _chassis_paint())
        parts.tube([(x - 0.02, y - 0.16, 2.45), (x + 0.24, y + 0.02, 2.42), (x + 0.24, y + 0.02, 1.72), (x - 0.02, y - 0.12, 1.70)], 0.018, trim, sides=6)
        parts.box((0.24, 0.09, 0.40), (x + 0.22, y + 0.01, 2.18), trim, bevel_m=0.035)
        parts.box((0.24, 0.09, 0.20), (x + 0.22, y + 0.01, 1.83), trim, bevel_m=0.03)
        parts.box((0.20, 0.01, 0.34), (x + 0.22, y - 0.038, 2.18), glass)
        parts.box((0.46, 0.05, 0.20), (half - 0.27, y + 0.098, 0.72), wheels.shade(), bevel_m=0.02)
        for k, (wide, colour) in enumerate(((0.15, "white"), (0.15, "white"), (0.08, "amber"))):
            parts.box((wide, 0.04, 0.15), (half - 0.42 + 0.155 * k - (0.035 if k == 2 else 0), y + 0.115, 0.72), bw.lamp(colour), bevel_m=0.02)
        parts.box((0.05, 0.12, 0.05), (half - 0.35, y - 0.25, top - 0.02), bw.lamp("amber"))
    parts.matrix = Matrix.Identity(4)


def _mudguard(parts: Parts, y: float, radius: float, x0: float, x1: float, material: bpy.types.Material) -> None:
    outer = [(y + (radius + 0.09) * math.cos(a), radius + (radius + 0.09) * math.sin(a)) for a in (math.pi * (0.02 + 0.96 * k / 10) for k in range(11))]
    inner = [(y + (radius + 0.06) * math.cos(a), radius + (radius + 0.06) * math.sin(a)) for a in (math.pi * (0.98 - 0.96 * k / 10) for k in range(11))]
    for sign in (-1, 1):
        _mirrored(parts, sign)
        for k in range(10):
            ring = [outer[k], outer[k + 1], inner[9 - k], inner[10 - k]]
            parts.prism(ring, x0, x1, material)
    parts.matrix = Matrix.Identity(4)


def _running_gear(parts: Parts, front: float, rears: list[float], rear_end: float, front_end: float) -> None:
    """Frame rails, axles, wheels, mudguards, tank, battery box and the rear underrun bar with its lamps."""
    dark = _chassis_paint()
    for x in (-0.42, 0.42):
        parts.box((0.09, front_end - rear_end, 0.26), (x, (front_end + rear_end) / 2, 0.92), dark)
    for y in (front, *rears):
        parts.tube([(-0.95, y, 0.5), (0.95, y, 0.5)], 0.08, dark)
        for sign in (-1, 1):
            driven = y != front
            wheels.lorry_wheel(parts, (sign * (1.06 if driven else 1.04), y, 0.50), 0.50, sign, twin=driven)
        if y != front:
            _mudguard(parts, y, 0.5, 0.62, 1.20, dark)
    _mudguard(parts, front, 0.5, 0.80, 1.20, bw.black_trim())
    parts.box((2.30, 0.10, 0.14), (0, rear_end + 0.06, 0.56), _aluminium())
    for sign in (-1, 1):
        _mirrored(parts, sign)
        parts.box((0.08, 0.10, 0.40), (0.45, rear_end + 0.10, 0.74), dark)
        parts.box((0.44, 0.06, 0.15), (0.96, rear_end + 0.03, 0.74), wheels.shade(), bevel_m=0.015)
        for x, colour in ((1.09, "amber"), (0.95, "red"), (0.81, "red")):
            parts.box((0.12, 0.04, 0.12), (x, rear_end - 0.002, 0.74), bw.lamp(colour), bevel_m=0.015)
        parts.box((0.50, 0.012, 0.40), (0.90, rears[-1] - 0.78, 0.36), wheels.rubber(), bevel_m=0.0)
    parts.matrix = Matrix.Identity(4)


def _side_guards(parts: Parts, y0: float, y1: float) -> None:
    for sign in (-1, 1):
        _mirrored(parts, sign)
        for z in (0.50, 0.80):
            parts.box((0.03, y1 - y0, 0.12), (1.17, (y0 + y1) / 2, z), _aluminium())
        for k in range(3):
            parts.box((0.05, 0.05, 0.62), (1.14, y0 + 0.15 + (y1 - y0 - 0.3) * k / 2, 0.76), _chassis_paint())
    parts.matrix = Matrix.Identity(4)


def _stores(parts: Parts, y: float) -> None:
    """The fuel tank on the right and the battery and air boxes on the left, behind the cab."""
    parts.prism([(0.62, 0.42), (1.16, 0.42), (1.20, 0.48), (1.20, 0.90), (1.14, 0.96), (0.62, 0.96)], y - 1.1, y, _aluminium(), axis="Y", bevel_m=0.03, segments=2)
    for k in (0.25, 0.85):
        parts.box((0.60, 0.05, 0.57), (0.915, y - k, 0.69), _chassis_paint(), bevel_m=0.02)
    parts.lathe([(0.05, 0), (0.05, 0.05), (0.03, 0.06)], (0.9, y - 0.55, 0.955), bw.black_trim())
    parts.box((0.55, 0.70, 0.45), (-0.90, y - 0.35, 0.70), _chassis_paint(), bevel_m=0.03)
    parts.lathe([(0.02, -0.32), (0.13, -0.29), (0.13, 0.29), (0.02, 0.32)], (-0.98, y - 1.06, 0.62), _chassis_paint(), axis="Y")


def _marker_tape(parts: Parts, x: float, y0: float, y1: float, z: float) -> None:
    tape = shading.plain("conspicuity tape", (0.75, 0.42, 0.02), 0.4)
    for sign in (-1, 1):
        parts.box((0.006, y1 - y0, 0.05), (sign * x, (y0 + y1) / 2, z), tape, bevel_m=0.0)


def _box_parts() -> Parts:
    parts = Parts()
    parts.slot(bw.paint_slot(0))
    parts.slot(bw.paint_slot(1))
    _running_gear(parts, 2.35, [-2.35], -4.25, 3.6)
    _cab(parts, 3.72)
    _stores(parts, 1.55)
    _side_guards(parts, -1.55, 0.35)
    box = bw.paint_slot(1)
    parts.box((2.48, 6.10, 2.55), (0, -1.20, 2.42), box, bevel_m=0.03)
    rail, dark = _aluminium(), _chassis_paint()
    parts.box((2.30, 6.0, 0.12), (0, -1.20, 1.10), dark)
    for sign in (-1, 1):
        _mirrored(parts, sign)
        for z in (1.17, 3.66):
            parts.box((0.03, 6.14, 0.09), (1.24, -1.20, z), rail)
        for y in (-4.24, 1.84):
            parts.box((0.07, 0.07, 2.56), (1.22, y, 2.42), rail, bevel_m=0.02)
        parts.box((0.02, 0.02, 2.40), (0.012, -4.262, 2.42), wheels.shade(), bevel_m=0.0)
        for x in (0.18, 0.85):
            parts.tube([(x, -4.285, 1.25), (x, -4.285, 3.60)], 0.017, rail, sides=6)
            parts.box((0.10, 0.03, 0.05), (x, -4.275, 2.0), rail)
        for z in (1.45, 2.1, 2.75, 3.4):
            parts.box((0.16, 0.025, 0.06), (1.12, -4.268, z), rail)
        parts.box((0.10, 0.04, 0.10), (1.17, -4.25, 3.60), bw.lamp("red"), bevel_m=0.01)
        for y in (-3.9, -2.6, 0.0, 1.4):
            parts.box((0.02, 0.10, 0.04), (1.262, y, 1.10), bw.lamp("amber"), bevel_m=0.005)
    parts.matrix = Matrix.Identity(4)
    parts.box((2.2, 0.5, 1.2), (0, 2.12, 3.2), bw.paint_slot(0), bevel_m=0.15)
    parts.box((2.40, 0.05, 0.10), (0, -4.27, 1.17), dark)
    return parts


def box_lorry(cab_colour: str, box_colour: str, *, plate: str, lettering: str) -> Built:
    """A two-axle rigid lorry with a box body and barn doors, 8 m long; lettering on both sides and above the rear doors."""
    body = bw.body_mesh("box lorry", _box_parts)
    own, letters = bw.plates(plate, (3.86, 0.60), (-4.30, 0.98))
    tint = _contrast(box_colour)
    letters += bw.both_sides(lettering, 0.42, -1.2, 2.55, tint, x=1.242, width_m=5.0)
    letters.append(bw.words(lettering, 0.16, (0, -4.281, 3.30), "-Y", tint, width_m=0.30 * 7))
    paints = [bw.paint("lorry cab", cab_colour, dirt_top_m=1.2), bw.paint("lorry box", box_colour, dirt_top_m=1.9, dirt=0.35)]
    return bw.finish("box lorry", body, paints, letters, own)


def _tipper_parts() -> Parts:
    parts = Parts()
    parts.slot(bw.paint_slot(0))
    parts.slot(bw.paint_slot(1))
    _running_gear(parts, 2.55, [-1.35, -2.65], -3.95, 3.7)
    _cab(parts, 3.85)
    _stores(parts, 1.75)
    body, dark = bw.paint_slot(1), _chassis_paint()
    floor, top, y0, y1 = 1.30, 2.45, -4.15, 1.65
    parts.box((2.36, y1 - y0, 0.14), (0, (y0 + y1) / 2, floor), body)
    for x in (-0.42, 0.42):
        parts.box((0.12, y1 - y0 - 0.2, 0.16), (x, (y0 + y1) / 2, floor - 0.14), dark)
    for sign in (-1, 1):
        _mirrored(parts, sign)
        parts.prism([(1.12, floor), (1.18, floor), (1.24, top), (1.16, top)], y0, y1, body, axis="Y")
        parts.box((0.12, y1 - y0 + 0.02, 0.12), (1.21, (y0 + y1) / 2, top), body, bevel_m=0.02)
        for k in range(8):
            y = y0 + 0.06 + (y1 - y0 - 0.12) * k / 7
            parts.prism([(1.16, floor - 0.05), (1.26, floor - 0.05), (1.30, top), (1.20, top)], y - 0.05, y + 0.05, body, axis="Y", bevel_m=0.01)
        parts.box((0.10, 0.10, 0.14), (1.12, y0 - 0.02, top + 0.05), dark)
    parts.matrix = Matrix.Identity(4)
    parts.box((2.34, 0.08, top - floor + 0.35), (0, y1, (top + floor + 0.35) / 2), body)
    parts.prism([(y1 - 0.04, top + 0.28), (y1 + 0.85, top + 0.55), (y1 + 0.85, top + 0.62), (y1 - 0.04, top + 0.36)], -1.17, 1.17, body)
    parts.box((2.30, 0.07, top - floor), (0, y0, (top + floor) / 2), body)
    for x in (-0.8, 0.0, 0.8):
        parts.box((0.12, 0.08, top - floor - 0.08), (x, y0 - 0.05, (top + floor) / 2), body)
    parts.lathe([(0.11, 0.95), (0.11, 2.1), (0.09, 2.1), (0.09, 2.6)], (0, y1 + 0.22, 0), _aluminium(), steps=16)
    _load(parts, y0 + 0.06, y1 - 0.06, top - 0.32)
    return parts


def _load(parts: Parts, y0: float, y1: float, z: float) -> None:
    """A heap of crushed stone in the body."""
    stone = bpy.data.materials.get("lorry aggregate")
    if stone is None:
        sh = shading.Shader("lorry aggregate")
        cell = sh.voronoi(sh.object_coords(), 16.0, output="Distance")
        tone = sh.mix(sh.ramp(sh.noise(sh.object_coords(), 9.0), 0.3, 0.7), (0.10, 0.085, 0.07), (0.30, 0.27, 0.23))
        stone = sh.surface(base_color=sh.mix(sh.ramp(cell, 0.0, 0.6), tone, (0.05, 0.045, 0.04)), roughness=0.95, normal=sh.bump(cell, 1.0, 0.04))
    nx, ny = 14, 36
    points, faces = [], []
    for i in range(nx + 1):
        for j in range(ny + 1):
            u, v = i / nx, j / ny
            heap = 0.42 * math.sin(math.pi * u) * (0.55 + 0.45 * abs(math.sin(2 * math.pi * v * 1.0 + 0.3))) * min(1.0, 6 * v, 6 * (1 - v))
            rough = 0.03 * math.sin(37.0 * i + 11.3 * j * j) + 0.02 * math.sin(5.1 * i * j)
            points.append((-1.14 + 2.28 * u, y0 + (y1 - y0) * v, z + heap + rough))
    for i in range(nx):
        for j in range(ny):
            a = i * (ny + 1) + j
            faces.append((a, a + ny + 1, a + ny + 2, a + 1))
    parts.add(points, faces, stone, smooth=True)


def tipper(cab_colour: str, body_colour: str, *, plate: str) -> Built:
    """A three-axle tipper loaded with crushed stone, 8 m long."""
    own, letters = bw.plates(plate, (3.99, 0.60), (-3.97, 0.98))
    paints = [bw.paint("lorry cab", cab_colour, dirt_top_m=1.2), bw.paint("tipper body", body_colour, dirt_top_m=2.2, dirt=0.5)]
    return bw.finish("tipper", bw.body_mesh("tipper", _tipper_parts), paints, letters, own)


_TANK: tuple[float, float, float] = (0.0, 2.15, 1.20)


def _tank_outline(grow: float = 0.0) -> list[Flat]:
    return [((1.20 + grow) * math.cos(a), 2.12 + (0.90 + grow) * math.sin(a)) for a in (2 * math.pi * (k + 0.5) / 40 for k in range(40))]


def _tanker_parts() -> Parts:
    parts = Parts()
    parts.slot(bw.paint_slot(0))
    parts.slot(bw.paint_slot(1))
    _running_gear(parts, 2.75, [-1.35, -2.70], -4.20, 3.9)
    _cab(parts, 4.05)
    _stores(parts, 1.90)
    y0, y1 = -4.25, 1.90
    parts.prism(_tank_outline(), y0 + 0.12, y1 - 0.12, bw.paint_slot(1), axis="Y", smooth=True)
    for y, sign in ((y0 + 0.12, -1), (y1 - 0.12, 1)):
        for k, (shrink, push) in enumerate(((-0.06, 0.07), (-0.20, 0.12))):
            low, high = sorted((y - sign * 0.05, y + sign * push))
            parts.prism(_tank_outline(shrink), low, high, bw.paint_slot(1), axis="Y", bevel_m=0.03)
    for y in (y0 + 0.15, -2.7, -1.2, 0.35, y1 - 0.15):
        parts.prism(_tank_outline(0.012), y - 0.03, y + 0.03, _aluminium(), axis="Y", smooth=True)
    parts.box((0.62, y1 - y0 - 0.5, 0.04), (0, (y0 + y1) / 2, 3.05), _aluminium())
    for y in (-3.3, -1.9, -0.4, 1.0):
        parts.lathe([(0.27, 0), (0.27, 0.10), (0.22, 0.14), (0.05, 0.16)], (0, y, 3.04), _aluminium())
    for sign in (-1, 1):
        _mirrored(parts, sign)
        parts.tube([(0.38, y0 + 0.4, 3.05), (0.38, y0 + 0.4, 3.50), (0.38, y1 - 0.4, 3.50), (0.38, y1 - 0.4, 3.05)], 0.02, _aluminium(), sides=6)
        for k in range(4):
            y = y0 + 1.4 + k * 1.15
            parts.tube([(0.38, y, 3.05), (0.38, y, 3.50)], 0.016, _aluminium(), sides=6)
        parts.prism([(0.5, 1.0), (1.20, 1.05), (1.20, 1.60), (1.14, 1.64), (0.5, 1.3)], y0 + 0.05, y1 - 0.3, _chassis_paint(), axis="Y")
    parts.matrix = Matrix.Identity(4)
    for x in (0.62, 0.98):
        parts.tube([(x, y0 - 0.16, 0.75), (x, y0 - 0.16, 2.75), (x * 0.9, y0 + 0.2, 3.05)], 0.018, _aluminium(), sides=6)
    for k in range(8):
        parts.tube([(0.62, y0 - 0.16, 0.85 + 0.27 * k), (0.98, y0 - 0.16, 0.85 + 0.27 * k)], 0.013, _aluminium(), sides=6)
    _side_guards(parts, -0.55, 0.65)
    return parts


def tanker(cab_colour: str, *, plate: str, lettering: str) -> Built:
    """A three-axle fuel tanker, 8.4 m long, with a silver tank and lettering on both sides."""
    body = bw.body_mesh("tanker", _tanker_parts)
    own, letters = bw.plates(plate, (4.19, 0.60), (-4.22, 0.98))
    letters += bw.both_sides(lettering, 0.40, -1.2, 2.22, cab_colour if cab_colour in _DARK_PAINTS else "dark blue", width_m=4.4, onto=bw.Surface(body))
    letters += [bw.words("HIGHLY FLAMMABLE", 0.11, (0, -4.262, 2.3), "-Y", "red", width_m=1.4)]
    paints = [bw.paint("lorry cab", cab_colour, dirt_top_m=1.2), bw.paint("tank", "silver", dirt_top_m=2.0, dirt=0.4)]
    return bw.finish("tanker", body, paints, letters, own)


_COACH_FRONT, _COACH_REAR, _COACH_HALF, _COACH_TOP = 5.95, -5.75, 1.25, 3.25


def _coach_parts() -> Parts:
    parts = Parts()
    front, rear, half, top = _COACH_FRONT, _COACH_REAR, _COACH_HALF, _COACH_TOP
    paint, trim, glass = bw.paint_slot(), bw.black_trim(), bw.glass()
    section: list[Flat] = [
        (rear + 0.02, 0.42), (rear, 0.9), (rear, 2.2), (rear + 0.10, top - 0.10), (rear + 0.35, top), (front - 0.55, top), (front - 0.22, top - 0.10),
        (front - 0.10, 2.6), (front, 1.25), (front, 0.6), (front - 0.06, 0.34),
    ]  # fmt: skip
    parts.prism(section, -half, half, paint, bevel_m=0.10, segments=3, smooth=True)
    lean = math.atan2(0.10, 1.35)
    parts.matrix = Matrix.Translation((0, front - 0.045, 1.86)) @ Matrix.Rotation(lean, 4, "X")
    parts.box((2.34, 0.03, 1.42), (0, 0, 0), glass, bevel_m=0.012)
    for x in (-0.75, 0.10):
        parts.tube([(x, 0.03, -0.66), (x + 0.75, 0.035, -0.55)], 0.013, trim, sides=4)
    parts.matrix = Matrix.Identity(4)
    parts.box((2.30, 0.10, 0.42), (0, front - 0.17, 2.84), wheels.shade(), bevel_m=0.03)
    parts.box((2.20, 0.04, 0.05), (0, front + 0.01, 0.95), _aluminium())
    parts.box((1.3, 0.04, 0.18), (0, front + 0.005, 0.82), trim)
    windows = [4.05, 2.62, 1.19, -0.24, -1.67, -3.10, -4.53]
    for sign in (-1, 1):
        _mirrored(parts, sign)
        parts.box((0.02, 9.95, 1.12), (half - 0.003, -0.40 + 0.02, 2.14), trim, bevel_m=0.008)
        for y in windows:
            if sign < 0 and y == windows[0]:
                continue
            parts.box((0.02, 1.36, 1.02), (half + 0.003, y - 0.15, 2.14), glass, bevel_m=0.008)
            parts.box((0.008, 1.36, 0.02), (half + 0.012, y - 0.15, 2.42), trim, bevel_m=0.0)
        parts.box((0.02, 0.80, 1.0), (half + 0.003, 5.15, 2.0), glass, bevel_m=0.008)
        for y in (3.3, 2.0, 0.7, -0.6, -1.9):
            parts.box((0.006, 1.22, 0.62), (half + 0.001, y - 0.4, 0.80), paint, bevel_m=0.0)
            for edge in (-0.62, 0.62):
                parts.box((0.008, 0.012, 0.62), (half + 0.001, y - 0.4 + edge, 0.80), wheels.shade(), bevel_m=0.0)
        parts.box((0.008, 8.0, 0.012), (half + 0.001, -0.5, 1.14), wheels.shade(), bevel_m=0.0)
        parts.box((0.40, 0.05, 0.22), (half - 0.28, front + 0.005, 0.72), wheels.shade(), bevel_m=0.03)
        for k, colour in enumerate(("white", "white", "amber")):
            parts.box((0.115, 0.04, 0.14), (half - 0.41 + 0.13 * k, front + 0.02, 0.72), bw.lamp(colour), bevel_m=0.03)
        for k, colour in enumerate(("red", "red", "amber", "white")):
            parts.box((0.16, 0.04, 0.16), (half - 0.22, rear - 0.005, 1.30 - 0.18 * k), bw.lamp(colour), bevel_m=0.03)
        parts.tube([(half - 0.10, front - 0.25, 2.95), (half + 0.10, front + 0.30, 2.90), (half + 0.16, front + 0.36, 2.62)], 0.025, trim, sides=6)
        parts.box((0.24, 0.12, 0.48), (half + 0.16, front + 0.36, 2.36), trim, bevel_m=0.04)
        for y in (3.55, -2.75):
            arch = [(y + 0.60 * math.cos(a), 0.46 + 0.60 * math.sin(a)) for a in (math.pi * k / 14 for k in range(15))]
            parts.prism([*arch, (y - 0.60, 0.30), (y + 0.60, 0.30)], half - 0.5, half + 0.006, wheels.shade())
            parts.tube([(half + 0.005, a, b) for a, b in arch], 0.022, trim, sides=6)
    parts.matrix = Matrix.Identity(4)
    for y, twin in ((3.55, False), (-2.75, True)):
        for sign in (-1, 1):
            wheels.lorry_wheel(parts, (sign * 1.14, y, 0.48), 0.48, sign, width=0.27, twin=twin)
    for y in (4.93, 4.37):
        parts.box((0.02, 0.53, 2.20), (-half - 0.004, y - 0.05 + 0.25, 1.52), trim, bevel_m=0.008)
        parts.box((0.02, 0.44, 1.95), (-half - 0.010, y - 0.05 + 0.25, 1.55), glass, bevel_m=0.008)
    parts.box((2.0, 0.03, 0.85), (0, rear + 0.01, 2.30), trim)
    parts.box((1.9, 0.03, 0.76), (0, rear + 0.004, 2.30), glass)
    for k in range(6):
        parts.box((1.3, 0.03, 0.04), (0, rear - 0.002, 0.95 + 0.09 * k), trim)
    parts.box((1.4, 2.2, 0.16), (0, -3.2, top + 0.05), paint, bevel_m=0.06)
    parts.box((0.9, 0.9, 0.06), (0, 1.5, top + 0.02), paint, bevel_m=0.03)
    return parts


def coach(colour: str, *, plate: str, lettering: str, destination: str) -> Built:
    """A single-deck coach, 11.7 m long, door on the left (kerb) side; the destination glows above the windscreen."""
    own, letters = bw.plates(plate, (_COACH_FRONT + 0.01, 0.52), (_COACH_REAR - 0.012, 0.66))
    letters += bw.both_sides(lettering, 0.30, 0.2, 1.38, _contrast(colour), x=_COACH_HALF, width_m=4.4)
    letters.append(bw.words(destination, 0.20, (0, _COACH_FRONT - 0.116, 2.84), "+Y", "display", width_m=2.05))
    patches = [
        Patch(TRIM, z=(0.0, 0.46), roughness=0.6),
        Patch(GAP, x=(0, 9), y=(-9, -5.5), z=(1.60, 1.61), roughness=0.9),
    ]
    return bw.finish("coach", bw.body_mesh("coach", _coach_parts), [bw.paint("coach", colour, patches, dirt_top_m=1.0)], letters, own)
