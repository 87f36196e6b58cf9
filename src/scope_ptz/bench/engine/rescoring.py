"""Rescore logs with checks and judges, without running the agent again. Earlier scores are kept."""

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
from scope_ptz.bench.engine.logs import DECIDES, HEADER, kept_in, read_evaluation, read_header, reading, trials_by_sample
from scope_ptz.bench.engine.samples import STORE
from scope_ptz.bench.judging.deciding_judge import check_decides
from scope_ptz.bench.judging.judgement_tally import JudgementTally
from scope_ptz.bench.judging.rubrics import prompt_version
from scope_ptz.bench.scoring.trials import Trial
from scope_ptz.errors import InputError, OutputError

AT_A_TIME = 8
"""Default number of samples that are scored concurrently."""
FLUSH_EVERY = 50
"""Number of samples held in memory between two writes. Each write copies the whole new log."""

Report = Callable[[int, int], None]


async def rescore(
    log: Path,
    context: EvalContext,
    *,
    judge_model: Model | None,
    repeats: int = 1,
    further: bool = True,
    with_checks: bool = False,
    at_a_time: int = AT_A_TIME,
    report: Report,
) -> JudgementTally:
    """Append scores to a log, and return the outcome of the new judgements. The log is replaced at the end, in one step.

    Args:
        log: Log of a finished evaluation.
        context: Provides the judge and ground truth.
        judge_model: The judge; None to apply only the checks.
        repeats: Number of judgements of each run.
        further: Add ``repeats`` judgements to those in the log; otherwise complete the first ``repeats``.
        with_checks: Apply the executable checks again.
        at_a_time: Samples that are scored concurrently.
        report: Called with the number of written samples and the number of all samples.

    Raises:
        TraceError: There is no log, or it is damaged.
        InputError: The evaluation is not finished.
        OutputError: The log cannot be replaced.
    """
    header = read_header(log)
    if header.status == "started":
        raise InputError(f"The evaluation in {log} is not finished. Resume it with the command that started it.")
    scorers: list[Scorer] = [checks_scorer(context)] if with_checks else []
    journal = Journal.beside(log)
    if judge_model is not None:
        before = trials_by_sample(log)
        for sample, trial in before.items():
            for made in trial.judgements:
                journal.know(sample, made)
        numbers = _further(before, judge_model.name, repeats) if further else range(repeats)
        scorers += [judge_scorer(context, repeat, journal) for repeat in numbers]
    silence_display()
    scratch = log.with_name(f".{log.stem}.rescored.eval")
    scratch.unlink(missing_ok=True)
    try:
        with reading(log):
            await _append(log, scratch, scorers, judge_model, at_a_time, report)
        scratch.replace(log)
    except OSError as error:
        raise OutputError(f"The log {log} cannot be replaced: {error.strerror}.") from error
    finally:
        scratch.unlink(missing_ok=True)
    journal.done()
    return JudgementTally.of(journal.made)


def let_decide(log: Path, judge: str) -> None:
    """Record in a log which of its judges decides on runs that only a judge can score.

    Raises ``TraceError`` for a damaged log, and ``InputError`` when that judge has given no verdict on such a run.
    """
    check_decides(read_evaluation(log).trials, judge)
    if read_header(log).status == "started":
        raise InputError(f"The evaluation in {log} is not finished. Resume it with the command that started it.")
    scratch = log.with_name(f".{log.stem}.decided.eval")
    try:
        with reading(log), ZipFile(log) as old, ZipFile(scratch, "w", ZIP_DEFLATED) as new:
            for info in old.infolist():
                content = old.read(info)
                if info.filename == HEADER:
                    header = json.loads(content)
                    header["eval"]["metadata"] = {**(header["eval"].get("metadata") or {}), DECIDES: judge}
                    content = json.dumps(header).encode()
                new.writestr(info, content)
        scratch.replace(log)
    except OSError as error:
        raise OutputError(f"The log {log} cannot be replaced: {error.strerror}.") from error
    finally:
        scratch.unlink(missing_ok=True)


def _further(before: Mapping[str, Trial], judge_name: str, repeats: int) -> range:
    """Return the indices of the judgements to make. They begin after the last one by this judge and prompt, or at a failed one."""
    own = [j for t in before.values() for j in t.judgements if (j.judge, j.prompt) == (judge_name, prompt_version())]
    failed = [j.repeat for j in own if j.verdict == "failed"]
    first = min(failed) if failed else max((j.repeat + 1 for j in own), default=0)
    return range(first, first + repeats)


async def _append(log: Path, scratch: Path, scorers: Sequence[Scorer], model: Model | None, at_a_time: int, report: Report) -> None:
    header, reader = read_header(log), recorder(log, log.parent)
    writer = recorder(scratch, log.parent)
    names = await reader.read_log_sample_ids(str(log))
    slots, written = anyio.Semaphore(at_a_time), 0

    @asynccontextmanager
    async def sample_at(index: int) -> AsyncGenerator[EvalSample, None]:
        nonlocal written
        async with slots:
            sample = await reader.read_log_sample(str(log), *names[index])
            if STORE not in sample.store:
                kept = kept_in(sample.model_dump(mode="json"))
                sample.store |= {STORE: kept.as_store()} if kept is not None else {}
            yield sample
            await writer.log_sample(header.eval, sample)
            written += 1
            if written % FLUSH_EVERY == 0:
                await writer.flush(header.eval)
            report(written, len(names))

    await writer.log_init(header.eval, location=str(scratch))
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
