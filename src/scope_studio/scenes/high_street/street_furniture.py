"""High street: street furniture on the footways and along the kerbs, scaffolding, and works at a manhole."""

from __future__ import annotations

from scope_studio.kit.buildings import shopfronts
from scope_studio.kit.core.stage import Built, Stage
from scope_studio.kit.furniture import roadside, street, traditional
from scope_studio.kit.ground.wet_street import KERB_M
from scope_studio.kit.vehicles import cycles
from scope_studio.kit.works import barriers, materials, street_works
from scope_studio.scenes.high_street.plan import EAST_KERB, WEST_KERB, ZEBRA, Plot
from scope_studio.scenes.high_street.shops import plots

WEST_X, EAST_X = WEST_KERB - 0.55, EAST_KERB + 0.55
"""x coordinates of the posts along the western and the eastern kerb."""

LAMPS = (
    (WEST_X - 5.0, -51.3, True), (WEST_X, -16.5, True), (WEST_X, 6.0, True), (WEST_X, 31.0, False),
    (EAST_X, -27.0, True), (EAST_X, -5.0, True), (EAST_X, 21.4, True), (EAST_X, 41.0, True),
)  # fmt: skip
"""Street lamps: x, y, and whether the lamp is lit."""
BASKETS = (("red", "white"), ("purple", "pink"), ("yellow", "orange"), ("pink", "white"))
"""Flower colours of the hanging baskets."""


def build(stage: Stage) -> None:
    """Place the street furniture and the street works."""
    _lamps(stage)
    _posts(stage)
    _seats(stage)
    _bicycles(stage)
    _signals(stage)
    _signs(stage)
    _manhole(stage)
    _scaffold(stage)


def _lamps(stage: Stage) -> None:
    prototypes: dict[bool, Built] = {}
    baskets: dict[int, Built] = {}
    for k, (x, y, lit) in enumerate(LAMPS):
        built = prototypes[lit].copy() if lit in prototypes else prototypes.setdefault(lit, traditional.street_lamp(lit=lit))
        post = stage.place(
            built, "lamp post", "street lamp", (x, y, KERB_M), 90, colour="dark green", state="lit" if lit else "unlit"
        )
        for side in (-1, 1):
            index = (2 * k + (side > 0)) % len(BASKETS)
            basket = (
                baskets[index].copy()
                if index in baskets
                else baskets.setdefault(index, traditional.hanging_basket(BASKETS[index], seed=index))
            )
            stage.place(
                basket, "hanging basket", f"hanging basket of {BASKETS[index][0]} flowers", (x, y + side * 0.63, KERB_M + 3.28),
                40.0 * k, parent=post, colour=BASKETS[index][0],
            )  # fmt: skip


def _posts(stage: Stage) -> None:
    z = KERB_M
    for k, (x, y) in enumerate(((WEST_X, ZEBRA[0] - 0.7), (EAST_X, ZEBRA[1] + 0.7))):
        stage.place(
            traditional.belisha_beacon(), "belisha beacon", "belisha beacon", (x, y, z), 90 * k, colour="amber", state="lit"
        )
    stage.place(
        traditional.post_box(), "post box", "red post box", (EAST_X + 0.1, 37.6, z), 270, colour="red", material="cast iron"
    )
    stage.place(traditional.phone_box(), "phone box", "red phone box", (EAST_X + 0.5, 32.6, z), 270, colour="red")
    for colour, x, y, bearing in (
        ("dark green", WEST_X, -4.6, 270), ("dark green", WEST_X, 24.5, 270), ("black", EAST_X, -13.5, 90), ("dark red", EAST_X,
        38.7, 270),
        ("dark green", EAST_X, 9.5, 90), ("dark green", 8.6, -59.6, 0),
    ):  # fmt: skip
        stage.place(street.litter_bin(colour=colour), "bin", f"{colour} litter bin", (x, y, z), bearing, colour=colour)
    bollard = roadside.bollard()
    positions = [(WEST_X + 0.1, -47.6 + 1.5 * k) for k in range(5)] + [(EAST_X - 0.1, 42.6 + 1.4 * k) for k in range(5)]
    for k, (x, y) in enumerate(positions):
        stage.place(bollard if k == 0 else bollard.copy(), "bollard", "black bollard", (x, y, z), 0, colour="black")
    for x, y, bearing in ((EAST_X, -33.2, 90), (EAST_X, 28.6, 90)):
        stage.place(traditional.parking_meter(), "parking meter", "parking meter", (x, y, z), bearing, colour="dark grey")
    planters = ((WEST_X - 0.1, -30.6, ("red", "yellow")), (WEST_X - 0.1, -21.5, ("purple", "white")), (EAST_X + 0.1, -20.0,
    ("pink", "red")),
               (EAST_X + 0.1, 26.0, ("yellow", "purple")), (WEST_X - 0.1, 40.3, ("orange", "red")))  # fmt: skip
    for k, (x, y, colours) in enumerate(planters):
        built = traditional.planter(colours, seed=10 * k)
        stage.place(built, "planter", f"planter of {colours[0]} flowers", (x, y, z), 90, colour=colours[0], material="timber")
    drain = roadside.drain()
    for k, (x, y) in enumerate(
        ((WEST_KERB + 0.3, -37), (WEST_KERB + 0.3, 9.0), (WEST_KERB + 0.3, 34), (EAST_KERB - 0.3, -16), (EAST_KERB - 0.3, 10.6))
    ):
        stage.place(drain if k == 0 else drain.copy(), "drain", "drain grate", (x, y, 0.0), 0, material="cast iron")


