"""The benchmark as a task of the engine."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from inspect_ai import Epochs, Task

from scope_ptz.bench.engine.run_cards import AGENT_SOURCE
from scope_ptz.bench.engine.entries import Entry, datasets, digest
from scope_ptz.bench.engine.external_agents import source_digest
from scope_ptz.bench.engine.judge_scorer import judge
from scope_ptz.bench.engine.samples import dataset_of
from scope_ptz.bench.engine.checks_scorer import checks
from scope_ptz.bench.engine.agent_solver import OWN_AGENT, scope_agent
from scope_ptz.version import __version__

MOST_BROKEN = 0.1
"""Share of runs that infrastructure may break before the evaluation as a whole counts as failed."""


def bench_task(
    entries: Sequence[Entry],
    split: str,
    *,
    agent: str = OWN_AGENT,
    pictures: bool = True,
    max_steps: int = 60,
    time_s: float | None = None,
    seed: int = 1,
    epochs: int = 1,
    judgements: int = 0,
) -> Task:
    """Entries to run, the agent as their solver, checks and so many ``judgements`` as their scorers. Broken runs are scored, and
    counted apart."""
    # Place after place: the layers of a viewpoint are read once, and those of few have to be in memory.
    by_place = sorted(entries, key=lambda entry: (entry.facts.scene, entry.facts.viewpoint))
    return Task(
        dataset=dataset_of(by_place, name=f"{datasets(entries)} {Path(split).name}"),
        solver=scope_agent(agent, pictures, max_steps, time_s, seed),
        scorer=[checks(), *(judge(repeat) for repeat in range(judgements))],
        epochs=Epochs(epochs, "mean"),
        fail_on_error=MOST_BROKEN,
        continue_on_fail=True,
        score_on_error=True,
        version=datasets(entries),
        metadata=facts(entries, split, agent=agent, max_steps=max_steps, seed=seed),
    )


def facts(entries: Sequence[Entry], split: str, *, agent: str, max_steps: int, seed: int) -> dict[str, Any]:
    """What a log says of the tasks and the loop, whoever started it."""
    return {
        "scope": {
            "package_version": __version__,
            "dataset": datasets(entries),
            "dataset_digest": digest(entries),
            "split": Path(split).name,
            "agent": agent,
            "max_steps": max_steps,
            "seed": seed,
            **({AGENT_SOURCE: source_digest(agent)} if agent != OWN_AGENT else {}),
        }
    }
