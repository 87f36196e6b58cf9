"""High street: people, dogs and pigeons, standing and on the move, and the traffic."""

from __future__ import annotations

import math

from scope_ptz.studio.kit import birds, companions, cycles, double_decker, people, poses, shopfronts, stances, umbrellas, vehicles
from scope_ptz.studio.kit.stage import ActorPath, Built, Stage
from scope_ptz.studio.kit.wet_ground import KERB_M
from scope_ptz.studio.scenes.high_street_plan import BAY_X, NORTHBOUND_X, SOUTHBOUND_X, ZEBRA, Plot
from scope_ptz.studio.scenes.high_street_shops import plots

FIRST_ACTOR = 9001
PERIOD_S = 40.0
PARKED = (
    (vehicles.hatchback, "red", "LK19 FWD", "hatchback", -38.4), (vehicles.saloon, "silver", "GY68 TNB", "saloon", -26.0),
    (vehicles.suv, "blue", "RO21 HXC", "SUV", -13.8), (vehicles.hatchback, "yellow", "EA17 JVP", "hatchback", -1.6),
    (vehicles.suv, "grey", "PD70 KUS", "SUV", 33.2), (vehicles.hatchback, "dark red", "FN15 ZLR", "hatchback", 45.6),
)  # fmt: skip
UMBRELLAS: tuple[tuple[str, str | None, float, float, float, int, bool], ...] = (
    ("red", None, -5.6, -31.5, 10, 21, True), ("black", None, 7.7, -30.0, 182, 22, True), ("yellow", None, -5.0, 1.5, 172, 23, True),
    ("blue", None, 7.9, -15.5, 5, 24, True), ("green", "white", 7.2, 12.0, 250, 25, False), ("black", None, -5.5, 26.5, 4, 26, True),
    ("purple", None, 7.6, 29.0, 176, 27, True), ("pink", None, -5.4, 40.6, 130, 28, False), ("navy", "white", 12.0, 61.2, 268, 29, True),
)  # fmt: skip
"""Colour, second colour, place, bearing, seed, walking."""
STANDING: tuple[tuple[float, float, float, str, int, str | None, str], ...] = (
    (-5.0, -6.1, 95, "stand", 41, None, "waiting"), (-4.6, -7.2, 60, "phone", 42, None, "on the phone"), (-5.4, -39.0, 178, "walk", 43, "bag", "walking"),
    (8.3, -24.0, 0, "walk", 44, None, "walking"), (7.0, 24.6, 300, "stand", 45, "bag", "standing"), (-6.4, 46.0, 60, "phone", 47, None, "on the phone"),
    (8.6, 38.0, 250, "stand", 48, "bag", "standing"), (-8.0, -50.3, 95, "walk", 49, None, "walking"), (10.5, 50.0, 275, "walk", 50, "bag", "walking"),
    (2.0, 61.0, 180, "stand", 51, None, "standing"), (2.4, -60.9, 80, "walk", 52, "bag", "walking"), (-11.0, -61.4, 268, "walk", 53, None, "walking"),
)  # fmt: skip
"""Place, bearing, pose, seed, what they hold, what they do."""


def build(stage: Stage) -> None:
    _vehicles(stage)
    _walkers(stage)
    _pairs(stage)
    _sitters(stage)
    _indoors(stage)
    _pigeons(stage)
    _actors(stage)


