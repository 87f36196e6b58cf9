"""Convert operators' recorded runs to drafts, in the same format as drafts by language models.

A run becomes a draft if its tool calls match one of the draft programs. ``answer_programs`` decides later, from the ground truth,
whether the draft becomes a task.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

from scope_ptz.agent.records import Called
from scope_ptz.agent.trace import Trace
from scope_ptz.bench.answers import names_any
from scope_ptz.bench.tasks.task import Category
from scope_ptz.geometry import Pose
from scope_ptz.simulator.pack import Scene
from scope_ptz.taskgen.authoring.noun_phrases import object_words
from scope_ptz.taskgen.authoring.task_places import preset_position
from scope_ptz.taskgen.facts.kinds import Kind, own_colour
from scope_ptz.taskgen.generating.draft_places import DraftRejectedError
from scope_ptz.taskgen.generating.draft_schema import Draft, Program, parse_draft
from scope_ptz.taskgen.generating.run_draft_file import RunDraft

START_TOLERANCE_DEG, START_TOLERANCE_ZOOM = 0.5, 0.03
"""Maximum difference between a run's start pose and a preset's pose, in degrees of pan and tilt and as a fraction of the zoom."""
_SOURCE_NOTE = re.compile(r"\s*\(Source: [^()]*\)\s*\Z")  # a note at the end of a run's answer, which drafts omit
_ASKS_WHETHER = re.compile(r"\b(?:is|are) there\b(?! how)|\bany\b|\bwhether\b|\bdo you see\b|\bcan you see\b", re.IGNORECASE)
_ASKS_COUNT = re.compile(r"\bhow many\b|\bcount\b|\bnumber of\b", re.IGNORECASE)
_ASKS_SUM = re.compile(r"\b(?:total|altogether|together|sum|add|combined|in all)\b", re.IGNORECASE)
_QUESTIONS: tuple[tuple[Program, Category, str | None, re.Pattern[str]], ...] = (
    ("colour", "descriptor", None, re.compile(r"\bcolou?r\b", re.IGNORECASE)),
    ("side", "location", "across", re.compile(r"\bleft\b.*\bright\b|\bright\b.*\bleft\b", re.IGNORECASE)),
    (
        "side",
        "location",
        "down",
        re.compile(r"\b(?:upper|top)\b.*\b(?:lower|bottom)\b|\b(?:lower|bottom)\b.*\b(?:upper|top)\b", re.I),
    ),
    ("text", "ocr", None, re.compile(r"\b(?:say|says|read|reads|text|written|words?|number|inscription)\b", re.IGNORECASE)),
)
"""The program and category of each question type, the axis of a side question, and a pattern that recognises the question."""


@dataclass
class _View:
    """A view in a run: the moves that lead to it, and the object kinds and questions in the perception calls on it."""

    moves: list[dict[str, Any]] = field(default_factory=list)
    sweep: bool = False
    kinds: list[Kind] = field(default_factory=list)
    questions: list[str] = field(default_factory=list)


def convert_run(run: str, trace: Trace, note: str, open_scene: Callable[[str], Scene]) -> RunDraft:
    """Convert a run to a line of the drafts file, with a draft or the reason why the run cannot be converted.

    Args:
        run: Name of the run folder.
        trace: The trace of the run.
        note: The operators' comments.
        open_scene: A function that opens a scene with ground truth by its name.
    """
    started = trace.started
    line = RunDraft(run=run, scene=started.scene or "", instruction=started.instruction, note=note)
    if started.scene is None:
        return line.model_copy(update={"reason": "the camera is not simulated, so the correct answer is not known"})
    try:
        draft = create_draft(trace, open_scene(started.scene))
    except DraftRejectedError as rejected:
        return line.model_copy(update={"reason": str(rejected)})
    return line.model_copy(update={"draft": draft.model_dump(mode="json", exclude_defaults=True)})


def create_draft(trace: Trace, scene: Scene) -> Draft:
    """Convert a run to a draft.

    Raises:
        DraftRejectedError: The run does not match any draft program.
    """
    started, ended = trace.started, trace.ended
    if ended is None or ended.outcome != "answered":
        raise DraftRejectedError("the run did not end with an answer")
    views = _group_views(trace.calls, scene)
    program, category, axis, things = _match_program(started.instruction, views)
    row = {
        "instruction": started.instruction.strip(),
        "category": category,
        "start": _start_preset(trace, scene),
        "views": [{"moves": view.moves, "sweep": view.sweep} for view in views],
        "program": program,
        "things": [{"category": kind.category, "colour": kind.colour} for kind in things],
        "axis": axis,
        "expected": "" if program == "action" else _SOURCE_NOTE.sub("", ended.text),
    }
    draft = parse_draft(row)
    if isinstance(draft, str):
        raise DraftRejectedError(draft)
    return draft


def _start_preset(trace: Trace, scene: Scene) -> str:
    started = trace.started
    pose = started.pose.pose()
    for preset in scene.file.presets:
        at = preset_position(preset)
        if at.viewpoint == started.viewpoint and _is_close(pose, at.pose):
            return preset.name
    raise DraftRejectedError("the run does not start at a preset, as tasks must")


def _is_close(one: Pose, other: Pose) -> bool:
    turn = (one.pan_deg - other.pan_deg + 180.0) % 360.0 - 180.0
    return (
        abs(turn) <= START_TOLERANCE_DEG
        and abs(one.tilt_deg - other.tilt_deg) <= START_TOLERANCE_DEG
        and abs(one.zoom / other.zoom - 1) <= START_TOLERANCE_ZOOM
    )


def _group_views(calls: Sequence[Called], scene: Scene) -> list[_View]:
    """Group a run's tool calls into views. A move or a change of scope after a question begins a new view."""
    views = [_View()]
    for called in calls:
        call = called.outcome.call
        if called.outcome.error is not None:
            raise DraftRejectedError(f"the call of {call.name} failed")
        if call.name == "get_presets":
            continue
        if (moved := _parse_move(call.name, call.arguments)) is not None:
            if views[-1].kinds or views[-1].questions:
                views.append(_View())
            views[-1].moves.append(moved)
            continue
        sweep = call.arguments.get("view") == "full"
        if (views[-1].kinds or views[-1].questions) and views[-1].sweep != sweep:
            views.append(_View())
        views[-1].sweep = sweep
        if call.name == "count_objects":
            views[-1].kinds.append(find_kind(str(call.arguments.get("description", "")), scene))
        elif call.name == "query_answer":
            question = str(call.arguments.get("question", ""))
            views[-1].questions.append(question)
            views[-1].kinds.append(find_kind(question, scene))
        else:
            raise DraftRejectedError(f"no draft program calls {call.name}")
    return views


