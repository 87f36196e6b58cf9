"""High street: the two rows of shops."""

from __future__ import annotations

from dataclasses import dataclass, field

from scope_studio.kit.buildings import shopfronts
from scope_studio.kit.buildings.terraces import TerracedBuilding, terraced_building
from scope_studio.kit.core.stage import Built, Stage
from scope_studio.kit.furniture import shop_displays
from scope_studio.scenes.high_street.plan import EAST_FRONT, ROW_END, WEST_FRONT, Plot


@dataclass(frozen=True)
class Shop:
    """One building in a row.

    ``noun`` is the kind of shop, such as "bank". If it is empty, the building is a house with a front door.
    """

    number: int
    width_m: float
    noun: str
    sign: str
    colour: str
    ink: str
    door: str
    wall: tuple[str, str]
    storeys: int = 2
    columns: int = 2
    roof: str = "slate"
    parapet: bool = False
    bars: int = 1
    lit: tuple[tuple[int, int], ...] = ()
    small: str | None = None
    lamps: bool = True
    room: str = "cream"
    tiles: str | None = None
    awning: tuple[str, str, bool] | None = None
    hanging: tuple[str, ...] = ()
    hanging_side: int = -1
    card: tuple[str, ...] = ()
    open: bool | None = None
    door_side: float = 0.0
    traits: dict[str, str] = field(default_factory=dict)


