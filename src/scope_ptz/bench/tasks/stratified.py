"""Samples of tasks that preserve the shares of categories and scenes, and that are balanced over answers."""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

from scope_ptz.bench.tasks.expected import (
    ActionOnly,
    AnyExpected,
    Choice,
    NoneThere,
    Number,
    Relation,
    YesNo,
)
from scope_ptz.bench.tasks.task import Task

ABSENT = "no"
"""Key of the answers "no" and "there is none", which the same text gives."""


@dataclass(frozen=True, slots=True)
class SampledTask:
    """What a balanced sample considers of a task.

    Attributes:
        id: The task's id.
        group: Its category and other fields whose shares the sample preserves, such as the scene.
        answer: Key of its answer; empty if no other task could share the answer.
        twin: Id of the other task of its contrast pair; None without one.
    """

    id: str
    group: tuple[str, ...]
    answer: str = ""
    twin: str | None = None


_Unit = tuple[SampledTask, ...]
"""A pair, or a task without a twin."""
_Margin = tuple[str, str]


class _Group(NamedTuple):
    """The tasks with the same fields that have a twin, or those that have none."""

    fields: tuple[str, ...]
    paired: bool


def answer_key(expected: AnyExpected) -> str:
    """Return a key that answers share if the same constant text could give them; empty for texts, orders and actions."""
    match expected:
        case ActionOnly():
            return ""
        case NoneThere():
            return ABSENT
        case YesNo():
            return "yes" if expected.value else ABSENT
        case Number():
            return f"number {expected.value:g}"
        case Choice() | Relation():
            return f"option {expected.value}"
        case _:
            return ""


def balanced_sample(tasks: Sequence[SampledTask], number: int, order: Callable[[str], str] = str) -> frozenset[str]:
    """Return the ids of a sample that is balanced over answers.

    The tasks of a contrast pair are taken together, so that a sample contains as many absences as presences of paired things. One
    pair may be halved if only one place is left and no unpaired task fits. Paired tasks have the same share of the sample as of all
    tasks. Each step takes from the group that is least
    represented in the sample so far, relative to the numbers of tasks with each of its fields and to the number of paired or
    unpaired tasks of its category. Within a group, the task is taken whose answer the sample contains least often.

    Args:
        tasks: The tasks to sample from.
        number: Size of the sample.
        order: Returns the key by which ties between tasks are broken. The result does not depend on the order of ``tasks``.
    """
    number = min(number, len(tasks))
    groups: dict[_Group, list[_Unit]] = {}
    for unit in _units(sorted(tasks, key=lambda task: (order(task.id), task.id))):
        groups.setdefault(_group_of(unit), []).append(unit)
    pairs = sum(2 * len(units) for group, units in groups.items() if group.paired)
    quotas = {True: 2 * round(number * pairs / len(tasks) / 2) if tasks else 0}
    quotas[False] = number - quotas[True]
    totals = Counter(margin for group, units in groups.items() for unit in units for _ in unit for margin in _margins(group))
    taken, answers, chosen = Counter[_Margin](), Counter[str](), list[str]()
    while len(chosen) < number:
        free = number - len(chosen)
        remaining = [group for group, units in groups.items() if units]
        fitting = [group for group in remaining if quotas[group.paired] > 0 and (not group.paired or free > 1)]
        # Ties go to the group with the most remaining tasks, so that they do not exhaust small groups.
        least = min(
            fitting or remaining,
            key=lambda g: (sum(Fraction(taken[m], totals[m]) for m in _margins(g)), -len(groups[g]), g),
        )
        unit = min(groups[least], key=lambda u: _repetition(u, answers))
        groups[least].remove(unit)
        quotas[least.paired] -= len(unit)
        for task in unit[:free]:
            chosen.append(task.id)
            taken.update(_margins(least))
            answers[task.answer] += 1
    return frozenset(chosen)


def _units(tasks: Sequence[SampledTask]) -> list[_Unit]:
    """Return the pairs and the unpaired tasks. A task whose twin is not among the tasks is unpaired."""
    by_id = {task.id: task for task in tasks}
    units, seen = list[_Unit](), set[str]()
    for task in tasks:
        if task.id in seen:
            continue
        twin = by_id.get(task.twin or "")
        unit = (task,) if twin is None or twin.twin != task.id or twin is task else (task, twin)
        seen |= {each.id for each in unit}
        units.append(unit)
    return units


def _group_of(unit: _Unit) -> _Group:
    return _Group(unit[0].group, len(unit) > 1)


def _margins(group: _Group) -> list[_Margin]:
    """Return the keys under which a task of a group is counted: each of its fields, and whether it has a twin."""
    paired = "paired" if group.paired else "unpaired"
    return [*((str(field), name) for field, name in enumerate(group.fields)), (paired, group.fields[0])]


def _repetition(unit: _Unit, answers: Counter[str]) -> int:
    """Return how often the sample already contains the answers of a unit. The absence of a pair does not count."""
    keys = [task.answer for task in unit if task.answer and not (len(unit) > 1 and task.answer == ABSENT)]
    return max((answers[key] for key in keys), default=0)


def sampled_task(task: Task, *fields: str) -> SampledTask:
    """Return what a balanced sample considers of a task. ``fields`` are the names of the fields whose shares it preserves."""
    return SampledTask(task.id, tuple(str(getattr(task, name)) for name in fields), answer_key(task.expected), task.pair)


def lite_sample(tasks: Sequence[Task], number: int, seed: int) -> tuple[Task, ...]:
    """Return a balanced sample over categories, scenes, difficulties and answers. The seed breaks ties.

    Returns:
        The sample in the original order.
    """

    def shuffled(name: str) -> str:
        return hashlib.sha256(f"{seed}:{name}".encode()).hexdigest()

    chosen = balanced_sample([sampled_task(task, "category", "scene", "difficulty") for task in tasks], number, shuffled)
    return tuple(task for task in tasks if task.id in chosen)


def stratified_sample(tasks: Sequence[Task], number: int, seed: int) -> tuple[Task, ...]:
    """Return a sample that approximately preserves the fractions of categories, scenes, difficulties and their combinations.

    Tasks are taken one by one from the most underrepresented group. Within a group the choice depends only on the seed and the
    task ids. Answers are not balanced.

    Args:
        tasks: The tasks to sample from.
        number: Size of the sample.
        seed: Seed for the choice within a group.

    Returns:
        The sample in the original order.
    """
    number = min(number, len(tasks))
    remaining: dict[tuple[str, ...], list[str]] = {}
    for task in sorted(tasks, key=lambda t: hashlib.sha256(f"{seed}:{t.id}".encode()).hexdigest()):
        remaining.setdefault((task.category, task.scene, task.difficulty), []).append(task.id)
    total = Counter(margin for task in tasks for margin in _group_margins((task.category, task.scene, task.difficulty)))
    fraction = number / len(tasks) if tasks else 0.0
    taken, chosen = Counter[tuple[str, ...]](), set[str]()
    for _ in range(number):
        group = max(
            (g for g, ids in remaining.items() if ids),
            key=lambda g: (round(sum(total[margin] * fraction - taken[margin] for margin in _group_margins(g)), 6), g),
        )
        chosen.add(remaining[group].pop())
        taken.update(_group_margins(group))
    return tuple(task for task in tasks if task.id in chosen)


def _group_margins(group: tuple[str, ...]) -> list[tuple[str, ...]]:
    """Return the keys under which a task of a group is counted: the whole group, and each of its three parts."""
    return [group, *(("any", part) for part in group)]
