"""Add scores to existing logs: the current checks, a judge's verdicts, and missing judgements."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from scope_ptz.factory.evaluation_options import EvaluationResult, JudgeSettings
from scope_ptz.factory.judges import UnnamedJudgeError, open_judge

if TYPE_CHECKING:
    from scope_ptz.bench.engine.context import EvalContext, ModelRequest
    from scope_ptz.bench.engine.recording.scope_model import Model
    from scope_ptz.bench.judging.judge import Complete
    from scope_ptz.bench.judging.judgement_tally import JudgementTally
    from scope_ptz.bench.judging.server import JudgeServer

Notify = Callable[[str], None]
"""A callback that receives a sentence for the user."""

CONCURRENT_JUDGEMENTS = 8
PROGRESS_INTERVAL = 25
"""Number of samples between notes about scoring progress."""


def with_judge(context: EvalContext, judge: JudgeServer) -> EvalContext:
    """Return a context that provides the same judge for every request."""

    async def make_judge(request: ModelRequest, repeat: int) -> Complete:  # noqa: ARG001 - the engine passes a request
        return judge.for_repeat(repeat)

    return replace(context, make_judge=make_judge)


async def open_requested_judge(settings: JudgeSettings) -> JudgeServer:
    """Connect to the judge specified by the settings. The errors are those of ``open_judge``."""
    return await open_judge(settings.url, settings.model, settings.key_file, settings.timeout_s, settings.options)


def judge_model(judge: JudgeServer, max_connections: int) -> Model:
    """Return the engine's model object that represents a judge in the log."""
    from scope_ptz.bench.engine.recording.scope_model import inspect_model

    endpoint = judge.client.endpoint
    return inspect_model(endpoint.model, max_connections, url=endpoint.url, served=endpoint.model)


async def add_scores(
    log: Path,
    judge: JudgeServer | None,
    context: EvalContext,
    *,
    repeats: int,
    additional: bool = True,
    checks: bool = False,
    concurrency: int = CONCURRENT_JUDGEMENTS,
    notify: Notify,
) -> JudgementTally:
    """Add scores to a log, and return a tally of the judgements. The agent is not run again.

    Args:
        log: The log of a finished evaluation.
        judge: The judge; None to apply only the checks.
        context: The evaluation context.
        repeats: Number of judgements per run.
        additional: Whether to add ``repeats`` judgements to those in the log. If not, only the judgements that are missing from the
            first ``repeats`` are added.
        checks: Whether to apply the current executable checks again.
        concurrency: Number of runs to score concurrently.
        notify: A function that receives progress notes.

    Raises:
        InputError: The evaluation is not finished.
        TraceError: The log does not exist, or is damaged.
    """
    from scope_ptz.bench.engine.rescoring import rescore

    def report(done: int, total: int) -> None:
        if done % PROGRESS_INTERVAL == 0 or done == total:
            notify(f"{log.name}: {done} of {total}")

    if judge is not None:
        context = with_judge(context, judge)
    model = judge_model(judge, concurrency) if judge is not None else None
    return await rescore(
        log,
        context,
        judge_model=model,
        repeats=repeats,
        additional=additional,
        with_checks=checks,
        concurrency=concurrency,
        report=report,
    )


async def complete_judgements(
    log: Path,
    settings: JudgeSettings,
    connect_judge: Callable[[], Awaitable[JudgeServer]],
    context: EvalContext,
    *,
    retry_failed: bool,
    notify: Notify,
) -> EvaluationResult:
    """Request the missing judgements for a log, and return the evaluation with a tally of its judgements.

    Args:
        log: The evaluation log.
        settings: The judge, and the number of judgements per run.
        connect_judge: A function that connects to the judge. It is not called if the judge's name is known and no judgements are
            missing.
        context: The evaluation context.
        retry_failed: Whether to repeat judgements for which the judge's server failed.
        notify: A function that receives notes for the user.

    Raises:
        UnnamedJudgeError: The judge's name is unknown, and judgements are missing.
    """
    from scope_ptz.bench.engine.logs import read_evaluation
    from scope_ptz.bench.judging.judgement_tally import JudgementTally, judge_of_every_run, requested_judgements
    from scope_ptz.settings import load_settings

    evaluation = read_evaluation(log)
    requested = settings.model or load_settings().judge_model
    if not requested:
        try:
            requested = (await connect_judge()).client.endpoint.model
        except UnnamedJudgeError as error:
            known_judge = judge_of_every_run(evaluation.trials, "", settings.repeats)
            if known_judge is None:
                raise
            notify(f"{error} {known_judge} has already judged every run, so its verdicts are reported.")
            requested = known_judge
    name = judge_of_every_run(evaluation.trials, requested, settings.repeats)
    if name is None:
        judge = await connect_judge()
        name = judge.client.endpoint.model
        judgements = requested_judgements(evaluation.trials, name, settings.repeats)
        missing = sum(judgement is None or judgement.verdict == "failed" for judgement in judgements)
        if evaluation.finished and (None in judgements or (retry_failed and missing)):
            notify(f"{missing} of {len(judgements)} judgements by {name} are missing and will be requested now.")
            await add_scores(log, judge, context, repeats=settings.repeats, additional=False, notify=notify)
            evaluation = read_evaluation(log)
    completed = [
        judgement for judgement in requested_judgements(evaluation.trials, name, settings.repeats) if judgement is not None
    ]
    return EvaluationResult(evaluation, name, JudgementTally.of(completed))
