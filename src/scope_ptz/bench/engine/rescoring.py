"""Rescore logs with checks and judges, without running the agent again. Earlier scores remain in the log."""

from __future__ import annotations

import json
from collections.abc import AsyncGenerator, Callable, Mapping, Sequence
from contextlib import asynccontextmanager
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile

import anyio
from inspect_ai import score_async
from inspect_ai.log import EvalSample
from inspect_ai.model import Model
from inspect_ai.scorer import Scorer

from scope_ptz.bench.engine.checks_scorer import checks_scorer
from scope_ptz.bench.engine.context import EvalContext
from scope_ptz.bench.engine.inspect_internals import recorder, silence_display
from scope_ptz.bench.engine.judge_scorer import judge_scorer
from scope_ptz.bench.engine.judgement_journal import Journal
from scope_ptz.bench.engine.logs import DECIDING_JUDGE_KEY, HEADER, read_evaluation, read_header, trials_by_sample
from scope_ptz.bench.engine.sample_files import convert_read_errors, stored_run_in
from scope_ptz.bench.engine.stored_run import STORE
from scope_ptz.bench.judging.deciding_judge import check_can_decide
from scope_ptz.bench.judging.judgement_tally import JudgementTally
from scope_ptz.bench.judging.rubrics import prompt_version
from scope_ptz.bench.scoring.trials import Trial
from scope_ptz.errors import InputError, OutputError

CONCURRENCY = 8
"""Default number of samples that are scored concurrently."""
SAMPLES_PER_FLUSH = 50
"""Number of samples kept in memory between writes. Each write copies the whole new log."""

ReportProgress = Callable[[int, int], None]
"""Function that is called with the number of written samples and the total number of samples."""


async def rescore(
    log: Path,
    context: EvalContext,
    *,
    judge_model: Model | None,
    repeats: int = 1,
    additional: bool = True,
    with_checks: bool = False,
    concurrency: int = CONCURRENCY,
    report: ReportProgress,
) -> JudgementTally:
    """Append scores to a log, and return a tally of the new judgements. The log is replaced atomically at the end.

    Args:
        log: Log of a finished evaluation.
        context: The resources of the evaluation, including the judge and the ground truth.
        judge_model: The judge; None to run only the checks.
        repeats: Number of judgements of each run.
        additional: Whether to add ``repeats`` judgements to those in the log. If False, only the first ``repeats`` judgements are
            completed.
        with_checks: Whether to run the executable checks again.
        concurrency: Number of samples that are scored concurrently.
        report: Called after each sample.

    Raises:
        TraceError: The log does not exist or is damaged.
        InputError: The evaluation is not finished.
        OutputError: The log cannot be replaced.
    """
    header = read_header(log)
    if header.status == "started":
        raise InputError(f"The evaluation in {log} is not finished. Resume it with the command that started it.")
    scorers: list[Scorer] = [checks_scorer(context)] if with_checks else []
    journal = Journal.of_log(log)
    if judge_model is not None:
        trials = trials_by_sample(log)
        for sample, trial in trials.items():
            for judgement in trial.judgements:
                journal.register_logged(sample, judgement)
        indices = _additional_indices(trials, judge_model.name, repeats) if additional else range(repeats)
        scorers += [judge_scorer(context, index, journal) for index in indices]
    silence_display()
    new_log = log.with_name(f".{log.stem}.rescored.eval")
    new_log.unlink(missing_ok=True)
    try:
        with convert_read_errors(log):
            await _write_rescored(log, new_log, scorers, judge_model, concurrency, report)
        new_log.replace(log)
    except OSError as error:
        raise OutputError(f"The log {log} cannot be replaced: {error.strerror}.") from error
    finally:
        new_log.unlink(missing_ok=True)
    journal.remove_logged()
    return JudgementTally.of(journal.added)


def set_deciding_judge(log: Path, judge: str) -> None:
    """Record in a log which judge decides the runs that only a judge can score.

    Raises:
        TraceError: The log does not exist or is damaged.
        InputError: The judge has given no verdict on one of these runs, or the evaluation is not finished.
        OutputError: The log cannot be replaced.
    """
    check_can_decide(read_evaluation(log).trials, judge)
    if read_header(log).status == "started":
        raise InputError(f"The evaluation in {log} is not finished. Resume it with the command that started it.")
    new_log = log.with_name(f".{log.stem}.decided.eval")
    try:
        with convert_read_errors(log), ZipFile(log) as source, ZipFile(new_log, "w", ZIP_DEFLATED) as target:
            for info in source.infolist():
                content = source.read(info)
                if info.filename == HEADER:
                    header = json.loads(content)
                    header["eval"]["metadata"] = {**(header["eval"].get("metadata") or {}), DECIDING_JUDGE_KEY: judge}
                    content = json.dumps(header).encode()
                target.writestr(info, content)
        new_log.replace(log)
    except OSError as error:
        raise OutputError(f"The log {log} cannot be replaced: {error.strerror}.") from error
    finally:
        new_log.unlink(missing_ok=True)


def _additional_indices(trials: Mapping[str, Trial], judge_name: str, repeats: int) -> range:
    """Return the indices of ``repeats`` new judgements.

    The indices begin at the first failed judgement by this judge with the current prompt or, if none failed, after the last one.
    """
    judgements = [j for t in trials.values() for j in t.judgements if (j.judge, j.prompt) == (judge_name, prompt_version())]
    failed = [j.repeat for j in judgements if j.verdict == "failed"]
    first = min(failed) if failed else max((j.repeat + 1 for j in judgements), default=0)
    return range(first, first + repeats)


async def _write_rescored(
    log: Path, new_log: Path, scorers: Sequence[Scorer], model: Model | None, concurrency: int, report: ReportProgress
) -> None:
    """Write a copy of a log with additional scores, sample by sample."""
    header, reader = read_header(log), recorder(log, log.parent)
    writer = recorder(new_log, log.parent)
    names = await reader.read_log_sample_ids(str(log))
    slots, written = anyio.Semaphore(concurrency), 0

    @asynccontextmanager
    async def sample_at(index: int) -> AsyncGenerator[EvalSample, None]:
        nonlocal written
        async with slots:
            sample = await reader.read_log_sample(str(log), *names[index])
            if STORE not in sample.store:
                stored_run = stored_run_in(sample.model_dump(mode="json"))
                sample.store |= {STORE: stored_run.to_store()} if stored_run is not None else {}
            yield sample
            await writer.log_sample(header.eval, sample)
            written += 1
            if written % SAMPLES_PER_FLUSH == 0:
                await writer.flush(header.eval)
            report(written, len(names))

    await writer.log_init(header.eval, location=str(new_log))
    await writer.log_start(header.eval, header.plan)
    scored = await score_async(
        header,
        list(scorers),
        model_roles={"judge": model} if model is not None else None,
        action="append",
        copy=False,
        samples=sample_at,
    )
    await writer.log_finish(
        scored.eval,
        scored.status,
        scored.stats,
        scored.results,
        scored.reductions,
        scored.error,
        log_updates=scored.log_updates,
        config_updates=scored.config_updates,
    )
