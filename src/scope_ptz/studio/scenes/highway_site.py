"""Highway works: the closed lane with its cones, machines and crew, and the compound behind the verge."""

from __future__ import annotations

import math
import random

from scope_ptz.studio.kit import machines, people, works
from scope_ptz.studio.kit.stage import Built, Stage
from scope_ptz.studio.kit.works_barriers import FENCE_PANEL_M
from scope_ptz.studio.scenes.highway_land import COMPOUND

LINE_X = -9.3
"""The line of cones and barriers between the works and the traffic."""

TAPER = [(-15.1 + 5.8 * k / 9, -79.0 + 4.2 * k) for k in range(10)]
CONES = [(LINE_X, y) for y in (-35.0, -28.5, -22.0, -15.5, -9.0)] + [
    (LINE_X, 1.6), (LINE_X, 2.9), (LINE_X, 4.3), (LINE_X, 9.0), (LINE_X, 12.0), (LINE_X, 20.5), (LINE_X, 26.5),
]  # fmt: skip
"""Cones beside the works. The gaps between the groups are what makes counting by steps of 15 degrees unambiguous."""


def build(stage: Stage) -> None:
    _cones(stage)
    _barriers(stage)
    _machines(stage)
    _crew(stage)
    _fence(stage)


class Moulds:
    """Builds each kind of thing once and hands out linked copies."""

    def __init__(self) -> None:
        self._made: dict[str, Built] = {}

    def get(self, key: str, make) -> Built:  # type: ignore[no-untyped-def]
        if key in self._made:
            return self._made[key].copy()
        self._made[key] = make()
        return self._made[key]


def _cones(stage: Stage) -> None:
    moulds, rng = Moulds(), random.Random("cones")
    for k, (x, y) in enumerate(TAPER + CONES):
        height = 1.0
        built = moulds.get("cone", lambda: works.cone(1.0))
        lean = (rng.uniform(-2.5, 2.5), rng.uniform(-2.5, 2.5))
        stage.place(
            built, "traffic cone", "traffic cone", (x + rng.uniform(-0.06, 0.06), y, 0), rng.uniform(0, 90), lean_deg=lean,
            colour="orange", height_m=height, part_of="taper" if k < len(TAPER) else "lane closure",
        )  # fmt: skip


def _barriers(stage: Stage) -> None:
    moulds = Moulds()
    for k in range(14):
        colour = ("red", "white")[k % 2]
        built = moulds.get(colour, lambda colour=colour: works.water_barrier(colour))
        stage.place(built, "barrier", f"{colour} water-filled barrier", (LINE_X, 33.5 + 1.56 * k, 0), 90, colour=colour, material="plastic", kind="water-filled")
    for k in range(3):
        built = moulds.get("concrete", lambda: works.concrete_barrier(3.0))
        stage.place(built, "barrier", "concrete barrier", (-14.2, -26.5 - 3.1 * k, 0), 90, colour="grey", material="concrete", kind="concrete")
    for x, lit in ((-10.4, True), (-12.9, False)):
        built = moulds.get(f"board {lit}", lambda lit=lit: works.barrier_board(lit=lit))
        stage.place(built, "barrier", "red and white barrier board", (x, 56.5, 0), 0, colour="red and white", state="lit" if lit else "unlit", kind="board")
    for x in (-10.6, -12.8, -15.0):
        built = moulds.get("foot", works.chapter8_barrier)
        stage.place(built, "barrier", "orange pedestrian barrier", (x, -5.8, 0), 0, colour="orange", material="plastic", kind="pedestrian")
    for k in range(5):
        built = moulds.get("drum", works.drum)
        stage.place(built, "drum", "orange traffic drum", (-15.2, -42 + 6.0 * k if k < 2 else 44.0 + 4.0 * (k - 2), 0), 30 * k, colour="orange")


