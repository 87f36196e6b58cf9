"""Station square: the fountain, street furniture, signs, and the tram stop."""

from __future__ import annotations

from scope_studio.kit.buildings import station
from scope_studio.kit.core.finishes import paint, steel
from scope_studio.kit.core.prototypes import Prototypes
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Stage
from scope_studio.kit.furniture import clocks, fountain, plaza, roadside, street
from scope_studio.kit.ground import paving
from scope_studio.kit.people import characters, luggage
from scope_studio.kit.signs import town_signs
from scope_studio.kit.vehicles import tram

FOUNTAIN = (1.2, 6.2)
"""Position (x, y) of the fountain in metres."""
MAST = (4.0, -8.0)
"""Position (x, y) of the camera mast in metres."""
PLATFORM_TOP_M = 0.16
"""Height of the tram platform in metres."""
BENCHES = [
    (1.2, 1.6, 180.0, "bench by the fountain"),
    (5.8, 6.2, 90.0, "bench by the fountain"),
    (-3.4, 6.2, 270.0, "bench by the fountain"),
    (17.4, -3.6, 270.0, "bench under the trees"),
    (17.4, 5.4, 270.0, "bench under the trees"),
    (17.4, 13.4, 270.0, "bench under the trees"),
    (-8.5, 22.0, 180.0, "bench before the station"),
    (7.6, -9.6, 0.0, "bench by the street"),
]
"""Benches: x, y, bearing, name."""
TREES = [
    (16.6, 15.8),
    (20.3, 12.2),
    (20.3, 18.8),
    (-19.5, 20.6),
    (62.0, -10.6),
    (-64.0, -10.6),
    (84.0, -10.6),
    (-29.0, 8.4),
    (-29.5, 16.0),
    (-28.0, 22.5),
]
"""Positions (x, y) of the trees in metres."""


def build(stage: Stage) -> None:
    """Place the fixed objects of the square."""
    prototypes = Prototypes()
    _fountain(stage)
    _seats_and_bins(stage, prototypes)
    _posts_and_planters(stage, prototypes)
    _kiosk(stage)
    _signs_and_machines(stage)
    _tram_stop(stage)


def _fountain(stage: Stage) -> None:
    x, y = FOUNTAIN
    basin = stage.place(fountain.fountain_basin(2.7), "fountain", "stone fountain", (x, y, 0), 0, material="stone", state="running")
    stand = stage.place(
        fountain.plinth(["JOHN ALDER", "ENGINEER", "1811 - 1874"]),
        "plinth",
        "stone plinth",
        (x, y, 0.5),
        172,
        parent=basin,
        material="stone",
    )
    figure = fountain.apply_bronze(characters.pedestrian(top="grey", trousers="black", pose="point", seed=904))
    stage.place(
        figure,
        "statue",
        "bronze statue",
        (x, y, 2.7),
        172,
        parent=stand,
        scale=1.22,
        material="bronze",
        facing="south",
        colour="green",
    )


def _seats_and_bins(stage: Stage, prototypes: Prototypes) -> None:
    for k, (x, y, bearing, name) in enumerate(BENCHES):
        state = "occupied" if k in (0, 3, 5) else "empty"
        stage.place(prototypes.get("bench", street.bench), "bench", name, (x, y, 0), bearing, material="timber", state=state)
    for x, y in ((15.6, -8.8), (17.2, 9.6), (-11.2, 20.8), (-26.2, -7.8), (6.4, 11.2)):
        stage.place(prototypes.get("bin", street.litter_bin), "litter bin", "green litter bin", (x, y, 0), 200, colour="green")
    stage.place(street.litter_bin(colour="red"), "litter bin", "red litter bin", (11.0, 4.4, 0), 205, colour="red")
    stage.place(plaza.post_box(), "post box", "red post box", (12.0, 3.7, 0), 212, colour="red", material="iron")
    for k, (colour, word) in enumerate((("blue", "PAPER"), ("green", "GLASS"), ("yellow", "CANS"))):
        stage.place(
            plaza.recycling_bin(colour, word),
            "recycling bin",
            f"{colour} recycling bin",
            (13.3 + 0.62 * k, 2.5 - 0.36 * k, 0),
            210,
            colour=colour,
        )


