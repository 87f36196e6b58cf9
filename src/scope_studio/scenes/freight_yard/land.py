"""Freight yard: the road outside, trees, neighbouring buildings, and the town between the yard and the hills."""

from __future__ import annotations

import math
import random

from scope_studio.kit.buildings import skyline
from scope_studio.kit.core.stage import Built, Stage
from scope_studio.kit.furniture import roadside
from scope_studio.kit.ground import highway, terrain
from scope_studio.kit.light import dusk
from scope_studio.kit.nature import vegetation
from scope_studio.kit.vehicles import cars
from scope_studio.kit.yard import floor as yard_floor

ROAD = highway.Carriageway(edge_m=-1.0, straight_m=900.0)
"""A carriageway that is not built. It only defines the terrain: a level strip with hills on both sides."""
STREET_Y = -58.0
"""y coordinate of the centre line of the road outside."""


def build(stage: Stage) -> None:
    """Place the surroundings of the yard."""
    height = terrain.hills(ROAD)
    stage.put(terrain.terrain(ROAD, []), (0, 0, -0.02))
    _street(stage)
    _neighbours(stage)
    _trees(stage)
    _background(stage, height)


def _street(stage: Stage) -> None:
    stage.put(
        yard_floor.floor(
            "street", (-400, 400, STREET_Y - 4.0, STREET_Y + 4.0), yard_floor.asphalt("street asphalt", tone=1.1), -0.01
        ),
        (0, 0, 0),
    )
    for y0, y1 in ((STREET_Y + 4.0, STREET_Y + 6.2), (STREET_Y - 6.2, STREET_Y - 4.0)):
        stage.put(yard_floor.floor("footway", (-400, 400, y0, y1), yard_floor.slabs("footway slabs", joint_m=1.2), 0.02), (0, 0, 0))
    for k, x in enumerate((-66.0, -38.0, -8.0, 20.0, 48.0, 76.0)):
        lit = k != 1
        post = roadside.lamp_post(8.0, lit=lit)
        stage.place(
            post,
            "lamp post",
            "street lamp" if lit else "unlit street lamp",
            (x, STREET_Y - 4.6, 0),
            0,
            state="lit" if lit else "unlit",
            light="orange",
            height_m=8.0,
        )
        if lit:
            dusk.lamplight((x, STREET_Y - 3.0, 7.8), 300, dusk.SODIUM, size_m=0.45)
    for make, colour, noun, plate, x, y, bearing in (
        (cars.saloon, "dark blue", "saloon", "NB17 COL", 22.0, -60.9, 270),
        (cars.hatchback, "silver", "hatchback", "VE65 GRO", 29.0, -60.9, 270),
        (cars.suv, "black", "SUV", "LM22 OWL", -24.0, -60.9, 270),
        (cars.hatchback, "red", "hatchback", "RT13 KIN", -52.0, -55.1, 90),
    ):
        stage.place(
            make(colour, plate=plate),
            "car",
            f"{colour} {noun}",
            (x, y, -0.01),
            bearing,
            colour=colour,
            kind=noun.lower(),
            plate=plate,
            state="parked",
            area="street",
            facing="west" if bearing == 270 else "east",
        )
    s = yard_floor.Solid("street lines")
    for x in range(-200, 200, 6):
        yard_floor.line(s, (x, STREET_Y), (x + 2.5, STREET_Y), 0.10, yard_floor.paint("white"))
    stage.put(s.built(), (0, 0, 0.0))


def _neighbours(stage: Stage) -> None:
    sheds = [
        (
            {"width": 44, "depth": 26, "height": 8.5, "colour": (0.10, 0.20, 0.26), "lettering": "HALDEN COLD STORE", "seed": 1},
            74.0,
            -6.0,
            -90,
            "blue",
        ),
        (
            {"width": 36, "depth": 22, "height": 7.0, "colour": (0.26, 0.10, 0.08), "lettering": "BRIGHTWELL TYRES", "seed": 2},
            72.0,
            44.0,
            -90,
            "red",
        ),
        (
            {"width": 40, "depth": 24, "height": 8.0, "colour": (0.13, 0.20, 0.14), "lettering": "ARKWRIGHT TIMBER", "seed": 3},
            -82.0,
            6.0,
            90,
            "green",
        ),
        (
            {
                "width": 30,
                "depth": 20,
                "height": 6.5,
                "colour": (0.30, 0.29, 0.26),
                "lettering": "ASHDOWN GLASS",
                "seed": 4,
                "doors": 3,
            },
            -78.0,
            -36.0,
            90,
            "beige",
        ),
        (
            {"width": 46, "depth": 24, "height": 8.0, "colour": (0.22, 0.24, 0.27), "lettering": "CALDER PRINT WORKS", "seed": 5},
            -34.0,
            -86.0,
            0,
            "grey",
        ),
        (
            {
                "width": 38,
                "depth": 22,
                "height": 7.0,
                "colour": (0.30, 0.23, 0.10),
                "lettering": "NORTHGALE FOODS",
                "seed": 6,
                "doors": 3,
            },
            26.0,
            -86.0,
            0,
            "brown",
        ),
        ({"width": 50, "depth": 26, "height": 9.0, "colour": (0.20, 0.22, 0.25), "seed": 7}, -20.0, 98.0, 180, "grey"),
        ({"width": 36, "depth": 24, "height": 8.0, "colour": (0.12, 0.16, 0.24), "seed": 8}, 36.0, 96.0, 180, "blue"),
    ]
    for spec, x, y, bearing, colour in sheds:
        built = skyline.industrial(**spec)
        stage.place(
            built,
            "building",
            f"{colour} industrial shed",
            (x, y, 0),
            bearing,
            colour=colour,
            kind="shed",
            reads=spec.get("lettering", "").lower() or "nothing",
        )
    stage.place(
        skyline.silos(3, lettering="CALDER"), "silo", "row of steel silos", (-64.0, 92.0, 0), 150, material="steel", count=3
    )
    stage.place(skyline.chimney(), "chimney", "tall chimney with red lights", (64.0, 118.0, 0), 0, material="concrete", state="lit")