def _vehicles(stage: Stage) -> None:
    for make, colour, plate, noun, y in PARKED:
        built = make(colour, plate=plate)
        stage.place(
            built,
            "car",
            f"{colour} {noun}",
            (BAY_X, y, 0),
            180,
            colour=colour,
            kind=noun.lower(),
            plate=plate,
            state="parked",
            facing="south",
        )
    for colour, plate, lettering, y in (
        ("white", "VU20 DCM", "COBB & DAY\nPLUMBERS", -32.2),
        ("green", "MX18 POG", "ORCHARD\nFRUIT", 39.4),
    ):
        van = vehicles.van(colour, plate=plate, lettering=lettering)
        words = lettering.replace("\n", " ").lower()
        stage.place(
            van,
            "van",
            f"{colour} van",
            (BAY_X, y, 0),
            180,
            colour=colour,
            plate=plate,
            state="parked",
            facing="south",
            lettering=words,
        )
    taxi = vehicles.saloon("black", plate="TX16 AKE")
    cab = stage.place(
        taxi,
        "car",
        "black taxi",
        (BAY_X, -7.7, 0),
        180,
        colour="black",
        kind="taxi",
        plate="TX16 AKE",
        state="parked",
        facing="south",
    )
    for turn in (0, 180):
        lamp = shopfronts.plate(("TAXI",), 0.11, "amber", "black", border=False)
        place = Plot(BAY_X, -7.9, 180.0 + turn, 1.53)
        stage.place(lamp, "taxi sign", "taxi sign", place.at(0, 0.03), place.bearing_deg, parent=cab, state="lit", colour="amber")
    bus = double_decker.double_decker(
        "red",
        plate="BV69 HLK",
        route="7",
        destination="STATION",
        operator="HARROW VALE BUSES",
        poster="WORLD OF CARPETS  MILL LANE",
    )
    stage.place(
        bus, "bus", "red double-decker bus", (NORTHBOUND_X - 0.1, -12.0, 0), 0, colour="red", kind="double-decker", route="7",
        destination="station", plate="BV69 HLK", state="stopped", facing="north",
    )  # fmt: skip
    rows = (
        (vehicles.saloon, "white", "KP22 SEV", "saloon", (SOUTHBOUND_X + 0.2, -45.4), 180, "waiting", "south"),
        (vehicles.suv, "dark green", "OU71 BFA", "SUV", (-21.0, 57.2), 90, "moving", "east"),
        (vehicles.hatchback, "light blue", "WJ14 GCT", "hatchback", (11.5, -57.3), 270, "moving", "west"),
        (vehicles.saloon, "brown", "HD13 YRM", "saloon", (34.0, 53.4), 270, "parked", "west"),
        (vehicles.suv, "black", "SC20 NOX", "SUV", (-40.0, 53.4), 270, "parked", "west"),
        (vehicles.hatchback, "white", "DG65 LWP", "hatchback", (-30.0, -53.5), 90, "parked", "east"),
        (vehicles.saloon, "grey", "AE09 VHU", "saloon", (46.0, -53.5), 90, "parked", "east"),
    )  # fmt: skip
    for make, colour, plate, noun, (x, y), bearing, state, facing in rows:
        stage.place(
            make(colour, plate=plate),
            "car",
            f"{colour} {noun}",
            (x, y, 0),
            bearing,
            colour=colour,
            kind=noun.lower(),
            plate=plate,
            state=state,
            facing=facing,
        )


def _umbrella(stage: Stage, person: str, colour: str, second: str | None, here: Plot) -> None:
    x, y, z = stances.UMBRELLA_GRIP
    built = umbrellas.umbrella(colour, second=second)
    name = f"{colour} and {second} umbrella" if second else f"{colour} umbrella"
    stage.place(
        built,
        "umbrella",
        name,
        here.at(x, y, z),
        here.bearing_deg,
        parent=person,
        lean_deg=(-5.0, 4.0),
        colour=colour,
        state="open",
    )


