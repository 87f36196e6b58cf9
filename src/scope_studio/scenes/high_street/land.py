"""High street: roads, footways, markings, houses that hide the horizon in every direction, and trees behind the houses."""

from __future__ import annotations

import math
import random

from scope_studio.kit.buildings import shopfronts
from scope_studio.kit.buildings.terraces import DEPTH_M, TerracedBuilding, terraced_building
from scope_studio.kit.buildings.wet_masonry import roofing, trim, wall
from scope_studio.kit.core.finishes import paint
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built, Stage
from scope_studio.kit.furniture import traditional
from scope_studio.kit.furniture.clocks import dial
from scope_studio.kit.ground import wet_street
from scope_studio.kit.ground.markings import Stencil
from scope_studio.kit.nature import vegetation
from scope_studio.scenes.high_street.plan import (
    CROSS_STREET_KERBS,
    EAST_FRONT,
    EAST_KERB,
    FAR_FRONT,
    ROW_END,
    WEST_FRONT,
    WEST_KERB,
    ZEBRA,
    Plot,
)

END_X = 84.0
"""Distance in metres between x = 0 and the houses at both ends of each cross street."""


def build(stage: Stage) -> None:
    """Place the ground, houses and trees."""
    stage.put(wet_street.carriageway(260.0, _gutters()), (0, 0, 0))
    for colour, bars in _painted_rectangles().items():
        stage.put(wet_street.markings(bars, colour), (0, 0, 0))
    for outline in _blocks():
        stage.put(wet_street.footway(outline), (0, 0, 0))
    _zigzags(stage)
    _cross_streets(stage)
    _town_hall(stage)
    _gables(stage)
    _background(stage)


def _painted_rectangles() -> dict[str, list[Stencil]]:
    """Return the painted rectangles on the roads, by colour."""
    near, far = CROSS_STREET_KERBS
    white: list[Stencil] = []
    y = -46.0
    while y < 46:
        if not ZEBRA[0] - 8 < y < ZEBRA[1] + 6:
            white.append(Stencil(-0.05, 0.05, y, y + 2.0))
        y += 4.6
    x = WEST_KERB + 0.35
    while x < EAST_KERB - 0.4:
        white.append(Stencil(x, x + 0.55, *ZEBRA))
        x += 1.10
    for y0, y1 in ((-41.5, 3.0), (24.0, 44.0)):
        white += [Stencil(EAST_KERB - 2.15, EAST_KERB - 2.07, y, y + 0.9) for y in _positions(y0, y1, 1.8)]
        white += [Stencil(EAST_KERB - 2.15, EAST_KERB, y, y + 0.08) for y in _positions(y0, y1 + 5.0, 6.2)]
    white.append(Stencil(0.1, EAST_KERB, -ROW_END + 0.2, -ROW_END + 0.5))
    white += [Stencil(x, x + 0.6, near - 0.3, near - 0.1) for x in _positions(WEST_KERB, 0.0, 0.9)]
    for y in (sum(CROSS_STREET_KERBS) / 2, -sum(CROSS_STREET_KERBS) / 2):
        white += [Stencil(x, x + 2.0, y - 0.05, y + 0.05) for x in _positions(-80.0, 80.0, 5.0)]
    yellow = []
    for offset in (0.25, 0.45):
        yellow += [
            Stencil(WEST_KERB + offset - 0.04, WEST_KERB + offset + 0.04, -47.0, ZEBRA[0] - 8.2),
            Stencil(WEST_KERB + offset - 0.04, WEST_KERB + offset + 0.04, ZEBRA[1] + 8.2, 47.0),
            Stencil(-80.0, -8.0, far - offset - 0.04, far - offset + 0.04),
            Stencil(10.0, 80.0, far - offset - 0.04, far - offset + 0.04),
            Stencil(-80.0, 80.0, -far + offset - 0.04, -far + offset + 0.04),
        ]
    return {"white": white, "yellow": yellow}


def _positions(start: float, stop: float, step: float) -> list[float]:
    """Return evenly spaced positions from ``start`` to ``stop``, without ``stop``."""
    return [start + step * k for k in range(max(0, int((stop - start) / step)))]


