"""Highway works: the closed lane with its cones, machines and crew, and the compound behind the verge."""

from __future__ import annotations

import math
import random

from scope_studio.kit.core.prototypes import Prototypes
from scope_studio.kit.core.stage import Built, Stage
from scope_studio.kit.people import characters
from scope_studio.kit.vehicles import excavator, machines
from scope_studio.kit.works import barriers, equipment, fencing, materials, site_units
from scope_studio.kit.works.fencing import FENCE_PANEL_SIZE_M
from scope_studio.scenes.highway_works.land import COMPOUND

GATE_X = -33.0
"""x coordinate of the centre of the compound's gate."""
LINE_X = -9.3
"""x coordinate of the line of cones and barriers between the works and the traffic."""

TAPER = [(-15.1 + 5.8 * k / 9, -79.0 + 4.2 * k) for k in range(10)]
"""Positions of the cones that guide traffic out of the closed lane."""
CONES = [(LINE_X, y) for y in (-35.0, -28.5, -22.0, -15.5, -9.0, -2.5, 7.2, 10.8, 27.0, 31.0)]
"""Positions of the cones along the closed lane."""
RESERVE_CONES = [(-1.72, y) for y in (9.2, 11.3, 13.5)]
"""Positions of the cones on the central reserve, next to the works and a damaged guardrail.

From the preset "highway", pan steps of 15 degrees to the right show two, four and seven of them. In these views, no cone is near
the edge of the frame or partly hidden.
"""


def build(stage: Stage) -> None:
    """Place the works and the compound."""
    _cones(stage)
    _barriers(stage)
    _machines(stage)
    _crew(stage)
    _fence(stage)
    _compound(stage)
    _materials(stage)


def _cones(stage: Stage) -> None:
    prototypes, rng = Prototypes(), random.Random("cones")
    for k, (x, y) in enumerate(TAPER + CONES + RESERVE_CONES):
        part = "taper" if k < len(TAPER) else "lane closure" if x < -2 else "reserve repair"
        built = prototypes.get("cone", lambda: barriers.cone(1.0))
        lean = (rng.uniform(-2.5, 2.5), rng.uniform(-2.5, 2.5))
        stage.place(
            built,
            "traffic cone",
            "traffic cone",
            (x + rng.uniform(-0.06, 0.06), y, 0),
            rng.uniform(0, 90),
            lean_deg=lean,
            colour="orange",
            height_m=1.0,
            part_of=part,
        )


def _barriers(stage: Stage) -> None:
    prototypes = Prototypes()
    for k in range(14):
        colour = ("red", "white")[k % 2]
        built = prototypes.get(colour, lambda colour=colour: barriers.water_barrier(colour))
        stage.place(
            built,
            "barrier",
            f"{colour} water-filled barrier",
            (LINE_X, 33.5 + 1.56 * k, 0),
            90,
            colour=colour,
            material="plastic",
            kind="water-filled",
        )
    for k in range(3):
        built = prototypes.get("concrete", lambda: barriers.concrete_barrier(3.0))
        stage.place(
            built,
            "barrier",
            "concrete barrier",
            (-14.6, -26.5 - 3.1 * k, 0),
            0,
            colour="grey",
            material="concrete",
            kind="concrete",
        )
    for x, lit in ((-10.4, True), (-12.9, False)):
        built = prototypes.get(f"board {lit}", lambda lit=lit: barriers.barrier_board(lit=lit))
        stage.place(
            built,
            "barrier",
            "red and white barrier board",
            (x, 56.5, 0),
            0,
            colour="red and white",
            state="lit" if lit else "unlit",
            kind="board",
        )
    for x in (-10.6, -12.8, -15.0):
        built = prototypes.get("foot", barriers.chapter8_barrier)
        stage.place(
            built, "barrier", "orange pedestrian barrier", (x, -5.8, 0), 0, colour="orange", material="plastic", kind="pedestrian"
        )
    for k in range(5):
        built = prototypes.get("drum", barriers.drum)
        stage.place(
            built,
            "drum",
            "orange traffic drum",
            (-15.2, -42 + 6.0 * k if k < 2 else 44.0 + 4.0 * (k - 2), 0),
            30 * k,
            colour="orange",
        )


def _machines(stage: Stage) -> None:
    digger = excavator.excavator("yellow", number="EX 14", boom_deg=46)
    stage.place(digger, "excavator", "yellow excavator", (-11.4, 34.5, 0), 206, colour="yellow", number="EX 14", state="working")
    roller = machines.roller("yellow", number="R 07")
    stage.place(roller, "roller", "yellow road roller", (-11.3, 13.0, 0), 4, colour="yellow", number="R 07", state="working")