def _walkers(stage: Stage) -> None:
    for colour, second, x, y, bearing, seed, walking in UMBRELLAS:
        here = Plot(x, y, bearing)
        stance = stances.with_umbrella((seed * 0.37) % 1.0 if walking else None, seed=seed)
        person = stage.place(
            people.pedestrian(stance=stance, seed=seed), "pedestrian", f"pedestrian with a {colour} umbrella", here.at(0, 0), bearing,
            state="walking" if walking else "standing", holding="umbrella", umbrella=colour,
        )  # fmt: skip
        _umbrella(stage, person, colour, second, here)
    for x, y, bearing, pose, seed, holding, doing in STANDING:
        built = people.pedestrian(pose=pose, phase=(seed * 0.29) % 1.0, holding=holding, seed=seed)
        facts = {"holding": holding} if holding else {}
        stage.place(built, "pedestrian", f"pedestrian {doing}", (x, y, KERB_M), bearing, state=doing, **facts)
    worker = people.worker(vest="orange", helmet="white", pose="clipboard", seed=61)
    stage.place(
        worker, "worker", "worker in an orange vest", (-2.75, 31.9, 0.004), 130, vest="orange", helmet="white", state="standing"
    )
    worker = people.worker(vest="yellow", helmet="blue", pose="kneel", seed=62)
    stage.place(
        worker,
        "worker",
        "kneeling worker in a yellow vest",
        (-1.5, 29.95, 0.004),
        10,
        vest="yellow",
        helmet="blue",
        state="kneeling",
    )


def _pairs(stage: Stage) -> None:
    here = Plot(-5.2, -16.6, 6.0)
    person = people.pedestrian(stance=stances.pushing(0.15), seed=8, top="green")
    stage.place(
        person, "pedestrian", "woman with a pram", here.at(0, 0), here.bearing_deg, state="walking", top="green", pushing="pram"
    )
    stage.place(companions.pram("navy"), "pram", "navy pram", here.at(0, 0.98), here.bearing_deg, colour="navy")
    here = Plot(7.9, 4.2, 186.0)
    person = people.pedestrian(stance=stances.leading(None, seed=3), seed=15, top="navy")
    owner = stage.place(
        person, "pedestrian", "man with a dog", here.at(0, 0), here.bearing_deg, state="standing", top="navy", holding="lead"
    )
    gx, gy, gz = stances.LEAD_GRIP
    dog = companions.dog("golden", lead_to=(gx - 0.62, gy - 0.15, gz), collar="blue")
    stage.place(
        dog,
        "dog",
        "golden dog",
        here.at(0.62, 0.15),
        here.bearing_deg,
        parent=owner,
        colour="golden",
        state="standing",
        collar="blue",
    )


def _sitters(stage: Stage) -> None:
    rows = (
        (Plot(-6.42, -9.2, 90.0), 0.525, 71, True, "sitting at the bus stop"), (Plot(8.92, 1.0, 270.0), 0.47, 72, False, "sitting on a bench"),
        (Plot(-6.72, 20.5, 90.0), 0.47, 75, False, "sitting on a bench"),
    )  # fmt: skip
    for here, seat, seed, crossed, doing in rows:
        built = people.pedestrian(stance=stances.sitting(seat, seed=seed, crossed=crossed), seed=seed)
        stage.place(built, "pedestrian", f"person {doing}", here.at(0, 0), here.bearing_deg, state="sitting")
    plot = plots()[5]
    for x, side, seed in ((-2.4, 1, 73), (0.2, -1, 74)):
        spot = plot.at(x + side * 0.72, 1.05 + 0.1 * side)
        bearing = plot.bearing_deg - 90 * side + (20 if side > 0 else 160 % 90)
        built = people.pedestrian(stance=stances.sitting(0.46, seed=seed), seed=seed)
        stage.place(built, "pedestrian", "person sitting at the café", spot, bearing, state="sitting")


def _indoors(stage: Stage) -> None:
    """Shopkeepers and customers behind glass."""
    for number, x, y, bearing, seed, who in (
        (3, 1.4, -1.6, 0, 81, "butcher"), (9, -1.6, -1.7, 10, 82, "baker"), (6, -1.0, -1.5, 30, 83, "hairdresser"), (5, 1.8, -1.4, -20, 84, "customer"),
        (22, -1.4, -1.7, 15, 85, "greengrocer"), (14, -1.4, -1.6, -15, 86, "estate agent"),
    ):  # fmt: skip
        plot = plots()[number]
        top = "white" if who in ("butcher", "baker") else None
        built = people.pedestrian(pose="stand", top=top, seed=seed)
        stage.place(
            built,
            "pedestrian",
            f"{who} in the shop",
            plot.at(x, y, 0.03),
            plot.bearing_deg + bearing,
            state="standing",
            behind="glass",
            role=who,
        )


