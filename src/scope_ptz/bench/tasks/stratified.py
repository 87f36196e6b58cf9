"""Stratified samples of a dataset."""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Sequence

from scope_ptz.bench.tasks.task import Task


def stratified_sample(tasks: Sequence[Task], number: int, seed: int) -> tuple[Task, ...]:
    """Return a sample that approximately preserves the fractions of categories, scenes, difficulties and their combinations.

    Tasks are taken one by one from the most underrepresented group. Within a group the choice depends only on the seed and the
    task ids.

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
    total = Counter(margin for task in tasks for margin in _margins((task.category, task.scene, task.difficulty)))
    fraction = number / len(tasks) if tasks else 0.0
    taken, chosen = Counter[tuple[str, ...]](), set[str]()
    for _ in range(number):
        group = max(
            (g for g, ids in remaining.items() if ids),
            key=lambda g: (round(sum(total[margin] * fraction - taken[margin] for margin in _margins(g)), 6), g),
        )
        chosen.add(remaining[group].pop())
        taken.update(_margins(group))
    return tuple(task for task in tasks if task.id in chosen)


def _margins(group: tuple[str, ...]) -> list[tuple[str, ...]]:
    """Return the keys under which a task of a group is counted: the whole group, and each of its three parts."""
    return [group, *(("any", part) for part in group)]
