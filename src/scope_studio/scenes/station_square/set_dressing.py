"""Station square: bicycles, luggage, trees, pigeons."""

from __future__ import annotations

import random

from scope_studio.kit.core.prototypes import Prototypes
from scope_studio.kit.core.stage import Built, Stage
from scope_studio.kit.ground import paving
from scope_studio.kit.nature import birds, vegetation
from scope_studio.kit.people import luggage
from scope_studio.kit.vehicles import cycles
from scope_studio.scenes.station_square.fixtures import PLATFORM_TOP_M, TREES


def build(stage: Stage) -> None:
    """Place bicycles, luggage, trees and pigeons."""
    prototypes = Prototypes()
    _bicycles(stage, prototypes)
    _luggage(stage)
    _trees(stage, prototypes)
    _pigeons(stage, prototypes)


def _bicycles(stage: Stage, prototypes: Prototypes) -> None:
    for k in range(5):
        stage.place(
            prototypes.get("hoop", cycles.bike_stand),
            "bike stand",
            "steel bike stand",
            (12.2 + 1.2 * k, 19.8, 0),
            0,
            material="steel",
        )
    bikes = [
        (0, 1, "blue", "town", False),
        (0, -1, "red", "mountain", False),
        (1, 1, "black", "step-through", True),
        (2, 1, "green", "town", False),
        (2, -1, "yellow", "road", False),
        (3, 1, "white", "step-through", True),
        (4, -1, "orange", "mountain", False),
    ]
    for stand, side, colour, kind, basket in bikes:
        stage.place(
            cycles.bicycle(colour, kind=kind, basket=basket),
            "bicycle",
            f"{colour} bicycle",
            (12.2 + 1.2 * stand + side * 0.20, 19.8 + 0.1 * side, 0),
            0 if side > 0 else 180,
            lean_deg=(0, -4.0),
            colour=colour,
            kind=kind,
            state="parked",
            **({"with": "basket"} if basket else {}),
        )
    stage.place(
        cycles.bicycle("purple", kind="town"),
        "bicycle",
        "purple bicycle",
        (-35.45, 14.6, 0),
        4,
        lean_deg=(0, -7.0),
        colour="purple",
        kind="town",
        state="parked",
    )


def _luggage(stage: Stage) -> None:
    rows = [
        (luggage.suitcase("red"), "suitcase", "red suitcase", (16.9, 4.5), 250, "red"),
        (luggage.suitcase("navy", height=0.74), "suitcase", "blue suitcase", (16.8, 6.2), 265, "blue"),
        (luggage.suitcase("black", handle=False), "suitcase", "black suitcase", (4.1, 22.9), 160, "black"),
        (luggage.suitcase("yellow"), "suitcase", "yellow suitcase", (-22.0, -10.7), 200, "yellow"),
        (luggage.backpack("green"), "backpack", "green backpack", (0.2, 1.0), 200, "green"),
        (luggage.backpack("orange"), "backpack", "orange backpack", (-20.6, -10.2), 170, "orange"),
        (luggage.travel_bag("brown"), "bag", "brown travel bag", (24.1, 0.6), 120, "brown"),
    ]
    for built, category, name, (x, y), bearing, colour in rows:
        z = PLATFORM_TOP_M if y < -9.4 and x < -14 else 0.0
        stage.place(built, category, name, (x, y, z), bearing, colour=colour)


def _trees(stage: Stage, prototypes: Prototypes) -> None:
    rng = random.Random("square trees")
    trees: dict[int, Built] = {}
    for k, (x, y) in enumerate(TREES):
        kind = k % 2
        built = (
            trees[kind].copy() if kind in trees else trees.setdefault(kind, vegetation.tree(vegetation.LIME, 30 + kind, detail=0.8))
        )
        stage.place(prototypes.get("grate", paving.tree_grate), "tree grate", "iron tree grate", (x, y, 0), 0, material="iron")
        stage.place(
            built,
            "tree",
            "lime tree",
            (x, y, 0),
            rng.uniform(0, 360),
            scale=rng.uniform(0.66, 0.78),
            species="lime",
            colour="green",
        )


def _pigeons(stage: Stage, prototypes: Prototypes) -> None:
    rng = random.Random("pigeons")
    poses = ("stand", "peck", "peck", "stand", "rest")
    for k in range(16):
        x, y = (rng.gauss(2.6, 1.5), rng.gauss(-0.6, 0.9)) if k < 12 else (rng.gauss(-6.6, 1.2), rng.gauss(0.2, 0.8))
        colour, pose = ("grey", "dark grey", "grey", "white", "grey", "brown")[k % 6], poses[k % 5]
        built = prototypes.get(f"pigeon {colour} {pose}", lambda colour=colour, pose=pose: birds.pigeon(colour, pose=pose))
        stage.place(
            built,
            "pigeon",
            f"{colour} pigeon",
            (x, y, 0),
            rng.uniform(0, 360),
            colour=colour,
            state={"peck": "pecking"}.get(pose, "standing"),
        )
    for x, z in ((-3.1, 7.29), (1.4, 7.29), (4.9, 7.29)):
        stage.place(
            prototypes.get("pigeon grey stand", lambda: birds.pigeon("grey")),
            "pigeon",
            "grey pigeon",
            (x, 26.8, z),
            rng.uniform(120, 240),
            colour="grey",
            state="standing",
            area="ledge",
        )
