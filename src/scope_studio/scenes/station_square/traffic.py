"""Station square: the tram at its stop, taxis, parked vehicles, and moving vehicles."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

from scope_studio.kit.core.finishes import glow, paint
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import ActorPath, Built, Stage
from scope_studio.kit.people import characters, stances
from scope_studio.kit.vehicles import cars, cycles, tram
from scope_studio.scenes.station_square.ground import ROAD_Z_M, TRACKS

FIRST_ACTOR = 9001
"""Number of the first actor in instance masks. All static instances have smaller numbers."""
TAXI_ROOF_M = 1.445
"""Height in metres of a taxi's roof."""

TAXIS = [("black", "RM19 TXA", -4.6, "lit"), ("silver", "LK70 CBD", 1.2, "unlit"), ("black", "VE22 HGS", 6.9, "lit")]
"""Taxis on the rank: colour, number plate, y coordinate, state of the roof sign."""

PARKED_CARS: list[tuple[Callable[..., Built], str, str, str, float, float, float]] = [
    (cars.hatchback, "hatchback", "red", "GX68 LOM", 31.4, -6.4, 180.0),
    (cars.suv, "SUV", "white", "TY21 NEB", 31.4, 16.4, 180.0),
    (cars.hatchback, "hatchback", "blue", "PD17 WKU", 24.6, -24.3, 270.0),
    (cars.saloon, "saloon", "dark red", "HN65 RJF", -22.0, -24.3, 270.0),
    (cars.suv, "SUV", "dark green", "CE70 ZQA", -29.4, -24.3, 270.0),
    (cars.hatchback, "hatchback", "yellow", "AO18 SVT", 17.8, -24.3, 270.0),
]
"""Cars parked around the square: builder, noun, colour, plate, x, y, bearing."""

STREET_CARS: list[tuple[Callable[..., Built], str, str, str, float]] = [
    (cars.saloon, "saloon", "grey", "EJ18 PYT", 51.0),
    (cars.hatchback, "hatchback", "orange", "NR14 LKV", 57.2),
    (cars.suv, "SUV", "black", "BU22 ODA", 69.5),
    (cars.hatchback, "hatchback", "white", "YC16 FHM", -52.0),
    (cars.saloon, "saloon", "silver", "MT71 ESG", -64.5),
]
"""Cars parked farther along the street: builder, noun, colour, plate, x."""


def build(stage: Stage) -> None:
    """Place the vehicles that do not move. ``actors`` returns the moving vehicles."""
    _tram(stage)
    _taxis(stage)
    _parked(stage)


def _tram(stage: Stage) -> None:
    car = tram.tram("red", line="2", destination="RIVERSIDE", number="1407", company="ALDERMERE TRAMWAYS")
    stage.place(
        car,
        "tram",
        "red and cream tram",
        (-25.4, TRACKS[0], ROAD_Z_M),
        90,
        colour="red and cream",
        state="standing",
        facing="east",
        line="2",
        destination="riverside",
        number="1407",
    )


def taxi_sign(lit: bool) -> Built:
    """Build the sign for the roof of a taxi."""
    s = Solid("taxi sign")
    s.box((0.62, 0.16, 0.19), (0, 0, 0.10), glow("yellow", 1.3) if lit else paint("cream", dirt=0.1, roughness=0.3), 0.03)
    for facing, y in (("+Y", 0.0815), ("-Y", -0.0815)):
        s.text("TAXI", 0.115, (0, y, 0.10), paint("black", dirt=0.0), facing=facing)
    return s.built()


def _taxis(stage: Stage) -> None:
    for k, (colour, plate, y, sign) in enumerate(TAXIS):
        cab = stage.place(
            cars.saloon(colour, plate=plate),
            "taxi",
            f"{colour} taxi",
            (25.2, y, ROAD_Z_M),
            0,
            colour=colour,
            plate=plate,
            state="parked",
            facing="north",
            light=sign,
            position=k + 1,
        )
        stage.place(
            taxi_sign(sign == "lit"),
            "taxi sign",
            "taxi roof sign",
            (25.2, y - 0.25, ROAD_Z_M + TAXI_ROOF_M),
            0,
            parent=cab,
            state=sign,
        )