def _seats(stage: Stage) -> None:
    z = KERB_M
    shelter = street.bus_shelter("HIGH STREET", route="7")
    stage.place(shelter, "bus stop", "bus shelter", (-6.0, -10.0, z), 90, colour="dark grey", route="7", material="glass")
    bench = street.bench()
    for k, (x, y, bearing) in enumerate(((-6.75, -25.6, 90), (8.95, 0.6, 270), (-6.75, 20.2, 90), (5.9, -62.2, 0))):
        stage.place(bench if k == 0 else bench.copy(), "bench", "wooden bench", (x, y, z), bearing, material="timber")


def _bicycles(stage: Stage) -> None:
    stand = cycles.bike_stand()
    x = EAST_X + 0.55
    for k in range(4):
        stage.place(
            stand if k == 0 else stand.copy(), "bike stand", "steel bike stand", (x, -2.2 + 2.5 * k, KERB_M), 0, material="steel"
        )
    rows = (
        ("red", "town", True, -2.2, -0.28, 0, True), ("blue", "road", False, -2.2, 0.26, 180, True), ("green", "step-through",
        True, 0.3, 0.27, 0, True),
        ("black", "town", False, 2.8, -0.27, 180, True), ("yellow", "mountain", False, 2.8, 0.28, 0, True), ("white", "road",
        False, 5.3, -0.25, 0, False),
    )  # fmt: skip
    for colour, kind, basket, y, dx, bearing, whole in rows:
        built = cycles.bicycle(colour, kind=kind, basket=basket, front_wheel=whole)
        attributes = {} if whole else {"missing": "front wheel"}
        stage.place(
            built, "bicycle", f"{colour} bicycle", (x + dx, y, KERB_M), bearing, lean_deg=(0.0,
            6.0 if (dx < 0) == (bearing == 0) else -6.0),
            colour=colour, kind=f"{kind} bicycle", state="parked", basket=basket, **attributes,
        )  # fmt: skip
    stage.place(
        cycles.bicycle("purple", kind="step-through", basket=True), "bicycle", "purple bicycle", (-7.0, 33.2, KERB_M), 0,
        lean_deg=(0.0, -9.0), colour="purple", kind="step-through bicycle", state="parked", basket=True,
    )  # fmt: skip


def _signals(stage: Stage) -> None:
    z = KERB_M
    for x, y, bearing, state in (
        (EAST_X + 0.1, -48.6, 0, "red"), (WEST_X - 0.1, -60.2, 0, "red"), (WEST_X - 3.0, -51.3, 270, "green"), (EAST_X + 3.0,
        -59.7, 90, "green"),
    ):  # fmt: skip
        facing = {0: "north", 90: "east", 270: "west"}[bearing]
        stage.place(
            traditional.traffic_signal(state),
            "traffic light",
            f"{state} traffic light",
            (x, y, z),
            bearing,
            state=state,
            facing=facing,
        )


