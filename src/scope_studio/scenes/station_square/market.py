"""Station square: the market stalls with their goods, and the café's terrace."""

from __future__ import annotations

import math
import random

from scope_studio.kit.core.prototypes import Prototypes
from scope_studio.kit.core.stage import Stage
from scope_studio.kit.furniture import cafe, produce, stalls

FRONT_BEARING_DEG = 150.0
"""Bearing in degrees that the fronts of the stalls face."""

CrateSpec = tuple[str, str | None]
"""Contents of a crate, and the text of its price card, with lines separated by newlines."""

StallSpec = tuple[str, tuple[str, ...], tuple[float, float], list[CrateSpec]]
"""A stall: name board, canvas colours, position and goods."""

STALLS: list[StallSpec] = [
    (
        "MARLOWE FISH",
        ("blue", "white"),
        (-19.2, -2.2),
        [("fish", "COD\n6.50"), ("salmon", "SALMON\n9.80"), ("prawns", "PRAWNS\n7.20"), ("fish", None), ("fish", "MACKEREL\n4.40")],
    ),
    (
        "MARLOW FRUIT",
        ("red", "white"),
        (-14.6, 0.5),
        [
            ("apples", "APPLES\n1.20"),
            ("green apples", "APPLES\n1.35"),
            ("oranges", "ORANGES\n1.80"),
            ("lemons", "LEMONS\n0.45"),
            ("plums", "PLUMS\n2.40"),
            ("apples", None),
            ("oranges", None),
            ("tomatoes", "TOMATOES\n1.90"),
            ("plums", None),
        ],
    ),
    (
        "GREENWAY VEG",
        ("green", "green"),
        (-10.0, 3.2),
        [
            ("carrots", "CARROTS\n0.80"),
            ("leeks", "LEEKS\n1.10"),
            ("cabbages", "CABBAGE\n1.50"),
            ("lettuces", "LETTUCE\n0.95"),
            ("peppers", "PEPPERS\n2.20"),
            ("onions", None),
            ("potatoes", "POTATOES\n0.70"),
            ("tomatoes", None),
            ("carrots", None),
        ],
    ),
    (
        "PETAL & STEM",
        ("purple", "purple"),
        (-5.4, 5.9),
        [],
    ),
    (
        "HILLTOP CHEESE",
        ("cream", "cream"),
        (-24.2, 5.0),
        [("cheeses", "CHEDDAR\n8.60"), ("cheeses", "BRIE\n7.90"), ("cheeses", None), ("cheeses", "GOUDA\n9.10")],
    ),
    (
        "THE BREAD OVEN",
        ("yellow", "white"),
        (-19.6, 7.7),
        [
            ("baguettes", "BAGUETTE\n1.60"),
            ("loaves", "RYE LOAF\n3.20"),
            ("rolls", "ROLLS\n0.55"),
            ("loaves", None),
            ("baguettes", None),
        ],
    ),
    (
        "ORCHARD FARM",
        ("orange", "white"),
        (-15.0, 10.4),
        [
            ("green apples", "APPLES\n1.25"),
            ("apples", None),
            ("plums", "PLUMS\n2.60"),
            ("potatoes", None),
            ("onions", "ONIONS\n0.85"),
        ],
    ),
    (
        "HOT PANCAKES",
        ("red", "yellow"),
        (-10.4, 13.1),
        [("rolls", None), ("lemons", "LEMON\n2.50")],
    ),
]
"""The stalls that have goods."""

EMPTY_STALL = (-5.8, 15.8)
"""Position (x, y) of the stall without goods."""
BLOOMS = ("red", "yellow", "pink", "white", "purple", "orange")
TERRACE_ROWS = (-7.4, -4.4, -1.4, 1.6)
"""y coordinates of the rows of café tables."""
TERRACE_COLUMNS = (-32.2, -28.9)
"""x coordinates of the columns of café tables."""


def at_front(place: tuple[float, float], right_m: float, out_m: float, bearing: float = FRONT_BEARING_DEG) -> tuple[float, float]:
    """Convert a position relative to the front of a stall to world coordinates.

    ``right_m`` is the distance along the front, to the right as seen by a viewer, and ``out_m`` the distance in front of it (m).
    """
    b = math.radians(bearing)
    return place[0] - right_m * math.cos(b) + out_m * math.sin(b), place[1] + right_m * math.sin(b) + out_m * math.cos(b)