def _crew(stage: Stage) -> None:
    rows = [
        ("yellow", "white", "navy", "clipboard", -14.2, 6.2, 60, "site engineer with a clipboard", "clipboard"),
        ("orange", "yellow", None, "shovel", -12.3, 19.2, 40, "worker with a shovel", "shovel"),
        ("orange", "white", None, "shovel", -11.3, 27.6, 300, "worker with a shovel", "shovel"),
        ("orange", "blue", None, "point", -13.4, 25.2, 20, "pointing worker", None),
        ("yellow", "white", None, "stand", -14.6, 27.0, 80, "standing worker", None),
        ("orange", "orange", None, "kneel", -11.6, 25.0, 250, "kneeling worker", None),
        ("orange", "white", None, "carry", -14.8, 14.8, 350, "worker carrying a load", "load"),
        ("yellow", "red", None, "phone", -35.6, 5.6, 110, "worker on the phone", "phone"),
        ("orange", "yellow", None, "stand", -30.6, -17.2, 60, "standing worker", None),
        ("yellow", "white", None, "walk", -37.6, -9.4, 100, "walking worker", None),
        ("orange", "white", None, "point", -13.3, -16.0, 185, "pointing worker", None),
        ("yellow", "yellow", None, "carry", -12.6, 49.5, 170, "worker carrying a load", "load"),
    ]
    for k, (vest, helmet, trousers, pose, x, y, bearing, name, holding) in enumerate(rows):
        built = characters.worker(vest=vest, helmet=helmet, trousers=trousers, pose=pose, phase=0.3, seed=k + 3)
        attributes = {"carrying": holding} if holding else {}
        area = "compound" if x < -20 else "works"
        stage.place(built, "worker", name, (x, y, 0.0), bearing, vest=vest, helmet=helmet, pose=pose, area=area, **attributes)


def _fence(stage: Stage) -> None:
    """Place mesh panels around the compound, with a gap for the gate in the north side."""
    prototypes = Prototypes()
    width = FENCE_PANEL_SIZE_M[0] + 0.06
    west, east, south, north = COMPOUND

    def panel(x: float, y: float, bearing: float, plate: tuple[str, ...] = ()) -> None:
        built = prototypes.get("-".join(plate), lambda: fencing.mesh_fence_panel(plate))
        attributes = {"plate": " ".join(plate).lower()} if plate else {}
        stage.place(built, "fence panel", "mesh fence panel", (x, y, 0), bearing, material="steel", **attributes)

    def line(x0: float, y0: float, x1: float, y1: float, bearing: float, signs: dict[int, tuple[str, ...]]) -> None:
        count = round(math.hypot(x1 - x0, y1 - y0) / width)
        for k in range(count):
            t = (k + 0.5) / count
            panel(x0 + (x1 - x0) * t, y0 + (y1 - y0) * t, bearing, signs.get(k, ()))

    line(east, south, east, north, 90, {1: ("DANGER", "KEEP OUT"), 6: ("ALL VISITORS", "REPORT TO OFFICE")})
    line(west, south, west, north, 90, {})
    line(west, south, east, south, 0, {3: ("DANGER", "KEEP OUT")})
    line(west, north, GATE_X - 3.2, north, 180, {1: ("SITE TRAFFIC", "10 MPH")})
    line(GATE_X + 3.2, north, east, north, 180, {})
    stage.place(fencing.gate(is_open=True), "gate", "site gate", (GATE_X, north, 0), 0, state="open", material="steel")


