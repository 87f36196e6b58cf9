"""Highway works: vehicles in the open lanes, at the works and in the lorry park, and the moving actors."""

from __future__ import annotations

from collections.abc import Callable

from scope_studio.kit.core.paths import closed_loop
from scope_studio.kit.core.stage import ActorPath, Built, Stage
from scope_studio.kit.people import characters
from scope_studio.kit.vehicles import cars, coach, lorries

LANE_1, LANE_2, LANE_3 = 10.75, 7.25, 3.75
"""Distances in metres of the lane centres from the centre line of the road. One lane in each direction has only moving vehicles."""

FIRST_ACTOR = 9001
"""Number of the first actor in instance masks. All static instances have smaller numbers."""

CarBuilder = Callable[..., Built]

CARS: list[tuple[CarBuilder, str, str, float, float]] = [
    # Northbound: lane 3, and lane 1 before the taper. Only the moving car uses lane 2.
    (cars.hatchback, "red", "KV19 RTO", -LANE_3, 38.5),
    (cars.saloon, "silver", "MB68 WLN", -LANE_3, 21.0),
    (cars.suv, "black", "OE21 HXD", -LANE_3, 66.0),
    (cars.suv, "light blue", "YP70 CKA", -LANE_3, -31.0),
    (cars.hatchback, "yellow", "FN17 ZBE", -LANE_3, -66.0),
    (cars.saloon, "grey", "LD22 UMS", -LANE_3, -98.0),
    (cars.saloon, "dark red", "SR16 JVY", -LANE_1, -88.0),
    # Southbound
    (cars.suv, "green", "HG20 TPW", LANE_2, 58.0),
    (cars.saloon, "white", "VO69 EDK", LANE_2, 29.0),
    (cars.hatchback, "dark red", "CU15 NLR", LANE_2, 5.0),
    (cars.hatchback, "orange", "PJ71 AXG", LANE_1, -11.0),
    (cars.saloon, "blue", "DT18 OFC", LANE_2, -47.0),
    (cars.saloon, "black", "WA23 KZH", LANE_1, -58.0),
    (cars.suv, "silver", "BX67 VMJ", LANE_2, -88.0),
    (cars.suv, "brown", "GM19 YEU", LANE_2, 104.0),
]
CAR_NOUNS: dict[CarBuilder, str] = {cars.saloon: "saloon", cars.hatchback: "hatchback", cars.suv: "SUV"}


def build(stage: Stage) -> None:
    """Place the vehicles that do not move, and add the actors with their paths."""
    _cars(stage)
    _lorries_and_coaches(stage)
    _yard(stage)
    _works_vehicles(stage)
    _actors(stage)


def _lane_attributes(x: float) -> tuple[float, dict[str, str | int]]:
    """Return the bearing and attributes of a vehicle in the lane at ``x``."""
    lane = 1 + round((LANE_1 - abs(x)) / 3.5)
    heading = "north" if x < 0 else "south"
    return (0.0 if x < 0 else 180.0), {"state": "moving", "facing": heading, "lane": lane, "carriageway": f"{heading}bound"}


def _cars(stage: Stage) -> None:
    for make, colour, plate, x, y in CARS:
        bearing, attributes = _lane_attributes(x)
        noun = CAR_NOUNS[make]
        stage.place(
            make(colour, plate=plate),
            "car",
            f"{colour} {noun}",
            (x, y, 0),
            bearing,
            colour=colour,
            kind=noun.lower(),
            plate=plate,
            **attributes,
        )
    for colour, plate, lettering, x, y in (
        ("blue", "EK66 PRB", "Corvane\nPLUMBING", -LANE_3, -13.0),
        ("grey", "RF20 LWS", "NORTHLINE\nCOURIERS", LANE_2, -22.0),
    ):
        bearing, attributes = _lane_attributes(x)
        van = cars.van(colour, plate=plate, lettering=lettering)
        stage.place(van, "van", f"{colour} van", (x, y, 0), bearing, colour=colour, plate=plate, **attributes)


def _lorries_and_coaches(stage: Stage) -> None:
    rows = [
        (
            lorries.box_lorry("red", "white", plate="AY18 GTF", lettering="DRAYCOTT FOODS"),
            "lorry",
            "red and white box lorry",
            "red",
            "box lorry",
            -LANE_1,
            103.0,
        ),
        (
            lorries.tanker("blue", plate="NU70 HKD", lettering="PETRONELL"),
            "lorry",
            "blue tanker",
            "blue",
            "tanker",
            -LANE_1,
            -100.0,
        ),
        (
            coach.coach("dark green", plate="JC19 XPO", lettering="Linnet Coaches", destination="EXPRESS 7"),
            "bus",
            "green coach",
            "green",
            "coach",
            -LANE_1,
            -118.0,
        ),
        (
            coach.coach("white", plate="BT65 SVA", lettering="SKYLARK", destination="HARROWFIELD"),
            "bus",
            "white coach",
            "white",
            "coach",
            LANE_1,
            41.0,
        ),
        (
            lorries.box_lorry("dark green", "light grey", plate="OV21 RNC", lettering="HALLAM & SONS"),
            "lorry",
            "green box lorry",
            "green",
            "box lorry",
            LANE_1,
            14.0,
        ),
        (lorries.tipper("blue", "grey", plate="KE17 UDM"), "lorry", "blue tipper lorry", "blue", "tipper", LANE_1, -33.0),
        (
            lorries.box_lorry("white", "blue", plate="PX68 JTL", lettering="TIDEWAY"),
            "lorry",
            "blue box lorry",
            "blue",
            "box lorry",
            LANE_1,
            -78.0,
        ),
    ]
    for built, category, name, colour, kind, x, y in rows:
        bearing, attributes = _lane_attributes(x)
        stage.place(built, category, name, (x, y, 0), bearing, colour=colour, kind=kind, **attributes)


