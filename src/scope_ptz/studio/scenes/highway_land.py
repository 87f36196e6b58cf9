"""Highway works: the road, the land around it, the bridge, buildings and everything that grows."""

from __future__ import annotations

import math
import random
from collections.abc import Callable

import bpy

from scope_ptz.studio.kit import ground, markings, structures, vegetation
from scope_ptz.studio.kit.mesh import from_data
from scope_ptz.studio.kit.shading import Shader
from scope_ptz.studio.kit.stage import Built, Stage

Height = Callable[[float, float], float]

ROAD = ground.Carriageway(
    lines=(
        markings.Line(2.15, 0.20),
        markings.Line(5.5, 0.13, 2.0, 7.0),
        markings.Line(9.0, 0.13, 2.0, 7.0),
        markings.Line(12.5, 0.20),
    ),
    patches=(
        markings.Patch("milled", -12.40, -9.25, 30.0, 52.0),
        markings.Patch("fresh", -12.40, -9.25, -4.0, 30.0),
        markings.Patch("repair", 3.1, 4.5, 8.0, 15.5),
        markings.Patch("repair", -6.4, -5.6, -34.0, -26.5),
        markings.Patch("repair", 9.4, 12.2, 38.0, 47.0),
        markings.Patch("repair", -14.9, -13.1, -24.0, -19.0),
        markings.Patch("repair", -4.9, -2.6, 57.0, 61.0),
    ),
)
COMPOUND = (-44.4, -22.6, -24.4, 4.0)
"""West, east, south and north fence lines of the site compound, metres."""
BRIDGE_Y = 85.0
DECK_M = 6.9


def build(stage: Stage) -> None:
    height = ground.hills(ROAD)
    bare = [
        (COMPOUND[0] - 2, COMPOUND[1] + 1.5, COMPOUND[2] - 2, COMPOUND[3] + 1),
        (-38.0, -27.0, 2.0, 17.0),
        (-38.0, -15.0, 12.0, 21.0),
        (-24.0, -15.0, 18.0, 56.0),
    ]
    stage.put(ground.terrain(ROAD, bare), (0, 0, 0))
    stage.put(ground.carriageways(ROAD), (0, 0, 0))
    _bridge(stage)
    _yard()
    _buildings(stage, height)
    _near_trees(stage, height)
    _boundaries(stage, height)
    _countryside(stage, height)
    _grass(stage)


def _bridge(stage: Stage) -> None:
    bridge = structures.overbridge(
        span_m=44.0, deck_m=DECK_M, number="B17  42/6", banner=("HARROWFIELD SUMMER FAIR", "SATURDAY 14 JUNE  10 AM TO 4 PM")
    )
    stage.place(bridge, "bridge", "concrete overbridge", (0, BRIDGE_Y, 0), material="concrete", colour="grey")
    grass = bpy.data.materials["land"]
    for side in (-1, 1):
        bank = structures.approach(length_m=125, width_m=9, height_m=DECK_M - 0.04, side=side, grass=grass)
        stage.put(bank, (side * 27.5, BRIDGE_Y, 0))


def _yard() -> None:
    s = Shader("yard asphalt")
    p = s.position()
    tone = s.noise(p, 0.25, detail=7.0, roughness=0.62)
    colour = s.mix(s.ramp(tone, 0.3, 0.7), (0.060, 0.059, 0.057), (0.125, 0.122, 0.116))
    x, y, _ = s.xyz(p)
    bay = s.math("MULTIPLY", s.ramp(s.math("PINGPONG", y, 1.3), 0.04, 0.06, 1.0, 0.0), s.band(x, 46.0, 50.5, 0.03))
    yard = s.surface(base_color=s.mix(s.math("MULTIPLY", bay, 0.7), colour, (0.5, 0.5, 0.48)), roughness=0.9)
    from_data("yard", [(38, -62, 0.01), (118, -62, 0.01), (118, 62, 0.01), (38, 62, 0.01)], [(0, 1, 2, 3)], yard)


