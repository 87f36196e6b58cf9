"""Station square: the station, and the buildings around the square with their shops."""

from __future__ import annotations

import math

import bpy

from scope_studio.kit.buildings import square_shops, station, townhouses, wall_materials
from scope_studio.kit.buildings.townhouses import CLAY, SLATE, House
from scope_studio.kit.core.finishes import paint
from scope_studio.kit.core.lettering import extent
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Stage
from scope_studio.kit.furniture import clocks

STATION_Y = 27.0
"""y coordinate of the front of the station."""
WEST_X, EAST_X, SOUTH_Y = -36.0, 37.0, -30.0
"""Coordinates of the house fronts on the western, eastern and southern sides of the square."""
DEPARTURES = [
    ("09:44", "Harrowfield", "1"),
    ("09:52", "Port Ellis", "3"),
    ("09:58", "Brampton", "2"),
    ("10:06", "Harrow Hill", "1"),
    ("10:15", "Lower Ashby", "4"),
    ("10:31", "Ashby Road", "2"),
]
"""Departures: time, destination, platform."""


def build(stage: Stage) -> None:
    """Place the station and the buildings."""
    _station(stage)
    _rows(stage)


def _station(stage: Stage) -> None:
    house = station.station_house("ALDERMERE STATION")
    front = stage.place(
        house, "building", "station building", (0, STATION_Y, 0), 180, material="stone", colour="beige", kind="railway station"
    )
    stage.place(
        clocks.wall_clock(1.05, 9, 41), "clock", "station clock", (0, STATION_Y - 0.02, station.CLOCK_Z_M), 180,
        parent=front, time="9:41", colour="white", mounted="gable",
    )  # fmt: skip
    for x, name, state in (
        (0.0, "middle station door", "open"),
        (4.3, "right station door", "closed"),
        (-4.3, "left station door", "closed"),
    ):
        stage.place(
            station.double_door(is_open=state == "open"), "door", name, (x, STATION_Y + 0.38, 0.0), 180,
            parent=front, state=state, colour="dark green",
        )  # fmt: skip
    for x, text in ((-15.2, "TICKETS"), (15.2, "WAY OUT")):
        stage.place(
            square_shops.sign_board(text, 3.0, colour="navy", ink="white", cap=0.36, height=0.60), "sign", f"{text.lower()} sign",
            (x, STATION_Y + station.PROJECTION_M - 3.62, 4.52), 180, parent=front, colour="navy",
        )  # fmt: skip
    board = station.departures_board(DEPARTURES)
    stage.place(
        board, "departures board", "departures board", (10.2, STATION_Y + 0.2, 2.38), 180, parent=front, state="lit", lines=6
    )


def walls() -> dict[str, bpy.types.Material]:
    """Return the wall materials by colour name."""
    return {
        "cream": wall_materials.stucco("stucco cream", (0.58, 0.50, 0.36)),
        "white": wall_materials.stucco("stucco white", (0.64, 0.62, 0.57)),
        "ochre": wall_materials.stucco("stucco ochre", (0.52, 0.34, 0.14)),
        "pink": wall_materials.stucco("stucco pink", (0.53, 0.31, 0.25)),
        "blue": wall_materials.stucco("stucco blue", (0.30, 0.38, 0.44)),
        "green": wall_materials.stucco("stucco green", (0.33, 0.38, 0.28)),
        "stone": wall_materials.ashlar("town stone", (0.43, 0.37, 0.28)),
        "grey stone": wall_materials.ashlar("bank stone", (0.40, 0.385, 0.355), (0.95, 0.45)),
        "red brick": wall_materials.brick_material("town red brick", (0.27, 0.090, 0.055)),
        "buff brick": wall_materials.brick_material("town buff brick", (0.38, 0.285, 0.17)),
    }


