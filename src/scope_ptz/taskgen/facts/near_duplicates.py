"""Detect near-duplicate tasks, which ask the same question about the same view or use almost the same words.

Texts are compared by the Jaccard similarity between their sets of five-character shingles, including numbers and names. For a few
thousand short texts, this is exact and as fast as a MinHash estimate.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from dataclasses import dataclass

from scope_ptz.bench.tasks.task import Task

SHINGLE_CHARS = 5
MIN_SIMILARITY = 0.75
"""Minimum similarity between near-duplicates. Only texts about the same scene and variation are compared."""


def shingles(text: str) -> frozenset[str]:
    """Return all five-character substrings of text, after converting it to lower case and single spaces."""
    normalised = f" {' '.join(re.findall(r'[a-z0-9]+', text.lower()))} "
    return frozenset(normalised[index : index + SHINGLE_CHARS] for index in range(max(1, len(normalised) - SHINGLE_CHARS + 1)))


def similarity(one: frozenset[str], two: frozenset[str]) -> float:
    """Return the Jaccard similarity between two sets, from 0 to 1."""
    return len(one & two) / len(one | two) if one or two else 1.0


def question_key(task: Task) -> str | None:
    """Return a key for a task's expected answer, views and objects that does not depend on its wording.

    Return None for a task without evidence.
    """
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
    """An earlier task that a new task repeats.

    Attributes:
        task: Id of the earlier task.
        similarity: Similarity between the two texts; 1 if both ask the same question about the same view.
    """

    task: str
    similarity: float


class KnownTasks:
    """The tasks with which new tasks are compared."""

    def __init__(self, tasks: Iterable[Task] = ()) -> None:
        self._texts: dict[str, list[tuple[str, frozenset[str]]]] = {}
        self._questions: dict[str, str] = {}
        for task in tasks:
            self.add(task)

    def add(self, task: Task) -> None:
        """Add a task. Later tasks are compared with it."""
        self._texts.setdefault(task.world, []).append((task.id, shingles(task.instruction)))
        if (key := question_key(task)) is not None:
            self._questions.setdefault(key, task.id)

    def most_similar(self, task: Task) -> NearDuplicate | None:
        """Return the most similar task; None if no task is a near-duplicate."""
        key = question_key(task)
        if key is not None and key in self._questions:
            return NearDuplicate(self._questions[key], 1.0)
        new = shingles(task.instruction)
        candidates = [NearDuplicate(name, similarity(new, other)) for name, other in self._texts.get(task.world, ())]
        best = max(candidates, key=lambda candidate: candidate.similarity, default=None)
        return best if best is not None and best.similarity >= MIN_SIMILARITY else None