def _buildings(stage: Stage, height: Height) -> None:
    white, grey, dark = (0.62, 0.63, 0.62), (0.36, 0.38, 0.40), (0.05, 0.07, 0.09)
    sheds = [
        (structures.shed(width_m=46, depth_m=30, height_m=9.5, colour=(0.16, 0.27, 0.42), trim=white, lettering="MERIDIAN FREIGHT", docks=4, windows=5), (76.0, 28.0), "blue", "blue warehouse"),
        (structures.shed(width_m=38, depth_m=26, height_m=8.0, colour=(0.50, 0.50, 0.47), trim=(0.36, 0.05, 0.04), lettering="ASHDOWN TILES", docks=3, windows=4), (74.0, -26.0), "grey", "grey warehouse"),
        (structures.shed(width_m=30, depth_m=22, height_m=7.0, colour=(0.10, 0.20, 0.13), trim=dark, lettering="COLDSTORE 3", docks=3), (112.0, -52.0), "green", "green warehouse"),
    ]
    for built, (x, y), colour, name in sheds:
        stage.place(built, "building", name, (x, y, 0.0), -90, colour=colour, material="metal cladding", kind="warehouse")
    red, buff, brown = (0.26, 0.085, 0.055), (0.36, 0.27, 0.17), (0.20, 0.075, 0.055)
    slate, clay = (0.085, 0.09, 0.10), (0.22, 0.085, 0.055)
    houses = [
        (-74.0, 30.0, 118, red, slate, (0.02, 0.10, 0.05)),
        (-86.0, 44.0, 118, buff, clay, (0.30, 0.03, 0.02)),
        (-70.0, 62.0, 150, brown, clay, (0.03, 0.06, 0.20)),
        (-98.0, 20.0, 100, red, clay, (0.5, 0.5, 0.48)),
        (-112.0, 52.0, 120, buff, slate, (0.02, 0.02, 0.02)),
        (-90.0, 78.0, 160, red, slate, (0.2, 0.12, 0.03)),
    ]
    for k, (x, y, bearing, brick, roof, door) in enumerate(houses):
        colour = "buff" if brick is buff else "red"
        built = structures.house(brick=brick, roof=roof, door=door, seed=k)
        stage.place(built, "building", f"{colour} brick house", (x, y, height(x, y)), bearing, colour=colour, material="brick", kind="house")
    x, y = -128.0, -62.0
    stage.place(structures.barn(), "building", "timber barn", (x, y, height(x, y)), 60, colour="brown", material="timber", kind="barn")
    _power_line(stage, height)


def _power_line(stage: Stage, height: Height) -> None:
    """Three pylons that cross the road far to the south, with sagging wires."""
    mould = structures.pylon()
    feet = [(-430.0, -160.0), (-185.0, -205.0), (75.0, -252.0), (330.0, -300.0)]
    bearing = math.degrees(math.atan2(-(feet[1][1] - feet[0][1]), feet[1][0] - feet[0][0]))
    points: list[tuple[float, float, float]] = []
    faces: list[tuple[int, ...]] = []
    for k, (x, y) in enumerate(feet):
        built = mould if k == 0 else mould.copy()
        stage.place(built, "pylon", "electricity pylon", (x, y, height(x, y) - 0.3), bearing + 90, colour="grey", material="steel")
    across = (math.sin(math.radians(bearing + 180)), math.cos(math.radians(bearing + 180)))
    for (x0, y0), (x1, y1) in zip(feet, feet[1:], strict=False):
        for share, reach in ((0.66, 5.5), (0.80, 6.6), (0.93, 4.8)):
            for side in (-1, 1):
                base = len(points)
                for i in range(25):
                    t = i / 24
                    x, y = x0 + (x1 - x0) * t + across[0] * reach * side, y0 + (y1 - y0) * t + across[1] * reach * side
                    z = (height(x0, y0) * (1 - t) + height(x1, y1) * t) + 30 * share - 1.6 - 28.0 * t * (1 - t)
                    points += [(x, y, z - 0.02), (x, y, z + 0.02)]
                faces += [(base + 2 * i, base + 2 * i + 2, base + 2 * i + 3, base + 2 * i + 1) for i in range(24)]
    from_data("wires", points, faces, Shader("wire").surface(base_color=(0.05, 0.05, 0.05), roughness=0.6))


