"""Near-duplicates among tasks: the same question about the same view in any words, or nearly the same words.

Texts are compared by the Jaccard similarity of their sets of five-letter shingles, numbers and names included. For a few thousand
short texts this is as fast as an estimate by MinHash, and exact.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from dataclasses import dataclass

from scope_ptz.bench.tasks.task import Task

SHINGLE_CHARS = 5
NEAR_SIMILARITY = 0.75
"""Similarity from which two texts in the same world are near-duplicates."""


def shingles(text: str) -> frozenset[str]:
    """Return all substrings of five characters of a text, in lower case and with single spaces."""
    plain = f" {' '.join(re.findall(r'[a-z0-9]+', text.lower()))} "
    return frozenset(plain[at : at + SHINGLE_CHARS] for at in range(max(1, len(plain) - SHINGLE_CHARS + 1)))


def similarity(one: frozenset[str], two: frozenset[str]) -> float:
    """Return the Jaccard similarity of two sets."""
    return len(one & two) / len(one | two) if one or two else 1.0


def asked_about(task: Task) -> str | None:
    """Return what a task asks about which views, independent of its words, or None when it asks nothing."""
    if not task.evidence:
        return None
    views = [
        (v.aim.viewpoint, v.scope, round(v.aim.pan_deg, 1), round(v.aim.tilt_deg, 1), round(v.aim.zoom, 2), sorted(v.about))
        for v in task.evidence
    ]
    items = sorted(item.instance for view in task.evidence for item in view.items)
    return json.dumps([task.world, task.expected.model_dump(), views, items])


@dataclass(frozen=True)
class NearDuplicate:
    """A task that another one nearly repeats, with their similarity (1 when they ask the same about the same view)."""

    task: str
    similarity: float


class KnownTasks:
    """Tasks that new tasks are compared with."""

    def __init__(self, tasks: Iterable[Task] = ()) -> None:
        self._texts: dict[str, list[tuple[str, frozenset[str]]]] = {}
        self._asked: dict[str, str] = {}
        for task in tasks:
            self.add(task)

    def add(self, task: Task) -> None:
        """Add a task to compare with."""
        self._texts.setdefault(task.world, []).append((task.id, shingles(task.instruction)))
        if (asked := asked_about(task)) is not None:
            self._asked.setdefault(asked, task.id)

    def nearest(self, task: Task) -> NearDuplicate | None:
        """Return the task that this one repeats or resembles most, or None when it resembles none enough."""
        asked = asked_about(task)
        if asked is not None and asked in self._asked:
            return NearDuplicate(self._asked[asked], 1.0)
        own = shingles(task.instruction)
        found = [NearDuplicate(name, similarity(own, other)) for name, other in self._texts.get(task.world, ())]
        best = max(found, key=lambda near: near.similarity, default=None)
        return best if best is not None and best.similarity >= NEAR_SIMILARITY else None
