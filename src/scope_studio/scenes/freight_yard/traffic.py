"""Freight yard: the moving actors (a forklift, an arriving van, a patrolling guard and a fox)."""

from __future__ import annotations

from scope_studio.kit.core.paths import closed_loop
from scope_studio.kit.core.stage import ActorPath, Built, Stage
from scope_studio.kit.nature import wildlife
from scope_studio.kit.people import characters
from scope_studio.kit.people.poses import walking
from scope_studio.kit.people.stances import reaching
from scope_studio.kit.vehicles import cars, forklift
from scope_studio.kit.yard.goods import pallet_load
from scope_studio.scenes.freight_yard import ground
from scope_studio.scenes.freight_yard.parked_vehicles import driver

FIRST_ACTOR = 9001
"""Number of the first actor in instance masks. All static instances have smaller numbers."""


def _forklift_with_load(_phase: float) -> Built:
    """Build the moving forklift with its driver and load as one object."""
    truck = forklift.forklift("orange", number="5", fork_m=0.30)
    for part, (x, y, z) in (
        (driver("yellow", "blue", 17), (0.0, forklift.SEAT[1], forklift.SEAT[2] - 0.46)),
        (pallet_load("crates"), (0.0, 1.68, 0.20)),
    ):
        part.root.location = (x, y, z)
        part.root.parent = truck.root
        truck.objects.extend(part.objects)
    return truck


def _guard(phase: float) -> Built:
    pose = reaching(walking(phase), right=(0.20, 0.34, 1.12))
    return characters.pedestrian(top="navy", trousers="black", hair="black", stance=pose, holding="torch", seed=4)


def build(stage: Stage) -> None:
    """Add the actors with their paths."""
    stage.actors = [
        ActorPath(
            "moving-forklift-01",
            FIRST_ACTOR,
            "forklift",
            "orange forklift",
            _forklift_with_load,
            closed_loop(
                [(21.4, 25.0), (21.2, 15.5), (18.5, 11.8), (2.0, 10.6), (-1.5, 11.8), (1.0, 13.6), (17.0, 14.2), (20.0, 17.0)], 1.9
            ),
            40.0,
            {
                "colour": "orange",
                "number": "flt 5",
                "state": "moving",
                "carrying": "pallet of crates",
                "driver": "yes",
                "lights": "lit",
            },
        ),
        ActorPath(
            "moving-van-01",
            FIRST_ACTOR + 1,
            "van",
            "white van",
            lambda _phase: cars.van("white", plate="OB69 JNR", lettering="Brightwell\nCOURIERS"),
            [
                (0.0, -36.0, -56.0, 0.0),
                (4.0, -8.0, -56.0, 0.0),
                (5.8, -1.2, -50.5, 0.0),
                (14.4, ground.IN_X, -3.0, 0.0),
                (16.2, 3.0, 5.0, 0.0),
                (20.4, 19.0, 16.2, 0.0),
                (21.8, 22.0, 21.5, 0.0),
                (25.6, 22.0, 38.0, 0.0),
            ],
            46.0,
            {"colour": "white", "state": "moving", "lettering": "brightwell couriers", "plate": "OB69 JNR"},
        ),
        ActorPath(
            "moving-guard-01",
            FIRST_ACTOR + 2,
            "security guard",
            "security guard with a torch",
            _guard,
            closed_loop([(-7.0, -29.0), (-7.0, -13.0), (-9.6, -11.0), (-9.6, -26.0)], 1.25),
            60.0,
            {"top": "navy", "holding": "torch", "state": "walking"},
            stride_m=1.32,
        ),
        ActorPath(
            "moving-fox-01",
            FIRST_ACTOR + 3,
            "fox",
            "fox",
            lambda phase: wildlife.fox(phase=phase),
            [
                (0.0, 31.0, -21.0, 0.0),
                (9.0, 11.0, -19.8, 0.0),
                (16.5, -6.0, -18.8, 0.0),
                (26.0, -28.0, -19.4, 0.0),
                (36.0, -50.0, -20.6, 0.0),
                (40.0, -58.6, -20.5, 0.0),
            ],
            44.0,
            {"colour": "red", "state": "moving"},
            stride_m=wildlife.TROT_STRIDE_M,
        ),
    ]
    for actor in stage.actors:
        if actor.id in ("moving-guard-01", "moving-forklift-01"):
            actor.period_s = actor.waypoints[-1][0]
