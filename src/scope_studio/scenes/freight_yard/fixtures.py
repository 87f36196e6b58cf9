"""Freight yard: the gate and gatehouse, fences, shelters, charge points, and bay number signs."""

from __future__ import annotations

from scope_studio.kit.core.prototypes import Prototypes
from scope_studio.kit.core.stage import Built, Stage
from scope_studio.kit.furniture import roadside
from scope_studio.kit.light import dusk
from scope_studio.kit.vehicles import cycles
from scope_studio.kit.yard import safety as yard_safety
from scope_studio.kit.yard import shelters as yard_shelters
from scope_studio.scenes.freight_yard import ground

GATEHOUSE = (3.0, -39.0)
"""Position (x, y) of the gatehouse in metres."""


def build(stage: Stage) -> None:
    """Place the fixed objects of the yard."""
    _gate(stage)
    _fences(stage)
    _shelters(stage)
    _bay_furniture(stage)


def _gate(stage: Stage) -> None:
    x, y = GATEHOUSE
    house = stage.place(
        yard_shelters.gatehouse(), "gatehouse", "gatehouse", (x, y, 0), 0, colour="grey", state="lit", occupied="yes"
    )
    dusk.lamplight((x, y, 2.72), 110, dusk.WARM, size_m=0.9)
    dusk.lamplight((x - 2.2, y, 2.75), 60, dusk.LED, size_m=0.4)
    dusk.lamplight((x + 2.2, y, 2.75), 60, dusk.LED, size_m=0.4)
    stage.place(
        yard_shelters.barrier_arm(raised=True),
        "barrier arm",
        "raised barrier arm",
        (1.0, -36.0, 0),
        180,
        state="raised",
        colour="red and white",
        lane="in",
    )
    stage.place(
        yard_shelters.barrier_arm(),
        "barrier arm",
        "lowered barrier arm",
        (5.0, -36.0, 0),
        0,
        state="lowered",
        colour="red and white",
        lane="out",
    )
    stage.place(
        yard_shelters.traffic_head("green"),
        "lane signal",
        "green lane signal",
        (0.7, -42.0, 0),
        180,
        parent=house,
        state="lit",
        colour="green",
        lane="in",
    )
    stage.place(
        yard_shelters.traffic_head("red"),
        "lane signal",
        "red lane signal",
        (5.2, -35.0, 0),
        0,
        state="lit",
        colour="red",
        lane="out",
    )
    stage.place(
        yard_safety.sliding_gate(),
        "gate",
        "open sliding gate",
        (-10.4, -45.4, 0),
        0,
        state="open",
        colour="green",
        material="steel",
    )
    stage.place(roadside.cctv_pole(6.4), "camera pole", "camera pole", (11.6, -42.6, 0), 320, colour="grey", height_m=6.4)


def _fences(stage: Stage) -> None:
    """Place the fences. Each run of panels is one instance, and the damaged panel in the west is a separate instance."""
    prototypes = Prototypes()
    step = yard_safety.FENCE_PANEL_LENGTH_M

    def run(name: str, x0: float, y0: float, dx: float, dy: float, count: int, bearing: float, skip: tuple[int, ...] = ()) -> None:
        parts = []
        for k in range(count):
            if k in skip:
                continue
            panel = prototypes.get("panel", yard_safety.chain_link)
            stage.put(panel, (x0 + dx * step * (k + 0.5), y0 + dy * step * (k + 0.5), 0), bearing)
            parts += panel.objects
        built = Built.of(name, [])
        built.objects.extend(parts)
        stage.place(built, "fence", name, (x0, y0, 0), 0, material="steel", kind="chain-link")

    run("southern chain-link fence", -58.0, -46.0, 1, 0, 17, 180)
    run("southern chain-link fence", 12.5, -46.0, 1, 0, 13, 180)
    run("western chain-link fence", -58.0, -46.0, 0, 1, 32, 270, skip=(8,))
    run("eastern chain-link fence", 50.5, -46.0, 0, 1, 32, 90)
    stage.place(
        yard_safety.chain_link(hole=True),
        "fence panel",
        "fence panel with a hole",
        (-58.0, -20.5, 0),
        270,
        material="steel",
        kind="chain-link",
        state="damaged",
    )


