"""Station square: vendors, customers, travellers, people at café tables and on benches, and walking people."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from scope_studio.kit.core.stage import ActorPath, Built, Stage
from scope_studio.kit.nature import dogs
from scope_studio.kit.people import characters, luggage, poses, prams, seated, stances
from scope_studio.kit.people.poses import Pose, walking
from scope_studio.scenes.station_square import traffic
from scope_studio.scenes.station_square.fixtures import BENCHES, PLATFORM_TOP_M
from scope_studio.scenes.station_square.market import FRONT_BEARING_DEG, STALLS, at_front, seat_position

CASE_GRIP: tuple[float, float, float] = (0.24, -0.16, 0.86)
"""Position in metres of the right hand of a walking person who pulls a suitcase."""

VENDORS = ["white", "green", "dark green", "purple", "navy", "cream", "brown", "red"]
"""Colour of each stallholder's top, in the order of ``STALLS``."""
CUSTOMERS: list[tuple[int, float, float, str, str, str | None]] = [
    (0, 0.4, 1.75, "navy", "stand", "bag"), (1, -0.9, 1.65, "dark red", "point", None), (1, 0.7, 1.8, "beige", "stand", "bag"),
    (2, 0.1, 1.7, "yellow", "stand", "bag"), (2, 1.3, 2.5, "grey", "phone", None), (3, 1.9, 1.2, "pink", "stand", None),
    (5, -0.3, 1.7, "green", "stand", "bag"), (6, 0.8, 1.7, "light blue", "point", None), (7, 0.0, 1.9, "black", "stand", None),
    (7, 0.9, 2.3, "orange", "stand", None),
]  # fmt: skip
"""Customers: index of the stall, position in front of the stall (right, out), coat, pose, held object."""

PEDESTRIANS: list[tuple[float, float, float, str, str, str | None, str]] = [
    (3.3, 22.6, 160, "navy", "stand", None, "waiting by the station"),
    (6.0, 21.2, 320, "beige", "walk", "bag", "walking to the station"),
    (13.8, 8.4, 20, "dark red", "walk", None, "walking to the station"),
    (16.2, 4.9, 80, "green", "phone", None, "waiting for a taxi"),
    (23.9, -2.4, 80, "black", "stand", None, "standing by the taxis"),
    (-18.4, -11.0, 100, "light blue", "stand", None, "waiting for the tram"),
    (-21.6, -11.2, 170, "yellow", "phone", None, "waiting for the tram"),
    (-26.4, -11.4, 190, "purple", "stand", "bag", "waiting for the tram"),
    (5.2, -1.2, 300, "grey", "walk", None, "crossing the square"),
    (9.9, -5.4, 20, "brown", "stand", None, "at the kiosk"),
    (-4.2, -10.3, 285, "red", "walk", "bag", "crossing the square"),
    (8.3, 7.4, 350, "white", "stand", None, "reading the map"),
    (-12.0, -27.4, 262, "navy", "walk", None, "on the hotel's pavement"),
    (13.5, -26.8, 95, "green", "walk", "bag", "on the hotel's pavement"),
    (34.6, 3.4, 5, "pink", "walk", None, "on the eastern pavement"),
    (34.8, -6.6, 182, "dark grey", "phone", None, "by the pharmacy"),
    (-34.8, 11.0, 176, "blue", "walk", None, "by the pink house"),
]  # fmt: skip
"""People on foot: x, y, bearing, top, pose, held object, activity."""

SITTERS: list[tuple[int, int, int, str, str]] = [
    (0, 0, 0, "navy", "cup"),
    (0, 0, 1, "pink", "table"),
    (1, 0, 2, "beige", "phone"),
    (0, 1, 1, "grey", "table"),
    (1, 2, 0, "white", "cup"),
    (1, 2, 1, "dark red", "table"),
    (0, 3, 0, "green", "phone"),
    (1, 3, 2, "light blue", "table"),
    (1, 3, 0, "black", "cup"),
]
"""People at café tables: column, row and seat, coat, and activity of the hands."""