def build(stage: Stage) -> None:
    """Place the stalls and the terrace."""
    prototypes = Prototypes()
    for sign, canvas, place, goods in STALLS:
        _stall(stage, prototypes, sign, canvas, place, goods)
    _flowers(stage, prototypes)
    x, y = EMPTY_STALL
    empty = stage.place(
        stalls.stall("grey", table=True, rolled=True),
        "market stall",
        "empty market stall",
        (x, y, 0),
        FRONT_BEARING_DEG,
        state="closed",
        canopy="rolled up",
    )
    cx, cy = at_front(EMPTY_STALL, 0.4, 0.5)
    stage.place(
        produce.price_card("BACK AT\nNOON", cap=0.09),
        "notice",
        "notice on the empty stall",
        (cx, cy, 0.82),
        FRONT_BEARING_DEG,
        parent=empty,
    )
    for k, (right, out) in enumerate(((-2.2, -0.6), (-2.2, 0.1), (2.3, -0.9))):
        x, y = at_front(EMPTY_STALL, right, out)
        for level in range(3 if k == 0 else 1):
            stage.place(
                prototypes.get("empty crate", produce.crate),
                "crate",
                "empty crate",
                (x, y, 0.165 * level),
                FRONT_BEARING_DEG + 7 * level,
                state="empty",
                material="timber",
            )
    _carts(stage, prototypes)
    _terrace(stage, prototypes)


def _stall(
    stage: Stage, prototypes: Prototypes, sign: str, canvas: tuple[str, ...], place: tuple[float, float], goods: list[CrateSpec]
) -> None:
    canvas_colour, second_colour = canvas
    striped = canvas_colour != second_colour
    colour = f"{canvas_colour} and {second_colour}" if striped else canvas_colour
    stall_id = stage.place(
        stalls.stall(canvas_colour, second_colour, sign=sign),
        "market stall",
        f"{colour} market stall",
        (*place, 0.0),
        FRONT_BEARING_DEG,
        colour=colour,
        pattern="striped" if striped else "plain",
        state="open",
        sells=_goods_of(sign),
    )
    for k, (kind, card) in enumerate(goods):
        row, column = divmod(k, 5)
        right, out = -1.17 + 0.585 * column, 0.70 - 0.42 * row
        x, y = at_front(place, right, out)
        z = stalls.COUNTER_HEIGHT_M + 0.145 - (out - 0.35) * math.tan(math.radians(14))
        colour = "timber" if kind not in ("fish", "salmon", "prawns") else "white"
        built = prototypes.get(
            f"{kind} {k % 2}", lambda kind=kind, k=k, colour=colour: produce.produce_crate(kind, seed=k % 2, colour=colour)
        )
        crate = stage.place(
            built,
            "crate",
            f"crate of {kind}",
            (x, y, z),
            FRONT_BEARING_DEG,
            lean_deg=(-14, 0),
            parent=stall_id,
            contents=kind,
            state="full",
        )
        if card:
            cx, cy = at_front(place, right, out - 0.19)
            stage.place(
                produce.price_card(card, cap=0.068, colour="yellow" if k % 3 == 1 else "white"), "price card",
                f"price card for {card.split(chr(10))[0].lower()}", (cx, cy, z + 0.06), FRONT_BEARING_DEG, parent=crate,
            )  # fmt: skip
    for k, right in enumerate((-1.0, 0.2, 1.1)):  # empty crates behind the counter
        if (k + len(sign)) % 2:
            x, y = at_front(place, right, -1.35)
            stage.place(
                prototypes.get("empty crate", produce.crate),
                "crate",
                "empty crate",
                (x, y, 0.0),
                FRONT_BEARING_DEG + 20 * right,
                parent=stall_id,
                state="empty",
                material="timber",
            )


def _goods_of(sign: str) -> str:
    """Return the goods that a stall sells, from its name."""
    words = {
        "FISH": "fish",
        "FRUIT": "fruit",
        "VEG": "vegetables",
        "STEM": "flowers",
        "CHEESE": "cheese",
        "BREAD": "bread",
        "FARM": "fruit",
        "PANCAKES": "pancakes",
    }
    return next(value for key, value in words.items() if key in sign)


