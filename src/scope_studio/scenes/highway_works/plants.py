"""Highway works: trees, hedges and grass, and the fences among them."""

from __future__ import annotations

import math
import random

from scope_studio.kit.buildings import structures
from scope_studio.kit.core.stage import Built, Stage
from scope_studio.kit.ground import terrain
from scope_studio.kit.nature import vegetation
from scope_studio.scenes.highway_works.land import ROAD, Height


def build(stage: Stage) -> None:
    """Place all plants."""
    height = terrain.hills(ROAD)
    _near_trees(stage, height)
    _boundaries(stage, height)
    _countryside(stage, height)
    _grass(stage)


def _near_trees(stage: Stage, height: Height) -> None:
    kinds = {
        sp.name: sp
        for sp in (
            vegetation.OAK,
            vegetation.LIME,
            vegetation.BIRCH,
            vegetation.POPLAR,
            vegetation.PINE,
            vegetation.COPPER,
            vegetation.BUSH,
        )
    }
    prototypes: dict[tuple[str, int], Built] = {}
    rows = [
        ("lime", 0, 24.5, 24.0),
        ("birch", 0, 23.5, 33.5),
        ("oak", 0, 30.0, 62.0),
        ("lime", 1, 25.5, -21.0),
        ("birch", 1, 23.8, -31.0),
        ("copper beech", 0, 33.0, -50.0),
        ("pine", 0, 29.0, -74.0),
        ("oak", 1, 24.0, -92.0),
        ("poplar", 0, 34.0, 46.0),
        ("poplar", 0, 34.5, 52.5),
        ("birch", 0, -25.5, 52.0),
        ("lime", 1, -27.5, 60.0),
        ("oak", 1, -54.0, 26.0),
        ("birch", 1, -53.0, 10.0),
        ("pine", 0, -60.5, -8.0),
        ("oak", 0, -62.0, -26.0),
        ("lime", 0, -55.5, -44.0),
        ("copper beech", 0, -40.0, -52.0),
        ("lime", 1, -26.5, -48.0),
        ("birch", 0, -22.8, -58.5),
        ("oak", 0, -29.0, -78.0),
        ("poplar", 0, -66.0, 48.0),
        ("bush", 0, 20.6, 5.0),
        ("bush", 0, 21.2, -12.5),
        ("bush", 1, -22.4, -44.5),
        ("bush", 1, -20.8, 66.0),
        ("bush", 0, 20.9, 69.0),
        ("bush", 1, 22.3, 45.0),
    ]
    rng = random.Random("near trees")
    for name, seed, x, y in rows:
        key = (name, seed)
        built = prototypes[key].copy() if key in prototypes else prototypes.setdefault(key, vegetation.tree(kinds[name], seed))
        category = "bush" if name == "bush" else "tree"
        noun = {"lime": "lime tree", "birch": "birch tree", "oak": "oak tree", "pine": "pine tree", "poplar": "poplar tree"}.get(
            name, name
        )
        colour = "copper" if name == "copper beech" else "green"
        stage.place(
            built,
            category,
            "green bush" if name == "bush" else noun,
            (x, y, height(x, y)),
            rng.uniform(0, 360),
            scale=rng.uniform(0.85, 1.12),
            colour=colour,
            species=name,
        )


def _boundaries(stage: Stage, height: Height) -> None:
    """Place timber fences along the highway boundary and hedges behind them. They are not annotated; their ends are out of view."""
    fence = structures.post_and_rail(9.0)
    first = True
    for x, spans in ((27.5, ((-190, 64), (106, 190))), (-21.2, ((106, 190), (-190, -50)))):
        for start, end in spans:
            for y in range(start, end - 8, 9):
                stage.put(fence if first else fence.copy(), (x, y + 4.5, height(x, y)), 90)
                first = False
    hedges = [vegetation.hedge(8.4, seed=k, detail=0.8) for k in range(2)]
    used = [False, False]
    rng = random.Random("hedges")
    lines = [
        ((30.0, -190.0), (30.0, -66.0)),
        ((33.0, 108.0), (33.0, 200.0)),
        ((-24.5, 108.0), (-24.5, 200.0)),
        ((-24.5, -190.0), (-24.5, -62.0)),
        ((-54.5, -60.0), (-54.5, 4.0)),
        ((-58.0, 14.0), (-150.0, 6.0)),
        ((-58.0, 14.0), (-52.0, 70.0)),
        ((-54.5, -60.0), (-190.0, -84.0)),
        ((-96.0, 10.0), (-104.0, -64.0)),
        ((-54.0, -60.0), (-24.5, -62.0)),
        ((30.0, 64.0), (36.0, 64.0)),
    ]
    for (x0, y0), (x1, y1) in lines:
        length = math.hypot(x1 - x0, y1 - y0)
        bearing = math.degrees(math.atan2(x1 - x0, y1 - y0)) - 90
        for k in range(max(1, int(length / 8.0))):
            t = (k + 0.5) * 8.0 / length
            x, y = x0 + (x1 - x0) * t, y0 + (y1 - y0) * t
            index = rng.randrange(2)
            built = hedges[index].copy() if used[index] else hedges[index]
            used[index] = True
            hedge_bearing = bearing + (180 if rng.random() < 0.5 else 0)
            stage.put(built, (x, y, height(x, y) - 0.05), hedge_bearing, scale=rng.uniform(0.9, 1.15))


