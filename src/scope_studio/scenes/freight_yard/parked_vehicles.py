"""Freight yard: the parked vehicles (lorries at the docks, trailers in their bays, cars, forklifts)."""

from __future__ import annotations

import math

from scope_studio.kit.core.stage import Built, Stage
from scope_studio.kit.people import characters
from scope_studio.kit.people.stances import reaching, sitting
from scope_studio.kit.vehicles import artics, cars, forklift, lorries, motorcycle
from scope_studio.kit.yard.goods import pallet_load
from scope_studio.scenes.freight_yard import ground
from scope_studio.scenes.freight_yard.premises import DOCK_X, FRONT_Y

DOCKED_REAR_Y = FRONT_Y - 0.55
"""y coordinate of the rear of a docked lorry."""

PARKED_CARS = {
    "12": ("hatchback", "LD19 KRA"), "13": ("saloon", "MV70 TSE"), "15": ("hatchback", "YK18 BOW"), "16": ("suv", "PN22 FGH"),
    "18": ("saloon", "RX67 DUN"), "20": ("suv", "EJ21 LKA"), "22": ("hatchback", "OV71 ELC"), "23": ("saloon", "HG23 VLT"),
    "25": ("hatchback", "CN16 RYE"), "26": ("hatchback", "SB15 ZIP"), "28": ("suv", "BT20 MHO"), "29": ("saloon", "KP14 WAX"),
    "31": ("van", "GU19 NGF"), "33": ("hatchback", "FY68 JAM"), "34": ("pickup", "AK72 TOW"), "37": ("saloon", "WR66 VIS"),
    "39": ("suv", "DS21 HAT"),
}  # fmt: skip
"""Body style and number plate of the car in each occupied bay, by bay number."""


def build(stage: Stage) -> None:
    """Place the parked vehicles."""
    _docked_lorries(stage)
    _trailers(stage)
    _cars(stage)
    _forklifts(stage)


def _articulated_lorry(
    stage: Stage,
    tractor: Built,
    trailer: Built,
    x: float,
    rear_y: float,
    attributes: dict[str, object],
    trailer_attributes: dict[str, object],
) -> None:
    """Place a tractor unit and its trailer facing south, with the trailer's rear at ``rear_y``."""
    nose_y = rear_y - artics.TRAILER_LENGTH_M
    kingpin_y = nose_y + artics.KINGPIN_SETBACK_M
    name = str(trailer_attributes.pop("name"))
    stage.place(trailer, "trailer", name, (x, rear_y - artics.TRAILER_LENGTH_M / 2, 0), 180, facing="south", **trailer_attributes)
    stage.place(
        tractor,
        "lorry",
        f"{attributes['colour']} tractor unit",
        (x, kingpin_y + artics.COUPLING_Y, 0),
        180,
        facing="south",
        kind="tractor unit",
        **attributes,
    )


def _docked_lorries(stage: Stage) -> None:
    _articulated_lorry(
        stage,
        artics.tractor("blue", plate="KX20 HGF", name="NORTHGATE", lit=True),
        artics.trailer("blue", lettering="NORTHGATE FREIGHT", plate="KX20 HGF", front="blue"),
        DOCK_X[1],
        DOCKED_REAR_Y,
        {"colour": "blue", "plate": "KX20 HGF", "state": "parked", "lights": "lit", "dock": "2"},
        {
            "name": "blue curtain-sided trailer",
            "colour": "blue",
            "kind": "curtain-sided",
            "state": "docked",
            "dock": "2",
            "lettering": "northgate freight",
        },
    )
    box = artics.trailer("white", kind="box", lettering="POLAR LINE", plate="NU69 ICE")
    _waiting_lorries(stage)
    stage.place(
        box,
        "trailer",
        "white refrigerated trailer",
        (DOCK_X[3], DOCKED_REAR_Y - artics.TRAILER_LENGTH_M / 2, 0),
        180,
        colour="white",
        kind="refrigerated",
        state="docked",
        facing="south",
        dock="4",
        lettering="polar line",
    )
    lorry = lorries.box_lorry("red", "white", plate="AY18 GTF", lettering="DRAYCOTT")
    stage.place(
        lorry,
        "lorry",
        "red and white box lorry",
        (DOCK_X[6], DOCKED_REAR_Y - 4.3, 0),
        180,
        colour="red",
        kind="box lorry",
        plate="AY18 GTF",
        state="parked",
        lights="unlit",
        facing="south",
        dock="7",
        lettering="draycott",
    )
    _articulated_lorry(
        stage,
        artics.tractor("green", plate="FJ21 OAK", name="HALDEN"),
        artics.trailer("green", lettering="HALDEN HAULAGE", plate="FJ21 OAK"),
        10.6,
        -2.0,
        {"colour": "green", "plate": "FJ21 OAK", "state": "parked", "lights": "unlit"},
        {
            "name": "green curtain-sided trailer",
            "colour": "green",
            "kind": "curtain-sided",
            "state": "parked",
            "lettering": "halden haulage",
        },
    )


