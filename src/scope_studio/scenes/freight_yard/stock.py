"""Freight yard: container stacks, and the goods and equipment around them."""

from __future__ import annotations

import random

from scope_studio.kit.core.prototypes import Prototypes
from scope_studio.kit.core.stage import Built, Stage
from scope_studio.kit.works import barriers, equipment, materials, site_units
from scope_studio.kit.yard import containers
from scope_studio.kit.yard import goods as yard_goods
from scope_studio.kit.yard import safety as yard_safety

STACKS = (
    (20, 20.5, -14.5, (("blue", "KVRU 482915 3", "KESTREL"), ("dark red", "TSLU 610382 7", None))),
    (
        20,
        20.5,
        -11.7,
        (("orange", "MBOU 274406 1", None), ("light grey", "KVRU 482951 3", None), ("blue", "KVRU 482915 8", "KESTREL")),
    ),
    (20, 20.5, -8.9, (("dark green", "TSLU 730614 2", "TESSALINE"),)),
    (20, 27.4, -14.5, (("yellow", "ORTU 918823 5", "ORTIS"),)),
    (20, 27.4, -11.7, (("dark red", "MBOU 274460 1", "MARBO"), ("green", "TSLU 730164 9", "TESSALINE"))),
    (20, 27.4, -8.9, (("blue", "KVRU 509127 4", None), ("cream", "ORTU 918832 5", "ORTIS"), ("dark red", "MBOU 331175 0", None))),
    (40, 38.0, -14.5, (("green", "TSLU 845520 6", "TESSALINE"), ("blue", "KVRU 771203 9", "KESTREL"))),
    (
        40,
        38.0,
        -11.7,
        (("orange", "MBOU 660918 3", "MARBO"), ("dark red", "MBOU 660981 3", "MARBO"), ("light grey", "ORTU 402277 8", "ORTIS")),
    ),
    (40, 38.0, -8.9, (("dark red", "MBOU 118346 2", "MARBO"), ("yellow", "ORTU 402727 8", "ORTIS"))),
    (40, 38.0, -29.5, (("blue", "KVRU 315588 0", "KESTREL"), ("orange", "MBOU 590043 7", "MARBO"))),
    (20, 41.0, -26.7, (("light grey", "ORTU 226190 4", None),)),
    (40, 40.0, 0.5, (("dark green", "TSLU 187734 1", "TESSALINE"),)),
)
"""Stacks: length in feet, x, y, and the (colour, code, livery) of each container from the ground up."""


def build(stage: Stage) -> None:
    """Place containers, goods, equipment and bollards."""
    _containers(stage)
    _goods(stage)
    _equipment(stage)
    _barriers(stage)


def _containers(stage: Stage) -> None:
    rng = random.Random("stacks")
    for feet, x, y, tiers in STACKS:
        for level, (colour, code, livery) in enumerate(tiers):
            built = containers.container(colour, code, feet=feet, livery=livery)
            position = (x + rng.uniform(-0.05, 0.05), y + rng.uniform(-0.04, 0.04), 0.004 + containers.HEIGHT_M * level)
            attributes = {"livery": livery.lower()} if livery else {}
            stage.place(
                built,
                "container",
                f"{colour} container",
                position,
                270 + (180 if feet == 40 else 0),
                colour=colour,
                number=code,
                length_ft=feet,
                state="closed",
                level=level + 1,
                **attributes,
            )
    for colour, code, x, y, bearing, load in (
        ("dark red", "MBOU 455071 9", 21.5, -28.6, 262.0, None),
        ("blue", "KVRU 482519 3", 21.8, -24.4, 272.0, "cartons"),
    ):
        built = containers.container(colour, code, doors="open", load=load, livery="MARBO" if colour == "dark red" else "KESTREL")
        stage.place(
            built,
            "container",
            f"open {colour} container",
            (x, y, 0.004),
            bearing,
            colour=colour,
            number=code,
            length_ft=20,
            state="open",
            contents=load or "empty",
            level=1,
        )


