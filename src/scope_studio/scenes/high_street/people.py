"""High street: people, dogs and pigeons that do not move."""

from __future__ import annotations

from scope_studio.kit.core.stage import Built, Stage
from scope_studio.kit.ground.wet_street import KERB_M
from scope_studio.kit.nature import birds, dogs
from scope_studio.kit.people import characters, prams, stances, umbrellas
from scope_studio.scenes.high_street.plan import Plot
from scope_studio.scenes.high_street.shops import plots

UMBRELLA_CARRIERS: tuple[tuple[str, str | None, float, float, float, int, bool], ...] = (
    ("red", None, -5.6, -31.5, 10, 21, True), ("black", None, 7.7, -30.0, 182, 22, True), ("yellow", None, -5.0, 1.5, 172, 23,
    True),
    ("blue", None, 7.9, -15.5, 5, 24, True), ("green", "white", 7.2, 12.0, 250, 25, False), ("black", None, -5.2, 17.4, 4, 26,
    True),
    ("purple", None, 7.6, 30.8, 176, 27, True), ("pink", None, -5.4, 40.6, 130, 28, False), ("navy", "white", 12.0, 61.2, 268,
    29, True),
)  # fmt: skip
"""People with umbrellas: the two colours of the umbrella, x, y, bearing, seed, and whether the person walks."""
PEDESTRIANS: tuple[tuple[float, float, float, str, int, str | None, str], ...] = (
    (-5.0, -6.1, 95, "stand", 41, None, "waiting"), (-4.6, -7.2, 60, "phone", 42, None, "on the phone"), (-5.4, -39.0, 178,
    "walk", 43, "bag", "walking"),
    (8.3, -24.0, 0, "walk", 44, None, "walking"), (8.75, 14.6, 300, "stand", 45, "bag", "standing"), (-6.4, 46.0, 60, "phone",
    47, None, "on the phone"),
    (8.6, 38.0, 250, "stand", 48, "bag", "standing"), (-8.0, -50.3, 95, "walk", 49, None, "walking"), (10.5, 50.0, 275, "walk",
    50, "bag", "walking"),
    (2.0, 61.0, 180, "stand", 51, None, "standing"), (2.4, -60.9, 80, "walk", 52, "bag", "walking"), (-11.0, -61.4, 268, "walk",
    53, None, "walking"),
)  # fmt: skip
"""People without umbrellas: x, y, bearing, pose, seed, held object, activity."""


def build(stage: Stage) -> None:
    """Place people, dogs and pigeons."""
    _pedestrians(stage)
    _companions(stage)
    _sitting_people(stage)
    _people_indoors(stage)
    _pigeons(stage)


def _umbrella(stage: Stage, person: str, colour: str, second: str | None, plot: Plot) -> None:
    x, y, z = stances.UMBRELLA_GRIP
    built = umbrellas.umbrella(colour, second_colour=second)
    name = f"{colour} and {second} umbrella" if second else f"{colour} umbrella"
    stage.place(
        built,
        "umbrella",
        name,
        plot.at(x, y, z),
        plot.bearing_deg,
        parent=person,
        lean_deg=(-5.0, 4.0),
        colour=colour,
        state="open",
    )


def _pedestrians(stage: Stage) -> None:
    for colour, second, x, y, bearing, seed, walking in UMBRELLA_CARRIERS:
        plot = Plot(x, y, bearing)
        stance = stances.with_umbrella((seed * 0.37) % 1.0 if walking else None, seed=seed)
        person = stage.place(
            characters.pedestrian(stance=stance, seed=seed), "pedestrian", f"pedestrian with a {colour} umbrella", plot.at(0, 0),
            bearing,
            state="walking" if walking else "standing", holding="umbrella", umbrella=colour,
        )  # fmt: skip
        _umbrella(stage, person, colour, second, plot)
    for x, y, bearing, pose, seed, holding, activity in PEDESTRIANS:
        built = characters.pedestrian(pose=pose, phase=(seed * 0.29) % 1.0, holding=holding, seed=seed)
        attributes = {"holding": holding} if holding else {}
        stage.place(built, "pedestrian", f"pedestrian {activity}", (x, y, KERB_M), bearing, state=activity, **attributes)
    worker = characters.worker(vest="orange", helmet="white", pose="clipboard", seed=61)
    stage.place(
        worker, "worker", "worker in an orange vest", (-2.75, 31.9, 0.004), 130, vest="orange", helmet="white", state="standing"
    )
    worker = characters.worker(vest="yellow", helmet="blue", pose="kneel", seed=62)
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