def _compound(stage: Stage) -> None:
    for colour, text, x, y, z, bearing in (
        ("light grey", "SITE OFFICE", -42.0, -5.5, 0.0, 90),
        ("green", "CANTEEN", -42.0, -13.5, 0.0, 90),
        ("blue", "MEETING ROOM", -42.0, -5.5, 2.72, 90),
        ("light grey", "STORES", -34.6, -22.4, 0.0, 22),
    ):
        noun = colour.replace("light ", "")
        stage.place(
            site_units.site_cabin(colour, text),
            "cabin",
            f"{noun} site cabin",
            (x, y, z),
            bearing,
            colour=noun,
            reads=text.lower(),
            upper=z > 0,
        )
    for colour, x, bearing in (("blue", -37.4, 140), ("green", -38.9, 150)):
        stage.place(
            site_units.portable_toilet(colour),
            "portable toilet",
            f"{colour} portable toilet",
            (x, 2.2, 0),
            bearing,
            colour=colour,
            state="closed",
        )
    rows: list[tuple[Built, str, str, float, float, float, dict[str, str]]] = [
        (site_units.skip("yellow"), "skip", "yellow skip", -28.0, -21.0, 70, {"colour": "yellow", "state": "full"}),
        (site_units.skip("blue", full=False), "skip", "blue skip", -24.6, -18.2, 10, {"colour": "blue", "state": "empty"}),
        (equipment.generator("green"), "generator", "green generator", -38.6, -19.0, 95, {"colour": "green"}),
        (
            equipment.light_tower(lit=False),
            "light tower",
            "lighting tower",
            -39.6,
            -21.6,
            200,
            {"colour": "yellow", "state": "unlit"},
        ),
        (equipment.light_tower(lit=True), "light tower", "lighting tower", -14.3, 52.5, 160, {"colour": "yellow", "state": "lit"}),
        (
            equipment.arrow_board("right"),
            "arrow board",
            "lit arrow board",
            -12.6,
            -60.5,
            180,
            {"state": "lit", "direction": "right"},
        ),
        (equipment.arrow_board("right", lit=False), "arrow board", "dark arrow board", -14.2, -36.5, 0, {"state": "unlit"}),
        (equipment.plate_compactor(), "plate compactor", "yellow plate compactor", -14.7, 10.3, 130, {"colour": "yellow"}),
        (
            equipment.wheelbarrow("green"),
            "wheelbarrow",
            "green wheelbarrow",
            -27.8,
            -6.6,
            200,
            {"colour": "green", "state": "full"},
        ),
        (
            equipment.wheelbarrow("red", load=False),
            "wheelbarrow",
            "red wheelbarrow",
            -14.7,
            18.6,
            300,
            {"colour": "red", "state": "empty"},
        ),
        (materials.toolbox("red"), "toolbox", "red toolbox", -14.4, 8.3, 60, {"colour": "red"}),
        (materials.fuel_can("red"), "fuel can", "red fuel can", -37.0, -18.1, 20, {"colour": "red"}),
        (materials.fuel_can("green"), "fuel can", "green fuel can", -14.9, 12.0, 70, {"colour": "green"}),
        (materials.fire_extinguisher(), "fire extinguisher", "red fire extinguisher", -27.2, -1.9, 120, {"colour": "red"}),
    ]
    for built, category, name, x, y, bearing, attributes in rows:
        stage.place(built, category, name, (x, y, 0), bearing, **attributes)


def _materials(stage: Stage) -> None:
    prototypes = Prototypes()
    for x, y, bearing in ((-29.4, -9.0, 8), (-29.2, -11.0, 2), (-31.2, -9.6, 95), (-20.2, 33.0, 12), (-20.6, 35.2, 4)):
        stage.place(
            prototypes.get("kerbs", materials.pallet_of_kerbs),
            "pallet",
            "pallet of kerb stones",
            (x, y, 0),
            bearing,
            material="concrete",
            load="kerb stones",
        )
    for x, y, bearing in ((-33.4, -17.6, 30), (-32.0, -18.6, 18)):
        stage.place(
            prototypes.get("cement", materials.cement_bags),
            "pallet",
            "pallet of cement bags",
            (x, y, 0),
            bearing,
            load="cement bags",
        )
    for colour, x, y, bearing, length in (
        ("orange", -27.6, -15.2, 78, 6.0),
        ("grey", -21.8, 45.5, 12, 6.0),
        ("blue", -19.4, 49.6, 5, 4.0),
    ):
        stage.place(
            materials.pipe_stack(colour, length=length), "pipe stack", f"stack of {colour} pipes", (x, y, 0), bearing, colour=colour
        )
    stage.place(materials.cable_drum(1.6), "cable drum", "wooden cable drum", (-25.0, -5.6, 0), 35, material="timber")
    stage.place(materials.cable_drum(1.2), "cable drum", "wooden cable drum", (-24.3, -7.4, 0), 70, material="timber")
    stage.place(materials.sand_pile(1.9), "sand pile", "pile of sand", (-26.6, -3.8, -0.03), 0, material="sand")
    stage.place(materials.gravel_pile(2.6), "gravel pile", "pile of gravel", (-21.4, 28.0, -0.03), 40, material="gravel")
    stage.place(materials.gravel_pile(1.7), "gravel pile", "pile of gravel", (-21.9, 38.6, -0.03), 110, material="gravel")
    stage.place(materials.standing_shovel(), "shovel", "shovel", (-26.0, -3.6, 0.55), 30)
