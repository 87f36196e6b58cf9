"""High street: goods in the shop windows and on the footway."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from scope_studio.kit.buildings.shopfronts import SILL_M
from scope_studio.kit.core.stage import Built, Stage
from scope_studio.kit.furniture import cafe, shop_displays, shop_goods
from scope_studio.kit.works import equipment, materials
from scope_studio.scenes.high_street.shops import plots

SHELF_HEIGHT_M = SILL_M - 0.012  # height of the display shelf in a shop window

WindowItem = tuple[Callable[[], Built], str, str, dict[str, str]]
"""An item in a shop window: function that builds it, category, name and attributes."""


def build(stage: Stage, shops: dict[int, str]) -> None:
    """Place the goods of all shops. ``shops`` contains the instance ids of the shops by house number."""
    _windows(stage, shops)
    _boards(stage, shops)
    _greengrocer(stage, shops[22])
    _florist(stage, shops[4])
    _cafe(stage, shops[5])
    _hardware(stage, shops[23])
    _deliveries(stage)


def _row(
    stage: Stage,
    number: int,
    parent: str,
    xs: Sequence[float],
    items: Sequence[WindowItem],
    *,
    y: float = -0.30,
    z: float = SHELF_HEIGHT_M,
) -> None:
    """Place goods in a row on the display shelf of a shop's window. Identical goods are linked copies."""
    plot = plots()[number]
    prototypes: dict[str, Built] = {}
    for k, x in enumerate(xs):
        make, category, name, attributes = items[k % len(items)]
        built = prototypes[name].copy() if name in prototypes else prototypes.setdefault(name, make())
        shift = 0.06 * ((k * 7) % 3 - 1)
        stage.place(
            built,
            category,
            name,
            plot.at(x, y + shift, z),
            plot.bearing_deg + 9 * ((k * 5) % 4 - 1.5),
            parent=parent,
            behind="glass",
            **attributes,
        )


def _windows(stage: Stage, shops: dict[int, str]) -> None:
    goods = shop_goods
    loaves: list[WindowItem] = [
        (lambda: goods.loaf(1), "loaf", "loaf of bread", {}),
        (lambda: goods.loaf(2), "loaf", "crusty loaf", {}),
    ]
    _row(stage, 9, shops[9], (-2.7, -2.3, -1.9, -1.5, -1.1), loaves)
    _row(stage, 9, shops[9], (2.7, 2.15, 1.6, 1.05), [
        (lambda: goods.cake("pink"), "cake", "pink cake", {"colour": "pink"}), (lambda: goods.cake("white"), "cake",
        "white cake", {"colour": "white"}),
        (lambda: goods.cake("brown"), "cake", "chocolate cake", {"colour": "brown"}),
    ])  # fmt: skip
    _row(stage, 3, shops[3], (2.6, 2.1, 1.6, 1.1, 0.6), [(goods.ham, "ham", "hanging ham", {"state": "hanging"})], z=2.10)
    books = [
        (lambda c=c: goods.book(c, seed=len(c)), "book", f"{c} book", {"colour": c})
        for c in ("red", "navy", "green", "yellow", "purple", "light blue", "black", "orange")
    ]
    _row(stage, 7, shops[7], (2.55, -2.4, -2.0, -1.6, -1.2, -0.8, -0.4, 0.0), books)
    _row(stage, 17, shops[17], (2.7, 2.3, -2.6, -2.1, -1.6, -1.1, -0.6), [
        (lambda c=c: goods.bottle(c), "bottle", f"{c} bottle", {"colour": c}) for c in ("green", "blue", "amber", "green", "red",
        "blue")
    ])  # fmt: skip
    _row(stage, 15, shops[15], (-2.7, -1.5, 1.4, 2.7), [
        (lambda: goods.mannequin("yellow"), "mannequin", "mannequin in a yellow dress", {"colour": "yellow"}),
        (lambda: goods.mannequin("grey", dress=False), "mannequin", "mannequin in a grey coat", {"colour": "grey"}),
        (lambda: goods.mannequin("green", dress=False), "mannequin", "mannequin in a green coat", {"colour": "green"}),
    ], y=-0.5, z=SHELF_HEIGHT_M - 0.05)  # fmt: skip
    _row(stage, 20, shops[20], (-2.8, -1.5, 1.5, 2.8), [
        (lambda: goods.mannequin("red"), "mannequin", "mannequin in a red dress", {"colour": "red"}),
        (lambda: goods.mannequin("navy", dress=False), "mannequin", "mannequin in a navy coat", {"colour": "navy"}),
        (lambda: goods.mannequin("purple"), "mannequin", "mannequin in a purple dress", {"colour": "purple"}),
        (lambda: goods.mannequin("black", dress=False), "mannequin", "mannequin in a black coat", {"colour": "black"}),
    ], y=-0.5, z=SHELF_HEIGHT_M - 0.05)  # fmt: skip
    _row(stage, 12, shops[12], (-2.7, -2.2, -1.7, -1.2, 1.1, 1.7, 2.3, 2.8), [
        (lambda c=c: goods.teapot(c), "teapot", f"{c} teapot", {"colour": c}) for c in ("blue", "white", "red", "yellow", "green")
    ])  # fmt: skip
    _row(stage, 16, shops[16], (-2.8, 0.0, 0.6, 1.2, 1.8, 2.4), [
        (lambda: goods.table_lamp("cream"), "table lamp", "lit cream lamp", {"colour": "cream", "state": "lit"}),
        (lambda: goods.table_lamp("red", lit=False), "table lamp", "unlit red lamp", {"colour": "red", "state": "unlit"}),
        (lambda: goods.table_lamp("orange"), "table lamp", "lit orange lamp", {"colour": "orange", "state": "lit"}),
        (lambda: goods.table_lamp("green", lit=False), "table lamp", "unlit green lamp", {"colour": "green", "state": "unlit"}),
    ])  # fmt: skip