def _signs(stage: Stage) -> None:
    plot_of = plots()
    post = traditional.fingerpost([("STATION", 0), ("MARKET HALL", 255), ("RIVER WALK", 100), ("MUSEUM", 180)])
    stage.place(post, "signpost", "green signpost", (WEST_X - 0.1, 43.0, KERB_M), 0, colour="dark green")
    for number, x, text in ((1, 1.6, "HIGH STREET"), (2, 2.2, "HIGH STREET"), (25, -3.3, "HIGH STREET"), (26, 3.6, "HIGH STREET")):
        plot = plot_of[number]
        plate = shopfronts.plate((text,), 0.12, "white", "black")
        stage.place(plate, "street name sign", "High Street name plate", plot.at(x, 0.035, 3.95), plot.bearing_deg, colour="white")
    for x, y, bearing, text in (
        (-10.5, 48.03, 0, "CHURCH ROAD"),
        (13.0, 48.03, 0, "CHURCH ROAD"),
        (-10.5, -48.03, 180, "MILL LANE"),
        (13.0, -48.03, 180, "MILL LANE"),
        (0.95, -62.96, 0, "MILL LANE"),
    ):
        plate = shopfronts.plate((text,), 0.12, "white", "black")
        stage.place(plate, "street name sign", f"{text.title()} name plate", (x, y, KERB_M + 3.2), bearing, colour="white")
    for number, x, lines, colour in (
        (8, 2.2, ("TO LET", "WARD & LISLE", "01632 960144"), "red"),
        (14, -2.4, ("SOLD", "FINCH & POTTER", "01632 960188"), "navy"),
    ):
        plot = plot_of[number]
        plate = shopfronts.plate(lines, 0.14, colour, "white")
        stage.place(
            plate,
            "estate agent board",
            f"{lines[0].lower()} board",
            plot.at(x, 0.55, 4.6),
            plot.bearing_deg + 90,
            colour=colour,
            says=lines[0].lower(),
        )
    plot = plot_of[24]
    clock = traditional.bracket_clock(3, 40)
    stage.place(clock, "clock", "jeweller's clock", plot.at(1.6, 0.0, 4.7), plot.bearing_deg, shows="3:40", colour="black")
    for x, y, bearing, lines in (
        (WEST_X, -16.4, 90, ("NO LOADING", "MON TO SAT", "8 AM TO 6 PM")), (EAST_X, -26.9, 270, ("1 HOUR", "NO RETURN",
        "WITHIN 2 HOURS")),
        (EAST_X, 41.1, 270, ("PERMIT", "HOLDERS B", "OR 1 HOUR")), (WEST_X, 31.1, 90, ("NO LOADING", "AT ANY TIME")),
    ):  # fmt: skip
        plate = shopfronts.plate(lines, 0.055, "white", "black")
        dx = 0.09 if bearing == 90 else -0.09
        stage.place(plate, "parking sign", "parking restriction sign", (x + dx, y - 0.1, KERB_M + 2.35), bearing, colour="white")


def _manhole(stage: Stage) -> None:
    x, y = -1.55, 31.0
    stage.place(street_works.open_manhole(), "manhole", "open manhole", (x, y, 0.006), 60, state="open", material="cast iron")
    cone = barriers.cone()
    for k, (dx, dy) in enumerate(((-1.2, -1.7), (1.25, -1.6), (1.45, 0.3), (1.2, 2.0), (-1.2, 2.1), (0.0, -3.2))):
        stage.place(
            cone if k == 0 else cone.copy(), "traffic cone", "orange traffic cone", (x + dx, y + dy, 0.004), 37 * k, colour="orange"
        )
    barrier = barriers.chapter8_barrier()
    for k, (dx, dy, bearing) in enumerate(((0.0, -1.5, 180), (0.05, 1.9, 0))):
        stage.place(
            barrier if k == 0 else barrier.copy(), "barrier", "red and white works barrier", (x + dx, y + dy, 0.004), bearing,
            colour="red and white",
        )  # fmt: skip
    stage.place(materials.toolbox("blue"), "toolbox", "blue toolbox", (x - 0.9, y + 0.9, 0.004), 30, colour="blue")


def _scaffold(stage: Stage) -> None:
    plot: Plot = plots()[10]
    frame = street_works.scaffolding(7.2, 3, first_lift_m=3.75)
    scaffolding_id = stage.place(frame, "scaffolding", "scaffolding", plot.at(0, 0.12), plot.bearing_deg, material="steel")
    board = shopfronts.plate(("TURRET SCAFFOLDING", "01632 960171"), 0.15, "yellow", "black")
    stage.place(
        board, "sign", "scaffolder's sign", plot.at(0.4, 1.60, 6.25), plot.bearing_deg, parent=scaffolding_id, colour="yellow"
    )
    ladder = street_works.ladder(5.0, 12.0)
    stage.place(ladder, "ladder", "aluminium ladder", plot.at(-2.4, 2.35), plot.bearing_deg, state="leaning", material="aluminium")
