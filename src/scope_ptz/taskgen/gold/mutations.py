"""Insert a known fault of one error mode into a passing run."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from scope_ptz.bench.scoring.episode import Episode
from scope_ptz.bench.scoring.error_modes import ErrorMode, error_mode
from scope_ptz.bench.tasks.task import Task
from scope_ptz.taskgen.gold import agent_faults, reply_faults
from scope_ptz.taskgen.gold.agent_faults import FaultContext

__all__ = ["FaultContext", "GoldRun", "count_assigned_modes", "mutate"]

FaultFunction = Callable[[Task, Episode, FaultContext, random.Random], Episode | None]
# The fault functions for each error mode.
FAULTS: dict[ErrorMode, tuple[FaultFunction, ...]] = {
    ErrorMode.LACK_OF_TOOL_CALL: (agent_faults.drop_all, agent_faults.drop_looks, agent_faults.drop_pictures),
    ErrorMode.TOOL_ROUTING: (agent_faults.swap_tools, agent_faults.swap_order),
    ErrorMode.SCOPE: (agent_faults.flip_scope,),
    ErrorMode.TOOL_ARGS: (agent_faults.other_preset, agent_faults.turned_round, agent_faults.other_target),
    ErrorMode.HALLUCINATION: (reply_faults.make_up,),
    ErrorMode.VLM_COUNTING: (reply_faults.miscount,),
    ErrorMode.VLM_QUERY: (reply_faults.misread, reply_faults.overlook),
    ErrorMode.REASONING: (reply_faults.conclude_wrongly,),
}


@dataclass(frozen=True, slots=True)
class GoldRun:
    """A run with a known fault. ``fault`` is the name of the fault function."""

    mode: ErrorMode
    task: Task
    episode: Episode
    fault: str


def mutate(task: Task, episode: Episode, mode: ErrorMode, context: FaultContext, rng: random.Random) -> GoldRun | None:
    """Insert one fault of an error mode into a passing run.

    Returns:
        The run with the fault; None if no fault of this mode applies. For example, a run without a counting call cannot have a
        wrong count.
    """
    functions = list(FAULTS[mode])
    rng.shuffle(functions)
    for function in functions:
        if (faulty := function(task, episode, context, rng)) is not None:
            return GoldRun(mode, task, faulty, function.__name__)
    return None


def count_assigned_modes(gold: Iterable[GoldRun]) -> Counter[tuple[ErrorMode, ErrorMode | None]]:
    """Count runs by their fault mode and the mode that the rules assign, which is None for runs that are not judged incorrect."""
    return Counter((run.mode, error_mode(run.task, run.episode)) for run in gold)
