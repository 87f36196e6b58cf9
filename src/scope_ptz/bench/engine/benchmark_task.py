"""The benchmark as an Inspect task."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from inspect_ai import Epochs, Task, task

from scope_ptz.bench.agents.launch import AgentOptions
from scope_ptz.bench.agents.start import local_agent
from scope_ptz.bench.engine.agent_solver import BUILT_IN_AGENT, agent_solver
from scope_ptz.bench.engine.checks_scorer import checks_scorer
from scope_ptz.bench.engine.context import EvalContext
from scope_ptz.bench.engine.entries import Entry, datasets, digest, select_entries
from scope_ptz.bench.engine.judge_scorer import judge_scorer
from scope_ptz.bench.engine.run_cards import AGENT_SOURCE
from scope_ptz.bench.engine.samples import dataset_of, viewpoint_order
from scope_ptz.version import __version__

__all__ = ["Task", "benchmark_task"]

MAX_BROKEN_FRACTION = 0.1
"""Maximum fraction of runs with an infrastructure failure. If more runs fail, the whole evaluation fails."""


def benchmark_task(provide_context: Callable[[int], EvalContext]) -> Callable[..., Task]:
    """Return the function that creates the Inspect task ``bench``.

    Args:
        provide_context: Function that returns the context of an evaluation with the given seed. It is called when Inspect creates
            the task.
    """

    @task
    def bench(
        split: str = "core",
        category: str | list[str] | None = None,
        scene: str | list[str] | None = None,
        limit: int | None = None,
        agent: str = BUILT_IN_AGENT,
        pictures: bool = True,
        max_steps: int = 60,
        time_s: float | None = None,
        seed: int = 1,
        epochs: int = 1,
        judgements: int = 0,
    ) -> Task:
        """SCOPE: a PTZ camera controlled in plain language.

        Args:
            split: Split of the dataset (core, lite, paraphrase, reaction, unseen, all), or a task file.
            category: Run only tasks of these categories, separated by commas.
            scene: Run only tasks of these scenes, separated by commas.
            limit: Run at most this many tasks, sampled evenly across the selected categories, scenes and answers.
            agent: "scope" for the built-in loop, or ``module:Class`` of an external agent.
            pictures: Render frames and log them.
            max_steps: Planner steps after which a run ends.
            time_s: Wall-clock seconds after which a run ends.
            seed: Seed for every random choice.
            epochs: Number of runs of each task.
            judgements: Number of judgements of each run by the model in the role "judge".
        """
        context = provide_context(seed)
        entries = select_entries(context.load_tasks(split), _name_list(category), _name_list(scene), limit)
        ordered = context.order(entries) if context.order is not None else viewpoint_order(entries, context.open_scene)
        return Task(
            dataset=dataset_of(ordered, name=f"{datasets(entries)} {Path(split).name}"),
            solver=agent_solver(context, agent=agent, pictures=pictures, max_steps=max_steps, time_s=time_s, seed=seed),
            scorer=[checks_scorer(context), *(judge_scorer(context, repeat) for repeat in range(judgements))],
            epochs=Epochs(epochs, "mean"),
            fail_on_error=MAX_BROKEN_FRACTION,
            continue_on_fail=True,
            score_on_error=True,
            version=datasets(entries),
            metadata=_log_metadata(entries, split, max_steps=max_steps, seed=seed, **_agent_metadata(context, agent)),
        )

    return bench


def _name_list(names: str | list[str] | None) -> list[str]:
    if isinstance(names, str):
        return names.split(",")
    return names or []


def _agent_metadata(context: EvalContext, agent: str) -> dict[str, Any]:
    """Return the log metadata about the agent. If the caller starts the agent, the run card contains the other details."""
    if agent == BUILT_IN_AGENT or context.open_agent is not None:
        return {"agent": agent}
    external = local_agent(agent, AgentOptions())
    return {"agent": agent, "isolation": external.isolation, AGENT_SOURCE: external.source}


def _log_metadata(entries: Sequence[Entry], split: str, **facts: Any) -> dict[str, Any]:
    """Return the log metadata about the tasks and the agent loop."""
    return {
        "scope": {
            "package_version": __version__,
            "dataset": datasets(entries),
            "dataset_digest": digest(entries),
            "split": Path(split).name,
            **facts,
        }
    }