def _shelters(stage: Stage) -> None:
    shelter = stage.place(
        yard_shelters.cycle_shelter(), "cycle shelter", "green cycle shelter", (-52.0, -34.0, 0), 90, colour="green", state="lit"
    )
    dusk.lamplight((-51.9, -34.0, 2.25), 40, dusk.LED, size_m=1.0)
    rows = [("red", "town", 1.9), ("blue", "town", 1.2), ("black", "town", -0.4), ("green", "town", -1.2), ("orange", "town", -1.9)]
    prototypes = Prototypes()
    for colour, kind, offset in rows:
        built = cycles.bicycle(colour, kind=kind)
        stage.place(
            built, "bicycle", f"{colour} bicycle", (-52.15, -34.0 - offset, 0), 270, colour=colour, state="parked", parent=shelter
        )
        stage.place(
            prototypes.get("hoop", cycles.bike_stand),
            "bike stand",
            "bike stand",
            (-52.1, -34.0 - offset - 0.22, 0),
            270,
            material="steel",
            parent=shelter,
        )
    smoking = (-30.0, -7.2)
    stage.place(
        yard_shelters.smoking_shelter(), "smoking shelter", "smoking shelter", (*smoking, 0), 180, colour="grey", state="lit"
    )
    dusk.lamplight((smoking[0], smoking[1] - 0.1, 2.12), 40, dusk.WARM, size_m=0.9)
    for name, colour, x in (("FIZZ", "red", -26.6), ("SNAX", "blue", -25.4)):
        stage.place(
            yard_shelters.vending_machine(name, colour),
            "vending machine",
            f"lit {colour} vending machine",
            (x, -7.0, 0),
            180,
            colour=colour,
            state="lit",
            reads=name.lower(),
        )
    dusk.lamplight((-26.0, -7.9, 1.5), 25, dusk.LED, size_m=1.2, aim=(0, -1, -0.4))
    cabinet = stage.place(
        roadside.cabinet(colour="green"),
        "cabinet",
        "green electrical cabinet",
        (-22.4, -7.4, 0),
        180,
        colour="green",
        state="closed",
    )
    plate = yard_safety.notice(["DANGER", "415 VOLTS"], background="yellow", cap=0.075)
    stage.place(
        plate,
        "sign",
        "high voltage sign",
        (-22.4, -7.63, 1.02),
        180,
        parent=cabinet,
        colour="yellow",
        kind="warning",
        reads="danger 415 volts",
    )


def _bay_furniture(stage: Stage) -> None:
    prototypes = Prototypes()
    for row, y, bearing in ((ground.ROW_A, -11.75, 180.0), (ground.ROW_B, -29.25, 0.0), (ground.VISITORS, -44.3, 0.0)):
        for x, number in row:
            background = "green" if number in ground.CHARGING_BAYS else "yellow" if row is ground.VISITORS else "blue"
            stage.place(
                yard_safety.bay_plate(number, background=background),
                "bay number",
                f"bay number {number}",
                (x, y, 0),
                bearing,
                number=number,
                colour=background,
            )
            side = -1 if bearing == 0.0 else 1
            stage.place(
                prototypes.get("stop", yard_safety.wheel_stop),
                "wheel stop",
                "wheel stop",
                (x, y - 0.55 * side, 0),
                bearing,
                colour="yellow and black",
            )
    for y, number in ground.TRAILER_BAYS:
        stage.place(
            yard_safety.bay_plate(number, background="yellow"),
            "bay number",
            f"bay number {number}",
            (-40.6, y - 1.75, 0),
            90,
            number=number,
            colour="yellow",
        )
    for number, state in (("21", "green"), ("22", "red"), ("23", "unlit")):
        x = next(x for x, n in ground.ROW_A if n == number)
        attributes = {"state": "unlit"} if state == "unlit" else {"state": "lit", "colour": state}
        stage.place(
            yard_shelters.charge_point(state, number=number),
            "charging point",
            f"{state} charging point" if state != "unlit" else "unlit charging point",
            (x + 0.75, -11.55, 0),
            180,
            bay=number,
            light=state,
            **attributes,
        )