def _goods(stage: Stage) -> None:
    prototypes = Prototypes()
    for n, (x, y, count) in enumerate(((25.6, 25.0, 9), (27.2, 25.4, 12), (25.8, 22.6, 5), (-27.9, 10.6, 7))):
        stage.place(
            prototypes.get(f"stack {count}", lambda count=count, n=n: yard_goods.pallet_stack(count, seed=n)),
            "pallet stack",
            "stack of empty pallets",
            (x, y, 0),
            4 * n - 3,
            material="timber",
            pallets=count,
        )
    loads = [
        ("cartons", "BATCH 14", True, 15.6, 25.4, 184),
        ("cartons", "BATCH 41", True, 17.1, 25.7, 178),
        ("crates", None, False, 15.5, 23.4, 90),
        ("sacks", None, False, 29.6, 22.0, 12),
        ("sacks", None, True, 31.2, 22.4, 6),
        ("cartons", None, False, 18.6, -26.4, 200),
        ("crates", None, True, -14.6, 9.2, 95),
        ("cartons", "RETURNS", True, -16.4, 9.0, 178),
    ]
    for n, (kind, label, wrapped, x, y, bearing) in enumerate(loads):
        attributes = {"label": label.lower()} if label else {}
        built = yard_goods.pallet_load(kind, label=label, wrapped=wrapped, seed=n)
        stage.place(
            built, "pallet", f"pallet of {kind}", (x, y, 0), bearing, load=kind, wrapped="yes" if wrapped else "no", **attributes
        )
    for k in range(11):
        colour = "red" if k in (3, 7, 8) else "blue"
        fallen = k == 10
        built = prototypes.get(f"drum {colour}", lambda colour=colour: yard_goods.steel_drum(colour))
        position = (15.8 + 0.72 * k, 8.4, 0.0) if not fallen else (24.2, 7.3, 0.29)
        stage.place(
            built,
            "drum",
            f"{colour} drum",
            position,
            170 + 17 * (k % 3) if not fallen else 40,
            lean_deg=(90, 0) if fallen else (0, 0),
            colour=colour,
            material="steel",
            state="fallen" if fallen else "upright",
        )
    for n, (x, y) in enumerate(((35.0, 21.6), (36.5, 21.7), (35.1, 20.2))):
        stage.place(
            yard_goods.tank(f"TANK {n + 4}"),
            "liquid container",
            "white liquid container",
            (x, y, 0),
            184 - 3 * n,
            colour="white",
            number=str(n + 4),
        )
    for n, (x, y, count) in enumerate(((33.2, 26.0, 5), (34.5, 26.2, 3), (33.9, 24.8, 2))):
        stage.place(
            yard_goods.tyre_stack(count, seed=n), "tyre stack", "stack of tyres", (x, y, 0), 40 * n, tyres=count, colour="black"
        )
    for n, (x, y, bearing, is_open) in enumerate(
        (
            (18.2, -25.2, 20, False),
            (18.9, -24.2, 70, True),
            (18.1, -24.0, 10, False),
            (19.3, -25.4, 45, False),
            (17.4, -24.8, 0, True),
        )
    ):
        stage.place(
            yard_goods.carton(seed=n, is_open=is_open),
            "box",
            "cardboard box",
            (x, y, 0.004),
            bearing,
            material="cardboard",
            state="open" if is_open else "closed",
        )
    stage.place(yard_goods.carton(seed=7), "box", "cardboard box", (18.15, -24.0, 0.43), 34, material="cardboard", state="closed")


