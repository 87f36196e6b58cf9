"""A small-town railway station of dressed stone: a gabled central block with three arches, and two wings with iron canopies."""

from __future__ import annotations

import random

import bpy

from scope_studio.kit.buildings.townhouses import SLATE
from scope_studio.kit.buildings.wall_materials import ashlar, cladding_material, tile_material
from scope_studio.kit.core.finishes import glass, paint, steel, timber
from scope_studio.kit.core.shading import Shader, plain
from scope_studio.kit.core.shapes import arc, block
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built

CENTRAL_BLOCK_WIDTH_M = 14.4
"""Width in metres of the gabled central block, which projects from the wings by ``PROJECTION_M``."""
PROJECTION_M = 1.6
"""Distance in metres by which the central block projects from the wings."""
WING_WIDTH_M = 16.0
"""Width in metres of each wing."""
WING_EAVES_M = 6.6
"""Height in metres of the eaves of the wings."""
CENTRAL_BLOCK_EAVES_M = 9.2
"""Height in metres of the eaves of the central block."""
GABLE_TOP_M = 14.4
"""Height in metres of the top of the gable."""
CLOCK_Z_M = 11.3
"""Height in metres of the clock's centre."""
DOOR_X = (-4.3, 0.0, 4.3)
"""x coordinates of the three arches in the central block."""
ARCH_HALF_WIDTH_M = 1.35
"""Half width in metres of an arch."""
ARCH_SPRING_Z_M = 2.9
"""Height in metres at which the arches begin to curve."""


def arch_panel(
    s: Solid,
    width: float,
    z0: float,
    z1: float,
    half: float,
    spring: float,
    material: bpy.types.Material,
    *,
    depth: float = 0.45,
    rise: float | None = None,
) -> None:
    """Add a wall panel with an arched opening, centred on x = 0, from ``z0`` to ``z1``. Its front face is at y = 0.

    The opening is twice ``half`` wide. It starts at ``z0``, and its arch springs at the height ``spring``. ``rise`` is the height
    of the arch itself; None means a semicircle.
    """
    lift = (half if rise is None else rise) / half
    curve = [(u, spring + (v - spring) * lift) for u, v in arc((0.0, spring), half, 0, 180, 16)]
    w = width / 2
    s.prism([(half, z0), *curve, (-half, z0), (-w, z0), (-w, z1), (w, z1), (w, z0)], (-depth, 0.0), material, "XZ")


def arch_trim(
    s: Solid, half: float, spring: float, material: bpy.types.Material, *, projection: float = 0.07, band: float = 0.28
) -> None:
    """Add the voussoirs (wedge-shaped stones) of an arch, with a keystone. ``half`` and ``spring`` are as in ``arch_panel``."""
    outer, inner = arc((0, spring), half + band, 0, 180, 14), arc((0, spring), half - 0.01, 0, 180, 14)
    for k in range(14):
        gap = 0.006
        quad = [inner[k], outer[k], outer[k + 1], inner[k + 1]]
        mid = (sum(u for u, _ in quad) / 4, sum(v for _, v in quad) / 4)
        s.prism([(mid[0] + (u - mid[0]) * (1 - gap * 4), mid[1] + (v - mid[1]) * (1 - gap * 4)) for u, v in quad],
                (-0.1, projection), material, "XZ")  # fmt: skip
    s.prism([(-0.14, spring + half - 0.06), (0.14, spring + half - 0.06), (0.20, spring + half + band + 0.12),
             (-0.20, spring + half + band + 0.12)], (-0.1, projection + 0.06), material, "XZ")  # fmt: skip


def station_house(name: str) -> Built:
    """Build the station without its doors, clock and departures board.

    It is 46 m wide and faces +y; the front of the central block is the plane y = 0.
    """
    s = Solid("station building")
    stone = ashlar("station stone", (0.46, 0.375, 0.255))
    pale = ashlar("station dressings", (0.56, 0.50, 0.39), (1.2, 0.6))
    slate = tile_material("station slate", SLATE)
    _central_block(s, stone, pale, slate, name)
    for side in (-1, 1):
        _wing(s, side, stone, pale, slate)
    _train_shed(s)
    return s.built()


