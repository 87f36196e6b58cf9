"""Gold runs for the error modes: a run that passes, with one known fault of one mode put into it."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from scope_ptz.bench.scoring.episode import Episode
from scope_ptz.bench.scoring.error_modes import ErrorMode, error_mode
from scope_ptz.bench.tasks.task import Task
from scope_ptz.taskgen.gold import agent_faults as faults
from scope_ptz.taskgen.gold import reply_faults as faults_told
from scope_ptz.taskgen.gold.agent_faults import Setting

__all__ = ["Gold", "Setting", "confusion", "mutate"]


Way = Callable[[Task, Episode, Setting, random.Random], Episode | None]
FAULTS: dict[ErrorMode, tuple[Way, ...]] = {
    ErrorMode.LACK_OF_TOOL_CALL: (faults.drop_all, faults.drop_looks, faults.drop_pictures),
    ErrorMode.TOOL_ROUTING: (faults.swap_tools, faults.swap_order),
    ErrorMode.SCOPE: (faults.flip_scope,),
    ErrorMode.TOOL_ARGS: (faults.other_preset, faults.turned_round, faults.other_target),
    ErrorMode.HALLUCINATION: (faults_told.make_up,),
    ErrorMode.VLM_COUNTING: (faults_told.miscount,),
    ErrorMode.VLM_QUERY: (faults_told.misread, faults_told.overlook),
    ErrorMode.REASONING: (faults_told.conclude_wrongly,),
}


@dataclass(frozen=True, slots=True)
class Gold:
    """A run with a known fault. ``fault``: the name of the function that put it in."""

    mode: ErrorMode
    task: Task
    episode: Episode
    fault: str


def mutate(task: Task, episode: Episode, mode: ErrorMode, setting: Setting, rng: random.Random) -> Gold | None:
    """The run with one fault of a mode, or None when it has no place for one (who looks at nothing cannot miscount)."""
    ways = list(FAULTS[mode])
    rng.shuffle(ways)
    for way in ways:
        if (faulty := way(task, episode, setting, rng)) is not None:
            return Gold(mode, task, faulty, way.__name__)
    return None


def confusion(gold: Iterable[Gold]) -> Counter[tuple[ErrorMode, ErrorMode | None]]:
    """How often a fault of one mode (first) was taken for which (second); None: not judged incorrect, which is a false accept."""
    return Counter((one.mode, error_mode(one.task, one.episode)) for one in gold)
