"""Sample tasks so that the shares of categories and scenes are preserved and the answers are balanced."""

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
"""Key for the answers "no" and "there is none", which share a key because the same text can express both."""


@dataclass(frozen=True, slots=True)
class SampledTask:
    """The properties of a task that balanced sampling uses.

    Attributes:
        id: The task's id.
        group: The task's category and other fields whose shares the sample preserves, such as the scene.
        answer: Key of the task's answer; empty if no other task can have the same answer.
        twin: Id of the other task in the contrast pair; None for an unpaired task.
    """

    id: str
    group: tuple[str, ...]
    answer: str = ""
    twin: str | None = None


_Unit = tuple[SampledTask, ...]
"""A contrast pair or an unpaired task. A sample usually includes both tasks of a pair."""
_Margin = tuple[str, str]


class _Group(NamedTuple):
    """A group of tasks with the same field values, which are either all paired or all unpaired."""

    fields: tuple[str, ...]
    paired: bool


def answer_key(expected: AnyExpected) -> str:
    """Return a key shared by all answers that can be given in the same words. It is empty for texts, orders and actions."""
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
    """Return the ids of a sample that is balanced across answers.

    The two tasks of a contrast pair are selected together, so that the paired things are present as often as they are absent.
    A pair may be split if only one more task is needed and no unpaired task remains. The fraction of paired tasks in the sample is
    the same as in the full set.

    Each step selects from the group that is least represented in the sample so far, relative to the number of tasks with each of
    its field values, and to the number of paired or unpaired tasks in its category. Within a group, it selects the task whose
    answer occurs least often in the sample.

    Args:
        tasks: The tasks to sample from.
        number: Size of the sample.
        order: Function that returns the key for breaking ties between tasks. The order of ``tasks`` does not affect the result.
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
        # Ties go to the group with the most remaining tasks, so that small groups are not exhausted early.
        least = min(
            fitting or remaining,
            key=lambda g: (sum(Fraction(taken[m], totals[m]) for m in _margins(g)), -len(groups[g]), g),
        )
        unit = min(groups[least], key=lambda u: _repetition_count(u, answers))
        groups[least].remove(unit)
        quotas[least.paired] -= len(unit)
        for task in unit[:free]:
            chosen.append(task.id)
            taken.update(_margins(least))
            answers[task.answer] += 1
    return frozenset(chosen)


def _units(tasks: Sequence[SampledTask]) -> list[_Unit]:
    """Group tasks into pairs and unpaired tasks. A task whose twin is missing counts as unpaired."""
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
    """Return the keys for counting the tasks in a group: one for each field, and one for whether they are paired."""
    paired = "paired" if group.paired else "unpaired"
    return [*((str(field), name) for field, name in enumerate(group.fields)), (paired, group.fields[0])]


def _repetition_count(unit: _Unit, answers: Counter[str]) -> int:
    """Return how often the sample already contains the unit's most frequent answer. In a pair, the answer ABSENT is ignored."""
    keys = [task.answer for task in unit if task.answer and not (len(unit) > 1 and task.answer == ABSENT)]
    return max((answers[key] for key in keys), default=0)


def sampled_task(task: Task, *fields: str) -> SampledTask:
    """Return the properties of a task for balanced sampling. ``fields`` are the fields whose shares the sample preserves."""
    return SampledTask(task.id, tuple(str(getattr(task, name)) for name in fields), answer_key(task.expected), task.pair)


def lite_sample(tasks: Sequence[Task], number: int, seed: int) -> tuple[Task, ...]:
    """Return a sample that is balanced across categories, scenes, difficulties and answers. The seed breaks ties.

    Returns:
        The sample in the original order.
    """

    def random_key(name: str) -> str:
        return hashlib.sha256(f"{seed}:{name}".encode()).hexdigest()

    chosen = balanced_sample([sampled_task(task, "category", "scene", "difficulty") for task in tasks], number, random_key)
    return tuple(task for task in tasks if task.id in chosen)


def stratified_sample(tasks: Sequence[Task], number: int, seed: int) -> tuple[Task, ...]:
    """Return a sample that approximately preserves the fractions of categories, scenes, difficulties and their combinations.

    Tasks are selected one by one from the most underrepresented group. Within a group, the selection depends only on the seed and
    the task ids. Answers are not balanced.

    Args:
        tasks: The tasks to sample from.
        number: Size of the sample.
        seed: Seed for the selection within a group.

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
    """Return the keys for counting the tasks in a group: the whole group, and each of its three fields."""
    return [group, *(("any", part) for part in group)]