def _gutters() -> tuple[Stencil, ...]:
    """Return the strips along which puddles are larger."""
    near, far = CROSS_STREET_KERBS
    return (
        Stencil(WEST_KERB - 0.2, WEST_KERB + 1.1, -50, 50),
        Stencil(EAST_KERB - 0.9, EAST_KERB + 0.2, -50, 50),
        Stencil(-80, 80, far - 0.9, far + 0.3),
        Stencil(-80, 80, -far - 0.3, -far + 0.9),
        Stencil(-80, 80, near - 0.3, near + 0.7),
        Stencil(-1.6, 1.2, -34, -20),
    )


def _blocks() -> list[list[tuple[float, float]]]:
    """Return the outlines of the footways between the roads."""
    near, far = CROSS_STREET_KERBS
    radius, out = 3.2, 130.0
    west = [
        (-out, -near),
        *_rounded_corner(WEST_KERB, -near, radius, 270),
        *_rounded_corner(WEST_KERB, near, radius, 0),
        (-out, near),
    ]
    east = [
        (out, near),
        *_rounded_corner(EAST_KERB, near, radius, 90),
        *_rounded_corner(EAST_KERB, -near, radius, 180),
        (out, -near),
    ]
    north = [(-out, far), (out, far), (out, far + 60), (-out, far + 60)]
    return [west, east, north, [(-x, -y) for x, y in north]]


def _rounded_corner(x: float, y: float, radius: float, start_deg: float) -> list[tuple[float, float]]:
    """Return an anticlockwise quarter circle, from ``start_deg``, that rounds the corner (x, y) of a convex outline."""
    cx = x - radius if start_deg in (270, 0) else x + radius
    cy = y + radius if start_deg in (270, 180) else y - radius
    angles = [math.radians(start_deg + 90 * k / 8) for k in range(9)]
    return [(cx + radius * math.cos(a), cy + radius * math.sin(a)) for a in angles]


def _zigzags(stage: Stage) -> None:
    """Place the white zigzag lines of the zebra crossing at both kerbs, and the words BUS STOP on the road."""
    s = Solid("zigzags")
    white = wet_street.road_paint("white")
    for x in (WEST_KERB + 0.62, 0.0, EAST_KERB - 0.55):
        for y0, sign in ((ZEBRA[0] - 0.6, -1), (ZEBRA[1] + 0.6, 1)):
            for k in range(4):
                a, b = y0 + sign * 2.0 * k, y0 + sign * 2.0 * (k + 1)
                side = 0.16 if k % 2 else -0.16
                s.add(
                    [
                        (x - side - 0.05, a, 0.004),
                        (x - side + 0.05, a, 0.004),
                        (x + side + 0.05, b, 0.004),
                        (x + side - 0.05, b, 0.004),
                    ],
                    [(0, 1, 2, 3) if sign > 0 else (3, 2, 1, 0)],
                    white,
                )
    stage.put(s.built(), (0, 0, 0))
    words = Solid("road lettering")
    for k, word in enumerate(("STOP", "BUS")):
        words.text(word, 1.1, (0, 0.8 - 1.6 * k, 0.004), white, facing="+Z")
    stage.place(words.built(), "road marking", "bus stop road marking", (-1.75, -20.5, 0), 0, colour="white", says="bus stop")


HOUSES = (
    TerracedBuilding(6.2, ("brick", "red"), 2, 2, shop=False, seed=31, lit=frozenset({(1, 0)})),
    TerracedBuilding(5.8, ("render", "cream"), 2, 2, "clay", shop=False, seed=32),
    TerracedBuilding(6.6, ("brick", "buff"), 2, 2, shop=False, seed=33, bars=2, lit=frozenset({(0, 0)})),
    TerracedBuilding(6.0, ("render", "white"), 3, 2, shop=False, seed=34, lit=frozenset({(1, 1)})),
    TerracedBuilding(6.4, ("brick", "dark red"), 3, 2, shop=False, seed=35),
    TerracedBuilding(6.0, ("stone", "grey"), 2, 2, shop=False, seed=36, bars=2),
)
DOORS = ("green", "blue", "black", "dark green", "navy", "white")