def _house(stage: Stage, h: House, place: tuple[float, float, float], colour: str, name: str, kind: str, storeys: int) -> str:
    x, y, bearing = place
    material = "brick" if "brick" in colour else "stone" if "stone" in colour else "render"
    plain_colour = {"stone": "beige", "grey stone": "grey", "red brick": "red", "buff brick": "buff"}.get(colour, colour)
    attributes = {"shutters": h.shutters} if h.shutters else {}
    return stage.place(
        townhouses.town_house(h),
        "building",
        name,
        (x, y, 0.0),
        bearing,
        colour=plain_colour,
        material=material,
        kind=kind,
        storeys=storeys,
        **attributes,
    )


def _at_front(place: tuple[float, float, float], right_m: float, out_m: float) -> tuple[float, float]:
    """Convert a position relative to the front of a building to world coordinates.

    ``right_m`` is the distance along the front, to the right as seen by a viewer, and ``out_m`` the distance in front of it (m).
    """
    x, y, bearing = place
    b = math.radians(bearing)
    return x - right_m * math.cos(b) + out_m * math.sin(b), y + right_m * math.sin(b) + out_m * math.cos(b)


def shop(
    stage: Stage,
    parent: str,
    place: tuple[float, float, float],
    *,
    name: str,
    kind: str,
    text: str,
    width: float,
    colour: str,
    ink: str = "cream",
    door: str = "closed",
    door_colour: str | None = None,
    notice: str | None = None,
    awning: tuple[str, str] | None = None,
    awning_text: str | None = None,
    awning_open: bool = True,
    seed: int = 0,
) -> None:
    """Place a shop front in front of the house at ``place``. Its sign, door and awning are separate instances."""
    bearing = place[2]
    x, y = _at_front(place, 0.0, 0.0)
    front = stage.place(
        square_shops.front(width, colour, seed=seed), "shop", name, (x, y, 0.0), bearing, parent=parent, kind=kind, colour=colour,
        state="closed" if notice == "CLOSED" else "open",
    )  # fmt: skip
    sx, sy = _at_front(place, 0.0, 0.25)
    stage.place(
        square_shops.sign_board(text, width - 0.6, colour=colour, ink=ink), "shop sign", f"{name} sign", (sx, sy, 3.05), bearing,
        parent=front, colour=colour,
    )  # fmt: skip
    dx, dy = _at_front(place, 0.0, 0.17)
    stage.place(
        square_shops.shop_door(door_colour or colour, is_open=door == "open", notice=notice),
        "door",
        f"{name} door",
        (dx, dy, 0.02),
        bearing,
        parent=front,
        state=door,
        colour=door_colour or colour,
    )
    if awning:
        ax, ay = _at_front(place, 0.0, 0.30)
        canvas = square_shops.awning(width - 0.3, *awning, text=awning_text, is_open=awning_open)
        pattern_colour = awning[0] if awning[0] == awning[1] else f"{awning[0]} and {awning[1]}"
        pattern = "plain" if awning[0] == awning[1] else "striped"
        stage.place(
            canvas, "awning", f"{pattern_colour} awning", (ax, ay, 2.72 if not awning_text else 2.74), bearing, parent=front,
            colour=pattern_colour, pattern=pattern, state="open" if awning_open else "closed",
        )  # fmt: skip