def _near_trees(stage: Stage, height: Height) -> None:
    kinds = {sp.name: sp for sp in (vegetation.OAK, vegetation.LIME, vegetation.BIRCH, vegetation.POPLAR, vegetation.PINE, vegetation.COPPER, vegetation.BUSH)}
    moulds: dict[tuple[str, int], Built] = {}
    rows = [
        ("lime", 0, 24.5, 24.0), ("birch", 0, 23.5, 33.5), ("oak", 0, 30.0, 62.0), ("lime", 1, 25.5, -21.0), ("birch", 1, 23.8, -31.0),
        ("copper beech", 0, 33.0, -50.0), ("pine", 0, 29.0, -74.0), ("oak", 1, 24.0, -92.0), ("poplar", 0, 34.0, 46.0), ("poplar", 0, 34.5, 52.5),
        ("birch", 0, -25.5, 52.0), ("lime", 1, -27.5, 60.0), ("oak", 1, -54.0, 26.0), ("birch", 1, -53.0, 10.0), ("pine", 0, -60.5, -8.0),
        ("oak", 0, -62.0, -26.0), ("lime", 0, -55.5, -44.0), ("copper beech", 0, -40.0, -52.0), ("lime", 1, -26.5, -48.0), ("birch", 0, -22.8, -58.5),
        ("oak", 0, -29.0, -78.0), ("poplar", 0, -66.0, 48.0), ("bush", 0, 20.6, 5.0), ("bush", 0, 21.2, -12.5), ("bush", 1, -22.4, -44.5),
        ("bush", 1, -20.8, 66.0), ("bush", 0, 20.9, 69.0), ("bush", 1, 22.3, 45.0),
    ]  # fmt: skip
    rng = random.Random("near trees")
    for name, seed, x, y in rows:
        key = (name, seed)
        built = moulds[key].copy() if key in moulds else moulds.setdefault(key, vegetation.tree(kinds[name], seed))
        category = "bush" if name == "bush" else "tree"
        noun = {"lime": "lime tree", "birch": "birch tree", "oak": "oak tree", "pine": "pine tree", "poplar": "poplar tree"}.get(name, name)
        colour = "copper" if name == "copper beech" else "green"
        stage.place(
            built, category, "green bush" if name == "bush" else noun, (x, y, height(x, y)), rng.uniform(0, 360),
            scale=rng.uniform(0.85, 1.12), colour=colour, species=name,
        )  # fmt: skip


def _boundaries(stage: Stage, height: Height) -> None:
    """Timber fences along the highway boundary, hedges behind them. Unannotated: they run on for ever."""
    fence = structures.post_and_rail(9.0)
    first = True
    for x, spans in ((27.5, ((-190, 64), (106, 190))), (-21.2, ((106, 190), (-190, -50)))):
        for start, end in spans:
            for y in range(start, end - 8, 9):
                stage.put(fence if first else fence.copy(), (x, y + 4.5, height(x, y)), 90)
                first = False
    hedge = [vegetation.hedge(8.4, seed=k, detail=0.8) for k in range(2)]
    used = [False, False]
    rng = random.Random("hedges")
    lines = [((30.0, -190.0), (30.0, -66.0)), ((33.0, 108.0), (33.0, 200.0)), ((-24.5, 108.0), (-24.5, 200.0)), ((-24.5, -190.0), (-24.5, -62.0)),
             ((-54.5, -60.0), (-54.5, 4.0)), ((-58.0, 14.0), (-150.0, 6.0)), ((-58.0, 14.0), (-52.0, 70.0)), ((-54.5, -60.0), (-190.0, -84.0)), ((-96.0, 10.0), (-104.0, -64.0)), ((-54.0, -60.0), (-24.5, -62.0)), ((30.0, 64.0), (36.0, 64.0))]  # fmt: skip
    for (x0, y0), (x1, y1) in lines:
        length = math.hypot(x1 - x0, y1 - y0)
        bearing = math.degrees(math.atan2(x1 - x0, y1 - y0)) - 90
        for k in range(max(1, int(length / 8.0))):
            t = (k + 0.5) * 8.0 / length
            x, y = x0 + (x1 - x0) * t, y0 + (y1 - y0) * t
            pick = rng.randrange(2)
            built = hedge[pick].copy() if used[pick] else hedge[pick]
            used[pick] = True
            turned = bearing + (180 if rng.random() < 0.5 else 0)
            stage.put(built, (x, y, height(x, y) - 0.05), turned, scale=rng.uniform(0.9, 1.15))