def _flowers(stage: Stage, prototypes: Prototypes) -> None:
    place = STALLS[3][2]  # PETAL & STEM
    for k in range(14):
        bloom = BLOOMS[(k * 5 + k // 6) % 6]
        row, column = divmod(k, 5)
        right, out = -1.15 + 0.56 * column + 0.1 * row, 1.55 - 0.45 * row if row < 2 else 0.55
        x, y = at_front(place, right, out if row < 2 else 0.45)
        z = 0.0 if row < 2 else 0.90
        built = prototypes.get(f"bucket {bloom}", lambda bloom=bloom: stalls.flower_bucket(bloom))
        stage.place(built, "flower bucket", f"bucket of {bloom} flowers", (x, y, z), 40.0 * k, colour=bloom)
    for text, right in (("ROSES\n5.00", -0.6), ("TULIPS\n3.50", 0.5)):
        x, y = at_front(place, right, 0.75)
        stage.place(
            produce.price_card(text, cap=0.068),
            "price card",
            f"price card for {text.split(chr(10))[0].lower()}",
            (x, y, 0.84),
            FRONT_BEARING_DEG,
        )


def _carts(stage: Stage, prototypes: Prototypes) -> None:
    stage.place(stalls.hand_cart("green"), "hand cart", "green hand cart", (-1.4, 18.2, 0.0), 205, colour="green", state="loaded")
    rng = random.Random("cart")
    for k, kind in enumerate(("cabbages", "apples", "potatoes")):
        b = math.radians(205)
        out = 0.55 - 0.42 * k
        stage.place(
            prototypes.get(f"{kind} 0", lambda kind=kind: produce.produce_crate(kind)), "crate", f"crate of {kind}",
            (-1.4 + out * math.sin(b), 18.2 + out * math.cos(b), 0.64), 205 + rng.uniform(-5, 5), contents=kind, state="full",
        )  # fmt: skip
    stage.place(stalls.hand_cart("red"), "hand cart", "red hand cart", (-26.2, 9.6, 0.0), 70, colour="red", state="empty")


def _terrace(stage: Stage, prototypes: Prototypes) -> None:
    """Place eight tables in two columns, with three chairs at each table and parasols between the tables."""
    rng = random.Random("terrace")
    taken_seats = {(0, 0, 0), (0, 0, 1), (1, 0, 2), (0, 1, 1), (1, 2, 0), (1, 2, 1), (0, 3, 0), (1, 3, 2), (1, 3, 0)}
    for row, y in enumerate(TERRACE_ROWS):
        for column, x in enumerate(TERRACE_COLUMNS):
            occupied = sorted(seat for c, r, seat in taken_seats if (c, r) == (column, row))
            table = stage.place(
                prototypes.get("table", cafe.table),
                "table",
                "round café table",
                (x, y, 0.0),
                0,
                state="occupied" if occupied else "free",
                area="terrace",
            )
            for seat in range(3):
                position, bearing = seat_position(column, row, seat)
                tint = "dark green" if column == 0 else "red"
                stage.place(
                    prototypes.get(f"chair {tint}", lambda tint=tint: cafe.chair(tint)),
                    "chair",
                    f"{tint.removeprefix('dark ')} café chair",
                    (*position, 0.0),
                    bearing,
                    colour=tint.removeprefix("dark "),
                    state="occupied" if seat in occupied else "empty",
                    area="terrace",
                )
            for k in range(len(occupied) or rng.randrange(2)):
                a = rng.uniform(0, 6.28)
                stage.place(
                    prototypes.get("cup", cafe.cup),
                    "cup",
                    "white coffee cup",
                    (x + 0.2 * math.cos(a + 2.2 * k), y + 0.2 * math.sin(a + 2.2 * k), cafe.TABLE_HEIGHT_M),
                    rng.uniform(0, 360),
                    parent=table,
                    colour="white",
                )
    middle = sum(TERRACE_COLUMNS) / 2
    parasols = [("dark red", "cream", True), ("dark red", "cream", False), ("dark red", "cream", True), ("cream", "cream", True)]
    for (parasol_colour, second_colour, is_open), y in zip(parasols, TERRACE_ROWS, strict=True):
        colour = "cream" if parasol_colour == second_colour else "red and cream"
        stage.place(
            cafe.parasol(parasol_colour, second_colour, is_open=is_open, text="BELLAVISTA" if is_open else None),
            "parasol",
            f"{colour} parasol",
            (middle, y + 0.1, 0.0),
            12,
            colour=colour,
            state="open" if is_open else "closed",
        )
    stage.place(cafe.parasol("navy", is_open=False), "parasol", "blue parasol", (-27.0, 4.4, 0.0), 0, colour="blue", state="closed")
    menu = ["MENU", "SOUP 4.50", "OMELETTE 6.20", "FISH PIE 8.90", "PASTA 7.40", "APPLE TART 3.80"]
    stage.place(
        cafe.menu_board(menu, cap=0.085), "menu board", "chalk menu board", (-26.6, -4.6, 0.0), 98, colour="black", scale=1.1
    )


def seat_position(column: int, row: int, seat: int) -> tuple[tuple[float, float], float]:
    """Return the position of a chair of the terrace, and the bearing that a person on it faces."""
    x, y = TERRACE_COLUMNS[column], TERRACE_ROWS[row]
    bearing = (20.0, 140.0, 260.0)[seat] + 25.0 * ((row + column) % 2)
    b = math.radians(bearing)
    return (x - 0.62 * math.sin(b), y - 0.62 * math.cos(b)), bearing