def _rows(stage: Stage) -> None:
    materials = walls()
    # West side, in the morning sun
    cafe = (WEST_X, -3.2, 90.0)
    front = _house(stage, House(12.0, materials["ochre"], 3, 4, shutters="dark green", dormers=2, roof=CLAY, seed=1), cafe, "ochre",
                   "ochre house with green shutters", "town house", 3)  # fmt: skip
    shop(
        stage,
        front,
        cafe,
        name="café",
        kind="café",
        text="CAFE BELLAVISTA",
        width=11.0,
        colour="dark red",
        ink="cream",
        door="open",
        awning=("dark red", "cream"),
        awning_text="COFFEE  CAKES  LUNCH",
        seed=1,
    )
    bakery = (WEST_X, 6.9, 90.0)
    front = _house(stage, House(8.2, materials["white"], 3, 3, shutters="blue", seed=2), bakery, "white",
                   "white house with blue shutters", "town house", 3)  # fmt: skip
    shop(
        stage,
        front,
        bakery,
        name="bakery",
        kind="bakery",
        text="BARTON & SON",
        width=7.4,
        colour="navy",
        ink="white",
        notice="OPEN",
        awning=("navy", "white"),
        seed=2,
    )
    _house(
        stage,
        House(6.4, materials["pink"], 4, 2, storey_m=2.9, shutters="light grey", door="dark green", seed=3),
        (WEST_X, 14.2, 90.0),
        "pink",
        "pink house with grey shutters",
        "town house",
        4,
    )
    bookshop = (WEST_X, 25.0, 90.0)
    front = _house(
        stage,
        House(8.6, materials["red brick"], 3, 3, dormers=2, seed=4),
        bookshop,
        "red brick",
        "red brick house",
        "town house",
        3,
    )
    shop(
        stage,
        front,
        bookshop,
        name="bookshop",
        kind="bookshop",
        text="BARTON'S BOOKS",
        width=7.6,
        colour="dark green",
        ink="cream",
        notice="CLOSED",
        awning=("dark green", "dark green"),
        awning_open=False,
        seed=3,
    )
    _house(
        stage,
        House(9.0, materials["buff brick"], 3, 3, seed=5),
        (WEST_X, 33.8, 90.0),
        "buff brick",
        "buff brick house",
        "town house",
        3,
    )
    # East side
    pharmacy = (EAST_X, -5.4, 270.0)
    front = _house(
        stage, House(9.4, materials["green"], 3, 3, quoins=True, seed=6), pharmacy, "green", "green house", "town house", 3
    )
    shop(
        stage,
        front,
        pharmacy,
        name="pharmacy",
        kind="pharmacy",
        text="PHARMACY",
        width=8.4,
        colour="white",
        ink="green",
        notice="OPEN",
        door_colour="green",
        seed=4,
    )
    x, y = _at_front(pharmacy, 4.0, 0.0)
    stage.place(
        square_shops.pharmacy_cross(), "cross", "green pharmacy cross", (x, y, 4.9), 270, parent=front, colour="green", state="lit"
    )
    _bank(stage, materials["grey stone"])
    grocer = (EAST_X, 19.7, 270.0)
    front = _house(
        stage,
        House(8.0, materials["cream"], 3, 3, shutters="brown", seed=8),
        grocer,
        "cream",
        "cream house with brown shutters",
        "town house",
        3,
    )
    shop(
        stage,
        front,
        grocer,
        name="barber shop",
        kind="barber",
        text="BARBER",
        width=5.4,
        colour="black",
        ink="white",
        door="open",
        door_colour="red",
        notice="OPEN",
        seed=5,
    )
    _house(
        stage,
        House(7.6, materials["blue"], 3, 3, door="yellow", seed=9),
        (EAST_X, 27.5, 270.0),
        "blue",
        "blue house",
        "town house",
        3,
    )
    _house(
        stage,
        House(9.0, materials["red brick"], 4, 3, storey_m=2.9, seed=10),
        (EAST_X, 35.8, 270.0),
        "red brick",
        "tall brick house",
        "town house",
        4,
    )
    # South side, behind the tramway
    _hotel(stage, materials["cream"])
    south = [
        (-29.7, 8.6, "buff brick", 3, {"dormers": 2}, "tobacconist", "GREEN & WEBB", "brown", "yellow"),
        (-21.0, 8.8, "blue", 3, {"shutters": "white"}, "travel agent", "SUNWAY TRAVEL", "yellow", "navy"),
        (-12.3, 8.6, "white", 4, {"storey_m": 2.9, "balconies": True}, "shoe shop", "SOLE MATES", "purple", "white"),
        (18.2, 8.4, "red brick", 3, {"shutters": "cream"}, "optician", "CLEARVIEW OPTICIANS", "light blue", "navy"),
        (26.2, 7.6, "pink", 3, {"balconies": True}, "toy shop", "THE TOY BOX", "red", "yellow"),
        (32.9, 5.8, "stone", 4, {"storey_m": 2.9}, "watchmaker", "WATCHMAKER", "dark green", "yellow"),
    ]  # fmt: skip
    for k, (front_x, width, colour, storeys, options, kind, text, board_colour, ink) in enumerate(south):
        place = (front_x, SOUTH_Y, 0.0)
        h = House(
            width, materials[colour], storeys, 3 if width > 7 else 2, seed=20 + k, roof=CLAY if k % 3 == 2 else SLATE, **options
        )
        noun = {"buff brick": "buff brick house", "red brick": "red brick house", "stone": "tall stone house"}.get(
            colour, f"{colour} house"
        )
        front = _house(stage, h, place, colour, noun, "town house", storeys)
        shop(
            stage,
            front,
            place,
            name=kind,
            kind=kind,
            text=text,
            width=width - 1.0,
            colour=board_colour,
            ink=ink,
            notice="OPEN" if k % 2 else None,
            awning=(("yellow", "white") if k == 1 else ("red", "red")) if k in (1, 4) else None,
            seed=10 + k,
        )


