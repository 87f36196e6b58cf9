"""Read the logs of finished and unfinished evaluations."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any
from zipfile import ZipFile

from inspect_ai.log import EvalLog  # also registers the compression of logs with zipfile
from pydantic_core import from_json

from scope_ptz.bench.engine.inspect_internals import header_context
from scope_ptz.bench.engine.run_cards import CARD, card_of
from scope_ptz.bench.engine.sample_files import convert_read_errors, sample_count, samples, stored_run_in
from scope_ptz.bench.engine.stored_run import trace_of
from scope_ptz.bench.engine.token_costs import cost_usd
from scope_ptz.bench.engine.traces.log_completeness import check_completeness
from scope_ptz.bench.engine.traces.traced_trials import traced_trial
from scope_ptz.bench.judging.deciding_judge import with_deciding_verdicts
from scope_ptz.bench.scoring.trials import Evaluation, Trial
from scope_ptz.errors import TraceError

DECIDING_JUDGE_KEY = "decides"
"""Metadata key for the name of the deciding judge, whose verdicts count for the runs that only a judge can score."""
HEADER, START = "header.json", "_journal/start.json"
SUMMARIES, SUMMARY_PARTS = "summaries.json", "_journal/summaries/"
"""Files in a log, which is a ZIP archive. The second name of each pair is used in the log of an unfinished evaluation."""


def read_evaluation(path: Path, progress: Callable[[int, int], None] | None = None) -> Evaluation:
    """Read an evaluation from a log, and compute the verdicts from the traces. The trials are sorted by task and epoch.

    The scores in the log are not used. Differences from the recomputed scores are reported in ``Evaluation.findings``. Judgements
    cannot be recomputed. If several judges have judged the runs that only a judge can score, one judge decides all of them.

    Args:
        path: The log.
        progress: Called after each sample with the number of finished samples and the total number of samples.

    Raises:
        TraceError: The log does not exist, is damaged, or is not from this benchmark.
    """
    with convert_read_errors(path):
        header, total = read_header(path), sample_count(path)
        split = str(((header.eval.metadata or {}).get(CARD) or {}).get("split", ""))
        traced, first = [], None
        for number, sample in enumerate(samples(path), 1):
            traced.append(traced_trial(sample, path, split))
            first = first or stored_run_in(sample)
            if progress is not None:
                progress(number, total)
        card = card_of(
            header, trace_of(first.trace, path) if first is not None and CARD not in (header.eval.metadata or {}) else None
        )
        scored, findings = check_completeness(traced, header, card)
        trials = with_deciding_verdicts(scored, (header.eval.metadata or {}).get(DECIDING_JUDGE_KEY, ""))
        expected_trials = (header.eval.dataset.samples or 0) * (header.eval.config.epochs or 1)
    order = {str(name): index for index, name in enumerate(header.eval.dataset.sample_ids or ())}
    trials.sort(key=lambda trial: (order.get(trial.task.id, len(order)), trial.task.id, trial.epoch))
    priced = (t.model_copy(update={"cost_usd": cost_usd(card, t.input_tokens, t.output_tokens)}) for t in trials)
    return Evaluation(
        card=card,
        trials=tuple(priced),
        wanted=expected_trials,
        log=str(path),
        findings=findings,
        failure=_failure(header),
    )


def _failure(header: EvalLog) -> str:
    """Return the error that ended an evaluation, or an empty string if it did not end in an error."""
    if header.status != "error":
        return ""
    return header.error.message if header.error is not None else "some of its runs failed"


def trials_by_sample(path: Path) -> dict[str, Trial]:
    """Return the trials of a log by sample name. Raises ``TraceError``."""
    return {trial.sample: trial for trial in read_evaluation(path).trials}


def read_header(path: Path) -> EvalLog:
    """Return the header of a log. For an interrupted evaluation, this is the header written at the start. Raises ``TraceError``."""
    with convert_read_errors(path):
        # Inspect's reader is not used, because it patches asyncio for the whole program if an event loop is running.
        with ZipFile(path) as archive:
            is_complete = HEADER in archive.namelist()
            header_data = from_json(archive.read(HEADER if is_complete else START))
        if not is_complete:
            header_data = {**header_data, "status": "started"}
        header = EvalLog.model_validate(header_data, context=header_context())
        header.location = str(path)
        if "scope" not in (header.eval.metadata or {}):
            raise TraceError(f"{path} is a log of the Inspect task {header.eval.task} that this benchmark did not write.")
        return header


def run_completion(path: Path) -> dict[tuple[str, int], bool]:
    """Return whether each run in a log completed without an error, by task and epoch. Raises ``TraceError``."""
    return {run: not row.get("error") for run, row in _summaries(path).items()}


def uuids_in(path: Path) -> dict[tuple[str, int], str | None]:
    """Return the unique ids of the runs in a log, by task and epoch. Raises ``TraceError``.

    A run keeps its id when it is carried over to another log.
    """
    return {run: row.get("uuid") for run, row in _summaries(path).items()}


def _summaries(path: Path) -> dict[tuple[str, int], dict[str, Any]]:
    with convert_read_errors(path), ZipFile(path) as archive:
        names = archive.namelist()
        parts = [SUMMARIES] if SUMMARIES in names else sorted((n for n in names if n.startswith(SUMMARY_PARTS)), key=_number)
        rows = [row for part in parts for row in from_json(archive.read(part))]
        return {(str(row["id"]), int(row["epoch"])): row for row in rows}


def _number(name: str) -> int:
    return int(name.rpartition("/")[2].partition(".")[0])