def _posts_and_planters(stage: Stage, prototypes: Prototypes) -> None:
    """Place bollards, planters, lanterns, the camera mast and the flags."""
    for k in range(12):
        stage.place(
            prototypes.get("bollard", roadside.bollard),
            "bollard",
            "black bollard",
            (22.9, -9.6 + 2.6 * k, 0),
            0,
            colour="black",
            row="approach",
        )
    for k in range(11):
        x = -11.6 + 2.9 * k
        stage.place(
            prototypes.get("bollard", roadside.bollard), "bollard", "black bollard", (x, -11.2, 0), 0, colour="black", row="street"
        )
    flower_colours = [("red", "yellow"), ("pink", "white"), ("yellow", "purple"), ("red", "white")]
    planters = [
        (-4.6, 1.6),
        (7.0, 1.6),
        (-4.6, 10.8),
        (7.0, 10.8),
        (-26.9, -1.2),
        (-26.9, 2.0),
        (-8.0, 24.2),
        (8.0, 24.2),
        (14.4, -9.6),
        (-34.6, 3.9),
    ]
    for k, (x, y) in enumerate(planters):
        colour, second_colour = flower_colours[k % 4]
        stage.place(
            prototypes.get(f"planter {k % 4}", lambda a=colour, b=second_colour, k=k: plaza.planter(a, b, seed=k)),
            "planter",
            f"planter with {colour} flowers",
            (x, y, 0),
            0,
            colour=colour,
            material="timber",
        )
    for x, y, bearing in (
        (-9.0, -9.2, 0),
        (17.4, -9.8, 0),
        (-13.0, 19.2, 0),
        (5.2, 18.4, 0),
        (17.2, 1.0, 90),
        (-25.6, 12.6, 30),
        (52.0, -11.0, 0),
        (72.0, -11.0, 0),
        (-54.0, -11.0, 0),
        (-74.0, -11.0, 0),
    ):
        stage.place(
            prototypes.get("lantern", plaza.lantern_post),
            "lamp post",
            "green lamp post",
            (x, y, 0),
            bearing,
            colour="green",
            state="unlit",
        )
    mast = Solid("camera mast")
    mast.lathe([(0.16, 0.0), (0.16, 0.05), (0.075, 0.10), (0.06, 5.0), (0.05, 5.3)], paint("dark green", dirt=0.2), steps=20)
    mast.box((0.22, 0.16, 0.4), (0, -0.14, 2.6), paint("light grey", dirt=0.2), 0.02)
    mast.lathe([(0.10, 5.2), (0.12, 5.3), (0.10, 5.45), (0.02, 5.5)], paint("white", dirt=0.1), steps=20)
    stage.place(mast.built(), "camera pole", "green camera mast", (*MAST, 0), 180, colour="green")
    for k, colours in enumerate((("blue", "yellow", "blue"), ("red", "white", "green"), ("dark green", "white", "dark green"))):
        name = f"{colours[0].removeprefix('dark ')} and {colours[1]} flag"
        stage.place(
            plaza.flagpole(colours=colours, seed=k),
            "flag",
            name,
            (12.6 + 2.9 * k, 22.6, 0),
            20 - 8 * k,
            colour=name.removesuffix(" flag"),
        )


def _kiosk(stage: Stage) -> None:
    hut = stage.place(
        plaza.news_kiosk("NEWS"),
        "kiosk",
        "green news kiosk",
        (11.6, -2.0, 0),
        238,
        colour="green",
        state="open",
        sells="newspapers",
    )
    bills = [
        ("ALDERMERE POST", ["TRAM FARES", "TO RISE", "IN MAY"], (9.5, -0.2), 240),
        ("DAILY COURIER", ["MARKET IS", "300 YEARS", "OLD"], (9.4, -4.4), 262),
        ("EVENING NEWS", ["FLOOD WALL", "NEARLY", "FINISHED"], (8.7, -3.3), 250),
    ]
    for paper, lines, (x, y), bearing in bills:
        stage.place(
            plaza.headline_board(paper, lines),
            "headline board",
            f"{paper.title()} headline board",
            (x, y, 0),
            bearing,
            parent=hut,
            colour="red",
        )


