"""Highway works: objects along the road (gantries, signs, lamp posts, guardrails, marker posts, telephones)."""

from __future__ import annotations

from collections.abc import Sequence

from scope_studio.kit.core.stage import Built, Stage
from scope_studio.kit.furniture import roadside
from scope_studio.kit.signs import gantry, message_sign, road_signs
from scope_studio.kit.signs.faces import Panel
from scope_studio.kit.signs.gantry import LaneSignal

SOUTH, NORTH = 180.0, 0.0
"""Bearings that the fronts of signs face. Signs for northbound drivers face south."""


def build(stage: Stage) -> None:
    """Place the objects along the road."""
    _gantries(stage)
    _direction_signs(stage)
    _works_signs(stage)
    _small_signs(stage)
    _guardrails(stage)
    _lamps(stage)
    _equipment(stage)


def _gantries(stage: Stage) -> None:
    north = gantry.gantry(
        16.4,
        [
            (-3.1, Panel(("Harrowfield\t6", "Brampton\t14"), 6.2, 2.7, "blue", 0.40, route="A482")),
            (5.6, Panel(("Airport", "Port Ellis"), 3.7, 2.1, "blue", 0.34)),
        ],
        5.8,
        signals=[(1.45, LaneSignal("50"))],
        facing="-Y",
    )
    stage.place(
        north, "gantry", "northbound gantry", (-8.7, 45.5, 0), 0, colour="blue", readable_by="northbound drivers", signal="50"
    )
    south = gantry.gantry(
        16.4,
        [
            (-1.0, Panel(("Stoke Mallory\t9", "Ashdown\t17"), 6.6, 2.8, "blue", 0.42, route="A482")),
            (5.9, Panel(("B17", "Linton"), 3.0, 2.0, "blue", 0.36)),
        ],
        5.8,
        signals=[(-6.1, LaneSignal("60"))],
        facing="+Y",
    )
    stage.place(
        south, "gantry", "southbound gantry", (8.7, -86.0, 0), 0, colour="blue", readable_by="southbound drivers", signal="60"
    )


def _sign(
    stage: Stage, built: Built, name: str, x: float, y: float, bearing: float, reads: str, colour: str, **attributes: str
) -> None:
    facing = {SOUTH: "south", NORTH: "north"}.get(bearing, "road")
    stage.place(built, "sign", name, (x, y, 0), bearing, reads=reads, colour=colour, facing=facing, **attributes)


def _direction_signs(stage: Stage) -> None:
    services = road_signs.panel(("Services", "Petrol  Food  Beds"), width=3.9, height=1.8, background="blue", cap_height=0.28)
    _sign(stage, services, "blue services sign", -20.4, 67.5, SOUTH, "services petrol food beds", "blue")
    attraction = road_signs.panel(("Wetland Centre", "next exit"), width=3.3, height=1.3, background="brown", cap_height=0.22)
    _sign(stage, attraction, "brown tourist sign", 19.2, 47.0, NORTH, "wetland centre next exit", "brown")
    distances = road_signs.panel(
        ("Stoke Mallory\t9", "Ashdown\t17", "Linton\t23"), width=4.0, height=2.6, background="green", cap_height=0.30
    )
    _sign(stage, distances, "green distance sign", 19.6, 20.0, NORTH, "stoke mallory 9 ashdown 17 linton 23", "green")
    exit_sign = road_signs.panel(
        ("Linton B17", "Industrial Estate", "1/2 mile"), width=4.2, height=2.4, background="blue", cap_height=0.30
    )
    _sign(stage, exit_sign, "blue exit sign", 19.4, -42.0, NORTH, "linton b17 industrial estate half mile", "blue")
    queue_sign = message_sign.variable_message(("SLOW", "QUEUE", "AHEAD"), width=3.4, height=2.2)
    stage.place(
        queue_sign,
        "message sign",
        "variable message sign",
        (18.9, -15.0, 0),
        NORTH,
        state="lit",
        reads="slow queue ahead",
        facing="north",
    )
    camera_sign = message_sign.variable_message(("50 MPH", "CAMERAS", "IN USE"), width=3.4, height=2.2)
    stage.place(
        camera_sign,
        "message sign",
        "variable message sign",
        (-18.8, 60.5, 0),
        SOUTH,
        state="lit",
        reads="50 mph cameras in use",
        facing="south",
    )


