"""Station square: the surroundings of the square, with side streets, roofs and trees behind the shops, and the church."""

from __future__ import annotations

import math
import random

from scope_studio.kit.buildings import townhouses, wall_materials
from scope_studio.kit.buildings.townhouses import CLAY, SLATE, House
from scope_studio.kit.core.finishes import paint
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built, Stage
from scope_studio.kit.nature import vegetation
from scope_studio.scenes.station_square.town import walls


def build(stage: Stage) -> None:
    """Place the houses along the side streets, the roofs behind the shops, and trees. They are not annotated."""
    materials = walls()
    kinds = [
        House(9.0, materials["red brick"], 3, 3, seed=50),
        House(8.0, materials["cream"], 3, 3, shutters="brown", seed=51, roof=CLAY),
        House(10.0, materials["buff brick"], 3, 4, seed=52, door="blue"),
        House(8.5, materials["white"], 2, 3, shutters="green", seed=53, roof=CLAY, door="red"),
        House(9.5, materials["stone"], 4, 3, seed=54, storey_m=2.9, dormers=2, door="black"),
    ]
    prototypes = [townhouses.town_house(h) for h in kinds]
    placed: set[int] = set()
    rng = random.Random("beyond")

    def row(x: float, y: float, bearing: float, length: float, first: int) -> None:
        """Place a row of houses, ``length`` metres long, that starts at (x, y). Their fronts face ``bearing``."""
        b = math.radians(bearing)
        step, k = 0.0, first
        while step < length:
            index = k % len(kinds)
            width = kinds[index].width
            step += width / 2
            _house(index, x + step * math.cos(b), y - step * math.sin(b), bearing)
            step += width / 2
            k += rng.choice((1, 2, 3))

    def _house(index: int, x: float, y: float, bearing: float) -> None:
        built: Built = prototypes[index].copy() if index in placed else prototypes[index]
        placed.add(index)
        stage.put(built, (x, y, 0.0), bearing)

    row(-45.4, -8.0, 180, 62, 0)  # north side of the street, west of the square
    row(110.0, -8.0, 180, 62, 2)  # north side, east of the square
    row(-110.0, -34.0, 0, 62, 1)  # south side
    row(48.5, -34.0, 0, 62, 3)
    row(-112.0, 4.0, 90, 60, 2)  # houses at the ends of the street
    row(112.0, -58.0, 270, 60, 4)
    row(-47.5, -36.0, 90, 50, 1)  # side streets to the south
    row(-34.0, -85.0, 270, 38, 0)
    row(49.5, -86.0, 270, 50, 2)
    row(35.6, -44.0, 90, 38, 3)
    row(-50.0, -92.0, 0, 110, 4)
    row(-66.0, 16.0, 90, 26, 2)  # behind the western shops
    row(-24.0, 46.0, 180, 12, 1)  # next to the station
    row(36.0, 46.0, 180, 12, 3)
    for _ in range(150):
        a, r = rng.uniform(0, 2 * math.pi), rng.uniform(58, 210)
        x, y = r * math.cos(a), r * math.sin(a)
        inside = -118 < x < 118 and -96 < y < 60
        behind_west = -100 < x < -58 and 18 < y < 90
        behind_east = 58 < x < 110 and 14 < y < 90
        behind_south = abs(x) < 30 and -84 < y < -50
        if inside and not (behind_west or behind_east or behind_south):
            continue
        _house(rng.randrange(len(kinds)), x, y, rng.choice((0, 90, 180, 270)) + rng.uniform(-9, 9))
    _trees(stage, rng)


def _trees(stage: Stage, rng: random.Random) -> None:
    species = (vegetation.OAK, vegetation.LIME, vegetation.POPLAR)
    far = [vegetation.tree(sp, 7 + k, detail=0.16) for k, sp in enumerate(species)]
    placed: set[int] = set()
    for _ in range(150):
        a, r = rng.uniform(0, 2 * math.pi), rng.uniform(70, 420)
        x, y = r * math.cos(a), r * math.sin(a)
        if (abs(y + 18) < 26 and abs(x) < 112) or (abs(x) < 48 and -95 < y < 74):
            continue
        index = rng.choices(range(3), weights=(5, 4, 1))[0]
        built = far[index].copy() if index in placed else far[index]
        placed.add(index)
        stage.put(built, (x, y, -0.4), rng.uniform(0, 360), scale=rng.uniform(0.8, 1.3))


def church(stage: Stage) -> None:
    """Place the church, north-west of the square: a stone tower with a louvred belfry, battlements and a spire."""
    s = Solid("church tower")
    stone = wall_materials.ashlar("church stone", (0.40, 0.36, 0.29))
    slate = wall_materials.tile_material("church slate", SLATE)
    s.box((7.0, 7.0, 24.0), (0, 0, 12.0), stone, 0.05)
    for x in (-3.5, 3.5):
        for y in (-3.5, 3.5):
            s.box((1.3, 1.3, 22.0), (x, y, 11.0), stone, 0.05)
            s.lathe([(0.65, 0.0), (0.05, 3.0)], stone, (x, y, 24.4), steps=4)
    s.box((7.8, 7.8, 0.5), (0, 0, 23.9), stone, 0.05)
    for turn in (0, 90, 180, 270):
        with s.at(turn=turn):
            for k in range(5):
                s.box((0.8, 0.4, 0.9), (-2.8 + 1.4 * k, 3.6, 24.6), stone, 0.03)
            for x in (-1.2, 1.2):
                s.box((1.3, 0.1, 4.2), (x, 3.5, 19.4), paint("dark grey"), 0.02)
                s.prism([(x - 0.65, 21.5), (x + 0.65, 21.5), (x, 22.6)], (3.45, 3.55), paint("dark grey"), "XZ")
                for n in range(9):
                    with s.at(x, 3.56, 17.6 + 0.44 * n, pitch=30):
                        s.box((1.2, 0.06, 0.34), (0, 0, 0), stone, 0.0)
    s.lathe([(3.6, 24.0), (0.08, 43.0)], slate, steps=8)
    s.rod((0, 0, 42.8), (0, 0, 45.0), 0.06, paint("yellow"))
    s.box((1.0, 0.1, 0.12), (0, 0, 44.3), paint("yellow"), 0.01)
    s.prism([(-6.5, 0.0), (6.5, 0.0), (6.5, 8.5), (0, 14.5), (-6.5, 8.5)], (-34.0, -3.0), stone, "XZ")
    for side in (-1, 1):
        s.prism([(0, 14.9), (side * 7.2, 8.2), (side * 7.2, 7.8), (0, 14.5)], (-34.4, -3.0), slate, "XZ")
    stage.place(
        s.built(), "church", "church tower with a spire", (-62.0, 96.0, -0.3), 160, material="stone", colour="beige", kind="church"
    )