def _central_block(s: Solid, stone: bpy.types.Material, pale: bpy.types.Material, slate: bpy.types.Material, name: str) -> None:
    half = CENTRAL_BLOCK_WIDTH_M / 2
    for x in DOOR_X:
        with s.at(x):
            arch_panel(s, 4.3, 0.0, 5.6, ARCH_HALF_WIDTH_M, ARCH_SPRING_Z_M, stone, depth=0.6)
            arch_trim(s, ARCH_HALF_WIDTH_M, ARCH_SPRING_Z_M, pale)
    for side in (-1, 1):
        s.box((0.78, 0.62, 5.6), (side * (half - 0.37), -0.30, 2.8), stone, 0.02)
    for x in (-half + 0.2, -2.15, 2.15, half - 0.2):
        s.box((0.62, 0.24, 5.2), (x, 0.08, 2.6), pale, 0.03)
        s.box((0.80, 0.36, 0.55), (x, 0.10, 0.28), pale, 0.03)
        s.box((0.80, 0.34, 0.22), (x, 0.10, 5.15), pale, 0.03)
    s.box((CENTRAL_BLOCK_WIDTH_M + 0.1, 0.70, 1.5), (0, -0.32, 6.35), pale, 0.02)
    s.box((CENTRAL_BLOCK_WIDTH_M + 0.5, 1.0, 0.22), (0, -0.28, 5.62), pale, 0.04)
    s.box((CENTRAL_BLOCK_WIDTH_M + 0.7, 1.2, 0.26), (0, -0.24, 7.16), pale, 0.05)
    s.text(name, 0.78, (0, 0.036, 6.38), paint("navy", dirt=0.10, roughness=0.4))
    peak = [(-half, 7.0), (half, 7.0), (half, CENTRAL_BLOCK_EAVES_M), (0.0, GABLE_TOP_M), (-half, CENTRAL_BLOCK_EAVES_M)]
    s.prism(peak, (-13.0, 0.0), stone, "XZ")
    for side in (-1, 1):
        with s.at(side * 4.4, 0.0, 7.9):
            _round_headed_window(s, 0.62, 1.05, pale)
    for side in (-1, 1):
        run, rise = half + 0.5, (GABLE_TOP_M - CENTRAL_BLOCK_EAVES_M) / half * (half + 0.5)
        slope = [
            (0.0, GABLE_TOP_M + 0.30),
            (side * run, GABLE_TOP_M - rise + 0.30),
            (side * run, GABLE_TOP_M - rise + 0.08),
            (0.0, GABLE_TOP_M + 0.08),
        ]
        s.prism(slope, (-13.4, 0.25), slate, "XZ")
        cope = [
            (0.0, GABLE_TOP_M + 0.62),
            (side * (run + 0.1), GABLE_TOP_M - rise + 0.52),
            (side * (run + 0.1), GABLE_TOP_M - rise + 0.05),
            (0.0, GABLE_TOP_M + 0.1),
        ]
        s.prism(cope, (-0.30, 0.32), pale, "XZ")
        s.box((0.9, 0.75, 1.5), (side * (half + 0.15), 0.0, CENTRAL_BLOCK_EAVES_M + 0.1), pale, 0.04)
    s.lathe([(0.30, 0.0), (0.34, 0.2), (0.12, 0.35), (0.22, 0.75), (0.05, 1.1)], pale, (0, 0.0, GABLE_TOP_M + 0.5), steps=20)
    s.lathe([(1.38, -0.05), (1.44, 0.05), (1.30, 0.09), (1.10, 0.06)], pale, (0, 0.03, CLOCK_Z_M), "Y", 48)
    hall = plain("station hall", (0.20, 0.17, 0.13), 0.9)
    block(s, (CENTRAL_BLOCK_WIDTH_M, 0.1, 5.6), (0, -6.0, 2.8), hall)
    block(s, (CENTRAL_BLOCK_WIDTH_M, 6.0, 0.1), (0, -3.0, 5.58), hall)
    block(s, (CENTRAL_BLOCK_WIDTH_M, 6.0, 0.04), (0, -3.3, 0.02), plain("hall floor", (0.30, 0.27, 0.22), 0.3))
    for x in (-4.3, 4.3):  # the side arches have glass above closed doors
        block(
            s,
            (2 * ARCH_HALF_WIDTH_M, 0.04, ARCH_SPRING_Z_M + ARCH_HALF_WIDTH_M),
            (x, -0.42, (ARCH_SPRING_Z_M + ARCH_HALF_WIDTH_M) / 2),
            glass(),
        )
    block(
        s,
        (2 * ARCH_HALF_WIDTH_M, 0.04, ARCH_HALF_WIDTH_M + 0.2),
        (0, -0.42, ARCH_SPRING_Z_M + ARCH_HALF_WIDTH_M / 2 - 0.1),
        glass(),
    )
    wood = paint("dark green", dirt=0.15, roughness=0.4)
    for x in DOOR_X:
        s.box((2 * ARCH_HALF_WIDTH_M, 0.14, 0.14), (x, -0.38, ARCH_SPRING_Z_M - 0.25), wood, 0.02)
        for a in (-45, -15, 15, 45):
            with s.at(x, -0.37, ARCH_SPRING_Z_M - 0.2, roll=a):
                s.box((0.05, 0.06, ARCH_HALF_WIDTH_M + 0.2), (0, 0, (ARCH_HALF_WIDTH_M + 0.2) / 2), wood, 0.006)