def _countryside(stage: Stage, height: Height) -> None:
    """Woods that close the road's vanishing points, hedgerow trees in the fields, woods on the hills."""
    rng = random.Random("countryside")
    species = (vegetation.OAK, vegetation.LIME, vegetation.POPLAR, vegetation.PINE, vegetation.COPPER)
    far = [vegetation.tree(sp, 7 + k, detail=0.14) for k, sp in enumerate(species)] + [vegetation.tree(vegetation.OAK, 21, detail=0.14)]
    scrub = vegetation.tree(vegetation.BUSH, 5, detail=0.16)
    hedgerow = vegetation.hedge(16.0, seed=9, detail=0.16)
    fresh = {id(m) for m in [*far, scrub, hedgerow]}

    def strew(mould: Built, x: float, y: float, bearing: float, scale: float) -> None:
        built = mould if id(mould) in fresh else mould.copy()
        fresh.discard(id(mould))
        stage.put(built, (x, y, height(x, y) - 0.1), bearing, scale=scale)

    def any_tree() -> Built:
        return far[rng.choices(range(6), weights=(5, 5, 1, 2, 0.5, 4))[0]]

    for side in (-1, 1):
        for end in (-1, 1):
            for _ in range(85):
                y = end * rng.triangular(125, 640, 300)
                x = ROAD.centre_x(y) + side * (27 + 46 * rng.random() ** 1.6)
                strew(any_tree(), x, y, rng.uniform(0, 360), rng.uniform(0.75, 1.25))
            for _ in range(26):
                y = end * rng.uniform(112, 420)
                strew(scrub, ROAD.centre_x(y) + side * rng.uniform(19.5, 24), y, rng.uniform(0, 360), rng.uniform(0.7, 1.5))
    for _ in range(46):
        strew(any_tree(), rng.uniform(124, 150), rng.uniform(-120, 150), rng.uniform(0, 360), rng.uniform(0.8, 1.3))
    for _ in range(30):
        x, y = rng.gauss(-100, 22), rng.gauss(66, 26)
        if min(math.hypot(x - hx, y - hy) for hx, hy in ((-74, 30), (-86, 44), (-70, 62), (-98, 20), (-112, 52), (-90, 78))) > 10 and x < -58:
            strew(any_tree(), x, y, rng.uniform(0, 360), rng.uniform(0.55, 0.95))
    for _ in range(60):
        x, y, heading, count = rng.uniform(-620, 620), rng.uniform(-620, 620), rng.uniform(0, 180), rng.randrange(4, 11)
        dx, dy = math.sin(math.radians(heading)), math.cos(math.radians(heading))
        for k in range(count):
            px, py = x + dx * 16 * k, y + dy * 16 * k
            if abs(px - ROAD.centre_x(py)) < 70 or math.hypot(px, py) < 110:
                continue
            strew(hedgerow, px, py, heading - 90, 1.0)
            if rng.random() < 0.35:
                strew(any_tree(), px, py, rng.uniform(0, 360), rng.uniform(0.6, 1.1))
    for _ in range(34):
        bearing, radius = rng.uniform(0, 2 * math.pi), rng.uniform(380, 1500)
        cx, cy = radius * math.sin(bearing), radius * math.cos(bearing)
        for _ in range(rng.randrange(8, 26)):
            x, y = cx + rng.gauss(0, 30), cy + rng.gauss(0, 18)
            if abs(x - ROAD.centre_x(max(-950.0, min(950.0, y)))) > 40:
                strew(any_tree(), x, y, rng.uniform(0, 360), rng.uniform(0.8, 1.4))


def _grass(stage: Stage) -> None:
    """Real blades wherever a camera can look closely: the verges near both viewpoints."""
    rng = random.Random("grass")
    long = [vegetation.grass_patch(2.0, blades=1500, height_m=0.17, seed=k, flowers=4 * (k == 0)) for k in range(3)]
    mown = [vegetation.grass_patch(2.0, blades=1700, height_m=0.075, seed=10 + k) for k in range(2)]
    used: set[int] = set()

    def strew(moulds: list[Built], x: float, y: float) -> None:
        mould = rng.choice(moulds)
        built = mould.copy() if id(mould) in used else mould
        used.add(id(mould))
        stage.put(built, (x, y, -0.03), 90 * rng.randrange(4) + rng.uniform(-8, 8), scale=rng.uniform(0.95, 1.2))

    for y in range(-60, 76, 2):
        for x in (-16.8, -18.7, -20.4):
            if 8 < y < 58 and x > -22:
                continue
            strew(mown if x > -17 else long, x + rng.uniform(-0.25, 0.25), y + rng.uniform(-0.4, 0.4))
        for x in (16.8, 18.7, 20.6, 22.5):
            strew(mown if x < 17 else long, x + rng.uniform(-0.25, 0.25), y + rng.uniform(-0.4, 0.4))