def _parked(stage: Stage) -> None:
    for make, noun, colour, plate, x, y, bearing in PARKED_CARS:
        stage.place(
            make(colour, plate=plate),
            "car",
            f"{colour} {noun}",
            (x, y, ROAD_Z_M),
            bearing,
            colour=colour,
            kind=noun.lower(),
            plate=plate,
            state="parked",
            facing="south" if bearing == 180 else "west",
        )
    for make, noun, colour, plate, x in STREET_CARS:
        stage.place(
            make(colour, plate=plate),
            "car",
            f"{colour} {noun}",
            (x, -24.3, ROAD_Z_M),
            270,
            colour=colour,
            kind=noun.lower(),
            plate=plate,
            state="parked",
            facing="west",
            area="street",
        )
    van = cars.van("blue", plate="WJ69 FDC", lettering="FENWICK\nBAKERS")
    stage.place(
        van,
        "van",
        "blue delivery van",
        (31.3, 7.2, ROAD_Z_M),
        180,
        colour="blue",
        plate="WJ69 FDC",
        state="parked",
        facing="south",
        lettering="fenwick bakers",
    )


def _bend(centre: tuple[float, float], radius: float, start: float, stop: float, steps: int = 7) -> list[tuple[float, float]]:
    """Return the points of an arc. Bearings are in degrees clockwise from north."""
    angles = [math.radians(start + (stop - start) * k / steps) for k in range(steps + 1)]
    return [(centre[0] + radius * math.sin(a), centre[1] + radius * math.cos(a)) for a in angles]


def _ground_height(x: float, y: float) -> float:
    """Return the height of the ground. Carriageways are lower than the paving."""
    return ROAD_Z_M if y < -11.9 or 23.6 < x < 32.4 else 0.0


def timed_path(
    corners: list[tuple[float, float]], speed_mps: float, start_s: float = 0.0
) -> list[tuple[float, float, float, float]]:
    """Return the waypoints (t_s, x, y, z) of a path on the ground through ``corners``, at constant speed."""
    waypoints, t = [(start_s, *corners[0], _ground_height(*corners[0]))], start_s
    for (x0, y0), (x1, y1) in pairwise(corners):
        t += math.hypot(x1 - x0, y1 - y0) / speed_mps
        waypoints.append((t, x1, y1, _ground_height(x1, y1)))
    return waypoints


def _moving_taxi() -> Built:
    cab = cars.saloon("yellow", plate="SD20 KWN")
    sign = taxi_sign(True)
    sign.root.parent = cab.root
    sign.root.location = (0.0, -0.25, TAXI_ROOF_M)
    return Built(cab.root, [*cab.objects, *sign.objects], [])


def _cyclist() -> Built:
    bike = cycles.bicycle("red", kind="town", basket=True, crank_deg=70.0)
    person = characters.pedestrian(top="light blue", trousers="denim", seed=733, stance=stances.riding(70.0))
    person.root.parent = bike.root
    return Built(bike.root, [*bike.objects, *person.objects], [])


def actors() -> list[ActorPath]:
    """Return the actors: a taxi that drives along the street, and a cyclist who crosses the square."""
    taxi_path = [
        (-40.2, -58.0),
        (-40.2, -28.0),
        *_bend((-32.6, -28.0), 7.6, 270, 360),
        (33.4, -20.4),
        *_bend((33.4, -28.0), 7.6, 0, 90),
        (41.0, -58.0),
    ]
    cyclist_path = [
        (42.0, -50.0),
        (42.0, -24.0),
        (38.0, -17.0),
        (33.0, -13.4),
        (24.4, -10.4),
        (23.2, -10.4),
        (16.0, -10.5),
        (3.0, -10.5),
        (-6.5, -7.6),
        (-10.4, -4.6),
        (-11.0, -1.0),
        (-13.4, 3.4),
        (-16.3, 7.3),
        (-18.3, 10.8),
        (-21.5, 15.5),
        (-26.5, 18.7),
        (-36.0, 19.0),
        (-42.0, 19.0),
    ]
    return [
        ActorPath(
            "moving-taxi-01",
            FIRST_ACTOR,
            "taxi",
            "yellow taxi",
            lambda _phase: _moving_taxi(),
            timed_path(taxi_path, 7.5),
            42.0,
            {"colour": "yellow", "state": "moving", "plate": "SD20 KWN"},
        ),
        ActorPath(
            "moving-cyclist-01",
            FIRST_ACTOR + 1,
            "cyclist",
            "cyclist on a red bicycle",
            lambda _phase: _cyclist(),
            timed_path(cyclist_path, 3.6, 2.0),
            46.0,
            {"colour": "light blue", "state": "riding", "bicycle": "red"},
        ),
    ]