WEST: tuple[Shop, ...] = (
    Shop(1, 9.0, "bank", "FAIRHOLM BANK", "navy", "white", "black", ("stone", "grey"), 3, 3, "slate", True, 2,
         card=("MON TO FRI", "9.30 TO 4.30"), open=True, door_side=0.3, hanging=("FAIRHOLM",)),
    Shop(3, 7.0, "butcher's shop", "HARTLEY & SONS", "dark red", "cream", "green", ("brick", "red"), 3, 2, bars=2,
         lit=((1, 0),), small="BUTCHERS", tiles="white", room="white", awning=("dark red", "white", True), open=True,
         door_side=-0.28, hanging=("HARTLEY", "& SONS")),
    Shop(5, 7.5, "café", "THE COPPER KETTLE", "dark green", "cream", "dark green", ("render", "cream"), 2, 3, "clay",
         lit=((1, 2),), room="beige", open=True, hanging=("COPPER", "KETTLE"), card=("BREAKFAST", "8 TILL 11"), door_side=0.05),
    Shop(7, 6.5, "bookshop", "DALBY BOOKS", "black", "white", "blue", ("brick", "buff"), 2, 2, room="beige", open=False,
         card=("CLOSED", "ON MONDAYS"), hanging=("BOOKS",), door_side=0.3),
    Shop(9, 7.0, "bakery", "PELL'S BAKERY", "blue", "white", "blue", ("render", "white"), 3, 3, lit=((2, 1),), small="EST 1924",
         awning=("blue", "white", True), room="white", open=True, card=("OPEN 7 TO 3",), door_side=-0.05),
    Shop(11, 6.5, "optician's shop", "WREN OPTICIANS", "light blue", "white", "white", ("brick", "dark red"), 3, 2, bars=2,
         room="light blue", open=True, hanging=("EYE", "TESTS"), door_side=0.28),
    Shop(13, 7.0, "shoe repair shop", "HARTLEY & SON", "brown", "cream", "green", ("brick", "brown"), 2, 2, "clay",
         small="SHOE REPAIRS", lit=((1, 1),), open=False, hanging=("HARTLEY", "& SON"), card=("BACK AT", "2.15"),
         door_side=-0.3),
    Shop(15, 7.5, "charity shop", "SECOND CHANCE", "purple", "white", "black", ("render", "pink"), 2, 3, room="light grey",
         open=True, card=("DONATIONS", "WELCOME"), door_side=0.0),
    Shop(17, 7.0, "chemist's shop", "MARLOW CHEMIST", "green", "white", "dark green", ("brick", "red"), 2, 2, bars=2,
         room="white", open=True, hanging=("CHEMIST",), card=("OPEN 9 TO 6",), door_side=0.26),
    Shop(19, 6.0, "", "", "", "", "red", ("brick", "buff"), 2, 2, lit=((1, 0),)),
    Shop(21, 6.5, "fish and chip shop", "THE GOLDEN COD", "navy", "yellow", "blue", ("render", "pale blue"), 2, 2, "clay",
         tiles="light blue", room="white", awning=("navy", "white", False), open=False, card=("OPEN 5 PM", "TO 10 PM"),
         door_side=-0.28),
    Shop(23, 8.0, "hardware shop", "OAKES HARDWARE", "dark green", "yellow", "black", ("brick", "brown"), 3, 3,
         lit=((1, 1), (2, 2)), room="beige", open=True, hanging=("TOOLS", "PAINT"), door_side=0.0),
    Shop(25, 10.5, "pub", "THE PLOUGH", "black", "yellow", "black", ("render", "white"), 3, 4, "clay", bars=2,
         lit=((1, 0), (1, 3)), room="beige", open=True, hanging=("THE", "PLOUGH"), card=("QUIZ NIGHT", "THURSDAY"),
         door_side=0.0),
)  # fmt: skip
EAST: tuple[Shop, ...] = (
    Shop(2, 8.5, "convenience shop", "CORNER STORES", "green", "white", "white", ("brick", "red"), 3, 3, lit=((1, 1),),
         room="white", open=True, card=("OPEN 7 TO 11",), door_side=-0.3),
    Shop(4, 6.5, "florist's shop", "BLOOM & BOWER", "cream", "dark green", "green", ("render", "pale green"), 2, 2, "clay",
         room="white", awning=("green", "white", True), open=True, door_side=0.3),
    Shop(6, 6.5, "hairdresser's shop", "SILVER SCISSORS", "dark grey", "white", "black", ("brick", "buff"), 3, 2, lit=((2, 0),),
         room="light grey", open=True, hanging=("HAIR",), door_side=-0.28),
    Shop(8, 7.0, "empty shop", "WEBB DRAPERS", "grey", "white", "dark grey", ("brick", "brown"), 2, 2, lamps=False, room="grey",
         open=False, door_side=0.28, traits={"state": "vacant"}),
    Shop(10, 7.5, "electrical shop", "KEMP ELECTRICAL", "blue", "yellow", "blue", ("render", "grey"), 3, 3, room="white",
         open=True, door_side=-0.3),
    Shop(12, 7.0, "gift shop", "POTTER & FINCH", "light blue", "white", "blue", ("stone", "honey"), 2, 2, lit=((1, 0),),
         room="cream", small="GIFTS", open=True, hanging=("POTTER", "& FINCH"), door_side=0.0),
    Shop(14, 7.0, "estate agent's office", "FINCH & POTTER", "navy", "white", "black", ("brick", "dark red"), 3, 3, bars=2,
         room="white", small="HOMES", open=True, hanging=("FINCH &", "POTTER"), door_side=0.28),
    Shop(16, 7.0, "lighting shop", "LANTERN LIGHTING", "black", "yellow", "green", ("render", "ochre"), 2, 2, "clay",
         lit=((1, 1),), room="beige", open=True, card=("SALE", "HALF PRICE"), door_side=-0.28),
    Shop(18, 6.0, "", "", "", "", "green", ("brick", "red"), 2, 2, bars=2),
    Shop(20, 7.5, "dress shop", "TAILOR & TWINE", "dark red", "white", "black", ("stone", "grey"), 3, 3, parapet=True,
         room="light grey", open=True, hanging=("TAILOR", "& TWINE"), door_side=0.0),
    Shop(22, 7.5, "greengrocer's shop", "GREENGAGE", "dark green", "white", "dark green", ("brick", "red"), 2, 3, "clay",
         tiles="green", room="white", awning=("green", "yellow", True), open=True, door_side=0.3, lit=((1, 1),)),
    Shop(24, 7.0, "jeweller's shop", "WHITLOCK", "black", "white", "black", ("render", "cream"), 3, 2, bars=2,
         small="JEWELLERS", room="navy", open=False, card=("RING FOR", "ENTRY"), door_side=-0.26),
    Shop(26, 11.0, "post office", "POST OFFICE", "red", "white", "blue", ("stone", "honey"), 3, 4, parapet=True, bars=2,
         lit=((1, 2),), room="white", open=True, card=("9 TO 5.30", "SAT 9 TO 1"), door_side=0.25),
)  # fmt: skip


def plots() -> dict[int, Plot]:
    """Return the plot of each building, by house number."""
    plot_of: dict[int, Plot] = {}
    for row, x, bearing in ((WEST, WEST_FRONT, 90.0), (EAST, EAST_FRONT, 270.0)):
        y = -ROW_END
        for shop in row:
            plot_of[shop.number] = Plot(x, y + shop.width_m / 2, bearing)
            y += shop.width_m
    return plot_of


def door_x(shop: Shop) -> float:
    """Return the x coordinate of the centre of the door, in the coordinates of the shop front."""
    return shop.door_side * (shop.width_m - 2.0)


def build(stage: Stage) -> dict[int, str]:
    """Place both rows.

    Returns:
        The instance id of each shop or house, by house number.
    """
    plot_of = plots()
    return {shop.number: _house(stage, shop, plot_of[shop.number]) for shop in (*WEST, *EAST)}


