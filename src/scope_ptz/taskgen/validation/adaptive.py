"""Agents that adapt a constant answer to the form of the question, such as "there is none" for "is there a van?".

They make the calls in the reference program up to its last perception call, but ignore the results. Their answers depend only on
the instruction and the most common answers to the tasks. Validation limits the fraction of tasks that such agents pass. A task in a
pair counts only if both tasks in the pair pass.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Literal

from scope_ptz.bench.scoring.constant_agents import constant_text
from scope_ptz.bench.tasks.expected import ActionOnly, NoneThere
from scope_ptz.bench.tasks.task import Task
from scope_ptz.taskgen.facts.answer_phrasing import offered_answers
from scope_ptz.taskgen.validation.adversarial import Attempt, perception_program

Form = Literal["list", "order", "count", "colour", "place", "exists", "read", "other"]
"""The form of a question, inferred from its wording."""
_FORMS: tuple[tuple[Form, re.Pattern[str]], ...] = (
    ("list", re.compile(r"\b(which|what) of (these|the following)\b", re.IGNORECASE)),
    ("order", re.compile(r"\b(order|rank|from (left|right|nearest|farthest|most|fewest|closest))\b", re.IGNORECASE)),
    ("count", re.compile(r"\b(how many|number of|count of|count the|count how|tally|one figure)\b", re.IGNORECASE)),
    ("colour", re.compile(r"\bcolou?r\b", re.IGNORECASE)),
    ("place", re.compile(r"\b(top|bottom|upper|lower) (left|right)\b", re.IGNORECASE)),
    (
        "exists",
        re.compile(
            r"\b(is|are) (there|any|an?\b|one\b)|\bany\b|\bfound\b"
            r"|\b(see|look|find|check|whether|if) (\w+ ){0,4}?(for|an?|any|there)\b",
            re.IGNORECASE,
        ),
    ),
    ("read", re.compile(r"\b(read|says?|written|text|letter)\b", re.IGNORECASE)),
)
"""The pattern for each form. The first pattern that matches determines the form."""
_ABSENCE_FORMS: frozenset[Form] = frozenset({"count", "colour", "place", "exists"})
"""Question forms that "there is none" can answer."""
NONE = "None."


def question_form(instruction: str) -> Form:
    """Return the form of the question in an instruction."""
    return next((form for form, pattern in _FORMS if pattern.search(instruction)), "other")


def common_answers_by_form(tasks: Sequence[Task]) -> dict[Form, str]:
    """Return the most common answer to each form of question among the core tasks, without "there is none"."""
    answers: dict[Form, Counter[str]] = {}
    for task in tasks:
        if task.stratum == "core" and not isinstance(task.expected, ActionOnly | NoneThere):
            answers.setdefault(question_form(task.instruction), Counter())[constant_text(task.expected)] += 1
    return {form: min(counts, key=lambda text: (-counts[text], text)) for form, counts in answers.items()}


def adaptive_attempts(task: Task, common: Mapping[Form, str]) -> Iterator[Attempt]:
    """Yield one attempt for each adaptive agent; none for a task that expects no answer.

    Args:
        task: The task.
        common: The most common answer to each form of question.
    """
    program = perception_program(task)
    if not program or isinstance(task.expected, ActionOnly):
        return
    form, options = question_form(task.instruction), offered_answers(task.expected, task.instruction)
    common_answer = common.get(form, NONE)
    yes_or_common = "Yes." if form == "exists" else common_answer
    answers = {
        "absence": NONE if form in _ABSENCE_FORMS else common_answer,
        "most common": common_answer,
        "first offered": _offered_answer(form, options, last=False) or yes_or_common,
        "last offered": _offered_answer(form, options, last=True) or yes_or_common,
        "absence, else first offered": NONE
        if form in _ABSENCE_FORMS
        else _offered_answer(form, options, last=False) or common_answer,
        "absence, else last offered": NONE
        if form in _ABSENCE_FORMS
        else _offered_answer(form, options, last=True) or common_answer,
    }
    for name, text in answers.items():
        yield Attempt(f"adaptive: {name}", program, text)


def _offered_answer(form: Form, options: Sequence[str], *, last: bool) -> str:
    """Return an offered answer: one name, or all names for an order or a list; empty if none is offered."""
    names = list(reversed(options)) if last else list(options)
    if form == "order":
        return ", ".join(names)
    return names[0] if names else ""