def _yard(stage: Stage) -> None:
    """Place staff cars in their bays, and lorries at the docks."""
    bays = [
        (cars.hatchback, "white", "YT14 BNA", -31.2),
        (cars.saloon, "red", "LO12 FKS", -26.0),
        (cars.suv, "grey", "EA22 CPD", -18.2),
        (cars.hatchback, "blue", "MJ63 VRE", -15.6),
        (cars.saloon, "black", "RK70 OLT", 2.6),
        (cars.hatchback, "silver", "BD16 HWX", 10.4),
        (cars.suv, "red", "AF19 UZN", 13.0),
    ]
    for make, colour, plate, y in bays:
        noun = CAR_NOUNS[make]
        stage.place(
            make(colour, plate=plate),
            "car",
            f"{colour} {noun}",
            (48.2, y, 0.01),
            90,
            colour=colour,
            kind=noun.lower(),
            plate=plate,
            state="parked",
            facing="east",
        )
    docked_lorries = [
        (
            lorries.box_lorry("yellow", "white", plate="NX20 GSM", lettering="MERIDIAN"),
            "yellow and white box lorry",
            "yellow",
            10.8,
        ),
        (lorries.box_lorry("blue", "blue", plate="NX20 GSP", lettering="MERIDIAN"), "blue box lorry", "blue", 24.9),
    ]
    for built, name, colour, y in docked_lorries:
        stage.place(built, "lorry", name, (56.2, y, 0.01), -90, colour=colour, kind="box lorry", state="parked", facing="west")


def _works_vehicles(stage: Stage) -> None:
    tipper = lorries.tipper("orange", "yellow", plate="VK69 BRO")
    stage.place(
        tipper,
        "lorry",
        "orange tipper lorry",
        (-13.9, 43.5, 0),
        4,
        colour="orange",
        kind="tipper",
        state="parked",
        facing="north",
        area="works",
    )
    van = cars.van("yellow", plate="WU20 KDF", lettering="CASTELL\nHIGHWAYS", roof_beacon=True)
    stage.place(
        van,
        "van",
        "yellow works van",
        (-14.0, -20.0, 0),
        0,
        colour="yellow",
        state="parked",
        facing="north",
        lettering="castell highways",
        area="works",
    )
    pickup = cars.pickup("white", plate="GN71 OAH", beacon=True)
    stage.place(
        pickup,
        "pickup truck",
        "white pickup truck",
        (-33.5, -5.0, 0),
        168,
        colour="white",
        state="parked",
        facing="south",
        area="compound",
    )
    second_pickup = cars.pickup("dark blue", plate="SH18 TEW")
    stage.place(
        second_pickup,
        "pickup truck",
        "dark blue pickup truck",
        (-13.9, -47.0, 0),
        0,
        colour="dark blue",
        state="parked",
        facing="north",
        area="works",
    )
    car = cars.hatchback("grey", plate="DP15 LXC")
    stage.place(
        car,
        "car",
        "grey hatchback",
        (-36.2, -14.0, 0),
        75,
        colour="grey",
        kind="hatchback",
        plate="DP15 LXC",
        state="parked",
        facing="east",
        area="compound",
    )


def _actors(stage: Stage) -> None:
    speed = 17.0
    stage.actors = [
        ActorPath(
            "moving-car-01",
            FIRST_ACTOR,
            "car",
            "dark blue saloon",
            lambda _phase: cars.saloon("dark blue", plate="HX20 DLM"),
            [(0.0, -LANE_2, -120.0, 0.0), (240.0 / speed, -LANE_2, 120.0, 0.0)],
            30.0,
            {"colour": "dark blue", "kind": "saloon", "state": "moving", "facing": "north", "lane": 2, "carriageway": "northbound"},
        ),
        ActorPath(
            "moving-van-01",
            FIRST_ACTOR + 1,
            "van",
            "white van",
            lambda _phase: cars.van("white", plate="OB69 JNR", lettering="Brightwell\nBAKERY"),
            [(8.0, LANE_3, 120.0, 0.0), (8.0 + 240.0 / 15.0, LANE_3, -120.0, 0.0)],
            36.0,
            {"colour": "white", "state": "moving", "facing": "south", "lane": 3, "carriageway": "southbound"},
        ),
        ActorPath(
            "moving-worker-01",
            FIRST_ACTOR + 2,
            "worker",
            "walking worker",
            lambda phase: characters.worker(vest="yellow", helmet="blue", trousers="navy", pose="walk", phase=phase, seed=71),
            closed_loop([(-13.2, -1.0), (-13.2, 16.6), (-9.95, 17.2), (-9.95, 22.0), (-13.2, 23.4)], 1.3),
            41.0,
            {"vest": "yellow", "helmet": "blue", "state": "walking", "area": "works"},
            stride_m=1.32,
        ),
    ]
    for actor in stage.actors:
        if actor.stride_m:
            actor.period_s = actor.waypoints[-1][0]
