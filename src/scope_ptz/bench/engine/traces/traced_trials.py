"""Compute the trials of a log from its traces. The only scores taken from the log are judge verdicts.

Each trial is compared with the score in the log, and differences are reported as findings. A missing, damaged or contradictory
trace results in an unscored trial, which does not count as correct.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from scope_ptz.bench.engine.entries import Entry
from scope_ptz.bench.engine.judgement_scores import judgements_in
from scope_ptz.bench.engine.sample_files import stored_run_in
from scope_ptz.bench.engine.stored_run import StoredRun, sample_name
from scope_ptz.bench.engine.traces.named_models import models_of
from scope_ptz.bench.engine.traces.scored_trials import (
    published_entry,
    published_task_entry,
    scored_trial,
    unusable_trial,
    with_packaged_presets,
)
from scope_ptz.bench.scoring.trials import Judgement, LogFinding, Trial
from scope_ptz.bench.tasks.published import published_digest
from scope_ptz.bench.tasks.splits import SPLITS
from scope_ptz.errors import TraceError

TRIAL = "trial"
"""Key for the trial in a score's metadata."""
MAX_CACHED = 4096
"""Maximum number of trials that are kept in memory, so that rereading a log does not rerun its checks."""
_COMPARED_FIELDS = (
    "headline", "error_mode", "checks", "collateral", "outcome", "answer", "steps", "planned_by", "tool_calls", "bad_calls",
    "perception_failures", "server_events", "input_tokens", "output_tokens", "timings", "looks",
)  # fmt: skip
"""Trial fields that are compared with the recomputed trial, the most important first."""
_SCORE_VALUES = {"correct": "C", "incorrect": "I", "unscored": "N"}

_trial_cache: dict[str, Trial] = {}


@dataclass(frozen=True, slots=True)
class TracedTrial:
    """A trial computed from a trace.

    Attributes:
        trial: The trial.
        findings: The contradictions that were found.
        entry: The entry that was run. A published task replaces its copy in the log.
        trace_digest: Digest of the trace; empty without a trace.
        models: The names of the planner and the perception model in the trace; empty without a trace.
    """

    trial: Trial
    findings: tuple[LogFinding, ...]
    entry: Entry
    trace_digest: str = ""
    models: tuple[str, str] = ("", "")


def traced_trial(sample: Mapping[str, Any], path: Path, split: str) -> TracedTrial:
    """Compute the trial of a sample from its trace, and compare it with the score in the log.

    Args:
        sample: The sample as JSON data.
        path: The log.
        split: The split on the run card. All tasks in a published split must be published tasks.

    Raises:
        TraceError: The sample contains no task.
    """
    scores = sample.get("scores") or {}
    entry, differs = _entry_of(sample, published_split=split in SPLITS)
    judgements, epoch = judgements_in(scores), int(sample["epoch"])
    name = sample_name(entry.facts.id, epoch)
    findings = []
    if differs:
        findings.append(LogFinding(kind="task-differs", sample=name, detail="its task is not the published one"))
    stored_run = with_packaged_presets(stored_run_in(sample) or StoredRun("", {}, ""), entry.world)
    digest = hashlib.sha256(stored_run.trace.encode()).hexdigest() if stored_run.trace else ""
    unknown = split in SPLITS and entry.task is not None and published_digest(entry.facts.id) is None
    fault: LogFinding | None
    if str(sample.get("id")) != entry.facts.id:
        trial, fault = unusable_trial(entry, epoch, judgements, "task-differs", "the sample contains the task of another sample")
    elif unknown:
        detail = f"it is not a task of the published split {split}"
        trial, fault = unusable_trial(entry, epoch, judgements, "task-unknown", detail)
    else:
        failed = sample.get("error") is not None
        trial, fault = cached_trial(entry, stored_run, epoch, path, judgements, failed=failed)
    if fault is not None:
        findings.append(fault)
    else:
        findings += _score_findings(trial, scores)
    return TracedTrial(trial, tuple(findings), entry, digest, models_of(stored_run))


def _entry_of(sample: Mapping[str, Any], *, published_split: bool) -> tuple[Entry, bool]:
    """Return the result of ``published_entry`` for a sample. A published task also replaces an unreadable copy."""
    try:
        return published_entry(Entry.of_metadata(sample["metadata"]), published_split=published_split)
    except TraceError:
        published = published_task_entry(str(sample.get("id")))
        if published is None:
            raise
        return published, True


def cached_trial(
    entry: Entry, stored_run: StoredRun, epoch: int, path: Path, judgements: tuple[Judgement, ...] = (), *, failed: bool = False
) -> tuple[Trial, LogFinding | None]:
    """Return the result of ``scored_trial``. Results without a fault are cached by a digest of everything that affects them."""
    content = (
        entry.metadata(), stored_run.trace, sorted(stored_run.presets.items()), stored_run.home, stored_run.sees,
        bool(stored_run.pictures), sorted(stored_run.truths.items()), epoch, failed,
        [judgement.model_dump(mode="json") for judgement in judgements],
    )  # fmt: skip
    key = hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()
    if key in _trial_cache:
        return _trial_cache[key], None
    trial, fault = scored_trial(entry, stored_run, epoch, path, judgements, failed=failed)
    if fault is None:
        while len(_trial_cache) >= MAX_CACHED:
            _trial_cache.pop(next(iter(_trial_cache)), None)
        _trial_cache[key] = trial
    return trial, fault


def _score_findings(trial: Trial, scores: Mapping[str, Any]) -> Iterator[LogFinding]:
    """Yield a finding if the log's latest score by the checks differs from the recomputed trial."""
    score = next((s for s in reversed(list(scores.values())) if TRIAL in (s.get("metadata") or {})), None)
    if score is None or trial.scored_by == "judge":
        return
    try:
        stored = Trial.model_validate({**score["metadata"][TRIAL], "task": trial.task})
    except (ValidationError, TypeError):
        yield LogFinding(kind="score-differs", sample=trial.sample, detail="its stored score is damaged")
        return
    difference = _difference(stored, trial)
    if not difference and trial.headline in _SCORE_VALUES and score.get("value") != _SCORE_VALUES[trial.headline]:
        difference = f"its stored score has the value {score.get('value')}, but the checks give {trial.headline}"
    if difference:
        yield LogFinding(kind="score-differs", sample=trial.sample, detail=difference)


def _difference(stored: Trial, trial: Trial) -> str:
    """Describe the first difference between a stored trial and the recomputed trial. Return an empty string if they are equal."""
    for name in _COMPARED_FIELDS:
        before, now = getattr(stored, name), getattr(trial, name)
        if name == "checks":
            before, now = ({check.name: check.passed for check in checks} for checks in (before, now))
        if before != now:
            long = len(f"{before}{now}") > 200
            return f"its stored score differs in {name}" + ("" if long else f": stored {before}, recomputed {now}")
    return ""