def _bank(stage: Stage, stone: bpy.types.Material) -> None:
    place = (EAST_X, 9.3, 270.0)
    h = House(
        12.4, stone, 3, 5, ground_m=4.6, storey_m=3.4, window=(1.1, 2.0), door="black", quoins=True, trim="light grey", seed=7
    )
    front = _house(stage, h, place, "grey stone", "stone bank building", "bank", 3)
    x, y = _at_front(place, 0.0, 0.20)
    stage.place(
        square_shops.sign_board("COUNTY & BOROUGH BANK", 8.6, colour="dark grey", ink="yellow", cap=0.36, height=0.66),
        "sign",
        "bank sign",
        (x, y, 4.15),
        270,
        parent=front,
        colour="dark grey",
    )


def _hotel(stage: Stage, wall: bpy.types.Material) -> None:
    place = (3.0, SOUTH_Y, 0.0)
    h = House(
        21.8, wall, 4, 7, depth=11.0, ground_m=4.4, storey_m=3.2, dormers=5, quoins=True, balconies=True, door="black", seed=15
    )
    front = _house(stage, h, place, "cream", "hotel building", "hotel", 4)
    s = Solid("hotel sign")
    text, cap = "STATION HOTEL", 0.62
    gold = paint("yellow", dirt=0.12, roughness=0.3)
    s.box((extent(text, cap) + 0.8, 0.05, 1.0), (0, 0.02, 0), paint("dark green", dirt=0.1), 0.02)
    s.text(text, cap, (0, 0.05, 0), gold)
    stage.place(s.built(), "sign", "hotel sign", (3.0, SOUTH_Y + 0.26, 4.55), 0, parent=front, colour="dark green")
    stage.place(
        square_shops.awning(3.6, "dark green", "dark green", reach=1.9, text="RESTAURANT"),
        "awning",
        "green hotel awning",
        (3.0, SOUTH_Y + 0.28, 3.5),
        0,
        parent=front,
        colour="green",
        pattern="plain",
        state="open",
    )
    for x, text, colour in ((0.2, "VACANCIES", "white"), (5.8, "ROOMS FROM 48.00", "white")):
        stage.place(
            square_shops.sign_board(text, 1.5, colour=colour, ink="navy", cap=0.14, height=0.42), "sign", f"{text.lower()} sign",
            (x, SOUTH_Y + 0.02, 3.35), 0, parent=front, colour=colour,
        )  # fmt: skip
