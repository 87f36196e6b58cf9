"""Gold runs for the error modes: a run that passes, with one known fault of one mode put into it."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

from scope_ptz.bench.episode import Episode
from scope_ptz.bench.error_modes import ErrorMode, error_mode
from scope_ptz.bench.faults import FAULTS, Setting
from scope_ptz.bench.tasks import Task

__all__ = ["Gold", "Setting", "confusion", "mutate"]


@dataclass(frozen=True, slots=True)
class Gold:
    """A run with a known fault."""

    mode: ErrorMode
    task: Task
    episode: Episode


def mutate(task: Task, episode: Episode, mode: ErrorMode, setting: Setting, rng: random.Random) -> Gold | None:
    """The run with one fault of a mode, or None when it has no place for one (who looks at nothing cannot miscount)."""
    ways = list(FAULTS[mode])
    rng.shuffle(ways)
    faulty = next((made for way in ways if (made := way(task, episode, setting, rng)) is not None), None)
    return None if faulty is None else Gold(mode, task, faulty)


def confusion(gold: Iterable[Gold]) -> Counter[tuple[ErrorMode, ErrorMode | None]]:
    """How often a fault of one mode (first) was taken for which (second); None: not judged incorrect, which is a false accept."""
    return Counter((one.mode, error_mode(one.task, one.episode)) for one in gold)
