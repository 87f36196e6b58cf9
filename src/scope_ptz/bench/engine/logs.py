"""Read the logs of finished and unfinished evaluations."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from zipfile import BadZipFile, ZipFile

from inspect_ai.log import EvalLog  # also registers the compression of logs with zipfile
from pydantic import ValidationError
from pydantic_core import from_json

from scope_ptz.agent.trace import Trace
from scope_ptz.bench.engine.checks_scorer import TRIAL
from scope_ptz.bench.engine.entries import Entry
from scope_ptz.bench.engine.inspect_internals import header_context
from scope_ptz.bench.engine.judgement_scores import judgements_in
from scope_ptz.bench.engine.recording.picture_store import jpeg_of
from scope_ptz.bench.engine.run_cards import card_of, cost_usd
from scope_ptz.bench.engine.samples import STORE, Kept, sample_name, trace_of
from scope_ptz.bench.engine.trial_records import trial_of
from scope_ptz.bench.judging.deciding_judge import decided_by_one_judge
from scope_ptz.bench.scoring.episode import PresetViewpoints
from scope_ptz.bench.scoring.trials import Evaluation, Trial
from scope_ptz.errors import TraceError

ATTACHMENT = "attachment://"
DECIDES = "decides"
"""Metadata key for the name of the judge whose verdicts count where only a judge can score."""
HEADER, START = "header.json", "_journal/start.json"
SUMMARIES, JOURNALED = "summaries.json", "_journal/summaries/"
_SAMPLES = "samples/"


@dataclass(frozen=True, slots=True)
class SampleFiles:
    """One run of a log: its trace, the viewpoints of its presets, and its pictures by their names in the trace."""

    trace: Trace
    places: PresetViewpoints
    references: Mapping[str, str]
    attachments: Mapping[str, str]

    def picture(self, name: str) -> bytes | None:
        """Return a picture as JPEG; None if it was not stored."""
        data = self.attachments.get(self.references.get(name, "").removeprefix(ATTACHMENT))
        return jpeg_of(data) if data is not None else None


def read_evaluation(path: Path) -> Evaluation:
    """Read a log as an evaluation. Its trials are in the order of tasks and epochs.

    If several judges judged the runs that only a judge can score, one of them decides all these runs.


    Raises:
        TraceError: There is no log, it is damaged, or it is not a log of this benchmark.
    """
    with reading(path):
        header = read_header(path)
        wanted = (header.eval.dataset.samples or 0) * (header.eval.config.epochs or 1)
        decider = (header.eval.metadata or {}).get(DECIDES, "")
        trials = decided_by_one_judge([trial_in(sample, path) for sample in samples(path)], decider)
        first = next((kept_in(sample) for sample in samples(path)), None)
        card = card_of(header, trace_of(first.trace, path) if first is not None else None)
    order = {str(name): at for at, name in enumerate(header.eval.dataset.sample_ids or ())}
    trials.sort(key=lambda trial: (order.get(trial.task.id, len(order)), trial.task.id, trial.epoch))
    priced = (t.model_copy(update={"cost_usd": cost_usd(card, t.input_tokens, t.output_tokens)}) for t in trials)
    return Evaluation(card=card, trials=tuple(priced), wanted=wanted, log=str(path))


def trials_by_sample(path: Path) -> dict[str, Trial]:
    """Return the trials of a log by the names of their samples. Raises ``TraceError``."""
    return {trial.sample: trial for trial in read_evaluation(path).trials}


def open_sample(path: Path, sample: str) -> SampleFiles:
    """Open one run of a log by its name (``Trial.sample``). Raises ``TraceError``."""
    task, _, epoch = sample.rpartition("#")
    with reading(path):
        found = next(
            (row for row in samples(path, f"{task}_epoch_{epoch}") if sample_name(row["id"], row["epoch"]) == sample), None
        )
        if found is None:
            raise TraceError(f"The log {path} contains no run {sample}.")
        kept = kept_in(found)
        trace = trace_of(kept.trace, path) if kept is not None else None
        if kept is None or trace is None:
            raise TraceError(f"The run {sample} of {path} never began, so it has no trace.")
        return SampleFiles(trace, kept.places, kept.pictures, found.get("attachments", {}))


@contextmanager
def reading(path: Path) -> Iterator[None]:
    """Turn every error in reading a log into a ``TraceError`` that names the file."""
    try:
        yield
    except TraceError:
        raise
    except FileNotFoundError:
        raise TraceError(f"There is no log at {path}.") from None
    except OSError as error:
        raise TraceError(f"The log {path} cannot be read: {error.strerror or error}.") from error
    except (BadZipFile, ValidationError, ValueError, KeyError, EOFError, TypeError, AttributeError, NotImplementedError) as error:
        raise TraceError(
            f"{path} is not the log of an evaluation, or it is damaged ({type(error).__name__}: {str(error)[:200]})."
        ) from error


def read_header(path: Path) -> EvalLog:
    """Return the header of a log. For an interrupted evaluation it is the header written at the start. Raises ``TraceError``."""
    with reading(path):
        # Inspect's own reader changes asyncio for the whole program when an event loop runs.
        with ZipFile(path) as archive:
            whole = HEADER in archive.namelist()
            header_data = from_json(archive.read(HEADER if whole else START))
        header = EvalLog.model_validate(header_data if whole else {**header_data, "status": "started"}, context=header_context())
        header.location = str(path)
        if "scope" not in (header.eval.metadata or {}):
            raise TraceError(f"{path} is the log of another evaluation ({header.eval.task}), not of this benchmark.")
        return header


def runs_in(path: Path) -> dict[tuple[str, int], bool]:
    """Return whether each run of a log, by task and epoch, is complete and not broken. Raises ``TraceError``."""
    return {run: not row.get("error") for run, row in _summaries(path).items()}


def uuids_in(path: Path) -> dict[tuple[str, int], str | None]:
    """Return the unique ids of the runs of a log, by task and epoch. A run keeps its id in every log that takes it over.

    Raises ``TraceError``.
    """
    return {run: row.get("uuid") for run, row in _summaries(path).items()}


def _summaries(path: Path) -> dict[tuple[str, int], dict[str, Any]]:
    with reading(path), ZipFile(path) as archive:
        names = archive.namelist()
        parts = [SUMMARIES] if SUMMARIES in names else sorted((n for n in names if n.startswith(JOURNALED)), key=_number)
        rows = [row for part in parts for row in from_json(archive.read(part))]
        return {(str(row["id"]), int(row["epoch"])): row for row in rows}


def _number(name: str) -> int:
    return int(name.rpartition("/")[2].partition(".")[0])


def samples(path: Path, name: str | None = None) -> Iterator[dict[str, Any]]:
    """Iterate over the samples of a log as JSON data: all of them, or one by the name of its file.

    If several files have the same name, the last one is read.
    """
    with ZipFile(path) as archive:
        wanted = f"{_SAMPLES}{name}.json" if name else None
        for member in dict.fromkeys(n for n in archive.namelist() if n.startswith(_SAMPLES)):
            if wanted is None or member == wanted:
                sample = from_json(archive.read(member))
                if not isinstance(sample, dict):
                    raise TraceError(f"{path}: {member} is not a sample.")
                yield sample


def kept_in(sample: Mapping[str, Any]) -> Kept | None:
    """Return the data that the run of a sample stored; None if it stored none.

    After a crash, the data are read from the last event that changed the store.
    """
    attachments = sample.get("attachments", {})
    stored = (sample.get("store") or {}).get(STORE)
    if stored is None:
        changes = (c for e in sample.get("events") or () if e.get("event") == "store" for c in e.get("changes") or ())
        stored = next((c["value"] for c in reversed(list(changes)) if c.get("path") == f"/{STORE}"), None)
    if stored is None:
        return None
    kept = Kept.of_store(stored)
    if kept.trace.startswith(ATTACHMENT):
        whole = attachments[kept.trace.removeprefix(ATTACHMENT)]
        return Kept(whole, kept.presets, kept.home, kept.sees, kept.pictures, kept.truths)
    return kept


def trial_in(sample: Mapping[str, Any], path: Path) -> Trial:
    """Return the trial of a sample, with its latest checks and every judgement."""
    entry, scores = Entry.of_metadata(sample["metadata"]), sample.get("scores") or {}
    judgements = judgements_in(scores)
    stored = next((s["metadata"][TRIAL] for s in reversed(scores.values()) if TRIAL in (s.get("metadata") or {})), None)
    if stored is None or entry.task is None:
        kept = kept_in(sample) or Kept("", {}, "")
        return trial_of(entry, kept, sample["epoch"], path, judgements)
    return Trial.model_validate({**stored, "task": entry.facts, "judgements": judgements})