BOARDS: tuple[tuple[int, float, float, tuple[str, ...], str], ...] = (
    (3, -2.6, 2.2, ("LAMB CHOPS", "9.50 A KILO", "SAUSAGES", "6.20"), "black"),
    (5, 3.2, 2.5, ("SOUP", "AND A ROLL", "4.80", "TEA 1.90"), "dark green"),
    (9, 2.2, 2.3, ("FRESH BREAD", "2.40", "HOT PIES", "3.10"), "navy"),
    (7, -2.4, 2.4, ("BOOK SALE", "TODAY"), "dark red"),
    (17, -2.2, 2.4, ("FLU JABS", "WALK IN"), "green"),
    (25, -3.6, 2.2, ("PIE AND PINT", "12.50", "LIVE MUSIC", "FRIDAY"), "black"),
    (20, 2.6, 0.95, ("COATS", "FROM 45.00"), "black"),
    (22, -3.4, 0.85, ("PLUMS", "1.80 A KILO", "LEEKS 0.95"), "dark green"),
    (16, -2.4, 2.5, ("LAMPS", "HALF PRICE"), "navy"),
    (6, 2.3, 2.4, ("CUT AND DRY", "28.00", "NO BOOKING"), "black"),
)
"""Pavement boards: house number of the shop, position in front of the shop (x and y in metres), lines, colour."""


def _boards(stage: Stage, shops: dict[int, str]) -> None:
    for number, x, y, lines, colour in BOARDS:
        plot = plots()[number]
        board = shop_displays.a_board(lines, colour, "white")
        bearing = plot.bearing_deg + 90 + (12 if number % 3 else -9)
        stage.place(
            board,
            "pavement board",
            f"{colour} pavement board",
            plot.at(x, y),
            bearing,
            parent=shops[number],
            colour=colour,
            says=" ".join(lines).lower(),
        )


def _greengrocer(stage: Stage, shop: str) -> None:
    plot = plots()[22]
    prices = {
        "apples": "1.60",
        "oranges": "3 FOR 1.00",
        "lemons": "0.40",
        "tomatoes": "2.20",
        "potatoes": "0.90",
        "cabbages": "1.10",
        "green apples": "1.75",
    }
    prototypes: dict[str, Built] = {}
    for k, load in enumerate(("apples", "oranges", "cabbages", "potatoes", "tomatoes", "lemons", "green apples", "oranges")):
        built = prototypes[load].copy() if load in prototypes else prototypes.setdefault(load, shop_displays.crate(load))
        x, y = 0.55 - 0.62 * (k % 6) if k < 6 else -0.2 - 0.9 * (k - 6), 0.62 if k < 6 else 1.15
        stage.place(
            built, "crate", f"crate of {load}", plot.at(x, y, 0.0 if k >= 6 else 0.22), plot.bearing_deg, parent=shop,
            load=load, state="full", material="timber",
        )  # fmt: skip
        if k < 6:
            empty = (
                prototypes["none"].copy()
                if "none" in prototypes
                else prototypes.setdefault("none", shop_displays.crate(None, colour="green"))
            )
            stage.put(empty, plot.at(x, y, 0.0), plot.bearing_deg)
            card = shop_displays.price_card(load.upper(), prices[load])
            stage.place(
                card,
                "price card",
                f"price of {load}",
                plot.at(x, y - 0.12, 0.44),
                plot.bearing_deg,
                parent=shop,
                price=prices[load].lower(),
            )


