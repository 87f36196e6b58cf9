"""Attempts at a task: correct programs, which must pass, and adversarial programs and answers, which must fail.

An attempt consists of tool calls, a final answer and an outcome. Some adversarial attempts give the correct answer without the
necessary calls. The names of the attempts are stored with the dataset.
"""

from __future__ import annotations

import math
import random
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from scope_ptz.bench.tasks.expected import ActionOnly, AnyExpected, NoneThere, Number
from scope_ptz.bench.tasks.task import ProgramCall, Task
from scope_ptz.taskgen.facts.answer_phrasing import correct_answers, offered_answers, wrong_answer
from scope_ptz.tools.registry import TOOLS

PERCEPTION_TOOLS = frozenset({"count_objects", "query_answer"})
MOVING_TOOLS = TOOLS.moving


@dataclass(frozen=True)
class Attempt:
    """A program of tool calls with a final answer.

    Attributes:
        name: Name of the attempt in the report.
        program: The calls.
        text: The final answer.
        outcome: The run's outcome.
    """

    name: str
    program: tuple[ProgramCall, ...]
    text: str
    outcome: str = "answered"


def correct_attempts(task: Task) -> Iterator[Attempt]:
    """Yield the reference program and two other correct programs, with different wordings of the correct answer."""
    outcome = task.behaviour.outcomes[0]
    texts = correct_answers(task.expected) if outcome == "answered" else ("I am not sure what you mean: which one?",) * 5
    yield Attempt("reference", task.reference, texts[0], outcome)
    if outcome != "answered":
        return
    yield Attempt("detour", add_detour(task), texts[1], outcome)
    yield Attempt("twice", tuple(double_calls(task.reference)), texts[2], outcome)


def other_correct_wordings(task: Task) -> tuple[str, ...]:
    """Return the wordings of the correct answer that ``correct_attempts`` does not use."""
    return correct_answers(task.expected)[3:] if task.behaviour.outcomes[0] == "answered" else ()


def add_detour(task: Task) -> tuple[ProgramCall, ...]:
    """Return the reference program with additional calls before it.

    They list the presets and, if the program begins by going to a preset, turn the camera.
    """
    first = task.reference[0] if task.reference else None
    before = (ProgramCall(tool="get_presets"),)
    if first is None or first.tool not in ("go_to_preset", "go_home"):
        return (*before, *task.reference)
    return (*before, ProgramCall(tool="adjust_ptz", arguments={"pan_deg": -7.0, "tilt_deg": -2.0}), *task.reference)


def double_calls(program: Sequence[ProgramCall]) -> Iterator[ProgramCall]:
    """Yield a program's calls, with every perception call made twice and every move split into two equal moves."""
    for call in program:
        if call.tool in PERCEPTION_TOOLS:
            yield from (call, call)
        elif call.tool == "adjust_ptz":
            half = {k: v / 2 for k, v in call.arguments.items() if k != "zoom_factor" and isinstance(v, int | float)}
            factor = call.arguments.get("zoom_factor")
            if isinstance(factor, int | float):
                half["zoom_factor"] = math.sqrt(factor)
            yield from (ProgramCall(tool="adjust_ptz", arguments=dict(half)),) * 2
        else:
            yield call


def common_answers(tasks: Sequence[Task], *, exclude_pairs: bool = False) -> dict[str, str]:
    """Return the most common answer in each category as text.

    Args:
        tasks: The tasks.
        exclude_pairs: Whether to exclude tasks with a twin and tasks with the answer "there is none".
    """
    answers: dict[str, Counter[str]] = {}
    for task in tasks:
        excluded = exclude_pairs and (task.pair is not None or isinstance(task.expected, NoneThere))
        if task.stratum == "core" and not isinstance(task.expected, ActionOnly) and not excluded:
            answers.setdefault(task.category, Counter())[_bare_answer(task.expected)] += 1
    return {category: counts.most_common(1)[0][0] for category, counts in answers.items()}


def _bare_answer(expected: AnyExpected) -> str:
    """Return a correct answer without words from its question, so that it is also an answer to other questions."""
    return f"{expected.value:g}" if isinstance(expected, Number) else correct_answers(expected)[0]


def adversarial_attempts(task: Task, common: str, sibling: str | None, rng: random.Random) -> Iterator[Attempt]:
    """Yield attempts that must fail.

    Args:
        task: The task.
        common: The most common answer in the task's category.
        sibling: The correct answer to a similar task, which is wrong for this one; None if there is no such task.
        rng: Random generator for the wrong answer.
    """
    blind_program = tuple(call for call in task.reference if call.tool not in PERCEPTION_TOOLS and call.tool != "zoom_to_object")
    correct = correct_answers(task.expected)[0]
    yield Attempt("nothing", (), "")
    for text in ("None.", "0", "Yes.", common):
        yield Attempt("guess", (), text)
    if any(view.must_look for view in task.evidence):
        yield Attempt("blind", blind_program, correct)
    if task.needs and task.behaviour.outcomes == ("answered",):
        yield Attempt("stay", tuple(remove_moves(task.reference)), correct)
    wrong = wrong_answer(task.expected, rng)
    if wrong is not None and task.behaviour.outcomes == ("answered",):
        yield Attempt("wrong-answer", task.reference, wrong)
    if sibling is not None:
        yield Attempt("ignored", task.reference, sibling)
    if task.behaviour.final is not None or task.behaviour.framing is not None:
        first_turn = ProgramCall(tool="adjust_ptz", arguments={"pan_deg": -13.0, "tilt_deg": 4.0})
        second_turn = ProgramCall(tool="adjust_ptz", arguments={"pan_deg": 6.0, "tilt_deg": -3.0})
        yield Attempt("wrong-pose", (*task.reference, first_turn, second_turn), correct)


def guess_attempts(task: Task, common: str) -> Iterator[Attempt]:
    """Yield attempts that make the perception calls in the reference program and then give a fixed answer.

    They pass only if that answer happens to be correct.
    """
    program = perception_program(task)
    if not program or isinstance(task.expected, ActionOnly):
        return
    names = offered_answers(task.expected, task.instruction)
    answers: dict[str, str | None] = {"none": "None.", "0": "0", "yes": "Yes.", "no": "No.", "most common": common}
    answers |= {f"{ordinal} offered": name for ordinal, name in zip(("first", "second", "third"), names, strict=False)}
    answers |= {"last offered": names[-1]} if names else {}
    for name, text in answers.items():
        if text is not None:
            yield Attempt(f"looked-and-guessed: {name}", program, text)


def perception_program(task: Task) -> tuple[ProgramCall, ...]:
    """Return the reference program up to its last perception call; empty if there is no such call."""
    perception_indices = [
        index for index, call in enumerate(task.reference) if call.tool in PERCEPTION_TOOLS or call.tool == "zoom_to_object"
    ]
    return task.reference[: perception_indices[-1] + 1] if perception_indices else ()


def remove_moves(program: Sequence[ProgramCall]) -> Iterator[ProgramCall]:
    """Yield a program's calls without its moves, so that all perception calls are made at the start view."""
    for call in program:
        if call.tool in PERCEPTION_TOOLS:
            yield ProgramCall(tool=call.tool, arguments={**call.arguments, "view": "current"})
        elif call.tool not in MOVING_TOOLS:
            yield call
