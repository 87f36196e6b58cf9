"""Agents that adapt a constant answer to the form of the question, such as "there is none" for "is there a van?".

They make the calls of the reference program up to its last look, but ignore what perception reports. An agent sees only the
instruction, and the most common answers of the tasks. Validation limits what such agents win with pairs counted whole.
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
from scope_ptz.taskgen.validation.adversarial import Attempt, looking_program

Form = Literal["list", "order", "count", "colour", "place", "exists", "read", "other"]
"""The form of a question, as its wording shows it."""
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
"""Patterns of the forms. The first that matches decides."""
_CAN_BE_ABSENT: frozenset[Form] = frozenset({"count", "colour", "place", "exists"})
"""Forms that "there is none" answers."""
NONE = "None."


def form_of(instruction: str) -> Form:
    """Return the form of the question that an instruction asks."""
    return next((form for form, pattern in _FORMS if pattern.search(instruction)), "other")


def common_by_form(tasks: Sequence[Task]) -> dict[Form, str]:
    """Return the most common answer to each form of question among the core tasks, without "there is none"."""
    answers: dict[Form, Counter[str]] = {}
    for task in tasks:
        if task.stratum == "core" and not isinstance(task.expected, ActionOnly | NoneThere):
            answers.setdefault(form_of(task.instruction), Counter())[constant_text(task.expected)] += 1
    return {form: min(counts, key=lambda text: (-counts[text], text)) for form, counts in answers.items()}


def adaptive_attempts(task: Task, common: Mapping[Form, str]) -> Iterator[Attempt]:
    """Yield one attempt for each adaptive agent. A task that expects no answer has none.

    Args:
        task: The task.
        common: The most common answer to each form of question.
    """
    program = looking_program(task)
    if not program or isinstance(task.expected, ActionOnly):
        return
    form, offered = form_of(task.instruction), offered_answers(task.expected, task.instruction)
    usual = common.get(form, NONE)
    exists = "Yes." if form == "exists" else usual
    answers = {
        "absence": NONE if form in _CAN_BE_ABSENT else usual,
        "most common": usual,
        "first offered": _listed(form, offered, last=False) or exists,
        "last offered": _listed(form, offered, last=True) or exists,
        "absence, else first offered": NONE if form in _CAN_BE_ABSENT else _listed(form, offered, last=False) or usual,
        "absence, else last offered": NONE if form in _CAN_BE_ABSENT else _listed(form, offered, last=True) or usual,
    }
    for name, text in answers.items():
        yield Attempt(f"adaptive: {name}", program, text)


def _listed(form: Form, offered: Sequence[str], *, last: bool) -> str:
    """Return an offered answer: one name, or all names for an order or a list; empty if none is offered."""
    names = list(reversed(offered)) if last else list(offered)
    if form == "order":
        return ", ".join(names)
    return names[0] if names else ""
