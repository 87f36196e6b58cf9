"""Multi-step command tasks: go to presets, turn, zoom, take pictures and go home, in the order of the instruction."""

from __future__ import annotations

import random
from collections.abc import Iterator

from scope_ptz.bench.scoring.episode import CameraPosition
from scope_ptz.bench.tasks.task import Argument, Behaviour, Need, ProgramCall, RequiredCall
from scope_ptz.taskgen.authoring.categories.single_call_tasks import command_draft
from scope_ptz.taskgen.authoring.drafts import TaskDraft
from scope_ptz.taskgen.authoring.noun_phrases import capitalise
from scope_ptz.taskgen.authoring.task_places import (
    ScenePlaces,
    TaskPlace,
    adjust_call,
    apply_adjustment,
    call_phrases,
    preset_call,
    preset_position,
)

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
"""The shapes of commands: sequences of steps, to which random presets and amounts are added. "shot" takes a picture."""

_OPENINGS = (
    "{M}.",
    "Please {m}.",
    "First {m}.",
    "I'd like you to {m}.",
    "Your next job: {m}.",
    "Could you {m}?",
    "Do this in order: {m}.",
)


def drafts(places: ScenePlaces, rng: random.Random) -> Iterator[TaskDraft]:
    """Yield commands of every shape, which start at random presets."""
    names = list(places.presets)
    for n in range(60 * len(_SHAPES)):
        shape = _SHAPES[n % len(_SHAPES)]
        draft = _command_draft(places, shape, rng.choice(names), rng)
        if draft is not None:
            yield draft


def _command_draft(places: ScenePlaces, shape: tuple[str, ...], start: str, rng: random.Random) -> TaskDraft | None:
    scene = places.scene
    position = preset_position(places.presets[start])
    program, visited = list[ProgramCall](), [start]
    for step in shape:
        call = _step_call(step, places, visited, rng)
        if call is None:
            return None
        next_position = position_after(places, position, call)
        if next_position is None or (call.tool != "take_image" and next_position == position):
            return None
        position = next_position
        program.append(call)
    origin = places.place_at_preset(start)
    end = TaskPlace(scene, start, tuple(program), position)
    picture_count = shape.count("shot")
    if not picture_count and end.key == origin.key:
        return None
    _step_phrases(program, rng)  # Published wordings depend on these random draws.
    variants = []
    for opening in _OPENINGS:
        moves = join_in_order(_step_phrases(program, rng), rng)
        variants.append(opening.format(m=moves, M=capitalise(moves)))
    calls = tuple(required_call(c) for c in program) if picture_count else ()
    return command_draft(
        "multi_step_command",
        "-".join(shape),
        f"steps:{[c.model_dump() for c in program]}",
        origin,
        tuple(variants),
        tuple(program),
        Behaviour(final=end.final, calls=calls, pictures=picture_count),
        collect_needs(program),
        ("picture",) if picture_count else (),
    )


def _step_phrases(program: list[ProgramCall], rng: random.Random) -> list[str]:
    """Return a phrase for each step of a program."""
    return [rng.choice(_SHOTS) if c.tool == "take_image" else " and ".join(call_phrases(c, rng)) for c in program]


def join_in_order(parts: list[str], rng: random.Random) -> str:
    """Join steps with words for their order, because "and" alone would not specify it."""
    last = rng.choice((", then ", " and then ", " and after that "))
    return f"{', '.join(parts[:-1])}{last}{parts[-1]}"


def required_call(call: ProgramCall) -> RequiredCall:
    """Return the tool call that a run must contain for a step.

    The arguments of moves are not checked here, because the check of the final pose covers them.
    """
    if call.tool == "go_to_preset":
        return RequiredCall(tool="go_to_preset", arguments={"name": Argument(equals=str(call.arguments["name"]))})
    return RequiredCall(tool=call.tool)


def collect_needs(program: list[ProgramCall]) -> tuple[Need, ...]:
    """Return the ways in which a program changes the view: by a preset, a move or a zoom."""
    needs: list[Need] = []
    for call in program:
        if call.tool in ("go_to_preset", "go_home"):
            needs.append("preset")
        if call.arguments.get("pan_deg") or call.arguments.get("tilt_deg"):
            needs.append("move")
        if "zoom_factor" in call.arguments:
            needs.append("zoom")
    return tuple(dict.fromkeys(needs))


def position_after(places: ScenePlaces, position: CameraPosition, call: ProgramCall) -> CameraPosition | None:
    """Return the camera position after a call; None if a limit would clamp the move."""
    if call.tool == "go_to_preset":
        return preset_position(places.presets[str(call.arguments["name"])])
    if call.tool == "go_home":
        return preset_position(places.presets[places.scene.file.home_preset])
    return apply_adjustment(position, call) if call.tool == "adjust_ptz" else position


def _step_call(step: str, places: ScenePlaces, visited: list[str], rng: random.Random) -> ProgramCall | None:
    match step:
        case "preset":
            unvisited = [p for p in places.presets if p not in visited]
            if not unvisited:
                return None
            visited.append(rng.choice(unvisited))
            return preset_call(visited[-1])
        case "home":
            return ProgramCall(tool="go_home")
        case "turn":
            return adjust_call(rng.choice((-1, 1)) * rng.choice((10, 15, 18, 20, 25, 30, 40, 45, 60, 90)))
        case "tilt":
            return adjust_call(0, rng.choice((-12, -10, -8, -5, 5, 6, 8)))
        case "zoom":
            return adjust_call(factor=rng.choice((1.25, 1.5, 1.75, 2.0, 2.5, 3.0)))
    return ProgramCall(tool="take_image")
