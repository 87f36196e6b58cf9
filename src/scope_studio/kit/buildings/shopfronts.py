"""Shop fronts with transparent display windows: pilasters, glass, fascias, and doors of shops and houses.

All parts are modelled in the coordinates of their building, whose wall is the plane y = 0. The street is towards +y.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from random import Random

import bpy

from scope_studio.kit.core.finishes import PALETTE, paint
from scope_studio.kit.core.lettering import extent
from scope_studio.kit.core.shading import Shader, plain
from scope_studio.kit.core.shapes import rounded_rectangle
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built
from scope_studio.kit.signs.faces import write

SILL_M = 0.60
"""Height in metres of the display shelf behind the glass."""
PILASTER_WIDTH_M = 0.34
"""Width in metres of the pilasters at both ends of a shop front."""
ROOM_DEPTH_M = 2.6
"""Depth in metres of the room behind the glass."""


@dataclass(frozen=True)
class ShopFront:
    """Parameters of a shop front. It is ``width_m`` wide, and the centre of its door is at ``door_x``.

    For a viewer in front of it, x increases to the left. ``room`` is the colour of the inside walls, and ``lit`` turns on
    the lamps. ``tiles`` is the colour of the tiles below the windows; None means wood.
    """

    width_m: float
    colour: str
    door_x: float
    room: str = "cream"
    lit: bool = True
    tiles: str | None = None


def shop_front(spec: ShopFront) -> Built:
    """Build the woodwork, the glass and the room behind the glass as one object. The door and the fascia are built separately."""
    s = Solid("shop front")
    wood = paint(spec.colour, dirt=0.10, roughness=0.34)
    w = spec.width_m / 2
    for x in (-w + PILASTER_WIDTH_M / 2, w - PILASTER_WIDTH_M / 2):
        s.box((PILASTER_WIDTH_M, 0.20, 3.38), (x, 0.02, 1.69), wood, 0.012)
        s.box((PILASTER_WIDTH_M + 0.06, 0.26, 0.34), (x, 0.02, 0.17), wood, 0.015)
        for dx in (-0.07, 0.07):
            s.box((0.045, 0.02, 2.0), (x + dx, 0.125, 1.55), wood, 0.008)
        s.box((PILASTER_WIDTH_M + 0.02, 0.36, 0.62), (x, 0.08, 3.10), wood, 0.03)
    s.box((spec.width_m, 0.46, 0.10), (0, 0.13, 3.45), wood, 0.025)
    s.box((spec.width_m, 0.36, 0.07), (0, 0.10, 3.375), wood, 0.02)
    s.box((spec.width_m - 2 * PILASTER_WIDTH_M, 0.14, 0.14), (0, 0.0, 2.77), wood, 0.012)
    inner = w - PILASTER_WIDTH_M
    for low, high in ((-inner, spec.door_x - 0.56), (spec.door_x + 0.56, inner)):
        if high - low > 0.35:
            _window(s, low, high, wood, spec.tiles)
    _doorway(s, spec, wood)
    _room(s, spec)
    return s.built()


def _window(s: Solid, low: float, high: float, wood: bpy.types.Material, tiles: str | None) -> None:
    width, middle = high - low, (low + high) / 2
    riser = wood if tiles is None else _tiles(tiles)
    s.box((width, 0.10, SILL_M - 0.08), (middle, 0.0, (SILL_M - 0.08) / 2), riser, 0.006)
    if tiles is None:
        for k in range(max(1, round(width / 1.0))):
            step = width / max(1, round(width / 1.0))
            s.box((step - 0.16, 0.02, 0.30), (low + step * (k + 0.5), 0.052, 0.29), wood, 0.01)
    s.box((width, 0.24, 0.07), (middle, 0.02, SILL_M - 0.045), wood, 0.012)
    count = max(1, round(width / 1.25))
    for k in range(count + 1):
        s.box((0.065, 0.10, 2.70 - SILL_M), (low + 0.032 + (width - 0.065) * k / count, 0.0, (2.70 + SILL_M) / 2), wood, 0.008)
    s.box((width, 0.09, 0.055), (middle, 0.0, 2.28), wood, 0.008)
    _pane(s, low + 0.03, high - 0.03, SILL_M - 0.01, 2.72, -0.01)
    shelf = plain("display shelf", (0.42, 0.38, 0.31), 0.6)
    s.box((width, 0.72, 0.03), (middle, -0.42, SILL_M - 0.03), shelf, 0.004)


def _pane(s: Solid, x0: float, x1: float, z0: float, z1: float, y: float) -> None:
    s.add([(x0, y, z0), (x1, y, z0), (x1, y, z1), (x0, y, z1)], [(1, 0, 3, 2)], shop_glass())


def _doorway(s: Solid, spec: ShopFront, wood: bpy.types.Material) -> None:
    x = spec.door_x
    for side in (-1, 1):
        s.box((0.08, 0.16, 2.70), (x + side * 0.53, -0.02, 1.35), wood, 0.01)
    s.box((1.1, 0.14, 0.08), (x, -0.02, 2.20), wood, 0.01)
    _pane(s, x - 0.5, x + 0.5, 2.24, 2.72, -0.03)
    s.box((1.15, 0.50, 0.13), (x, -0.12, 0.065), plain("doorstep", (0.22, 0.21, 0.19), 0.5), 0.015)


def _room(s: Solid, spec: ShopFront) -> None:
    """Add the room behind the glass: five inner faces and a row of ceiling lamps."""
    w, d, z1 = spec.width_m / 2 - 0.06, -ROOM_DEPTH_M, 2.74
    walls = _indoor_material(f"{spec.room} {spec.lit}", PALETTE[spec.room], 0.42 if spec.lit else 0.03)
    floor = _indoor_material(f"floor {spec.lit}", (0.16, 0.105, 0.065), 0.25 if spec.lit else 0.02)
    top = _indoor_material(f"ceiling {spec.lit}", (0.6, 0.6, 0.58), 0.5 if spec.lit else 0.03)
    z0 = 0.13
    s.add([(-w, d, z0), (w, d, z0), (w, d, z1), (-w, d, z1)], [(1, 0, 3, 2)], walls)
    for x in (-w, w):
        s.add([(x, 0, z0), (x, d, z0), (x, d, z1), (x, 0, z1)], [(0, 1, 2, 3)], walls)
    s.add([(-w, 0, z0), (w, 0, z0), (w, d, z0), (-w, d, z0)], [(0, 1, 2, 3)], floor)
    s.add([(-w, 0, z1), (w, 0, z1), (w, d, z1), (-w, d, z1)], [(3, 2, 1, 0)], top)
    lamp = _indoor_material(f"shop lamp {spec.lit}", (1.0, 0.93, 0.80), 3.2 if spec.lit else 0.0)
    for k in range(max(2, round(spec.width_m / 1.6))):
        x = -w + 2 * w * (k + 0.5) / max(2, round(spec.width_m / 1.6))
        s.box((0.16, 0.9, 0.04), (x, -1.2, z1 - 0.03), lamp, 0.01)
    shelf = _indoor_material(f"shop shelf {spec.lit}", (0.30, 0.19, 0.10), 0.3 if spec.lit else 0.02)
    for z in (0.75, 1.25, 1.75, 2.2):
        s.box((2 * w - 0.4, 0.30, 0.035), (0, d + 0.17, z), shelf, 0.004)
    for k in range(4):
        s.box((0.04, 0.30, 2.2), (-w + 0.22 + (2 * w - 0.44) * k / 3, d + 0.17, 1.2), shelf, 0.004)
    if spec.lit:
        _stock(s, w - 0.3, d + 0.18, Random(f"stock {spec.width_m} {spec.colour} {spec.door_x:.2f}"))


STOCK_COLOURS = ("red", "navy", "cream", "green", "white", "amber", "brown", "light blue", "dark red")


def _stock(s: Solid, half_m: float, y: float, rng: Random) -> None:
    """Fill the shelves on the back wall with groups of similar boxes, jars and packets."""
    for z in (0.77, 1.27, 1.77, 2.22):
        x = -half_m
        while x < half_m - 0.3:
            tint = rng.choice(STOCK_COLOURS)
            width, height = rng.uniform(0.07, 0.22), rng.uniform(0.12, 0.36)
            goods = _indoor_material(f"stock {tint}", PALETTE[tint], 0.30)
            for _ in range(rng.randrange(2, 6)):
                if x > half_m - 0.3:
                    break
                s.box((width, 0.22, height), (x + width / 2, y, z + height / 2), goods, 0.006)
                x += width + 0.012
            x += rng.choice((0.02, 0.05, 0.25))


def _indoor_material(name: str, colour: tuple[float, float, float], glow: float) -> bpy.types.Material:
    """Return a slightly emissive indoor material. Emission renders faster and with less noise than lamps behind glass."""
    material_name = f"inside {name}"
    existing = bpy.data.materials.get(material_name)
    if existing is not None:
        return existing
    s = Shader(material_name)
    patch = s.ramp(s.noise(s.object_coords(), 1.2, 3.0), 0.3, 0.7, 0.75, 1.1)
    warm = tuple(c * t for c, t in zip(colour, (1.0, 0.90, 0.74), strict=True))
    return s.surface(base_color=colour, roughness=0.8, emission_color=warm, emission_strength=s.math("MULTIPLY", patch, glow))


def shop_glass() -> bpy.types.Material:
    """Return the material of clean, mostly transparent glass that reflects the street more strongly at grazing angles."""
    existing = bpy.data.materials.get("shop glass")
    if existing is not None:
        return existing
    s = Shader("shop glass")
    clear, shine = s.node("ShaderNodeBsdfTransparent"), s.node("ShaderNodeBsdfGlossy")
    clear.inputs["Color"].default_value = (0.90, 0.93, 0.92, 1.0)
    shine.inputs["Roughness"].default_value = 0.015
    fraction = s.ramp(s.node("ShaderNodeLayerWeight").outputs["Facing"], 0.25, 0.95, 0.10, 0.36)
    mixed = s.node("ShaderNodeMixShader")
    s.set_input(mixed.inputs[0], fraction)
    s.tree.links.new(clear.outputs[0], mixed.inputs[1])
    s.tree.links.new(shine.outputs[0], mixed.inputs[2])
    output = next(n for n in s.tree.nodes if n.type == "OUTPUT_MATERIAL")
    s.tree.links.new(mixed.outputs[0], output.inputs["Surface"])
    return s.material


def _tiles(colour: str) -> bpy.types.Material:
    """Return the material of glazed tiles below a shop window."""
    name = f"glazed tiles {colour}"
    existing = bpy.data.materials.get(name)
    if existing is not None:
        return existing
    s = Shader(name)
    x, _, z = s.xyz(s.object_coords())
    grid = s.math("MINIMUM", s.math("PINGPONG", x, 0.075), s.math("PINGPONG", z, 0.075))
    joint = s.ramp(grid, 0.002, 0.005, 1.0, 0.0)
    return s.surface(base_color=s.mix(joint, PALETTE[colour], (0.3, 0.29, 0.27)), roughness=0.12, coat_weight=0.5)


def fascia(width_m: float, name: str, colour: str, ink: str, *, small: str | None = None, cap_m: float = 0.27) -> Built:
    """Build the name board over a shop front, at its mounting height. ``small`` is optional small lettering at the right end."""
    s = Solid(f"{name} sign")
    board = width_m - 2 * PILASTER_WIDTH_M - 0.04
    s.box((board, 0.10, 0.52), (0, 0.08, 3.085), paint(colour, dirt=0.15, roughness=0.30), 0.012)
    for z in (2.84, 3.33):
        s.box((board, 0.12, 0.03), (0, 0.085, z), paint(ink if ink in PALETTE else "white", dirt=0.1), 0.006)
    available = board - 0.30
    shift = 0.0
    if small:
        side = extent(small, 0.085)
        available -= side + 0.25
        shift = -(side + 0.25) / 2
    cap = min(cap_m, cap_m * available / extent(name, cap_m))
    with s.at(0, 0.131, 3.085):
        write(s, name, cap, shift, 0.0, ink, lift=0.002)
        if small:
            write(s, small, 0.085, board / 2 - 0.15 - extent(small, 0.085) / 2, 0.0, ink, lift=0.002)
    return s.built()


def shop_door(colour: str, *, number: str | None = None) -> Built:
    """Build a closed, half-glazed shop door with the centre of its lower edge at the origin. The number is on the glass."""
    s = Solid(f"{colour} door")
    wood = paint(colour, dirt=0.16, roughness=0.28)
    for x in (-0.42, 0.42):
        s.box((0.14, 0.05, 2.02), (x, 0, 1.01), wood, 0.008)
    for z, height in ((0.16, 0.32), (0.88, 0.14), (1.95, 0.14)):
        s.box((0.72, 0.05, height), (0, 0, z), wood, 0.008)
    s.box((0.70, 0.03, 0.54), (0, -0.005, 0.57), wood, 0.004)
    s.box((0.50, 0.02, 0.36), (0, 0.012, 0.57), wood, 0.012)
    _pane(s, -0.36, 0.36, 0.94, 1.89, 0.0)
    brass = plain("brass", (0.55, 0.36, 0.11), 0.25, 1.0)
    s.tube([(0.40, 0.03, 0.95), (0.40, 0.075, 0.97), (0.40, 0.075, 1.25), (0.40, 0.03, 1.27)], 0.012, brass)
    s.box((0.26, 0.012, 0.05), (0, 0.03, 0.88), brass, 0.003)
    if number:
        with s.at(0, 0.026, 1.955):
            write(s, number, 0.085, 0, 0, "white" if colour not in ("white", "cream", "yellow") else "black", lift=0.002)
    return s.built()


def house_door(colour: str, *, number: str | None = None) -> Built:
    """Build a six-panel front door with a knocker, letter plate and number. The centre of its lower edge is at the origin."""
    s = Solid(f"{colour} door")
    wood = paint(colour, dirt=0.12, roughness=0.22)
    s.box((0.96, 0.045, 2.02), (0, 0, 1.01), wood, 0.006)
    for x in (-0.22, 0.22):
        for z, height in ((0.42, 0.50), (1.02, 0.42), (1.64, 0.50)):
            s.box((0.34, 0.02, height), (x, 0.024, z), wood, 0.008)
            s.box((0.26, 0.02, height - 0.08), (x, 0.030, z), wood, 0.010)
    brass = plain("brass", (0.55, 0.36, 0.11), 0.25, 1.0)
    s.box((0.28, 0.014, 0.07), (0, 0.032, 0.76), brass, 0.004)
    s.tube([(-0.035, 0.05, 1.42), (-0.03, 0.055, 1.34), (0.03, 0.055, 1.34), (0.035, 0.05, 1.42)], 0.009, brass)
    s.lathe([(0.03, 0.0), (0.032, 0.03), (0.01, 0.04)], brass, (-0.40, 0.025, 1.02), "Y", 14)
    if number:
        with s.at(0, 0.026, 1.60):
            write(s, number, 0.10, 0, 0, "white" if colour not in ("white", "cream", "yellow") else "black", lift=0.003)
    return s.built()


def plate(lines: Sequence[str], cap_m: float, colour: str, ink: str, *, border: bool = True, pad: float = 0.6) -> Built:
    """Build a flat sign with centred lines for a wall or pane, such as a name plate or a card.

    It is centred on the origin and faces +y.
    """
    s = Solid(f"{lines[0]} sign")
    width = max(extent(line, cap_m) for line in lines) + cap_m * 2 * pad
    height = cap_m * (1.55 * len(lines) - 0.55 + 2 * pad)
    corner = min(0.02, height * 0.1)
    s.prism(rounded_rectangle(width, height, corner), (-0.012, 0.0), paint(colour, dirt=0.10, roughness=0.35), "XZ")
    if border:
        edge = cap_m * 0.10
        for z in (-height / 2 + edge * 2, height / 2 - edge * 2):
            s.box((width - edge * 4, 0.003, edge), (0, 0.0, z), paint(ink, dirt=0.1), 0.0)
        for x in (-width / 2 + edge * 2, width / 2 - edge * 2):
            s.box((edge, 0.003, height - edge * 4), (x, 0.0, 0), paint(ink, dirt=0.1), 0.0)
    for k, line in enumerate(lines):
        write(s, line, cap_m, 0, cap_m * 1.55 * ((len(lines) - 1) / 2 - k), ink, lift=0.003)
    return s.built()
