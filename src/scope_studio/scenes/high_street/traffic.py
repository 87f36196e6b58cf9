"""High street: parked vehicles, and all moving actors."""

from __future__ import annotations

import itertools
import math

import bpy

from scope_studio.kit.buildings import shopfronts
from scope_studio.kit.core.stage import ActorPath, Built, Stage
from scope_studio.kit.ground.wet_street import KERB_M
from scope_studio.kit.nature import dogs
from scope_studio.kit.people import characters, poses, stances, umbrellas
from scope_studio.kit.vehicles import cars, cycles, double_decker
from scope_studio.scenes.high_street.plan import BAY_X, NORTHBOUND_X, SOUTHBOUND_X, ZEBRA, Plot

FIRST_ACTOR = 9001
"""Number of the first actor in instance masks. All static instances have smaller numbers."""
PERIOD_S = 40.0
"""Period of all paths in seconds. All actors share it, so that their relative positions repeat."""
PARKED_VEHICLES = (
    (cars.hatchback, "red", "LK19 FWD", "hatchback", -38.4), (cars.saloon, "silver", "GY68 TNB", "saloon", -26.0),
    (cars.suv, "blue", "RO21 HXC", "SUV", -13.8), (cars.hatchback, "yellow", "EA17 JVP", "hatchback", -1.6),
    (cars.suv, "grey", "PD70 KUS", "SUV", 33.2), (cars.hatchback, "dark red", "FN15 ZLR", "hatchback", 45.6),
)  # fmt: skip


def build(stage: Stage) -> None:
    """Place the parked vehicles and add the actors with their paths."""
    _vehicles(stage)
    _actors(stage)


def _vehicles(stage: Stage) -> None:
    for make, colour, plate, noun, y in PARKED_VEHICLES:
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
        van = cars.van(colour, plate=plate, lettering=lettering)
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
    taxi = cars.saloon("black", plate="TX16 AKE")
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
        (cars.saloon, "white", "KP22 SEV", "saloon", (SOUTHBOUND_X + 0.2, -45.4), 180, "waiting", "south"),
        (cars.suv, "dark green", "OU71 BFA", "SUV", (-21.0, 57.2), 90, "moving", "east"),
        (cars.hatchback, "light blue", "WJ14 GCT", "hatchback", (11.5, -57.3), 270, "moving", "west"),
        (cars.saloon, "brown", "HD13 YRM", "saloon", (34.0, 53.4), 270, "parked", "west"),
        (cars.suv, "black", "SC20 NOX", "SUV", (-40.0, 53.4), 270, "parked", "west"),
        (cars.hatchback, "white", "DG65 LWP", "hatchback", (-30.0, -53.5), 90, "parked", "east"),
        (cars.saloon, "grey", "AE09 VHU", "saloon", (46.0, -53.5), 90, "parked", "east"),
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


def _actors(stage: Stage) -> None:
    crossing_path = _closed_path([(-4.7, 13.3), (6.5, 13.3), (6.9, 28.0), (7.9, 28.0), (7.6, 14.3), (-4.7, 14.3)], PERIOD_S)
    walker_path = [(-4.75, 22.8), (-4.75, 36.5), (-5.7, 36.5), (-5.7, 22.8)]
    dog_path = [(-4.3, 22.4), (-4.3, 36.9), (-6.15, 36.9), (-6.15, 22.4)]
    speed = 5.0
    gx, gy, gz = stances.LEAD_GRIP
    stage.actors = [
        ActorPath(
            "moving-car-01", FIRST_ACTOR, "car", "orange hatchback", lambda _phase: cars.hatchback("orange", plate="NB23 RTG"),
            _open_path([(30.0, 53.9), (6.5, 53.9), (2.6, 52.4), (1.5, 48.5), (1.5, -36.0)], 9.0, 12.0), PERIOD_S,
            {"colour": "orange", "kind": "hatchback", "plate": "NB23 RTG", "state": "moving", "facing": "south"},
        ),
        ActorPath(
            "moving-cyclist-01", FIRST_ACTOR + 1, "cyclist", "cyclist on a blue bicycle", _cyclist,
            _open_path([(2.3, 50.0), (2.45, -38.0)], speed, 4.0), PERIOD_S,
            {"bicycle": "blue", "state": "riding", "facing": "south"}, stride_m=4.4,
        ),
        ActorPath(
            "moving-walker-01", FIRST_ACTOR + 2, "pedestrian", "walker with a white umbrella", _walker, crossing_path, PERIOD_S,
            {"umbrella": "white", "state": "walking", "holding": "umbrella"}, stride_m=poses.STRIDE_M,
        ),
        ActorPath(
            "moving-walker-02", FIRST_ACTOR + 3, "pedestrian", "dog walker in a yellow jumper",
            lambda phase: characters.pedestrian(stance=stances.leading(phase), top="yellow", seed=92),
            _closed_path(walker_path, PERIOD_S), PERIOD_S,
            {"top": "yellow", "state": "walking", "holding": "lead"}, stride_m=1.15,
        ),
        ActorPath(
            "moving-dog-01", FIRST_ACTOR + 4, "dog", "black dog",
            lambda phase: dogs.dog("black", phase=phase, lead_to=(gx - 0.45, gy - 0.1, gz)), _companion_path(walker_path, dog_path),
            PERIOD_S,
            {"colour": "black", "state": "walking", "collar": "red"}, stride_m=0.75,
        ),
    ]  # fmt: skip