def _florist(stage: Stage, shop: str) -> None:
    plot = plots()[4]
    for k, colours in enumerate(
        (
            ("red",),
            ("yellow",),
            ("pink", "white"),
            ("purple",),
            ("white",),
            ("orange", "yellow"),
            ("red", "pink"),
            ("yellow", "white"),
        )
    ):
        x, y = 0.9 - 0.52 * (k % 6), 0.55 + 0.5 * (k // 6) + 0.08 * (k % 2)
        stage.place(
            shop_displays.flower_bucket(colours, seed=k), "flower bucket", f"bucket of {colours[0]} flowers", plot.at(x, y),
            30.0 * k, parent=shop, colour=colours[0],
        )  # fmt: skip


def _cafe(stage: Stage, shop: str) -> None:
    plot = plots()[5]
    table = chair = None
    for k, (x, seats) in enumerate(((-2.4, (20, 200)), (0.2, (0, 160)), (2.2, (185,)))):
        table = cafe.table("grey") if table is None else table.copy()
        stage.place(table, "table", "café table", plot.at(x, 1.05), plot.bearing_deg, parent=shop, colour="grey")
        for seat in seats:
            chair = cafe.chair("dark red") if chair is None else chair.copy()
            side = 1 if seat < 90 else -1
            stage.place(
                chair, "chair", "red café chair", plot.at(x + side * 0.72, 1.05 + 0.1 * side),
                plot.bearing_deg - 90 * side + (seat % 90), parent=shop,
                colour="dark red",
            )  # fmt: skip
        if k < 2:
            cup = cafe.cup("white")
            stage.place(
                cup, "cup", "white cup", plot.at(x + 0.12, 1.15, cafe.TABLE_HEIGHT_M), 40.0 * k, parent=shop, colour="white"
            )


def _hardware(stage: Stage, shop: str) -> None:
    plot = plots()[23]
    stage.place(
        equipment.wheelbarrow("green", load=False),
        "wheelbarrow",
        "green wheelbarrow",
        plot.at(2.4, 0.75),
        plot.bearing_deg + 70,
        parent=shop,
        colour="green",
        state="empty",
    )
    stage.place(
        equipment.wheelbarrow("red", load=False),
        "wheelbarrow",
        "red wheelbarrow",
        plot.at(-2.9, 0.75),
        plot.bearing_deg + 80,
        parent=shop,
        colour="red",
        state="empty",
    )
    for k, colour in enumerate(("red", "green")):
        stage.place(
            materials.fuel_can(colour),
            "fuel can",
            f"{colour} fuel can",
            plot.at(1.25 + 0.4 * k, 0.45),
            plot.bearing_deg + 15,
            parent=shop,
            colour=colour,
        )
    stage.place(materials.toolbox("red"), "toolbox", "red toolbox", plot.at(-1.5, 0.5), plot.bearing_deg, parent=shop, colour="red")


def _deliveries(stage: Stage) -> None:
    plot = plots()[25]
    prototypes: dict[str, Built] = {}
    for k, (colour, x, y, z) in enumerate(
        (
            ("blue", 3.6, 0.5, 0.0),
            ("blue", 3.6, 0.5, 0.25),
            ("red", 2.9, 0.55, 0.0),
            ("red", 2.9, 0.55, 0.25),
            ("yellow", 3.25, 1.0, 0.0),
        )
    ):
        built = (
            prototypes[colour].copy()
            if colour in prototypes
            else prototypes.setdefault(colour, shop_displays.crate(None, colour=colour))
        )
        stage.place(
            built,
            "crate",
            f"{colour} delivery crate",
            plot.at(x, y, z),
            plot.bearing_deg + 6 * (k % 3 - 1),
            colour=colour,
            state="empty",
            material="plastic",
        )