def _machines(stage: Stage) -> None:
    digger = machines.excavator("yellow", number="EX 14", boom_deg=46)
    stage.place(digger, "excavator", "yellow excavator", (-11.4, 34.5, 0), 206, colour="yellow", number="EX 14", state="working")
    roller = machines.roller("yellow", number="R 07")
    stage.place(roller, "roller", "yellow road roller", (-11.3, 13.0, 0), 4, colour="yellow", number="R 07", state="working")


def _crew(stage: Stage) -> None:
    rows = [
        ("yellow", "white", "navy", "clipboard", -13.6, 6.4, 60, "site engineer with a clipboard", "clipboard"),
        ("orange", "yellow", None, "shovel", -12.3, 19.2, 40, "worker with a shovel", "shovel"),
        ("orange", "white", None, "shovel", -10.4, 26.4, 300, "worker with a shovel", "shovel"),
        ("orange", "blue", None, "point", -13.4, 25.2, 20, "pointing worker", None),
        ("yellow", "white", None, "stand", -14.6, 27.0, 80, "standing worker", None),
        ("orange", "orange", None, "kneel", -10.3, 7.0, 190, "kneeling worker", None),
        ("orange", "white", None, "carry", -14.8, 14.8, 350, "worker carrying a load", "load"),
        ("yellow", "red", None, "phone", -35.6, 5.6, 110, "worker on the phone", "phone"),
        ("orange", "yellow", None, "stand", -31.0, -20.0, 10, "standing worker", None),
        ("yellow", "white", None, "walk", -40.0, -9.0, 100, "walking worker", None),
        ("orange", "white", None, "point", -13.3, -16.0, 185, "pointing worker", None),
        ("yellow", "yellow", None, "carry", -12.6, 49.5, 170, "worker carrying a load", "load"),
    ]  # fmt: skip
    for k, (vest, helmet, trousers, pose, x, y, bearing, name, holding) in enumerate(rows):
        built = people.worker(vest=vest, helmet=helmet, trousers=trousers, pose=pose, phase=0.3, seed=k + 3)
        facts = {"carrying": holding} if holding else {}
        area = "compound" if x < -20 else "works"
        stage.place(built, "worker", name, (x, y, 0.0), bearing, vest=vest, helmet=helmet, pose=pose, area=area, **facts)


def _fence(stage: Stage) -> None:
    """Mesh panels round the compound, with a gap for the gate in the north side."""
    moulds = Moulds()
    width = FENCE_PANEL_M[0] + 0.06
    west, east, south, north = COMPOUND

    def panel(x: float, y: float, bearing: float, plate: tuple[str, ...] = ()) -> None:
        built = moulds.get("-".join(plate), lambda: works.mesh_fence_panel(plate))
        facts = {"plate": " ".join(plate).lower()} if plate else {}
        stage.place(built, "fence panel", "mesh fence panel", (x, y, 0), bearing, material="steel", **facts)

    def line(x0: float, y0: float, x1: float, y1: float, bearing: float, signs: dict[int, tuple[str, ...]]) -> None:
        count = round(math.hypot(x1 - x0, y1 - y0) / width)
        for k in range(count):
            t = (k + 0.5) / count
            panel(x0 + (x1 - x0) * t, y0 + (y1 - y0) * t, bearing, signs.get(k, ()))

    line(east, south, east, north, 90, {2: ("DANGER", "KEEP OUT"), 7: ("ALL VISITORS", "REPORT TO OFFICE")})
    line(west, south, west, north, 90, {})
    line(west, south, east, south, 0, {3: ("DANGER", "KEEP OUT")})
    line(west, north, GATE_X - 3.2, north, 180, {1: ("SITE TRAFFIC", "10 MPH")})
    line(GATE_X + 3.2, north, east, north, 180, {})
    stage.place(works.gate(open=True), "gate", "site gate", (GATE_X, north, 0), 0, state="open", material="steel")


GATE_X = -33.0