def _signs_and_machines(stage: Stage) -> None:
    stage.place(
        clocks.post_clock(9, 14), "clock", "post clock", (-2.2, -6.2, 0), 118, time="9:14", colour="dark green", mounted="post"
    )
    fingers = [
        ("Town Hall 300 m", 268.0),
        ("Museum 150 m", 95.0),
        ("Library 250 m", 255.0),
        ("River Walk 600 m", 110.0),
        ("Station", 2.0),
    ]
    stage.place(town_signs.finger_post(fingers), "signpost", "wayfinding signpost", (0.8, -2.6, 0), 0, colour="green")
    stage.place(town_signs.map_board(), "map board", "town map board", (8.2, 9.0, 0), 196, colour="green")
    stage.place(
        town_signs.post_sign(["TAXIS", "RANK FOR 3 CABS"], background="blue"),
        "sign",
        "taxi rank sign",
        (23.1, 9.4, 0),
        232,
        colour="blue",
    )
    stage.place(
        town_signs.post_sign(["LOADING ONLY", "7 AM TO 11 AM"], background="white"),
        "sign",
        "loading sign",
        (33.4, 9.6, 0),
        262,
        colour="white",
    )
    stage.place(
        town_signs.post_sign(["P", "30 MINUTES", "NO RETURN"], background="blue"),
        "sign",
        "parking sign",
        (33.4, -2.0, 0),
        250,
        colour="blue",
    )
    stage.place(
        town_signs.post_sign(["CAR PARK", "84 SPACES"], background="blue", pointer="right"),
        "sign",
        "car park sign",
        (22.9, 21.8, 0),
        200,
        colour="blue",
    )
    stage.place(town_signs.no_entry(), "no entry sign", "no entry sign", (23.0, -11.5, 0), 205, colour="red")
    stage.place(town_signs.no_entry(), "no entry sign", "no entry sign", (-37.0, -25.9, 0), 20, colour="red")
    for k, (x, lit) in enumerate(((-6.2, True), (-7.4, False))):
        attributes = {"state": "working" if lit else "out of order", "screen": "lit" if lit else "unlit"}
        machine = stage.place(
            plaza.ticket_machine(lit=lit),
            "ticket machine",
            "blue ticket machine",
            (x - 1.6, 25.0, 0),
            176,
            colour="blue",
            **attributes,
        )
        if k:
            note = Solid("notice")
            note.box((0.44, 0.004, 0.30), (0, 0, 0), paint("white", dirt=0.0), 0.0)
            note.text("OUT OF", 0.075, (0, 0.0035, 0.065), paint("red", dirt=0.0))
            note.text("ORDER", 0.075, (0, 0.0035, -0.07), paint("red", dirt=0.0))
            stage.place(note.built(), "notice", "out of order notice", (x - 1.58, 24.71, 1.28), 176, parent=machine, colour="white")
    trolley = stage.place(station.luggage_trolley(), "luggage trolley", "luggage trolley", (-11.8, 23.9, 0), 70, colour="green")
    for k, (colour, dx) in enumerate((("brown", -0.35), ("black", 0.12))):
        stage.place(
            luggage.travel_bag(colour),
            "bag",
            f"{colour} travel bag",
            (-11.8 + dx, 23.9 + 0.1 * k, 0.45),
            66 + 20 * k,
            parent=trolley,
            colour=colour,
        )


def _tram_stop(stage: Stage) -> None:
    edge = Solid("tram platform")
    stone = paving.kerb_material()
    edge.box((22.0, 0.34, 0.30), (0, -1.5, 0.01), stone, 0.02)
    edge.box((22.0, 2.9, 0.28), (0, 0.1, 0.018), paving.flag_material(), 0.01)
    edge.box((22.0, 0.10, 0.004), (0, -1.22, 0.160), paint("yellow", dirt=0.3), 0.0)
    stage.place(edge.built(), "tram platform", "tram platform", (-25.0, -11.0, 0), 0, material="stone")
    z = PLATFORM_TOP_M
    stop = stage.place(
        tram.shelter("STATION SQUARE"),
        "tram shelter",
        "glass tram shelter",
        (-23.6, -10.4, z),
        180,
        material="glass",
        colour="grey",
    )
    stage.place(
        tram.stop_flag("2", direction="CITY CENTRE"),
        "tram stop sign",
        "yellow tram stop sign",
        (-16.2, -11.3, z),
        86,
        parent=stop,
        colour="yellow",
    )
    rows = [
        ("06", "12 32 52"),
        ("07", "04 14 24 34 44 54"),
        ("08", "04 14 24 34 44 54"),
        ("09", "04 19 34 49"),
        ("10", "04 19 34 49"),
        ("11", "04 19 34 49"),
    ]
    stage.place(
        tram.timetable("LINE 2", rows, cap=0.052),
        "timetable",
        "tram timetable",
        (-17.6, -10.0, z),
        98,
        parent=stop,
        scale=1.15,
        colour="white",
    )
    stage.place(
        plaza.ticket_machine(),
        "ticket machine",
        "blue ticket machine",
        (-19.4, -9.9, z),
        105,
        colour="blue",
        state="working",
        screen="lit",
    )
    pole = tram.overhead_pole()
    for k, x in enumerate((-66.0, -38.5, -12.6, 13.0, 38.5, 66.0)):
        built = pole if k == 0 else pole.copy()
        stage.place(built, "tram pole", "green tram pole", (x, -11.45, -0.02), 180, colour="green", material="steel")
    wire = Solid("contact wires")
    for y in (-13.85, -17.25):
        wire.box((230.0, 0.016, 0.016), (0, y, 5.40), steel(dark=True), 0.0)
    stage.put(wire.built(), (0, 0, 0))