def _waiting_lorries(stage: Stage) -> None:
    """Place the lorries that wait for a dock at the southern fence."""
    rows = [
        (
            lorries.tanker("dark red", plate="NU70 HKD", lettering="PETRONELL"),
            "dark red tanker",
            "dark red",
            "tanker",
            "NU70 HKD",
            23.0,
            -40.8,
            270,
        ),
        (
            lorries.tipper("yellow", "yellow", plate="KE17 UDM"),
            "yellow tipper lorry",
            "yellow",
            "tipper",
            "KE17 UDM",
            33.6,
            -41.0,
            270,
        ),
        (
            lorries.box_lorry("white", "blue", plate="PX68 JTL", lettering="TIDEWAY"),
            "white and blue box lorry",
            "white",
            "box lorry",
            "PX68 JTL",
            44.0,
            -38.4,
            180,
        ),
    ]
    for built, name, colour, kind, plate, x, y, bearing in rows:
        stage.place(
            built,
            "lorry",
            name,
            (x, y, 0),
            bearing,
            colour=colour,
            kind=kind,
            plate=plate,
            state="parked",
            lights="unlit",
            facing="west" if bearing == 270 else "south",
        )


def _trailers(stage: Stage) -> None:
    bays = {number: y for y, number in ground.TRAILER_BAYS}
    rows = [
        (
            "61",
            artics.trailer("white", kind="box", lettering="POLAR LINE", plate="NU69 ICY"),
            "white refrigerated trailer",
            "white",
            "refrigerated",
            "polar line",
        ),
        (
            "63",
            artics.trailer("orange", lettering="KESTREL EXPRESS", plate="SF17 KES"),
            "orange curtain-sided trailer",
            "orange",
            "curtain-sided",
            "kestrel express",
        ),
        (
            "64",
            artics.skeletal("TSLU 730164 2", "green", livery="TESSALINE", plate="PK18 SKL"),
            "skeletal trailer with a green container",
            "green",
            "skeletal",
            "tessaline",
        ),
    ]
    for number, built, name, colour, kind, lettering in rows:
        stage.place(
            built,
            "trailer",
            name,
            (ground.TRAILER_X + 0.2, bays[number], 0),
            270,
            colour=colour,
            kind=kind,
            state="parked",
            facing="west",
            bay=number,
            lettering=lettering,
        )
    for colour, name, plate, x, lit in (
        ("red", "DRAYCOTT", "AY20 GTR", -35.5, False),
        ("white", "KESTREL", "SF20 KEX", -31.2, True),
    ):
        stage.place(
            artics.tractor(colour, plate=plate, name=name, lit=lit),
            "lorry",
            f"{colour} tractor unit",
            (x, 9.5, 0),
            168,
            colour=colour,
            kind="tractor unit",
            plate=plate,
            state="parked",
            lights="lit" if lit else "unlit",
            facing="south",
        )


