"""Commands of several steps: go, turn, zoom, photograph, come back, in the order that the instruction fixes."""

from __future__ import annotations

import random
from collections.abc import Iterator

from scope_ptz.bench.scoring.episode import CameraPosition
from scope_ptz.bench.tasks.task import Argument, Behaviour, Need, ProgramCall, RequiredCall
from scope_ptz.taskgen.authoring.drafts import Draft
from scope_ptz.taskgen.authoring.places import Place, Places, adjust, go, move, preset_at, say
from scope_ptz.taskgen.authoring.single_call import command
from scope_ptz.taskgen.authoring.words import capital

_SHOTS = ("take a picture", "take a photo", "save an image", "capture a still", "take a snapshot")
_SHAPES = (
    ("preset", "turn"),
    ("preset", "zoom", "shot"),
    ("turn", "shot"),
    ("preset", "shot", "preset", "shot"),
    ("preset", "turn", "zoom"),
    ("turn", "zoom", "shot"),
    ("preset", "shot", "home"),
    ("zoom", "shot", "preset"),
    ("turn", "shot", "turn", "shot"),
    ("preset", "tilt", "shot"),
    ("home", "turn"),
    ("preset", "shot", "turn", "shot"),
    ("preset", "turn", "shot", "home"),
    ("turn", "tilt", "zoom"),
    ("shot", "preset", "shot"),
    ("preset", "zoom"),
    ("home", "zoom", "shot"),
    ("turn", "tilt", "shot"),
    ("shot", "turn", "shot"),
    ("preset", "tilt", "zoom", "shot"),
    ("tilt", "shot", "home"),
    ("zoom", "turn", "shot", "preset"),
)
_OPENINGS = (
    "{M}.",
    "Please {m}.",
    "First {m}.",
    "I'd like you to {m}.",
    "Your next job: {m}.",
    "Could you {m}?",
    "Do this in order: {m}.",
)


def drafts(places: Places, rng: random.Random) -> Iterator[Draft]:
    names = list(places.presets)
    for n in range(60 * len(_SHAPES)):
        shape = _SHAPES[n % len(_SHAPES)]
        draft = _command(places, shape, rng.choice(names), rng)
        if draft is not None:
            yield draft


def _command(places: Places, shape: tuple[str, ...], start: str, rng: random.Random) -> Draft | None:
    scene = places.scene
    at = preset_at(places.presets[start])
    program, visited = list[ProgramCall](), [start]
    for step in shape:
        call = _step(step, places, visited, rng)
        if call is None:
            return None
        there = after(places, at, call)
        if there is None or (call.tool != "take_image" and there == at):
            return None
        at = there
        program.append(call)
    origin = places.stay(start)
    end = Place(scene, start, tuple(program), at)
    shots = shape.count("shot")
    if not shots and end.key == origin.key:
        return None
    said = [[rng.choice(_SHOTS)] if c.tool == "take_image" else [" and ".join(say(c, rng))] for c in program]
    variants = []
    for opening in _OPENINGS:
        said = [[rng.choice(_SHOTS)] if c.tool == "take_image" else [" and ".join(say(c, rng))] for c in program]
        order = joined_in_order([part for parts in said for part in parts], rng)
        variants.append(opening.format(m=order, M=capital(order)))
    calls = tuple(required(c) for c in program) if shots else ()
    return command(
        "multi_step_command",
        "-".join(shape),
        f"steps:{[c.model_dump() for c in program]}",
        origin,
        tuple(variants),
        tuple(program),
        Behaviour(final=end.final, calls=calls, pictures=shots),
        needs_of(program),
        ("picture",) if shots else (),
    )


def joined_in_order(parts: list[str], rng: random.Random) -> str:
    """Steps one after the other: never "and" alone between them, which would leave their order open."""
    last = rng.choice((", then ", " and then ", " and after that "))
    return f"{', '.join(parts[:-1])}{last}{parts[-1]}"


def required(call: ProgramCall) -> RequiredCall:
    """A step that must be seen in the run. How far the camera turned is told by its pose in the end."""
    if call.tool == "go_to_preset":
        return RequiredCall(tool="go_to_preset", arguments={"name": Argument(equals=str(call.arguments["name"]))})
    return RequiredCall(tool=call.tool)


def needs_of(program: list[ProgramCall]) -> tuple[Need, ...]:
    found: list[Need] = []
    for call in program:
        if call.tool in ("go_to_preset", "go_home"):
            found.append("preset")
        if call.arguments.get("pan_deg") or call.arguments.get("tilt_deg"):
            found.append("move")
        if "zoom_factor" in call.arguments:
            found.append("zoom")
    return tuple(dict.fromkeys(found))


def after(places: Places, at: CameraPosition, call: ProgramCall) -> CameraPosition | None:
    if call.tool == "go_to_preset":
        return preset_at(places.presets[str(call.arguments["name"])])
    if call.tool == "go_home":
        return preset_at(places.presets[places.scene.file.home_preset])
    return move(at, call) if call.tool == "adjust_ptz" else at


def _step(step: str, places: Places, visited: list[str], rng: random.Random) -> ProgramCall | None:
    match step:
        case "preset":
            fresh = [p for p in places.presets if p not in visited]
            if not fresh:
                return None
            visited.append(rng.choice(fresh))
            return go(visited[-1])
        case "home":
            return ProgramCall(tool="go_home")
        case "turn":
            return adjust(rng.choice((-1, 1)) * rng.choice((10, 15, 18, 20, 25, 30, 40, 45, 60, 90)))
        case "tilt":
            return adjust(0, rng.choice((-12, -10, -8, -5, 5, 6, 8)))
        case "zoom":
            return adjust(factor=rng.choice((1.25, 1.5, 1.75, 2.0, 2.5, 3.0)))
    return ProgramCall(tool="take_image")