def build(stage: Stage) -> None:
    """Place the people and add the actors with their paths."""
    _market(stage)
    _pedestrians(stage)
    _sitting_people(stage)
    _companions(stage)
    stage.actors = [*traffic.actors(), *_walkers()]
    stage.actors[-1].period_s = stage.actors[-1].waypoints[-1][0]


def _person(
    stage: Stage, position: tuple[float, float, float], bearing: float, name: str, top: str, seed: int, **attributes: Any
) -> str:
    pose: str = attributes.pop("pose", "stand")
    stance: Pose | None = attributes.pop("stance", None)
    holding: str | None = attributes.pop("holding", None)
    built = characters.pedestrian(top=top, pose=pose, phase=0.08 + 0.13 * (seed % 7), holding=holding, stance=stance, seed=seed)
    state = {"walk": "walking", "sit": "sitting"}.get("sit" if attributes.pop("seated", False) else pose, "standing")
    if holding:
        attributes["holding"] = holding
    if pose == "phone":
        attributes["holding"] = "phone"
    category = "stallholder" if attributes.get("role") == "stallholder" else "person"
    return stage.place(built, category, name, position, bearing, top=top, state=state, **attributes)


def _market(stage: Stage) -> None:
    for k, top in enumerate(VENDORS):
        x, y = at_front(STALLS[k][2], (-0.5, 0.6, 0.0)[k % 3], -0.85)
        trade = STALLS[k][0].split()[-1].lower()
        _person(
            stage,
            (x, y, 0),
            FRONT_BEARING_DEG + (12, -15, 0)[k % 3],
            f"stallholder in {top}",
            top,
            300 + k,
            role="stallholder",
            stall=trade,
        )
    for k, (stall, right, out, top, pose, holding) in enumerate(CUSTOMERS):
        x, y = at_front(STALLS[stall][2], right, out)
        turn = FRONT_BEARING_DEG + 180 + (-14, 10, 22, -8)[k % 4]
        _person(stage, (x, y, 0), turn, f"customer in {top}", top, 340 + k, pose=pose, holding=holding, role="customer")


def _pedestrians(stage: Stage) -> None:
    for k, (x, y, bearing, top, pose, holding, activity) in enumerate(PEDESTRIANS):
        z = PLATFORM_TOP_M if "tram" in activity else 0.0
        name = f"person in {top}" if "white" not in top else "person in a white top"
        _person(stage, (x, y, z), bearing, name, top, 380 + k, pose=pose, holding=holding, activity=activity)


def _sitting_people(stage: Stage) -> None:
    stance = {"cup": seated.with_cup, "table": seated.at_table, "phone": seated.with_phone}
    for k, (column, row, seat, top, activity) in enumerate(SITTERS):
        (x, y), bearing = seat_position(column, row, seat)
        _person(
            stage,
            (x, y, 0),
            bearing,
            f"café guest in {top}",
            top,
            420 + k,
            stance=stance[activity](k),
            seated=True,
            role="customer",
            area="terrace",
        )
    for k, (bench, shift, top) in enumerate(((0, -0.45, "yellow"), (0, 0.4, "navy"), (3, 0.3, "brown"), (5, -0.3, "purple"))):
        x, y, bearing, _ = BENCHES[bench]
        dx, dy = {180.0: (-shift, 0.02), 270.0: (-0.02, shift)}[bearing]
        pose = seated.with_phone(k) if k == 2 else stances.sitting(0.455, seed=60 + k, crossed=k == 1)
        _person(stage, (x + dx, y + dy, 0), bearing, f"person on a bench in {top}", top, 440 + k, stance=pose, seated=True)
    _person(
        stage,
        (-23.2, -10.05, PLATFORM_TOP_M),
        180,
        "person sitting in the shelter",
        "red",
        450,
        stance=stances.sitting(0.47, seed=5),
        seated=True,
        behind="glass",
    )