def _parse_move(tool: str, arguments: dict[str, Any]) -> dict[str, Any] | None:
    """Convert a tool call to a move in a draft. Return None if the call is not a move."""
    if tool == "go_to_preset":
        return {"preset": str(arguments.get("name", ""))}
    if tool == "go_home":
        raise DraftRejectedError("a draft cannot go home, only to named presets")
    if tool != "adjust_ptz":
        return None
    if arguments.get("zoom_limit") is not None:
        raise DraftRejectedError("a draft can zoom by a factor, but not to the limit")
    factor, percent = arguments.get("zoom_factor"), arguments.get("zoom_percent")
    if factor is None and percent is not None:
        factor = 1 + float(percent) / 100
    move = {"pan_deg": float(arguments.get("pan_deg") or 0.0), "tilt_deg": float(arguments.get("tilt_deg") or 0.0)}
    return move if factor is None else {**move, "zoom_factor": float(factor)}


def find_kind(text: str, scene: Scene) -> Kind:
    """Return the kind of object that text names, with the category and colour from the scene's inventory.

    Raises:
        DraftRejectedError: The text does not name any kind in the inventory.
    """
    categories = {thing.category for thing in scene.things} | set(scene.file.absent)
    # If several names occur in the text, the longest one is meant: "traffic cone" rather than "cone".
    full_names = [category for category in categories if names_any(text, (category,))]
    candidates = full_names or [category for category in categories if names_any(text, object_words(Kind(category)))]
    if not candidates:
        raise DraftRejectedError(f"'{text[:80]}' names nothing in the inventory")
    category = max(sorted(candidates), key=len)
    colours = {own_colour(thing) for thing in scene.things if thing.category == category} - {None}
    named = [colour for colour in colours if colour is not None and re.search(rf"\b{re.escape(colour)}\b", text, re.IGNORECASE)]
    return Kind(category, max(sorted(named), key=len) if named else None)


def _match_program(instruction: str, views: Sequence[_View]) -> tuple[Program, Category, str | None, list[Kind]]:
    """Return the program, category, axis and object kinds for a draft."""
    kinds = list(dict.fromkeys(kind for view in views for kind in view.kinds))
    questions = [question for view in views for question in view.questions]
    if not kinds:
        moves = sum(len(view.moves) for view in views)
        if not moves:
            raise DraftRejectedError("the run neither moves the camera nor calls perception")
        return "action", "single_call" if moves == 1 else "multi_step_command", None, []
    if not (views[-1].kinds or views[-1].questions):
        raise DraftRejectedError("the run moves the camera after its last question, and a draft must end with a question")
    if len(views) == 1 and len(kinds) == 1:
        for program, category, axis, words in _QUESTIONS if questions else ():
            if words.search(questions[0]):
                return program, category, axis, kinds
        if _ASKS_WHETHER.search(instruction) and not _ASKS_COUNT.search(instruction):
            return "exists", "descriptor", None, kinds
        if questions and not _ASKS_COUNT.search(instruction):
            raise DraftRejectedError(f"no draft program asks '{questions[0][:80]}'")
        return "count", "counting", None, kinds
    if len(views) == 1:
        return "most", "comparative", None, kinds
    if len(kinds) == 1:
        return (
            ("sum", "multi_step_reasoning", None, kinds) if _ASKS_SUM.search(instruction) else ("most", "comparative", None, kinds)
        )
    raise DraftRejectedError("no draft program asks about different kinds in different views")
