"""What Inspect AI finds of this package: the task ``scope_ptz/bench`` and the models ``scope_ptz/...``.

inspect eval scope_ptz/bench --model-role planner=scope_ptz/grammar --model-role eyes=scope_ptz/ground-truth -T limit=5
"""

from __future__ import annotations

from typing import Any

from inspect_ai import Task, task
from inspect_ai.model import ModelAPI, modelapi

from scope_ptz.bench.engine.benchmark_task import bench_task
from scope_ptz.bench.engine.context import EQUIPMENT
from scope_ptz.bench.engine.entries import chosen
from scope_ptz.bench.engine.scope_model import ScopeModel
from scope_ptz.factory.evaluation import eval_context

__all__ = ["bench", "scope_ptz"]


@modelapi(name="scope_ptz")
def scope_ptz() -> type[ModelAPI]:
    """Planners and eyes of ``scope models``, and the built-in ones."""
    return ScopeModel


@task
def bench(
    split: str = "core",
    category: str | list[str] | None = None,
    scene: str | list[str] | None = None,
    limit: int | None = None,
    agent: str = "scope",
    pictures: bool = True,
    max_steps: int = 60,
    time_s: float | None = None,
    seed: int = 1,
    epochs: int = 1,
    judgements: int = 0,
) -> Task:
    """SCOPE: a camera that is told what to do in plain language.

    ``split``: core, another split of the dataset, or a file of tasks; ``category`` and ``scene``: only these, separated by
    commas; ``agent``: module:Class of another agent; ``pictures``: draw and keep what the camera shows;
    ``judgements``: how often the model that plays the role "judge" judges each run.
    """
    lent = EQUIPMENT.get()
    if lent is None:
        lent = eval_context(seed=seed)
        EQUIPMENT.set(lent)
    entries = chosen(lent.load_tasks(split), _names(category), _names(scene), limit)
    options: dict[str, Any] = {"agent": agent, "pictures": pictures, "max_steps": max_steps, "time_s": time_s, "seed": seed}
    return bench_task(entries, split, **options, epochs=epochs, judgements=judgements)


def _names(given: str | list[str] | None) -> list[str]:
    return [given] if isinstance(given, str) and "," not in given else given.split(",") if isinstance(given, str) else given or []
