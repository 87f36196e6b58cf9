"""Scoring logs again without running the agent: checks from the stored traces, and judges. Earlier scores stay."""

from __future__ import annotations

import json
from collections.abc import AsyncGenerator, Callable, Mapping, Sequence
from contextlib import asynccontextmanager
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile

import anyio
from inspect_ai._eval.score import score_async
from inspect_ai.log import EvalSample
from inspect_ai.log._recorders.create import create_recorder_for_location
from inspect_ai.model import Model
from inspect_ai.scorer import Scorer
from inspect_ai.util._display import init_display_type

from scope_ptz.bench.engine.journal import JOURNAL, Journal
from scope_ptz.bench.engine.judging import judge
from scope_ptz.bench.engine.logs import DECIDES, HEADER, kept_in, read_evaluation, read_header, reading, trials_by_sample
from scope_ptz.bench.engine.sampling import STORE
from scope_ptz.bench.engine.scorers import checks
from scope_ptz.bench.judging.deciding_judge import check_decides
from scope_ptz.bench.judging.judgement_tally import JudgementTally
from scope_ptz.bench.judging.rubrics import prompt_version
from scope_ptz.bench.scoring.trials import Trial
from scope_ptz.errors import InputError, OutputError

AT_A_TIME = 8
FLUSH_EVERY = 50
"""Samples that are held in memory. Writing them copies the whole new log."""

Say = Callable[[int, int], None]


async def rescore(
    log: Path,
    *,
    judge_model: Model | None,
    repeats: int = 1,
    more: bool = True,
    with_checks: bool = False,
    at_a_time: int = AT_A_TIME,
    say: Say,
) -> JudgementTally:
    """Append scores to a log; what came of the judgements that were made now. The log is replaced when all is done, and not before.

    ``more``: so many judgements beside those there are; without, what is missing of the first ``repeats``. Raises ``TraceError``
    for what is no log, ``InputError`` for one that is still being written or cannot be.
    """
    header = read_header(log)
    if header.status == "started":
        raise InputError(f"{log} is not finished: run it to its end first, with the command that began it.")
    scorers: list[Scorer] = [checks()] if with_checks else []
    journal = Journal.beside(log)
    if judge_model is not None:
        before = trials_by_sample(log)
        for sample, trial in before.items():
            for made in trial.judgements:
                journal.know(sample, made)
        scorers += [judge(repeat) for repeat in (_further(before, judge_model.name, repeats) if more else range(repeats))]
    JOURNAL.set(journal)
    init_display_type("none")
    scratch = log.with_name(f".{log.stem}.rescored.eval")
    scratch.unlink(missing_ok=True)
    try:
        with reading(log):
            await _append(log, scratch, scorers, judge_model, at_a_time, say)
        scratch.replace(log)
    except OSError as error:
        raise OutputError(f"The log {log} cannot be replaced: {error.strerror}.") from error
    finally:
        scratch.unlink(missing_ok=True)
    journal.done()
    return JudgementTally.of(journal.made)


def let_decide(log: Path, judge: str) -> None:
    """Write into a log which of its judges decides on runs that only a judge can score.

    Raises ``TraceError`` for what is no log, ``InputError`` when that judge has given no verdict on such a run.
    """
    check_decides(read_evaluation(log).trials, judge)
    if read_header(log).status == "started":
        raise InputError(f"{log} is not finished: run it to its end first, with the command that began it.")
    scratch = log.with_name(f".{log.stem}.decided.eval")
    try:
        with reading(log), ZipFile(log) as old, ZipFile(scratch, "w", ZIP_DEFLATED) as new:
            for info in old.infolist():
                content = old.read(info)
                if info.filename == HEADER:
                    told = json.loads(content)
                    told["eval"]["metadata"] = {**(told["eval"].get("metadata") or {}), DECIDES: judge}
                    content = json.dumps(told).encode()
                new.writestr(info, content)
        scratch.replace(log)
    except OSError as error:
        raise OutputError(f"The log {log} cannot be replaced: {error.strerror}.") from error
    finally:
        scratch.unlink(missing_ok=True)


def _further(before: Mapping[str, Trial], judge_name: str, repeats: int) -> range:
    """Numbers of the judgements to make: after those that this judge has given by today's prompt. One that failed somewhere is
    made good first."""
    own = [j for t in before.values() for j in t.judgements if (j.judge, j.prompt) == (judge_name, prompt_version())]
    failed = [j.repeat for j in own if j.verdict == "failed"]
    first = min(failed) if failed else max((j.repeat + 1 for j in own), default=0)
    return range(first, first + repeats)


async def _append(log: Path, scratch: Path, scorers: Sequence[Scorer], model: Model | None, at_a_time: int, say: Say) -> None:
    header, reader = read_header(log), create_recorder_for_location(str(log), str(log.parent))
    writer = create_recorder_for_location(str(scratch), str(log.parent))
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
            say(written, len(names))

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