def _countryside(stage: Stage, height: Height) -> None:
    """Place woods at both ends of the visible road and on the hills, and hedgerow trees in the fields."""
    rng = random.Random("countryside")
    species = (vegetation.OAK, vegetation.LIME, vegetation.POPLAR, vegetation.PINE, vegetation.COPPER)
    far = [vegetation.tree(sp, 7 + k, detail=0.14) for k, sp in enumerate(species)] + [
        vegetation.tree(vegetation.OAK, 21, detail=0.14)
    ]
    scrub = vegetation.tree(vegetation.BUSH, 5, detail=0.16)
    hedgerow = vegetation.hedge(16.0, seed=9, detail=0.16)
    unplaced = {id(m) for m in [*far, scrub, hedgerow]}

    def scatter(prototype: Built, x: float, y: float, bearing: float, scale: float) -> None:
        built = prototype if id(prototype) in unplaced else prototype.copy()
        unplaced.discard(id(prototype))
        stage.put(built, (x, y, height(x, y) - 0.1), bearing, scale=scale)

    def any_tree() -> Built:
        return far[rng.choices(range(6), weights=(5, 5, 1, 2, 0.5, 4))[0]]

    for side in (-1, 1):
        for end in (-1, 1):
            for _ in range(85):
                y = end * rng.triangular(125, 640, 300)
                x = ROAD.centre_x(y) + side * (27 + 46 * rng.random() ** 1.6)
                scatter(any_tree(), x, y, rng.uniform(0, 360), rng.uniform(0.75, 1.25))
            for _ in range(26):
                y = end * rng.uniform(112, 420)
                scatter(scrub, ROAD.centre_x(y) + side * rng.uniform(19.5, 24), y, rng.uniform(0, 360), rng.uniform(0.7, 1.5))
    for _ in range(46):
        scatter(any_tree(), rng.uniform(124, 150), rng.uniform(-120, 150), rng.uniform(0, 360), rng.uniform(0.8, 1.3))
    for _ in range(30):
        x, y = rng.gauss(-100, 22), rng.gauss(66, 26)
        if (
            min(math.hypot(x - hx, y - hy) for hx, hy in ((-74, 30), (-86, 44), (-70, 62), (-98, 20), (-112, 52), (-90, 78))) > 10
            and x < -58
        ):
            scatter(any_tree(), x, y, rng.uniform(0, 360), rng.uniform(0.55, 0.95))
    for _ in range(60):
        x, y, heading, count = rng.uniform(-620, 620), rng.uniform(-620, 620), rng.uniform(0, 180), rng.randrange(4, 11)
        dx, dy = math.sin(math.radians(heading)), math.cos(math.radians(heading))
        for k in range(count):
            px, py = x + dx * 16 * k, y + dy * 16 * k
            if abs(px - ROAD.centre_x(py)) < 70 or math.hypot(px, py) < 110:
                continue
            scatter(hedgerow, px, py, heading - 90, 1.0)
            if rng.random() < 0.35:
                scatter(any_tree(), px, py, rng.uniform(0, 360), rng.uniform(0.6, 1.1))
    for _ in range(34):
        bearing, radius = rng.uniform(0, 2 * math.pi), rng.uniform(380, 1500)
        cx, cy = radius * math.sin(bearing), radius * math.cos(bearing)
        for _ in range(rng.randrange(8, 26)):
            x, y = cx + rng.gauss(0, 30), cy + rng.gauss(0, 18)
            if abs(x - ROAD.centre_x(max(-950.0, min(950.0, y)))) > 40:
                scatter(any_tree(), x, y, rng.uniform(0, 360), rng.uniform(0.8, 1.4))


def _grass(stage: Stage) -> None:
    """Place grass on the verges near the viewpoints, where it is seen in close-up."""
    rng = random.Random("grass")
    unmown = [vegetation.grass_patch(2.0, blades=1500, height_m=0.17, seed=k, flowers=4 * (k == 0)) for k in range(3)]
    mown = [vegetation.grass_patch(2.0, blades=1700, height_m=0.075, seed=10 + k) for k in range(2)]
    placed: set[int] = set()

    def scatter(prototypes: list[Built], x: float, y: float) -> None:
        prototype = rng.choice(prototypes)
        built = prototype.copy() if id(prototype) in placed else prototype
        placed.add(id(prototype))
        stage.put(built, (x, y, -0.03), 90 * rng.randrange(4) + rng.uniform(-8, 8), scale=rng.uniform(0.95, 1.2))

    def row(prototypes: list[Built], x: float, y: float, fraction: float = 1.0) -> None:
        if rng.random() < fraction:
            width = 0.25 if fraction == 1.0 else 0.9
            scatter(prototypes, x + rng.uniform(-width, width), y + rng.uniform(-0.4, 0.4))

    for y in range(-60, 76, 2):
        if not 8 < y < 58:
            row(mown, -16.8, y)
            row(unmown, -18.6, y)
            row(unmown, -20.2, y, 0.7)
        if y < -26:
            row(unmown, -22.2, y, 0.5)
            row(unmown, -24.6, y, 0.3)
        row(mown, 16.8, y)
        row(unmown, 18.7, y)
        row(unmown, 20.6, y)
        row(unmown, 22.8, y, 0.6)
        row(unmown, 25.0, y, 0.35)