def _equipment(stage: Stage) -> None:
    rows: list[tuple[Built, str, str, float, float, float, dict[str, str]]] = [
        (yard_goods.gas_cage(), "gas cage", "cage of gas cylinders", 30.6, 27.6, 180, {"material": "steel", "state": "closed"}),
        (site_units.skip("yellow"), "skip", "yellow skip", 45.0, 24.0, 95, {"colour": "yellow", "state": "full"}),
        (site_units.skip("blue", full=False), "skip", "blue skip", 41.0, 26.2, 88, {"colour": "blue", "state": "empty"}),
        (materials.cable_drum(1.6), "cable drum", "wooden cable drum", 39.2, 19.0, 30, {"material": "timber"}),
        (materials.cable_drum(1.2), "cable drum", "wooden cable drum", 37.6, 17.4, 75, {"material": "timber"}),
        (materials.pipe_stack("grey", length=5.0), "pipe stack", "stack of grey pipes", 44.5, 14.0, 10, {"colour": "grey"}),
        (yard_safety.spill_kit(), "spill kit", "yellow spill kit", 27.4, 28.9, 180, {"colour": "yellow"}),
        (materials.fire_extinguisher(), "fire extinguisher", "red fire extinguisher", 18.9, 29.6, 180, {"colour": "red"}),
        (materials.fire_extinguisher(), "fire extinguisher", "red fire extinguisher", -6.6, -9.6, 200, {"colour": "red"}),
        (yard_goods.ladder(), "ladder", "aluminium ladder", -28.4, 30.0, 180, {"material": "aluminium"}),
        (yard_safety.hydrant(), "fire hydrant", "red fire hydrant", -12.9, -8.4, 180, {"colour": "red"}),
        (equipment.generator("green"), "generator", "green generator", 45.6, 7.0, 92, {"colour": "green"}),
        (
            equipment.wheelbarrow("green", load=False),
            "wheelbarrow",
            "green wheelbarrow",
            42.0,
            21.0,
            140,
            {"colour": "green", "state": "empty"},
        ),
    ]
    for built, category, name, x, y, bearing, attributes in rows:
        stage.place(built, category, name, (x, y, 0), bearing, **attributes)
    stage.place(yard_safety.hose_reel(), "hose reel", "red hose reel", (27.3, 30.0, 1.5), 180, colour="red")
    for colour, x, y, is_open, label in (
        ("green", 32.4, 29.4, False, "FOOD WASTE"),
        ("green", 34.0, 29.3, True, None),
        ("blue", 35.7, 29.5, False, "PAPER"),
        ("blue", 37.3, 29.4, False, "GLASS"),
        ("dark grey", 38.9, 29.2, False, None),
    ):
        attributes = {"label": label.lower()} if label else {}
        stage.place(
            yard_goods.wheelie_bin(colour, is_open=is_open, label=label),
            "wheelie bin",
            f"{colour} wheelie bin",
            (x, y, 0),
            180,
            colour=colour,
            state="open" if is_open else "closed",
            **attributes,
        )


def _barriers(stage: Stage) -> None:
    """Place bollards, concrete barriers, water-filled barriers and cones."""
    prototypes = Prototypes()
    bollards = [
        (19.2, 28.9),
        (24.8, 28.9),
        (15.6, 28.9),
        (-36.9, 25.6),
        (-42.6, 25.6),
        (0.7, -36.8),
        (5.3, -36.8),
        (0.7, -41.2),
        (5.3, -41.2),
    ]
    bollards += [(-20.7 + 2.6 * k, -11.2) for k in range(3)] + [(-9.9, 3.2), (-12.5, 3.2), (28.6, 29.2)]
    for x, y in bollards:
        stage.place(
            prototypes.get("bollard", yard_safety.yard_bollard),
            "bollard",
            "yellow bollard",
            (x, y, 0),
            30 * x,
            colour="yellow",
            material="steel",
        )
    for k in range(4):
        stage.place(
            prototypes.get("block", lambda: barriers.concrete_barrier(3.0)),
            "barrier",
            "concrete barrier",
            (14.4, -31.5 + 3.15 * k, 0),
            0,
            colour="grey",
            material="concrete",
            kind="concrete",
        )
    for k in range(3):
        colour = ("red", "white")[k % 2]
        stage.place(
            prototypes.get(colour, lambda colour=colour: barriers.water_barrier(colour)),
            "barrier",
            f"{colour} water-filled barrier",
            (1.2 + 1.6 * k, 25.6, 0),
            180,
            colour=colour,
            material="plastic",
            kind="water-filled",
        )
    cones = [
        (0.4, 23.8),
        (1.9, 23.2),
        (3.4, 23.1),
        (4.9, 23.4),
        (6.1, 24.2),
        (-3.4, -22.4),
        (15.4, -3.0),
        (16.9, -2.4),
        (18.4, -3.2),
    ]
    for k, (x, y) in enumerate(cones):
        stage.place(
            prototypes.get("cone", barriers.cone),
            "traffic cone",
            "traffic cone",
            (x, y, 0),
            25 * k,
            colour="orange",
            state="upright",
        )
    stage.place(
        prototypes.get("cone", barriers.cone),
        "traffic cone",
        "fallen traffic cone",
        (13.3, -18.2, 0.17),
        70,
        lean_deg=(86, 0),
        colour="orange",
        state="fallen",
    )