def _cross_streets(stage: Stage) -> None:
    """Place terraced houses along Church Road and Mill Lane, as linked copies of six prototypes."""
    rows = _HouseRows(stage)
    for sign in (1, -1):
        far_bearing, near_bearing = (180.0, 0.0) if sign > 0 else (0.0, 180.0)
        for side, start in ((-1, WEST_FRONT - DEPTH_M - 0.02), (1, EAST_FRONT + DEPTH_M + 0.02)):
            rows.place_row(start, side, END_X - 6, sign * ROW_END, near_bearing, seed=int(side * 3 + sign))
        gap = 7.0 if sign > 0 else 0.0
        for side in (-1, 1):
            rows.place_row(1.0 + side * gap, side, END_X - 6, sign * FAR_FRONT, far_bearing, seed=int(side * 5 + sign * 7))
        for side in (-1, 1):
            for k in range(3):
                rows.place_house(Plot(side * END_X, sign * (46.0 + 6.2 * k + 2.0), -side * 90.0))


class _HouseRows:
    """Places rows of houses. Each prototype is built once; later houses are linked copies of it."""

    def __init__(self, stage: Stage) -> None:
        self._stage = stage
        self._prototypes: dict[int, Built] = {}
        self._doors: dict[str, Built] = {}
        self._count = 0

    def place_row(self, start: float, side: int, stop: float, y: float, bearing: float, *, seed: int) -> None:
        """Place a row of houses that starts at x = ``start`` and continues in the direction ``side`` until ``stop``."""
        order = random.Random(f"row {seed}")
        x, last = start, -1
        while abs(x) < stop:
            index = order.choice([k for k in range(len(HOUSES)) if k != last])
            last = index
            width = HOUSES[index].width_m
            self.place_house(Plot(x + side * width / 2, y, bearing), index)
            x += side * width

    def place_house(self, plot: Plot, index: int | None = None) -> None:
        """Place a house on a plot. ``index`` selects it from ``HOUSES``; by default, the houses are used in order."""
        index = self._count % len(HOUSES) if index is None else index
        spec = HOUSES[index]
        built = (
            self._prototypes[index].copy()
            if index in self._prototypes
            else self._prototypes.setdefault(index, terraced_building(spec))
        )
        material = {"render": "painted render"}.get(spec.wall[0], spec.wall[0])
        house_id = self._stage.place(
            built, "building", f"{spec.wall[1]} {spec.wall[0]} house", plot.at(0, 0), plot.bearing_deg,
            colour=spec.wall[1], material=material, storeys=spec.storeys, kind="house",
        )  # fmt: skip
        colour = DOORS[self._count % len(DOORS)]
        self._count += 1
        door = (
            self._doors[colour].copy() if colour in self._doors else self._doors.setdefault(colour, shopfronts.house_door(colour))
        )
        pitch = spec.width_m / spec.columns
        self._stage.place(
            door, "door", f"{colour} front door", plot.at(pitch * (spec.columns - 0.5) - spec.width_m / 2, -0.09, 0.10),
            plot.bearing_deg, parent=house_id, colour=colour, state="closed", kind="house door",
        )  # fmt: skip


def _town_hall(stage: Stage) -> None:
    """Place the town hall, with its clock tower, at the northern end of the street."""
    spec = TerracedBuilding(
        14.0, ("stone", "honey"), 3, 5, parapet=True, bars=2, shop=False, seed=41, lit=frozenset({(1, 2), (0, 0)})
    )
    plot = Plot(1.0, FAR_FRONT - 0.3, 180.0)
    hall = stage.place(
        terraced_building(spec),
        "building",
        "town hall",
        plot.at(0, 0),
        180,
        colour="honey",
        material="stone",
        storeys=3,
        kind="town hall",
    )
    s = Solid("clock tower")
    stone, cut = wall("stone", "honey"), trim()
    top = 17.0
    s.box((4.2, 4.2, top - 8.0), (0, -3.0, 8.0 + (top - 8.0) / 2), stone, 0.03)
    for z in (11.2, top):
        s.box((4.7, 4.7, 0.35), (0, -3.0, z), cut, 0.06)
    s.add(
        [(-2.2, -5.2, top + 0.1), (2.2, -5.2, top + 0.1), (2.2, -0.8, top + 0.1), (-2.2, -0.8, top + 0.1), (0, -3.0, top + 5.0)],
        [(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)],
        roofing("slate"),
    )
    s.rod((0, -3.0, top + 4.9), (0, -3.0, top + 7.0), 0.04, cut)
    tower = stage.place(s.built(), "clock tower", "clock tower", plot.at(0, 0), 180, parent=hall, material="stone", colour="honey")
    face = Solid("clock")
    dial(face, 1.15, 4, 10)
    stage.place(face.built(), "clock", "town hall clock", plot.at(0, -0.88, 14.2), 180, parent=tower, shows="4:10", colour="white")
    name = shopfronts.plate(("TOWN HALL",), 0.34, "cream", "black", border=False)
    stage.place(name, "sign", "town hall sign", plot.at(0, 0.03, 3.45), 180, parent=hall, colour="cream")
    door = shopfronts.house_door("blue", number=None)
    stage.place(
        door, "door", "blue door", plot.at(5.6, -0.09, 0.10), 180, parent=hall, colour="blue", state="closed", kind="hall door"
    )


