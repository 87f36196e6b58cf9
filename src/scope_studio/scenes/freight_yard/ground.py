"""Freight yard: paving, painted markings, parking bays, and the lamps on masts."""

from __future__ import annotations

from scope_studio.kit.core.stage import Stage
from scope_studio.kit.light import dusk
from scope_studio.kit.yard import floor as yard_floor
from scope_studio.kit.yard import lamps as yard_lamps

WEST, EAST, SOUTH, NORTH = -58.0, 50.0, -46.0, 30.0
"""Edges of the yard in metres. There are fences on the west, east and south sides; the warehouse front is on the north side."""
IN_X, OUT_X = -1.2, 7.2
"""x coordinates of the lanes into and out of the yard. Traffic drives on the left."""

BAY_WIDTH_M = 2.6
"""Width of a bay in metres."""
ROW_A = [(-45.4 + BAY_WIDTH_M * k, str(12 + k)) for k in range(12)]
"""Bays of the northern row: x coordinate of the centre in metres, and number. Cars face north."""
ROW_B = [(-45.4 + BAY_WIDTH_M * k, str(24 + k)) for k in range(12)]
"""Bays of the southern row: x coordinate of the centre in metres, and number. Cars face south."""
ROW_A_Y, ROW_B_Y = -14.5, -26.5
"""y coordinates of the two rows."""
VISITORS = [(-44.0 + 2.8 * k, str(36 + k)) for k in range(5)]
"""Bays for visitors: x coordinate of the centre in metres, and number. Cars face south."""
VISITORS_Y = -41.5
"""y coordinate of the row for visitors."""
TRAILER_BAYS = [(3.5 + 4.2 * k, str(61 + k)) for k in range(5)]
"""Trailer bays along the west fence: y coordinate of the centre in metres, and number."""
TRAILER_X = -48.5
"""x coordinate of the centre of the trailer bays."""

MASTS = (
    (-17.0, -10.6, 0.0, "sodium", 2, True, "L1"),
    (-41.0, -10.6, 0.0, "sodium", 2, True, "L2"),
    (12.2, -4.0, 90.0, "led", 2, True, "L3"),
    (12.2, -27.0, 90.0, "led", 2, True, "L4"),
    (47.5, -12.0, 270.0, "led", 1, True, "L5"),
    (47.5, 18.0, 270.0, "led", 1, False, "L6"),
    (-56.0, 16.0, 90.0, "sodium", 1, True, "L7"),
    (-56.0, -30.0, 90.0, "sodium", 1, True, "L8"),
    (3.0, -45.0, 0.0, "sodium", 2, True, "L9"),
)
"""Masts: x, y, bearing, type of lamp, number of lamps, whether they are lit, and number on the plate."""


def build(stage: Stage) -> None:
    """Place the floor, markings, bays and lamps."""
    _paving(stage)
    _markings(stage)
    _bays(stage)
    _masts(stage)


def _paving(stage: Stage) -> None:
    asphalt, concrete = yard_floor.asphalt(), yard_floor.slabs()
    stage.put(yard_floor.floor("asphalt", (WEST, EAST, SOUTH, 6.0), asphalt), (0, 0, 0))
    stage.put(yard_floor.floor("apron", (WEST, EAST, 6.0, 45.0), concrete), (0, 0, 0))
    stage.put(yard_floor.floor("stack floor", (14.5, EAST, -34.0, 6.0), concrete, 0.003), (0, 0, 0))
    stage.put(yard_floor.floor("throat", (-6.0, 12.0, -54.0, SOUTH), asphalt), (0, 0, 0))


def _markings(stage: Stage) -> None:
    for x, y, bearing, turn in (
        (IN_X, -33.0, 0, "ahead"), (IN_X, -20.0, 0, "left"), (IN_X, -6.0, 0, "ahead"), (OUT_X, -30.0, 180, "ahead"),
        (OUT_X, -8.0, 180, "ahead"), (-16.0, -20.5, 270, "ahead"), (-34.0, -20.5, 270, "ahead"),
    ):  # fmt: skip
        facing = {0: "north", 180: "south", 270: "west"}[bearing]
        stage.place(
            yard_floor.arrow(turn=turn),
            "road marking",
            "painted arrow",
            (x, y, 0),
            bearing,
            colour="white",
            kind="arrow",
            direction=turn,
            facing=facing,
        )
    boxes = (
        ("yellow", 9.0, 5.0, -24.0, 20.0),
        ("yellow", 4.6, 6.0, 22.0, 26.0),
        ("white", 3.0, 9.0, 3.0, -24.0),
        ("yellow", 6.0, 3.2, 20.5, 9.0),
    )
    for colour, width, depth, x, y in boxes:
        stage.place(
            yard_floor.hatch(width, depth, colour=colour), "hatched zone", f"{colour} hatched zone", (x, y, 0), 0, colour=colour
        )
    stage.place(yard_floor.words(["STOP"], 1.2), "road marking", "painted STOP", (IN_X, -41.6, 0), 0, colour="white", kind="word")
    stage.place(yard_floor.words(["SLOW"], 1.2), "road marking", "painted SLOW", (IN_X, -13.5, 0), 0, colour="white", kind="word")
    stage.place(
        yard_floor.words(["KEEP", "CLEAR"], 0.9, colour="yellow"),
        "road marking",
        "painted KEEP CLEAR",
        (22.0, 20.6, 0),
        180,
        colour="yellow",
        kind="word",
    )
    stage.place(_stop_line(), "road marking", "stop line", (IN_X, -39.6, 0), 0, colour="white", kind="stop line")
    stage.place(_walkway(), "walkway", "green pedestrian walkway", (-11.2, -15.0, 0), 0, colour="green", state="empty")
    stage.put(_lanes(), (0, 0, 0))