def _works_signs(stage: Stage) -> None:
    rows: Sequence[tuple[Built, str, float, float, float, str, str]] = [
        (road_signs.triangle("1 mile", symbol="works"), "road works sign", -16.6, -112.0, SOUTH, "1 mile", "red and white"),
        (road_signs.lane_closed(3, (0,), "200 yds"), "lane closed sign", -16.6, -96.0, SOUTH, "200 yds", "white"),
        (road_signs.lane_closed(3, (0,), None), "lane closed sign", -16.5, -82.0, SOUTH, "", "white"),
        (
            road_signs.works_access(("WORKS", "ACCESS"), direction="left"),
            "works access sign",
            -16.4,
            9.5,
            SOUTH,
            "works access",
            "red",
        ),
        (
            road_signs.panel(
                ("END OF", "ROAD WORKS"), width=2.2, height=1.1, background="yellow", cap_height=0.24, post_height=1.2
            ),
            "yellow end of works sign",
            -16.9,
            63.0,
            SOUTH,
            "end of road works",
            "yellow",
        ),
        (
            road_signs.panel(("WORKS", "EXIT"), width=1.5, height=0.9, background="red", cap_height=0.22, post_height=1.0),
            "red works exit sign",
            -16.9,
            26.0,
            NORTH,
            "works exit",
            "red",
        ),
        (
            road_signs.panel(
                ("ROAD WORKS", "NEXT 2 MILES", "SORRY FOR ANY DELAY"),
                width=3.2,
                height=1.6,
                background="yellow",
                cap_height=0.20,
                post_height=1.5,
            ),
            "yellow road works sign",
            -18.2,
            40.0,
            SOUTH,
            "road works next 2 miles sorry for any delay",
            "yellow",
        ),
        (
            road_signs.panel(
                ("FREE RECOVERY", "AWAIT RESCUE"), width=2.6, height=1.2, background="yellow", cap_height=0.22, post_height=1.3
            ),
            "yellow recovery sign",
            17.6,
            -27.5,
            NORTH,
            "free recovery await rescue",
            "yellow",
        ),
        (
            road_signs.triangle("Works traffic", symbol="exclamation"),
            "works traffic sign",
            16.9,
            62.0,
            NORTH,
            "works traffic",
            "red and white",
        ),
        (
            road_signs.project_board(
                (
                    "CASTELL HIGHWAYS",
                    "A482 Resurfacing, Junctions 4 to 6",
                    "Completion: March 2027",
                    "Client: County Roads Board",
                    "Designer: Aldous Peake",
                    "Night closures from 9 pm",
                    "Plan ahead, allow more time",
                    "Help line 0900 555 0142, open day and night",
                    "Contract CH-2207. Unauthorised persons must not enter the site.",
                ),
                width=4.2,
                height=3.3,
                background="blue",
                post_height=0.7,
            ),
            "blue project board",
            -24.3,
            5.6,
            157.0,
            "castell highways a482 resurfacing",
            "blue",
        ),
    ]
    for built, name, x, y, bearing, reads, colour in rows:
        _sign(stage, built, name, x, y, bearing, reads, colour, temporary="yes")