def _trees(stage: Stage) -> None:
    rng = random.Random("yard trees")
    prototypes: dict[tuple[str, int], Built] = {}
    species = {
        "lime": vegetation.LIME,
        "birch": vegetation.BIRCH,
        "oak": vegetation.OAK,
        "poplar": vegetation.POPLAR,
        "pine": vegetation.PINE,
    }
    rows = [
        ("lime", 0, -14.0, -49.5),
        ("birch", 0, -24.0, -50.0),
        ("lime", 1, -36.0, -49.5),
        ("birch", 1, -48.0, -50.0),
        ("lime", 0, 20.0, -49.5),
        ("birch", 0, 31.0, -50.0),
        ("lime", 1, 43.0, -49.5),
        ("poplar", 0, 55.0, -30.0),
        ("poplar", 0, 55.5, -24.0),
        ("oak", 0, 57.0, 24.0),
        ("pine", 0, 55.0, 31.0),
        ("poplar", 0, -63.0, -14.0),
        ("birch", 0, -62.0, 24.0),
        ("oak", 0, -64.0, 34.0),
        ("pine", 0, -60.5, 40.0),
        ("oak", 0, -70.0, -60.0),
        ("oak", 0, 64.0, -60.0),
    ]
    for name, seed, x, y in rows:
        key = (name, seed)
        detail = 0.55 if abs(x) < 50 else 0.35
        built = (
            prototypes[key].copy()
            if key in prototypes
            else prototypes.setdefault(key, vegetation.tree(species[name], seed, detail=detail))
        )
        stage.place(
            built,
            "tree",
            f"{name} tree",
            (x, y, 0),
            rng.uniform(0, 360),
            scale=rng.uniform(0.72, 0.95),
            species=name,
            colour="green",
        )


def _background(stage: Stage, height) -> None:
    """Place lines of trees, blocks of flats, and lights that become sparser towards the hills. They are not annotated."""
    rng = random.Random("far town")
    trees = [
        vegetation.tree(sp, 7 + k, detail=0.12)
        for k, sp in enumerate((vegetation.OAK, vegetation.LIME, vegetation.POPLAR, vegetation.PINE))
    ]
    hedge = vegetation.hedge(14.0, seed=3, detail=0.3)
    placed: set[int] = set()

    def scatter(prototype: Built, x: float, y: float, bearing: float, scale: float) -> None:
        built = prototype.copy() if id(prototype) in placed else prototype
        placed.add(id(prototype))
        stage.put(built, (x, y, height(x, y) - 0.1), bearing, scale=scale)

    for x in range(-180, 190, 14):
        scatter(hedge, x, -67.0, 0, rng.uniform(0.95, 1.1))
    for y in range(-40, 60, 14):
        for x in (-60.8, 53.0):
            scatter(hedge, x, y, 90, rng.uniform(0.9, 1.1))
    for _ in range(300):
        bearing, r = rng.uniform(0, 2 * math.pi), rng.uniform(118, 520)
        x, y = r * math.sin(bearing), r * math.cos(bearing)
        if abs(y - STREET_Y) > 12:
            scatter(trees[rng.choices(range(4), (5, 4, 1, 2))[0]], x, y, rng.uniform(0, 360), rng.uniform(0.7, 1.2))
    blocks = [
        skyline.flats(seed=k, floors=3 + k % 4, width=16 + 4 * (k % 3), colour=c)
        for k, c in enumerate(((0.20, 0.14, 0.11), (0.26, 0.25, 0.23), (0.17, 0.10, 0.08), (0.30, 0.28, 0.24)))
    ]
    sheds = [
        skyline.industrial(width=34 + 6 * k, depth=20, height=7 + k, colour=(0.16 + 0.05 * k, 0.18, 0.20), seed=20 + k)
        for k in range(3)
    ]
    for _ in range(64):
        bearing, r = rng.uniform(0, 2 * math.pi), rng.uniform(150, 460)
        x, y = r * math.sin(bearing), r * math.cos(bearing)
        if abs(y - STREET_Y) > 24:
            scatter(rng.choice([*blocks, *sheds]), x, y, math.degrees(bearing) + 180 + rng.uniform(-30, 30), rng.uniform(0.9, 1.1))
    lights = []
    for _ in range(520):
        bearing, r = rng.uniform(0, 2 * math.pi), 170 + 1900 * rng.random() ** 1.4
        x, y = r * math.sin(bearing), r * math.cos(bearing)
        lights.append((x, y, height(x, y) + rng.uniform(3.0, 9.0)))
    stage.put(skyline.distant_lights(lights), (0, 0, 0))