def _gables(stage: Stage) -> None:
    """Place faded painted advertisements on the gable walls at Church Road, and the furniture of the cross streets."""
    for x, lines, ink in (
        (-11.9, ("OAKES HARDWARE", "HOME AND GARDEN", "SINCE 1888"), "cream"),
        (14.1, ("DRINK", "FENWICK TEA", "FULL WEIGHT"), "navy"),
    ):
        s = Solid(f"{lines[-1]} wall sign")
        for k, line in enumerate(lines):
            s.text(line, (0.55, 0.42, 0.34)[k], (0, 0.02, 0.85 - 0.85 * k), paint(ink, dirt=0.6, roughness=0.8))
        name = "painted advertisement on a gable"
        stage.place(
            s.built(), "wall sign", name, (x, ROW_END, wet_street.KERB_M + 6.0), 0, lettering=ink, says=" ".join(lines).lower()
        )
    lamp = traditional.street_lamp(lit=True)
    far = FAR_FRONT - 3.4
    positions = [(side * x, sign * far) for sign in (-1, 1) for side in (-1, 1) for x in (19.0, 45.0)]
    for k, (x, y) in enumerate(positions):
        built = lamp if k == 0 else lamp.copy()
        stage.place(built, "lamp post", "street lamp", (x, y, wet_street.KERB_M), 0, colour="dark green", state="lit")
    tree = vegetation.tree(vegetation.BIRCH, 71, detail=0.55)
    for k, (x, y) in enumerate(((-9.5, -60.6), (13.5, -60.6), (-31.0, 60.6), (29.0, 60.6), (58.0, -60.6))):
        built = tree if k == 0 else tree.copy()
        position = (x, y, wet_street.KERB_M)
        stage.place(built, "tree", "birch tree", position, 70.0 * k, scale=0.62 + 0.05 * (k % 2), colour="green", species="birch")


def _background(stage: Stage) -> None:
    """Place trees behind the houses, hedges at the ends of the streets, and the land beyond them."""
    rng = random.Random("behind")
    species = (vegetation.OAK, vegetation.LIME, vegetation.COPPER, vegetation.BIRCH, vegetation.POPLAR)
    prototypes = [vegetation.tree(sp, 60 + k, detail=0.16) for k, sp in enumerate(species)]
    unused = set(range(len(prototypes)))

    def scatter(x: float, y: float, scale: float) -> None:
        k = rng.choices(range(len(prototypes)), weights=(5, 5, 1, 3, 2))[0]
        built = prototypes[k] if k in unused else prototypes[k].copy()
        unused.discard(k)
        stage.put(built, (x, y, 0.1), rng.uniform(0, 360), scale=scale)

    for _ in range(46):
        side = rng.choice((-1, 1))
        scatter(side * rng.uniform(26, 70) + 1.0, rng.uniform(-36, 36), rng.uniform(0.8, 1.2))
    for sign in (-1, 1):
        for _ in range(26):
            scatter(rng.uniform(-90, 90), sign * rng.uniform(80, 105), rng.uniform(0.9, 1.4))
        for side in (-1, 1):
            for _ in range(16):
                scatter(side * rng.uniform(97, 125), rng.uniform(-80, 80), rng.uniform(0.9, 1.4))