def _house(stage: Stage, shop: Shop, plot: Plot) -> str:
    spec = TerracedBuilding(
        shop.width_m,
        shop.wall,
        shop.storeys,
        shop.columns,
        shop.roof,
        shop.parapet,
        bars=shop.bars,
        lit=frozenset(shop.lit),
        shop=bool(shop.noun),
        seed=shop.number,
    )
    position, bearing = plot.at(0, 0), plot.bearing_deg
    colour, material = shop.wall[1].replace("pale ", ""), {"render": "painted render"}.get(shop.wall[0], shop.wall[0])
    storeys = {2: "two-storey", 3: "three-storey"}[shop.storeys]
    building = stage.place(
        terraced_building(spec), "building", f"{shop.wall[1]} {shop.wall[0]} building", position, bearing,
        colour=colour, material=material, storeys=shop.storeys, roof=shop.roof, number=str(shop.number),
    )  # fmt: skip
    if not shop.noun:
        pitch = shop.width_m / shop.columns
        door = shopfronts.house_door(shop.door, number=str(shop.number))
        stage.place(
            door, "door", f"{shop.door} front door", plot.at(pitch * (shop.columns - 0.5) - shop.width_m / 2, -0.09, 0.10), bearing,
            parent=building, colour=shop.door, state="closed", number=str(shop.number), kind="house door", storey=storeys,
        )  # fmt: skip
        return building
    return _front(stage, shop, plot, building)


def _front(stage: Stage, shop: Shop, plot: Plot, building: str) -> str:
    position, bearing = plot.at(0, 0), plot.bearing_deg
    front = shopfronts.ShopFront(shop.width_m, shop.colour, door_x(shop), shop.room, shop.lamps, shop.tiles)
    traits = {"state": "open" if shop.open else "closed", **shop.traits}
    name = shop.sign.title().replace("'S", "'s")
    shop_id = stage.place(
        shopfronts.shop_front(front), "shop", shop.noun, position, bearing, parent=building,
        colour=shop.colour, lights="on" if shop.lamps else "off", shop_name=name.lower(), **traits,
    )  # fmt: skip
    sign = shopfronts.fascia(shop.width_m, shop.sign, shop.colour, shop.ink, small=shop.small)
    stage.place(sign, "shop sign", f"{name} sign", position, bearing, parent=shop_id, colour=shop.colour, lettering=shop.ink)
    door = shopfronts.shop_door(shop.door, number=str(shop.number))
    door_position = plot.at(door_x(shop), -0.03, 0.13)
    stage.place(
        door, "door", f"{shop.door} shop door", door_position, bearing, parent=shop_id,
        colour=shop.door, state="closed", number=str(shop.number), kind="shop door",
    )  # fmt: skip
    _notices(stage, shop, plot, shop_id)
    if shop.awning:
        colour, second_colour, is_open = shop.awning
        awning = shop_displays.awning(shop.width_m - 0.5, colour, second_colour, is_open=is_open)
        stage.place(
            awning, "awning", f"{colour} and {second_colour} awning", plot.at(0, 0.24, 2.80), bearing, parent=shop_id,
            colour=colour, pattern="striped", state="open" if is_open else "rolled up",
        )  # fmt: skip
    if shop.hanging:
        board = shop_displays.hanging_sign(shop.hanging, shop.colour, shop.ink)
        x = shop.hanging_side * (shop.width_m / 2 - 0.35)
        stage.place(
            board, "hanging sign", f"{name} hanging sign", plot.at(x, 0.0, 4.0), bearing, parent=shop_id, colour=shop.colour
        )
    return shop_id


def _notices(stage: Stage, shop: Shop, plot: Plot, shop_id: str) -> None:
    """Place the open or closed sign on the door, and a card with the opening hours next to it."""
    bearing = plot.bearing_deg
    if shop.open is not None:
        word, tint = ("OPEN", "green") if shop.open else ("CLOSED", "red")
        notice: Built = shopfronts.plate((word,), 0.075, "white", tint)
        stage.place(
            notice, "door sign", f"{word.lower()} sign", plot.at(door_x(shop), 0.035, 1.68), bearing, parent=shop_id,
            colour="white", lettering=tint, says=word.lower(),
        )  # fmt: skip
    if shop.card:
        notice = shopfronts.plate(shop.card, 0.055, "white", "black")
        step = 1.05 if door_x(shop) <= 0 else -1.05
        stage.place(
            notice,
            "window notice",
            "notice in the window",
            plot.at(door_x(shop) + step, 0.015, 1.62),
            bearing,
            parent=shop_id,
            colour="white",
        )