def _cyclist(phase: float) -> Built:
    bicycle = cycles.bicycle("blue", kind="town", crank_deg=360 * phase)
    rider = characters.pedestrian(stance=stances.riding(360 * phase), top="dark red", trousers="black", seed=14)
    return Built.of("cyclist", [_detach(bicycle), _detach(rider)])


def _walker(phase: float) -> Built:
    person = characters.pedestrian(stance=stances.with_umbrella(phase, seed=91), top="navy", seed=91)
    canopy = umbrellas.umbrella("white")
    obj = _detach(canopy)
    for vertex in obj.data.vertices:
        vertex.co = vertex.co + type(vertex.co)(stances.UMBRELLA_GRIP)
    return Built.of("walker", [_detach(person), obj])


def _detach(built: Built) -> bpy.types.Object:
    """Detach the first Blender object of ``built`` from its root, and return it."""
    obj = built.objects[0]
    obj.parent = None
    return obj


def _ground_height(x: float, y: float) -> float:
    """Return the height of the ground at a point on a footway or on the zebra crossing."""
    on_road = -3.2 < x < 5.4
    return 0.0 if on_road and ZEBRA[0] - 1 < y < ZEBRA[1] + 1 else KERB_M


def _closed_path(corners: list[tuple[float, float]], period_s: float) -> list[tuple[float, float, float, float]]:
    """Return the waypoints of a closed path that takes ``period_s`` at constant speed. The road is lower than the footways."""
    ring = []
    for (x0, y0), (x1, y1) in zip(corners, corners[1:] + corners[:1], strict=True):
        ring.append((x0, y0))
        cuts = sorted((k for k in (-3.35, -3.1, 5.3, 5.55) if min(x0, x1) < k < max(x0, x1)), reverse=x1 < x0)
        ring += [(k, y0 + (y1 - y0) * (k - x0) / (x1 - x0)) for k in cuts]
    ring.append(corners[0])
    total = sum(math.dist(a, b) for a, b in itertools.pairwise(ring))
    waypoints, walked = [(0.0, *ring[0], _ground_height(*ring[0]))], 0.0
    for a, b in itertools.pairwise(ring):
        walked += math.dist(a, b)
        waypoints.append((period_s * walked / total, *b, _ground_height(*b)))
    return waypoints


def _open_path(points: list[tuple[float, float]], speed_mps: float, start_s: float) -> list[tuple[float, float, float, float]]:
    """Return the waypoints of a path on the road, at constant speed from ``start_s``."""
    waypoints, t = [(start_s, *points[0], 0.0)], start_s
    for a, b in itertools.pairwise(points):
        t += math.dist(a, b) / speed_mps
        waypoints.append((t, *b, 0.0))
    return waypoints


def _companion_path(
    leader_corners: list[tuple[float, float]], corners: list[tuple[float, float]]
) -> list[tuple[float, float, float, float]]:
    """Return the waypoints of a path through ``corners``, in step with a leader who walks through ``leader_corners``."""
    times = [w[0] for w in _closed_path(leader_corners, PERIOD_S)]
    return [(t, *p, KERB_M) for t, p in zip(times, [*corners, corners[0]], strict=True)]