def _small_signs(stage: Stage) -> None:
    for x, y, bearing in ((-16.9, -66.0, SOUTH), (-16.7, 20.5, SOUTH), (16.8, 70.0, NORTH), (16.8, -4.0, NORTH)):
        _sign(
            stage,
            road_signs.speed_limit_sign("50"),
            "50 speed limit sign",
            x,
            y,
            bearing,
            "50",
            "red and white",
            kind="speed limit",
        )
    _sign(
        stage,
        road_signs.speed_limit_sign("10", diameter=0.6, post_height=1.5),
        "10 speed limit sign",
        -29.3,
        5.2,
        150.0,
        "10",
        "red and white",
        kind="speed limit",
    )
    for text, name, x, y, bearing, colour in (
        ("DEEP EXCAVATION", "yellow warning plate", -14.9, 31.5, 205.0, "yellow"),
        ("BURIED CABLE\nDIG WITH CARE", "yellow warning plate", -20.6, 1.0, 195.0, "yellow"),
        ("FIRST AID POINT", "green plate", -24.5, -8.0, 85.0, "green"),
        ("FIRE POINT 2", "red plate", -27.4, -1.4, 120.0, "red"),
        ("WASH DOWN AREA", "blue plate", -26.0, -20.5, 40.0, "blue"),
        ("CULVERT 118", "white plate", 17.0, 12.5, -60.0, "white"),
        ("GAS MAIN 3", "yellow warning plate", -17.9, 64.8, 60.0, "yellow"),
        ("CABLE ROUTE", "yellow warning plate", 17.2, 66.0, -70.0, "yellow"),
    ):
        _sign(
            stage,
            road_signs.warning_plate(text, background=colour, cap_height=0.075),
            name,
            x,
            y,
            bearing,
            text.replace("\n", " ").lower(),
            colour,
            kind="plate",
        )
    for k, y in enumerate((-78.0, -44.0, -2.5, 5.5, 38.0, 66.5)):
        stage.place(
            road_signs.marker_post(f"42/{3 + k}"),
            "marker post",
            "white marker post",
            (-16.25, y, 0),
            186.0,
            reads=f"42/{3 + k}",
            colour="white",
        )
    for k, y in enumerate((68.0, 36.0, 2.0, -34.0, -70.0)):
        stage.place(
            road_signs.marker_post(f"42/{4 + k}"),
            "marker post",
            "white marker post",
            (16.25, y, 0),
            -35.0,
            reads=f"42/{4 + k}",
            colour="white",
        )


def _guardrails(stage: Stage) -> None:
    length, prototype = 108.0, roadside.guardrail(108.0)
    is_first = True
    for x, bearing in ((-0.95, 180.0), (0.95, 0.0)):
        for k in range(4):
            built = prototype if is_first else prototype.copy()
            is_first = False
            stage.place(
                built, "guardrail", "steel guardrail", (x, -162.0 + length * k, 0.07), bearing, material="steel", colour="grey"
            )
    short = roadside.guardrail(16.0)
    stage.place(short, "guardrail", "steel guardrail", (-16.35, 46.5, 0), 0, material="steel", colour="grey", guards="gantry leg")
    stage.place(
        short.copy(), "guardrail", "steel guardrail", (16.35, -87.0, 0), 180, material="steel", colour="grey", guards="gantry leg"
    )


def _lamps(stage: Stage) -> None:
    prototype = roadside.lamp_post(12.0, 2)
    for k, y in enumerate((-154.0, -118.0, -82.0, -46.0, -10.0, 26.0, 62.0, 112.0, 148.0)):
        built = prototype if k == 0 else prototype.copy()
        stage.place(built, "lamp post", "double-armed lamp post", (0, y, 0.07), 90, colour="grey", state="unlit", arms=2)


def _equipment(stage: Stage) -> None:
    phone = roadside.emergency_phone("174")
    stage.place(phone, "emergency phone", "orange emergency phone", (-16.9, 69.5, 0), 200, colour="orange", number="174")
    stage.place(
        roadside.emergency_phone("175"),
        "emergency phone",
        "orange emergency phone",
        (16.9, -9.5, 0),
        -90,
        colour="orange",
        number="175",
    )
    stage.place(roadside.cabinet(), "cabinet", "grey roadside cabinet", (-18.9, 12.6, 0), 170, colour="grey", state="closed")
    stage.place(
        roadside.cabinet(is_open=True), "cabinet", "open roadside cabinet", (-17.6, 44.6, 0), 190, colour="grey", state="open"
    )
    stage.place(
        roadside.cabinet(colour="dark green"),
        "cabinet",
        "green roadside cabinet",
        (18.0, 51.0, 0),
        -80,
        colour="green",
        state="closed",
    )
    stage.place(roadside.cctv_pole(9.0), "camera pole", "camera pole", (19.4, 6.0, 0), -80, colour="grey")
    drain = roadside.drain()
    for k, y in enumerate((-30.0, 0.0, 60.0)):
        for x in (-15.15, 15.15):
            built = drain if k == 0 and x < 0 else drain.copy()
            stage.put(built, (x, y, -0.004), 0)
