"""Near-duplicates among tasks: the same question of the same view whatever its words, or nearly the same words.

Words are compared by the Jaccard similarity of their sets of five-letter shingles, numbers and names included. That is exact,
and at some thousands of short texts as fast as an estimate by MinHash, which pays from hundreds of thousands on.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from dataclasses import dataclass

from scope_ptz.bench.tasks.task import Task

SHINGLE = 5
ALIKE = 0.75
"""From this share of common shingles on two texts are near-duplicates, if they are set in the same world."""


def shingles(text: str) -> frozenset[str]:
    """The runs of five letters of a text in lower case, spaces made one."""
    plain = f" {' '.join(re.findall(r'[a-z0-9]+', text.lower()))} "
    return frozenset(plain[at : at + SHINGLE] for at in range(max(1, len(plain) - SHINGLE + 1)))


def similarity(one: frozenset[str], two: frozenset[str]) -> float:
    """Jaccard: what is common over what there is."""
    return len(one & two) / len(one | two) if one or two else 1.0


def asks(task: Task) -> str | None:
    """What a task asks of which views, whatever its words; None for one that asks nothing."""
    if not task.evidence:
        return None
    views = [
        (v.aim.viewpoint, v.scope, round(v.aim.pan_deg, 1), round(v.aim.tilt_deg, 1), round(v.aim.zoom, 2), sorted(v.about))
        for v in task.evidence
    ]
    items = sorted(item.instance for view in task.evidence for item in view.items)
    return json.dumps([task.world, task.expected.model_dump(), views, items])


@dataclass(frozen=True)
class Near:
    """A task that another one nearly repeats. ``share``: of common shingles; 1 where the same is asked of the same view."""

    task: str
    share: float


class Known:
    """Tasks that new ones are held against."""

    def __init__(self, tasks: Iterable[Task] = ()) -> None:
        self._texts: dict[str, list[tuple[str, frozenset[str]]]] = {}
        self._asked: dict[str, str] = {}
        for task in tasks:
            self.add(task)

    def add(self, task: Task) -> None:
        self._texts.setdefault(task.world, []).append((task.id, shingles(task.instruction)))
        if (asked := asks(task)) is not None:
            self._asked.setdefault(asked, task.id)

    def nearest(self, task: Task) -> Near | None:
        """The task that this one repeats, or comes nearest to; None when it comes near to none."""
        asked = asks(task)
        if asked is not None and asked in self._asked:
            return Near(self._asked[asked], 1.0)
        own = shingles(task.instruction)
        found = [Near(name, similarity(own, other)) for name, other in self._texts.get(task.world, ())]
        best = max(found, key=lambda near: near.share, default=None)
        return best if best is not None and best.share >= ALIKE else None