def _companions(stage: Stage) -> None:
    plot = Plot(-5.2, -16.6, 6.0)
    person = characters.pedestrian(stance=stances.pushing(0.15), seed=8, top="green")
    stage.place(
        person, "pedestrian", "woman with a pram", plot.at(0, 0), plot.bearing_deg, state="walking", top="green", pushing="pram"
    )
    stage.place(prams.pram("navy"), "pram", "navy pram", plot.at(0, 0.98), plot.bearing_deg, colour="navy")
    plot = Plot(7.9, 4.2, 186.0)
    person = characters.pedestrian(stance=stances.leading(None, seed=3), seed=15, top="navy")
    owner = stage.place(
        person, "pedestrian", "man with a dog", plot.at(0, 0), plot.bearing_deg, state="standing", top="navy", holding="lead"
    )
    gx, gy, gz = stances.LEAD_GRIP
    dog = dogs.dog("golden", lead_to=(gx - 0.62, gy - 0.15, gz), collar="blue")
    stage.place(
        dog,
        "dog",
        "golden dog",
        plot.at(0.62, 0.15),
        plot.bearing_deg,
        parent=owner,
        colour="golden",
        state="standing",
        collar="blue",
    )


def _sitting_people(stage: Stage) -> None:
    rows = (
        (Plot(-6.42, -9.2, 90.0), 0.525, 71, True, "sitting at the bus stop"), (Plot(8.92, 1.0, 270.0), 0.47, 72, False,
        "sitting on a bench"),
        (Plot(-6.72, 20.5, 90.0), 0.47, 75, False, "sitting on a bench"),
    )  # fmt: skip
    for place, seat, seed, crossed, activity in rows:
        built = characters.pedestrian(stance=stances.sitting(seat, seed=seed, crossed=crossed), seed=seed)
        stage.place(built, "pedestrian", f"person {activity}", place.at(0, 0), place.bearing_deg, state="sitting")
    plot = plots()[5]
    for x, side, seed in ((-2.4, 1, 73), (0.2, -1, 74)):
        position = plot.at(x + side * 0.72, 1.05 + 0.1 * side)
        bearing = plot.bearing_deg - 90 * side + (20 if side > 0 else 160 % 90)
        built = characters.pedestrian(stance=stances.sitting(0.46, seed=seed), seed=seed)
        stage.place(built, "pedestrian", "person sitting at the café", position, bearing, state="sitting")


def _people_indoors(stage: Stage) -> None:
    """Place shopkeepers and customers behind glass."""
    for number, x, y, bearing, seed, role in (
        (3, 1.4, -1.6, 0, 81, "butcher"), (9, -1.6, -1.7, 10, 82, "baker"), (6, -1.0, -1.5, 30, 83, "hairdresser"), (5, 1.8,
        -1.4, -20, 84, "customer"),
        (22, -1.4, -1.7, 15, 85, "greengrocer"), (14, -1.4, -1.6, -15, 86, "estate agent"),
    ):  # fmt: skip
        plot = plots()[number]
        top = "white" if role in ("butcher", "baker") else None
        built = characters.pedestrian(pose="stand", top=top, seed=seed)
        stage.place(
            built,
            "pedestrian",
            f"{role} in the shop",
            plot.at(x, y, 0.03),
            plot.bearing_deg + bearing,
            state="standing",
            behind="glass",
            role=role,
        )


def _pigeons(stage: Stage) -> None:
    flock = (
        (-4.9, -27.4, 20), (-5.3, -27.0, 130), (-4.6, -26.6, 250), (-5.6, -26.5, 300), (-5.0, -26.0, 75), (-4.5, -25.5, 190),
        (-5.4, -25.2, 10),
        (-5.9, -27.5, 95), (7.4, 8.4, 60), (7.8, 8.8, 200), (7.2, 9.1, 310),
    )  # fmt: skip
    kinds = (
        ("grey", "stand"),
        ("grey", "peck"),
        ("dark grey", "peck"),
        ("brown", "stand"),
        ("grey", "peck"),
        ("white", "stand"),
        ("dark grey", "stand"),
    )
    prototypes: dict[tuple[str, str], Built] = {}
    pigeons = [(x, y, KERB_M, b, kinds[k % len(kinds)]) for k, (x, y, b) in enumerate(flock)]
    for number, xs in ((7, (-1.2, -0.8, 1.4)), (12, (2.0, 1.3))):
        plot = plots()[number]
        pigeons += [
            (*plot.at(x, 0.28, 3.50), plot.bearing_deg + 40 * (k - 1), ("grey", "rest") if k % 2 else ("dark grey", "stand"))
            for k, x in enumerate(xs)
        ]
    pigeons += [(-5.6, -9.0 - 0.5 * k, KERB_M + 2.47, 80 + 60 * k, ("grey", "stand") if k else ("grey", "rest")) for k in range(2)]
    for x, y, z, bearing, kind in pigeons:
        built = prototypes[kind].copy() if kind in prototypes else prototypes.setdefault(kind, birds.pigeon(kind[0], pose=kind[1]))
        state = {"stand": "standing", "peck": "pecking", "rest": "resting"}[kind[1]]
        stage.place(built, "pigeon", f"{kind[0]} pigeon", (x, y, z), bearing, colour=kind[0], state=state)