def _cars(stage: Stage) -> None:
    builders = {"hatchback": cars.hatchback, "saloon": cars.saloon, "suv": cars.suv, "pickup": cars.pickup}
    for row, y, bearing in (
        (ground.ROW_A, ground.ROW_A_Y, 0.0),
        (ground.ROW_B, ground.ROW_B_Y, 180.0),
        (ground.VISITORS, ground.VISITORS_Y, 180.0),
    ):
        for k, (x, number) in enumerate(row):
            if number not in PARKED_CARS:
                continue
            body, plate = PARKED_CARS[number]
            colour = ground.CAR_COLOURS[number]
            car_bearing = bearing + (180 if number in ("16", "28", "33") else 0) + (1.8 if k % 2 else -1.2)
            facing = "north" if abs(car_bearing % 360) < 20 or car_bearing % 360 > 340 else "south"
            attributes = {"colour": colour, "plate": plate, "state": "parked", "bay": number, "facing": facing}
            if body == "van":
                van = cars.van(colour, plate=plate, lettering="NORTHGATE\nFREIGHT")
                stage.place(van, "van", f"{colour} van", (x, y + 0.1, 0), car_bearing, lettering="northgate freight", **attributes)
                continue
            category = "pickup truck" if body == "pickup" else "car"
            noun = {"suv": "SUV", "pickup": "pickup truck"}.get(body, body)
            stage.place(
                builders[body](colour, plate=plate), category, f"{colour} {noun}", (x, y, 0), car_bearing, kind=body, **attributes
            )
    patrol = cars.van("white", plate="OB69 JNS", lettering="ARGUS\nSECURITY", roof_beacon=True)
    stage.place(
        patrol,
        "van",
        "white security van",
        (-12.8, -42.0, 0),
        90,
        colour="white",
        plate="OB69 JNS",
        state="parked",
        facing="east",
        lettering="argus security",
    )
    bike = motorcycle.motorcycle("red")
    stage.place(
        bike,
        "motorcycle",
        "red motorcycle",
        (-51.4, -26.6, 0),
        70,
        lean_deg=(0, -9),
        colour="red",
        plate="KM21 BYK",
        state="parked",
    )
    bike = motorcycle.motorcycle("blue", plate="WX19 MTO")
    stage.place(
        bike,
        "motorcycle",
        "blue motorcycle",
        (-51.6, -25.0, 0),
        76,
        lean_deg=(0, -9),
        colour="blue",
        plate="WX19 MTO",
        state="parked",
    )


def driver(vest: str, helmet: str, seed: int) -> Built:
    """Build a sitting forklift driver with the hips over the origin."""
    pose = reaching(sitting(0.46, seed=seed), left=(-0.13, 0.44, 0.86), right=(0.13, 0.46, 0.84))
    return characters.worker(vest=vest, helmet=helmet, stance=pose, seed=seed)


def _forklifts(stage: Stage) -> None:
    for colour, number, x, y, bearing, fork, vest, helmet in (
        ("yellow", "3", 17.6, 21.5, 20.0, 0.45, "orange", "white"),
        ("red", "8", 31.0, 8.5, 250.0, 0.06, None, None),
    ):
        built = forklift.forklift(colour, number=number, fork_m=fork, lit=vest is not None)
        carrying = {"carrying": "pallet of cartons", "driver": "yes"} if vest else {"carrying": "nothing", "driver": "no"}
        truck = stage.place(
            built,
            "forklift",
            f"{colour} forklift",
            (x, y, 0),
            bearing,
            colour=colour,
            number=f"flt {number}",
            state="working" if vest else "parked",
            lights="lit" if vest else "unlit",
            **carrying,
        )
        if vest:
            sx, sy, sz = forklift.SEAT
            dx, dy = _rotate(sx, sy, bearing)
            stage.place(
                driver(vest, helmet, 11),
                "worker",
                "forklift driver",
                (x + dx, y + dy, sz - 0.46),
                bearing,
                vest=vest,
                helmet=helmet,
                pose="sitting",
                driving="forklift",
                parent=truck,
            )
            dx, dy = _rotate(0.0, 1.68, bearing)
            stage.place(
                pallet_load("cartons", label="BATCH 41"),
                "pallet",
                "pallet of cartons on the forks",
                (x + dx, y + dy, fork - 0.10),
                bearing + 180,
                load="cartons",
                wrapped="yes",
            )


def _rotate(x: float, y: float, bearing_deg: float) -> tuple[float, float]:
    """Rotate a point from the coordinates of an object with this bearing to world axes."""
    b = math.radians(bearing_deg)
    return x * math.cos(b) + y * math.sin(b), -x * math.sin(b) + y * math.cos(b)