def _pigeons(stage: Stage) -> None:
    flock = (
        (-4.9, -27.4, 20), (-5.3, -27.0, 130), (-4.6, -26.6, 250), (-5.6, -26.5, 300), (-5.0, -26.0, 75), (-4.5, -25.5, 190), (-5.4, -25.2, 10),
        (-5.9, -27.5, 95), (7.4, 8.4, 60), (7.8, 8.8, 200), (7.2, 9.1, 310),
    )  # fmt: skip
    looks = (
        ("grey", "stand"),
        ("grey", "peck"),
        ("dark grey", "peck"),
        ("brown", "stand"),
        ("grey", "peck"),
        ("white", "stand"),
        ("dark grey", "stand"),
    )
    made: dict[tuple[str, str], Built] = {}
    spots = [(x, y, KERB_M, b, looks[k % len(looks)]) for k, (x, y, b) in enumerate(flock)]
    for number, xs in ((7, (-1.2, -0.8, 1.4)), (12, (2.0, 1.3))):
        plot = plots()[number]
        spots += [
            (*plot.at(x, 0.28, 3.50), plot.bearing_deg + 40 * (k - 1), ("grey", "rest") if k % 2 else ("dark grey", "stand"))
            for k, x in enumerate(xs)
        ]
    spots += [(-5.6, -9.0 - 0.5 * k, KERB_M + 2.47, 80 + 60 * k, ("grey", "stand") if k else ("grey", "rest")) for k in range(2)]
    for x, y, z, bearing, look in spots:
        built = made[look].copy() if look in made else made.setdefault(look, birds.pigeon(look[0], pose=look[1]))
        state = {"stand": "standing", "peck": "pecking", "rest": "resting"}[look[1]]
        stage.place(built, "pigeon", f"{look[0]} pigeon", (x, y, z), bearing, colour=look[0], state=state)


def _actors(stage: Stage) -> None:
    walk = _closed([(-4.7, 13.3), (6.5, 13.3), (6.9, 28.0), (7.9, 28.0), (7.6, 14.3), (-4.7, 14.3)], PERIOD_S)
    dog_walk = [(-4.35, 21.5), (-4.35, 36.5), (-6.0, 36.5), (-6.0, 21.5)]
    beside = [(-3.9, 21.1), (-3.9, 36.9), (-6.45, 36.9), (-6.45, 21.1)]
    speed = 5.0
    gx, gy, gz = stances.LEAD_GRIP
    stage.actors = [
        ActorPath(
            "moving-car-01", FIRST_ACTOR, "car", "orange hatchback", lambda _phase: vehicles.hatchback("orange", plate="NB23 RTG"),
            _timed([(30.0, 53.9), (6.5, 53.9), (2.6, 52.4), (1.5, 48.5), (1.5, -36.0)], 9.0, 12.0), PERIOD_S,
            {"colour": "orange", "kind": "hatchback", "plate": "NB23 RTG", "state": "moving", "facing": "south"},
        ),
        ActorPath(
            "moving-cyclist-01", FIRST_ACTOR + 1, "cyclist", "cyclist on a blue bicycle", _cyclist,
            _timed([(2.3, 50.0), (2.45, -38.0)], speed, 4.0), PERIOD_S, {"bicycle": "blue", "state": "riding", "facing": "south"},
            stride_m=4.4,
        ),
        ActorPath(
            "moving-walker-01", FIRST_ACTOR + 2, "pedestrian", "walker with a white umbrella", _walker, walk, PERIOD_S,
            {"umbrella": "white", "state": "walking", "holding": "umbrella"}, stride_m=poses.STRIDE_M,
        ),
        ActorPath(
            "moving-walker-02", FIRST_ACTOR + 3, "pedestrian", "dog walker in a yellow jumper",
            lambda phase: people.pedestrian(stance=stances.leading(phase), top="yellow", seed=92), _closed(dog_walk, PERIOD_S), PERIOD_S,
            {"top": "yellow", "state": "walking", "holding": "lead"}, stride_m=1.15,
        ),
        ActorPath(
            "moving-dog-01", FIRST_ACTOR + 4, "dog", "black dog",
            lambda phase: companions.dog("black", phase=phase, lead_to=(gx - 0.45, gy - 0.1, gz)), _beside(dog_walk, beside), PERIOD_S,
            {"colour": "black", "state": "walking", "collar": "red"}, stride_m=0.75,
        ),
    ]  # fmt: skip