def _round_headed_window(s: Solid, half: float, height: float, pale: bpy.types.Material) -> None:
    """Add a narrow window with an arched head, in relief on a wall, with a stone surround and glazing bars."""
    s.box((2 * half + 0.5, 0.12, 0.12), (0, 0.04, -0.06), pale, 0.02)
    outline = [(half, 0.0), *arc((0, height), half, 0, 180, 12), (-half, 0.0)]
    surround = [(half + 0.16, 0.0), *arc((0, height), half + 0.16, 0, 180, 12), (-half - 0.16, 0.0)]
    s.prism(surround, (-0.05, 0.05), pale, "XZ")
    s.prism(outline, (0.045, 0.06), glass(), "XZ")
    white = paint("cream", dirt=0.15)
    block(s, (0.05, 0.03, height + half), (0, 0.065, (height + half) / 2), white)
    block(s, (2 * half, 0.03, 0.05), (0, 0.065, height * 0.5), white)
    block(s, (2 * half, 0.03, 0.05), (0, 0.065, height), white)


def _wing(s: Solid, side: int, stone: bpy.types.Material, pale: bpy.types.Material, slate: bpy.types.Material) -> None:
    rng = random.Random(f"wing {side}")
    x0 = side * (CENTRAL_BLOCK_WIDTH_M / 2 + WING_WIDTH_M / 2)
    front = -PROJECTION_M
    with s.at(x0, front):
        block(s, (WING_WIDTH_M, 0.4, WING_EAVES_M), (0, -0.55, WING_EAVES_M / 2), stone)
        for k in range(5):
            x = -WING_WIDTH_M / 2 + WING_WIDTH_M * (k + 0.5) / 5
            with s.at(x):
                arch_panel(s, WING_WIDTH_M / 5, 0.9, WING_EAVES_M, 0.75, 2.9, stone, depth=0.3)
                arch_trim(s, 0.75, 2.9, pale, band=0.22)
                s.box((WING_WIDTH_M / 5, 0.34, 0.9), (0, -0.14, 0.45), pale, 0.01)
                s.box((1.8, 0.3, 0.12), (0, 0.02, 0.92), pale, 0.02)
                block(s, (1.5, 0.03, 2.75), (0, -0.26, 2.27), glass())
                wood = paint("cream", dirt=0.15)
                block(s, (0.06, 0.05, 2.75), (0, -0.235, 2.27), wood)
                for z in (1.6, 2.3, 2.95):
                    block(s, (1.5, 0.05, 0.05), (0, -0.235, z), wood)
                if rng.random() < 0.5:
                    block(s, (1.4, 0.006, 0.8), (0, -0.24, 3.2), plain("window curtain", (0.52, 0.49, 0.43), 0.9))
        for k in range(6):
            s.box((0.42, 0.14, 5.4), (-WING_WIDTH_M / 2 + WING_WIDTH_M * k / 5, 0.02, 2.7), pale, 0.03)
        s.box((WING_WIDTH_M, 0.5, 0.30), (0, 0.05, WING_EAVES_M - 0.9), pale, 0.04)
        s.box((WING_WIDTH_M, 0.8, 0.24), (0, 0.12, WING_EAVES_M), pale, 0.05)
        s.box((WING_WIDTH_M, 0.35, 0.70), (0, -0.05, WING_EAVES_M + 0.4), stone, 0.02)
        s.box((WING_WIDTH_M, 0.45, 0.12), (0, -0.05, WING_EAVES_M + 0.8), pale, 0.03)
        roof = [(-0.3, WING_EAVES_M + 0.2), (-5.5, WING_EAVES_M + 3.2), (-10.8, WING_EAVES_M + 0.2)]
        s.prism(roof, (-WING_WIDTH_M / 2, WING_WIDTH_M / 2), slate, "YZ")
        block(s, (WING_WIDTH_M, 0.3, WING_EAVES_M), (0, -10.8, WING_EAVES_M / 2), stone)
        block(s, (0.3, 10.4, WING_EAVES_M), (side * (WING_WIDTH_M / 2 - 0.15), -5.6, WING_EAVES_M / 2), stone)
        for k in (-1, 1):
            s.box((0.9, 1.3, 3.4), (k * 4.5, -5.5, WING_EAVES_M + 2.9), stone, 0.02)
            s.box((1.1, 1.5, 0.2), (k * 4.5, -5.5, WING_EAVES_M + 4.6), pale, 0.02)
            for dy in (-0.4, 0.0, 0.4):
                s.lathe([(0.15, 0.0), (0.12, 0.5), (0.15, 0.55)], plain("chimney pot", (0.30, 0.13, 0.07), 0.8),
                        (k * 4.5, -5.5 + dy, WING_EAVES_M + 4.65), steps=12)  # fmt: skip
        _canopy(s)