def _stop_line() -> yard_floor.Built:
    s = yard_floor.Solid("stop line")
    yard_floor.line(s, (-1.9, 0), (1.9, 0), 0.35, yard_floor.paint("white"))
    return s.built()


def _walkway() -> yard_floor.Built:
    """Build a green pedestrian walkway between white lines."""
    s = yard_floor.Solid("walkway")
    yard_floor.flat(s, [(-0.7, -17.0), (0.7, -17.0), (0.7, 17.0), (-0.7, 17.0)], yard_floor.paint("green"), 0.003)
    for x in (-0.75, 0.75):
        yard_floor.line(s, (x, -17.0), (x, 17.0), 0.10, yard_floor.paint("white"))
    return s.built()


def _lanes() -> yard_floor.Built:
    """Build the lines that are not annotated: lane edges, dashes, dock approach lines."""
    s = yard_floor.Solid("lane lines")
    white, yellow = yard_floor.paint("white"), yard_floor.paint("yellow")
    for y in range(-38, 6, 5):
        for x in (IN_X - 2.1, OUT_X + 2.1):
            yard_floor.line(s, (x, y), (x, y + 3.0), 0.10, white)
    for x in (-26.7 + 5.4 * k for k in range(9)):
        yard_floor.line(s, (x, 12.0), (x, 29.0), 0.10, yellow)
    for y in (-22.0, 1.0):
        yard_floor.line(s, (-56.0, y), (-13.0, y), 0.10, white)
    return s.built()


def _bays(stage: Stage) -> None:
    occupied = {number for _, number in [*ROW_A, *ROW_B, *VISITORS]} & set(CAR_COLOURS)
    for row, y, bearing in ((ROW_A, ROW_A_Y, 0.0), (ROW_B, ROW_B_Y, 180.0), (VISITORS, VISITORS_Y, 180.0)):
        for x, number in row:
            kind = "visitor bay" if row is VISITORS else "charging bay" if number in CHARGING_BAYS else "car bay"
            stage.place(
                yard_floor.bay(number, width=BAY_WIDTH_M - 0.05, colour="white"),
                "parking space", f"parking bay {number}", (x, y, 0), bearing,
                number=number, state="occupied" if number in occupied else "empty", kind=kind,
            )  # fmt: skip
    for y, number in TRAILER_BAYS:
        stage.place(
            yard_floor.bay(number, width=3.9, depth=15.0, cap=1.0, colour="yellow"),
            "parking space", f"trailer bay {number}", (TRAILER_X, y, 0), 270,
            number=number, state="occupied" if number in CAR_COLOURS else "empty", kind="trailer bay",
        )  # fmt: skip


CHARGING_BAYS = ("21", "22", "23")
"""Numbers of the bays with a charging point."""
CAR_COLOURS = {
    "12": "dark blue", "13": "silver", "15": "red", "16": "white", "18": "grey", "20": "black", "22": "white", "23": "light blue",
    "25": "green", "26": "yellow", "28": "silver", "29": "dark red", "31": "white", "33": "orange", "34": "grey", "37": "blue",
    "39": "beige", "61": "", "63": "", "64": "",
}  # fmt: skip
"""Colour of the car in each occupied bay, by bay number. It is empty for trailer bays."""


def _masts(stage: Stage) -> None:
    for x, y, bearing, kind, heads, lit, number in MASTS:
        stage.place(
            yard_lamps.mast(kind=kind, heads=heads, lit=lit, number=number),
            "lamp post", "tall lamp post" if lit else "unlit lamp post", (x, y, 0), bearing,
            state="lit" if lit else "unlit", light="orange" if kind == "sodium" else "white", number=number, height_m=10.0,
        )  # fmt: skip
        if lit:
            yard_lamps.mast_light(x, y, bearing, kind=kind, heads=heads, power_w=820 if kind == "sodium" else 650)
    for x in (-18.0, -4.5, 9.0):
        dusk.lamplight((x, 28.4, 4.72), 220, dusk.LED, size_m=6.0, stretch=0.06)
    for x in (-20.0, -6.0, 8.0, 22.0):
        dusk.lamplight((x, 36.0, 6.8), 420, dusk.LED, size_m=4.0)