def _companions(stage: Stage) -> None:
    """Place a man with a dog on a lead, a woman with a pram, and two travellers with cases."""
    _person(
        stage, (5.6, 3.2, 0), 140, "dog walker in grey", "grey", 460, stance=stances.leading(None, seed=3), activity="walking a dog"
    )
    dog = dogs.dog("golden", lead_to=(stances.LEAD_GRIP[0] - 0.55, stances.LEAD_GRIP[1] - 0.55, stances.LEAD_GRIP[2]))
    x, y = at_front((5.6, 3.2), -0.55, 0.55, 140)
    stage.place(dog, "dog", "golden dog on a lead", (x, y, 0), 140, colour="golden", state="standing")
    _person(
        stage, (14.2, 14.0, 0), 262, "woman with a pram", "light blue", 461, stance=stances.pushing(0.2), activity="pushing a pram"
    )
    x, y = at_front((14.2, 14.0), 0.0, 0.86, 262)
    stage.place(prams.pram("navy"), "pram", "navy pram", (x, y, 0), 262, colour="navy")
    for k, (position, bearing, top, case) in enumerate(
        (((-3.6, 15.6), 20, "black", "green"), ((16.4, -0.6), 10, "dark red", "purple"))
    ):
        stance = stances.reaching(_walk_without_twist(0.3 + 0.3 * k), right=CASE_GRIP)
        _person(stage, (*position, 0), bearing, f"traveller in {top}", top, 470 + k, stance=stance, activity="pulling a suitcase")
        stage.place(
            luggage.trailing_case(case, CASE_GRIP),
            "suitcase",
            f"{case} suitcase",
            (*position, 0),
            bearing,
            colour=case,
            state="pulled",
        )


def _walk_without_twist(phase: float) -> Pose:
    """Return a walking pose without rotation of the trunk, which would move the hand that pulls a suitcase."""
    return replace(walking(phase), twist=0.0)


def _with_case(phase: float) -> Built:
    walker = characters.pedestrian(
        top="orange", trousers="navy", seed=501, stance=stances.reaching(_walk_without_twist(phase), right=CASE_GRIP)
    )
    case = luggage.trailing_case("blue", CASE_GRIP)
    case.root.parent = walker.root
    return Built(walker.root, [*walker.objects, *case.objects], [])


def _walkers() -> list[ActorPath]:
    """Return the walking actors: a traveller from the station, a person who walks to the station, and a dog without an owner."""
    traveller_path = [
        (0.4, 31.5),
        (0.3, 24.0),
        (-3.6, 19.6),
        (-14.0, 16.4),
        (-24.0, 17.4),
        (-31.0, 18.8),
        (-37.0, 18.9),
        (-42.0, 19.0),
    ]
    commuter_path = [
        (47.5, 6.0),
        (47.0, 1.2),
        (42.0, 0.8),
        (36.0, 0.6),
        (27.6, 4.05),
        (22.5, 4.05),
        (20.0, 5.6),
        (9.6, 12.6),
        (2.6, 18.6),
        (-0.5, 24.0),
        (-0.4, 31.5),
    ]
    dog_path = [(6.4, -4.6), (9.2, 1.6), (8.6, 11.8), (2.4, 14.4), (-2.3, 12.4), (-2.4, 1.6), (-1.6, -4.4), (6.4, -4.6)]
    number = traffic.FIRST_ACTOR + 2
    return [
        ActorPath(
            "moving-person-01",
            number,
            "person",
            "traveller with a blue suitcase",
            _with_case,
            traffic.timed_path(traveller_path, 1.35),
            52.0,
            {"top": "orange", "state": "walking", "with": "suitcase"},
            stride_m=poses.STRIDE_M,
        ),
        ActorPath(
            "moving-person-02",
            number + 1,
            "person",
            "walking person in dark red",
            lambda phase: characters.pedestrian(
                top="dark red", trousers="black", pose="walk", phase=phase, holding="bag", seed=502
            ),
            traffic.timed_path(commuter_path, 1.45),
            54.0,
            {"top": "dark red", "state": "walking", "holding": "bag"},
            stride_m=poses.STRIDE_M,
        ),
        ActorPath(
            "moving-dog-01",
            number + 2,
            "dog",
            "black dog",
            lambda phase: dogs.dog("black", phase=phase),
            traffic.timed_path(dog_path, 1.5),
            0.0,
            {"colour": "black", "state": "walking"},
            stride_m=0.62,
        ),
    ]