def _canopy(s: Solid) -> None:
    """Add a lean-to of ribbed metal on iron columns with brackets, with a pierced timber valance along its edge."""
    iron, valance = paint("dark green", dirt=0.2, roughness=0.35), paint("cream", dirt=0.2, roughness=0.5)
    reach, high, low, w = 3.6, 4.75, 4.15, WING_WIDTH_M - 0.6
    sheet_roof = cladding_material("canopy sheet", (0.30, 0.33, 0.34), 0.30)
    s.prism([(0.1, high), (0.1, high + 0.06), (reach, low + 0.06), (reach, low)], (-w / 2, w / 2), sheet_roof, "YZ")
    s.box((w, 0.14, 0.20), (0, reach - 0.05, low - 0.05), iron, 0.02)
    for k in range(int(w / 0.2)):
        x = -w / 2 + 0.1 + 0.2 * k
        s.prism([(x - 0.09, low - 0.12), (x + 0.09, low - 0.12), (x + 0.09, low - 0.38), (x, low - 0.48), (x - 0.09, low - 0.38)],
                (reach + 0.02, reach + 0.045), valance, "XZ")  # fmt: skip
    for k in range(5):
        x = -w / 2 + 0.5 + (w - 1.0) * k / 4
        s.lathe([(0.17, 0.0), (0.17, 0.30), (0.10, 0.38), (0.085, 2.9), (0.14, 3.0), (0.14, 3.1), (0.09, 3.15), (0.09, low - 0.1)],
                iron, (x, reach - 0.25, 0), steps=16)  # fmt: skip
        for sign in (-1, 1):
            bend = [
                (x + sign * 0.08, reach - 0.25, 3.2),
                (x + sign * 0.35, reach - 0.25, 3.75),
                (x + sign * 1.0, reach - 0.25, low - 0.1),
            ]
            s.tube(bend, 0.035, iron, sides=6)
        s.rod((x, 0.1, high - 0.1), (x, reach - 0.1, low - 0.05), 0.05, iron, sides=6)


def _train_shed(s: Solid) -> None:
    """Add the arched roof over the platforms behind the building, with its glazed lantern."""
    finish = cladding_material("train shed", (0.20, 0.225, 0.235), 0.45)
    hoop = [(-28.0 + 14.0 * u, 5.0 + 8.6 * v) for u, v in arc((0, 0), 1.0, 0, 180, 18)]
    s.prism([(-14.0, 0.0), *hoop, (-42.0, 0.0)], (-34.0, 34.0), finish, "YZ")
    s.box((60.0, 4.0, 0.9), (0, -28.0, 13.9), paint("dark grey", dirt=0.3), 0.05)
    s.box((60.0, 4.6, 0.16), (0, -28.0, 14.4), steel(dark=True), 0.02)


