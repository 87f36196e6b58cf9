"""Programs that must pass beside the reference, and cheats, none of which may.

A program is a list of calls, a closing text and an outcome. A cheat knows the right answer wherever that makes it stronger.
"""

from __future__ import annotations

import math
import random
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from scope_ptz.bench.tasks.expected import ActionOnly, AnyExpected, NoneThere, Number
from scope_ptz.bench.tasks.task import ProgramCall, Task
from scope_ptz.taskgen.facts.answer_phrasing import offered, right_answers, wrong_answer

LOOKS = frozenset({"count_objects", "query_answer"})
MOVES = frozenset({"adjust_ptz", "go_to_preset", "go_home", "zoom_to_object", "track_object"})


@dataclass(frozen=True)
class Attempt:
    """``name``: what is tried, for the report."""

    name: str
    program: tuple[ProgramCall, ...]
    text: str
    outcome: str = "answered"


def honest(task: Task) -> Iterator[Attempt]:
    """The reference and two other correct programs, with five wordings of the right answer among them."""
    outcome = task.behaviour.outcomes[0]
    texts = right_answers(task.expected) if outcome == "answered" else ("I am not sure what you mean: which one?",) * 5
    yield Attempt("reference", task.reference, texts[0], outcome)
    if outcome != "answered":
        return
    yield Attempt("detour", detour(task), texts[1], outcome)
    yield Attempt("twice", tuple(twice(task.reference)), texts[2], outcome)


def right_texts(task: Task) -> tuple[str, ...]:
    """The remaining wordings, to be told after the reference program."""
    return right_answers(task.expected)[3:] if task.behaviour.outcomes[0] == "answered" else ()


def detour(task: Task) -> tuple[ProgramCall, ...]:
    """The reference after a look at the presets, and, where the target is not the view of now, after turning aside and back."""
    first = task.reference[0] if task.reference else None
    ahead = (ProgramCall(tool="get_presets"),)
    if first is None or first.tool not in ("go_to_preset", "go_home"):
        return (*ahead, *task.reference)
    return (*ahead, ProgramCall(tool="adjust_ptz", arguments={"pan_deg": -7.0, "tilt_deg": -2.0}), *task.reference)


def twice(program: Sequence[ProgramCall]) -> Iterator[ProgramCall]:
    """Every look taken twice, every turn and zoom made in two halves."""
    for call in program:
        if call.tool in LOOKS:
            yield from (call, call)
        elif call.tool == "adjust_ptz":
            half = {k: v / 2 for k, v in call.arguments.items() if k != "zoom_factor" and isinstance(v, int | float)}
            factor = call.arguments.get("zoom_factor")
            if isinstance(factor, int | float):
                half["zoom_factor"] = math.sqrt(factor)
            yield from (ProgramCall(tool="adjust_ptz", arguments=dict(half)),) * 2
        else:
            yield call


def common_answers(tasks: Sequence[Task], *, presences: bool = False) -> dict[str, str]:
    """The most common answer of each category, as a text. ``presences``: of tasks without a twin, and other than "none"."""
    said: dict[str, Counter[str]] = {}
    for task in tasks:
        passed_over = presences and (task.pair is not None or isinstance(task.expected, NoneThere))
        if task.stratum == "core" and not isinstance(task.expected, ActionOnly) and not passed_over:
            said.setdefault(task.category, Counter())[_bare(task.expected)] += 1
    return {category: counts.most_common(1)[0][0] for category, counts in said.items()}


def _bare(expected: AnyExpected) -> str:
    """A right answer without the words of its question, so that it is an answer to others as well."""
    return f"{expected.value:g}" if isinstance(expected, Number) else right_answers(expected)[0]


def cheats(task: Task, common: str, sibling: str | None, rng: random.Random) -> Iterator[Attempt]:
    """What must fail. ``common``: the most common answer of the category; ``sibling``: the answer to another task like it."""
    blind = tuple(call for call in task.reference if call.tool not in LOOKS and call.tool != "zoom_to_object")
    right = right_answers(task.expected)[0]
    yield Attempt("nothing", (), "")
    for text in ("None.", "0", "Yes.", common):
        yield Attempt("guess", (), text)
    if any(view.must_look for view in task.evidence):
        yield Attempt("blind", blind, right)
    if task.needs and task.behaviour.outcomes == ("answered",):
        yield Attempt("stay", tuple(stay(task.reference)), right)
    wrong = wrong_answer(task.expected, rng)
    if wrong is not None and task.behaviour.outcomes == ("answered",):
        yield Attempt("wrong-answer", task.reference, wrong)
    if sibling is not None:
        yield Attempt("ignored", task.reference, sibling)
    if task.behaviour.final is not None or task.behaviour.framing is not None:
        aside = ProgramCall(tool="adjust_ptz", arguments={"pan_deg": -13.0, "tilt_deg": 4.0})
        back = ProgramCall(tool="adjust_ptz", arguments={"pan_deg": 6.0, "tilt_deg": -3.0})
        yield Attempt("wrong-pose", (*task.reference, aside, back), right)


def guesses(task: Task, common: str) -> Iterator[Attempt]:
    """Answers given after looking at everything, whatever was seen. Each passes where it happens to be right."""
    looks = [at for at, call in enumerate(task.reference) if call.tool in LOOKS or call.tool == "zoom_to_object"]
    if not looks or isinstance(task.expected, ActionOnly):
        return
    program = task.reference[: looks[-1] + 1]
    names = offered(task.expected, task.instruction)
    said: dict[str, str | None] = {"none": "None.", "0": "0", "yes": "Yes.", "no": "No.", "most common": common}
    said |= {f"{place} offered": name for place, name in zip(("first", "second", "third"), names, strict=False)}
    said |= {"last offered": names[-1]} if names else {}
    for name, text in said.items():
        if text is not None:
            yield Attempt(f"looked-and-guessed: {name}", program, text)


def stay(program: Sequence[ProgramCall]) -> Iterator[ProgramCall]:
    """The looks of a program, all taken at the view of the start."""
    for call in program:
        if call.tool in LOOKS:
            yield ProgramCall(tool=call.tool, arguments={**call.arguments, "view": "current"})
        elif call.tool not in MOVES:
            yield call