def _cyclist(phase: float) -> Built:
    bicycle = cycles.bicycle("blue", kind="town", crank_deg=360 * phase)
    rider = people.pedestrian(stance=stances.riding(360 * phase), top="dark red", trousers="black", seed=14)
    return Built.of("cyclist", [_loose(bicycle), _loose(rider)])


def _walker(phase: float) -> Built:
    person = people.pedestrian(stance=stances.with_umbrella(phase, seed=91), top="navy", seed=91)
    canopy = umbrellas.umbrella("white")
    obj = _loose(canopy)
    for vertex in obj.data.vertices:
        vertex.co = vertex.co + type(vertex.co)(stances.UMBRELLA_GRIP)
    return Built.of("walker", [_loose(person), obj])


def _loose(built: Built):  # noqa: ANN202
    """The single object of a thing, free of its root."""
    obj = built.objects[0]
    obj.parent = None
    return obj


def _height(x: float, y: float) -> float:
    """Footway or road: kerbs are dropped at the zebra."""
    on_road = -3.2 < x < 5.4
    return 0.0 if on_road and ZEBRA[0] - 1 < y < ZEBRA[1] + 1 else KERB_M


def _closed(corners: list[tuple[float, float]], period_s: float) -> list[tuple[float, float, float, float]]:
    """A closed walk at an even speed that takes ``period_s``, stepping down where it crosses the road."""
    ring = []
    for (x0, y0), (x1, y1) in zip(corners, corners[1:] + corners[:1], strict=True):
        ring.append((x0, y0))
        cuts = sorted((k for k in (-3.35, -3.1, 5.3, 5.55) if min(x0, x1) < k < max(x0, x1)), reverse=x1 < x0)
        ring += [(k, y0 + (y1 - y0) * (k - x0) / (x1 - x0)) for k in cuts]
    ring.append(corners[0])
    total = sum(math.dist(a, b) for a, b in zip(ring, ring[1:], strict=False))
    way, walked = [(0.0, *ring[0], _height(*ring[0]))], 0.0
    for a, b in zip(ring, ring[1:], strict=False):
        walked += math.dist(a, b)
        way.append((period_s * walked / total, *b, _height(*b)))
    return way


def _timed(points: list[tuple[float, float]], speed_mps: float, start_s: float) -> list[tuple[float, float, float, float]]:
    way, t = [(start_s, *points[0], 0.0)], start_s
    for a, b in zip(points, points[1:], strict=False):
        t += math.dist(a, b) / speed_mps
        way.append((t, *b, 0.0))
    return way


def _beside(lead: list[tuple[float, float]], own: list[tuple[float, float]]) -> list[tuple[float, float, float, float]]:
    """A walk along ``own`` corners that keeps step with a walker along the ``lead`` corners."""
    times = [w[0] for w in _closed(lead, PERIOD_S)]
    return [(t, *p, KERB_M) for t, p in zip(times, [*own, own[0]], strict=True)]
