"""Parts of a dataset that stand for all of it."""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Sequence

from scope_ptz.bench.tasks.task import Task


def stratified_sample(tasks: Sequence[Task], number: int, seed: int) -> tuple[Task, ...]:
    """``number`` of some tasks, in their order: of every category, scene and difficulty, and of every combination, as near to its
    share as may be.

    One task after the other is taken from the group that its category, scene, difficulty and combination lack most; which of a
    group depends on the seed and the id alone.
    """
    number = min(number, len(tasks))
    waiting: dict[tuple[str, ...], list[str]] = {}
    for task in sorted(tasks, key=lambda t: hashlib.sha256(f"{seed}:{t.id}".encode()).hexdigest()):
        waiting.setdefault((task.category, task.scene, task.difficulty), []).append(task.id)
    share = Counter(mark for task in tasks for mark in _marks((task.category, task.scene, task.difficulty)))
    of_all = number / len(tasks) if tasks else 0.0
    taken, chosen = Counter[tuple[str, ...]](), set[str]()
    for _ in range(number):
        group = max(
            (g for g, ids in waiting.items() if ids),
            key=lambda g: (round(sum(share[mark] * of_all - taken[mark] for mark in _marks(g)), 6), g),
        )
        chosen.add(waiting[group].pop())
        taken.update(_marks(group))
    return tuple(task for task in tasks if task.id in chosen)


def _marks(group: tuple[str, ...]) -> list[tuple[str, ...]]:
    return [group, *(("any", part) for part in group)]
