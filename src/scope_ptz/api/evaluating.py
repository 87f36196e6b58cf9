"""Run evaluations and read logs for ``scope_ptz.evaluate`` and ``scope_ptz.load_results``."""

from __future__ import annotations

import logging
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from scope_ptz.api.borrowed import BorrowedPerception, BorrowedPlanner
from scope_ptz.api.event_loop import run_in_thread
from scope_ptz.api.options import ModelServerOptions
from scope_ptz.bench.tasks.task import Task
from scope_ptz.errors import OutputError, TraceError
from scope_ptz.factory.models import ModelOptions
from scope_ptz.perception.base import Perception
from scope_ptz.planner.base import Planner

if TYPE_CHECKING:
    from scope_ptz.bench.agents.launch import AgentOptions
    from scope_ptz.bench.scoring.trials import Evaluation
    from scope_ptz.factory.evaluate import EvaluationOptions


logger = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class EvaluationRequest:
    """The arguments of ``scope_ptz.evaluate``."""

    planner: Planner | str | None
    perception: Perception | str | None
    pair: str | None
    tasks: str | PathLike[str] | tuple[Task, ...]
    out: Path
    agent: str | None
    agent_options: AgentOptions
    categories: tuple[str, ...]
    scenes: tuple[str, ...]
    limit: int | None
    epochs: int
    seed: int
    max_steps: int
    time_budget_s: float | None
    concurrency: int | None
    pictures: bool
    fresh: bool
    planner_url: str | None
    planner_model: str | None
    perception_url: str | None
    perception_model: str | None
    timeout_s: float | None


def run_evaluation(request: EvaluationRequest) -> Evaluation:
    """Run or resume an evaluation, or read the results of a complete one. This works even inside a running event loop."""
    from scope_ptz.factory.evaluate import evaluate, require_engine

    require_engine()
    options = _options(request)

    async def work() -> Evaluation:
        return (await evaluate(options)).evaluation

    return run_in_thread(work)


def read_results(path: Path) -> Evaluation:
    """Read a log, or the newest log in a folder. Verdicts are recomputed from the traces; contradictions are logged as warnings."""
    from scope_ptz.factory.evaluate import require_engine

    require_engine()
    from scope_ptz.bench.engine.logs import read_evaluation
    from scope_ptz.bench.reports.log_findings import finding_lines

    if path.is_dir():
        logs = sorted(path.rglob("*.eval"), key=lambda log: log.stat().st_mtime)
        if not logs:
            raise TraceError(f"There is no log in {path}. Pass a folder to which evaluate(out=...) has written.")
        path = logs[-1]
    evaluation = read_evaluation(path)
    for line in finding_lines(evaluation):
        logger.warning("%s", line)
    return evaluation


def _options(request: EvaluationRequest) -> EvaluationOptions:
    from scope_ptz.factory.evaluate import BUILT_IN_AGENT, EvaluationOptions

    served = ModelServerOptions(
        pair=request.pair,
        planner_url=request.planner_url,
        planner_model=request.planner_model,
        perception_url=request.perception_url,
        perception_model=request.perception_model,
        timeout_s=request.timeout_s,
    )
    return EvaluationOptions(
        models=_borrow_instances(served.model_options(request.planner, request.perception)),
        out=request.out,
        tasks=_task_file(request.tasks, request.out) if isinstance(request.tasks, tuple) else str(request.tasks),
        categories=request.categories,
        scenes=request.scenes,
        limit=request.limit,
        epochs=request.epochs,
        seed=request.seed,
        agent=request.agent or BUILT_IN_AGENT,
        agent_options=request.agent_options,
        max_steps=request.max_steps,
        time_s=request.time_budget_s,
        concurrency=request.concurrency,
        pictures=request.pictures,
        fresh=request.fresh,
    )


def _borrow_instances(models: ModelOptions) -> ModelOptions:
    """Wrap the caller's objects, so that they stay open after the evaluation."""
    planner, perception = models.planner_instance, models.perception_instance
    return replace(
        models,
        planner_instance=None if planner is None else BorrowedPlanner(planner),
        perception_instance=None if perception is None else BorrowedPerception(perception),
    )


def _task_file(tasks: tuple[Task, ...], out: Path) -> str:
    """Write tasks to a file next to the logs, and return its path. The file is required for resuming the evaluation."""
    from scope_ptz.bench.tasks.files import digest_of, dump_tasks

    path = out / "tasks" / f"{digest_of(tasks)[:16]}.jsonl"
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        dump_tasks(tasks, path)
    except OSError as error:
        raise OutputError(f"{path} cannot be written: {error.strerror}. Choose another folder with out=.") from error
    return str(path)
