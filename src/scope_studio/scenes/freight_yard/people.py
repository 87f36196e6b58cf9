"""Freight yard: workers, drivers and visitors who do not move."""

from __future__ import annotations

from scope_studio.kit.core.stage import Stage
from scope_studio.kit.people import characters
from scope_studio.scenes.freight_yard.fixtures import GATEHOUSE


def build(stage: Stage) -> None:
    """Place the workers, drivers and visitors."""
    _crew(stage)
    _visitors_and_drivers(stage)


def _crew(stage: Stage) -> None:
    rows = [
        ("yellow", "white", "clipboard", -13.4, 25.6, 0.0, 150, "worker with a clipboard", "clipboard", "docks"),
        ("orange", "blue", "carry", 18.6, 27.2, 0.0, 200, "worker carrying a box", "box", "goods in"),
        ("yellow", "red", "stand", -13.9, 31.6, 1.2, 170, "worker in an open dock", None, "docks"),
        ("orange", "white", "point", -4.2, 14.8, 0.0, 260, "pointing worker", None, "apron"),
        ("orange", "yellow", "kneel", 17.2, -27.6, 0.0, 80, "kneeling worker", None, "stacks"),
        ("yellow", "white", "phone", 16.0, -23.4, 0.0, 240, "worker on the phone", "phone", "stacks"),
        ("yellow", "blue", "stand", 14.9, 10.2, 0.0, 150, "standing worker", None, "apron"),
        ("orange", None, "walk", -11.2, -4.0, 0.0, 0, "worker without a helmet", None, "walkway"),
        ("orange", "white", "clipboard", -33.6, 6.0, 0.0, 230, "worker with a clipboard", "clipboard", "trailer bays"),
        ("yellow", "yellow", "carry", -1.6, 31.8, 1.2, 100, "worker carrying a box in a half-open dock", "box", "docks"),
    ]  # fmt: skip
    for k, (vest, helmet, pose, x, y, z, bearing, name, holding, area) in enumerate(rows):
        built = characters.worker(vest=vest, helmet=helmet, pose=pose, phase=0.3, seed=40 + k)
        attributes = {"carrying": holding} if holding else {}
        stage.place(
            built, "worker", name, (x, y, z), bearing, vest=vest, helmet=helmet or "none", pose=pose, area=area, **attributes
        )
    sweeper = characters.worker(vest="yellow", helmet="white", pose="shovel", holding="broom", seed=60)
    stage.place(
        sweeper,
        "worker",
        "worker sweeping with a broom",
        (25.0, 13.6, 0),
        210,
        vest="yellow",
        helmet="white",
        pose="sweep",
        carrying="broom",
        area="apron",
    )


def _visitors_and_drivers(stage: Stage) -> None:
    x, y = GATEHOUSE
    guard = characters.pedestrian(top="navy", trousers="black", hair="grey", pose="stand", seed=12)
    stage.place(
        guard,
        "security guard",
        "security guard in the gatehouse",
        (x - 0.75, y + 0.25, 0.24),
        285,
        top="navy",
        state="standing",
        behind="glass",
        area="gatehouse",
    )
    rows = [
        ("dark red", "denim", "phone", -16.2, 10.9, 200, "lorry driver on the phone", "driver", 21, None),
        ("grey", "black", "stand", -30.4, -7.3, 190, "man in the smoking shelter", "person", 22, None),
        ("light blue", "denim", "stand", -26.5, -8.3, 355, "person at the vending machine", "person", 23, None),
        ("purple", "black", "walk", -31.2, -22.3, 90, "person walking with a bag", "person", 24, "bag"),
        ("green", "beige", "stand", -39.0, -37.6, 40, "visitor beside a car", "person", 25, "bag"),
    ]  # fmt: skip
    for top, trousers, pose, px, py, bearing, name, category, seed, holding in rows:
        built = characters.pedestrian(top=top, trousers=trousers, pose=pose, phase=0.2, holding=holding, seed=seed)
        attributes = {"carrying": holding} if holding else {}
        stage.place(built, category, name, (px, py, 0), bearing, top=top, trousers=trousers, pose=pose, **attributes)