def double_door(colour: str = "dark green", *, is_open: bool = True) -> Built:
    """Build a pair of part-glazed doors for an opening 2.7 m wide and 2.6 m high. ``is_open`` folds them inwards (-y)."""
    s = Solid("station door")
    wood = paint(colour, dirt=0.15, roughness=0.35)
    for sign in (-1, 1):
        with s.at(sign * 1.33, 0, 0, turn=sign * (84.0 if is_open else 0.0)):
            c = -sign * 0.66
            s.box((1.30, 0.06, 1.0), (c, 0, 0.50), wood, 0.01)
            s.box((1.30, 0.06, 0.14), (c, 0, 2.50), wood, 0.01)
            for x in (-sign * 0.07, -sign * 1.25):
                s.box((0.13, 0.06, 2.58), (x, 0, 1.29), wood, 0.01)
            block(s, (1.1, 0.02, 1.5), (c, 0, 1.72), glass())
            s.box((0.04, 0.05, 1.5), (c, 0.0, 1.72), wood, 0.006)
            for y in (-0.06, 0.06):
                s.rod((-sign * 1.16, y, 0.9), (-sign * 1.16, y, 1.5), 0.018, paint("yellow", roughness=0.25))
    return s.built()


def departures_board(
    rows: list[tuple[str, str, str]], *, width: float = 3.3, cap: float = 0.125, title: str = "DEPARTURES"
) -> Built:
    """Build a wall-mounted board with rows of (time, destination, platform) in amber on black.

    It is centred on the origin, and its back is at y = 0.
    """
    s = Solid("departures board")
    pitch = cap * 1.9
    height = pitch * (len(rows) + 2.3)
    s.box((width, 0.16, height), (0, 0.08, 0), paint("dark grey", dirt=0.1), 0.02)
    s.box((width - 0.1, 0.02, height - 0.1), (0, 0.158, 0), plain("board black", (0.006, 0.006, 0.007), 0.25), 0.0)
    s.box((width + 0.16, 0.34, 0.06), (0, 0.14, height / 2 + 0.03), paint("dark grey", dirt=0.2), 0.01)
    amber = _amber()
    white = plain("board white", (0.85, 0.85, 0.82), 0.4)
    y, top = 0.172, height / 2 - pitch * 0.85
    s.box((width - 0.1, 0.012, pitch * 1.25), (0, 0.164, top), paint("blue", dirt=0.0), 0.0)
    s.text(title, cap * 1.1, (width / 2 - 0.16, y + 0.003, top), white, align="LEFT")
    s.text("Platform", cap * 0.8, (-width / 2 + 0.16, y + 0.003, top), white, align="RIGHT")
    for k, (time, place, platform) in enumerate(rows):
        z = top - pitch * (k + 1.25)
        s.text(time, cap, (width / 2 - 0.16, y, z), amber, align="LEFT")
        s.text(place, cap, (width / 2 - 0.16 - cap * 5.6, y, z), amber, align="LEFT")
        s.text(platform, cap, (-width / 2 + 0.2, y, z), amber, align="RIGHT")
    return s.built()


def _amber() -> bpy.types.Material:
    existing = bpy.data.materials.get("board amber")
    return existing or Shader("board amber").surface(
        base_color=(1.0, 0.48, 0.03), emission_color=(1.0, 0.45, 0.02), emission_strength=1.1
    )


def luggage_trolley() -> Built:
    """Build a flat porter's trolley, 1.5 m long, with a timber deck and a curved handle."""
    s = Solid("luggage trolley")
    iron = paint("dark green", dirt=0.25)
    s.box((0.72, 1.3, 0.05), (0, 0, 0.42), timber(), 0.01)
    for x in (-0.34, 0.34):
        s.box((0.05, 1.34, 0.07), (x, 0, 0.37), iron, 0.008)
        for y in (-0.48, 0.48):
            s.lathe([(0.14, -0.03), (0.16, -0.02), (0.16, 0.02), (0.14, 0.03)], paint("black"), (x, y, 0.16), "X", 20)
            s.rod((x, y, 0.16), (x, y, 0.36), 0.02, iron)
    s.tube([(-0.32, -0.64, 0.42), (-0.32, -0.72, 0.98), (0.32, -0.72, 0.98), (0.32, -0.64, 0.42)], 0.018, iron)
    return s.built()
