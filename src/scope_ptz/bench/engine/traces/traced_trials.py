"""Compute the trials of a log from its traces. Nothing that a score of the log states is used, except the verdicts of judges.

Each trial is compared with the score that the log stores; differences are findings. A trace that is missing, damaged or
contradicts itself gives an unscored trial, which counts as not correct.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from scope_ptz.agent.trace import Trace
from scope_ptz.agent.trace_faults import trace_faults
from scope_ptz.bench.engine.entries import Entry
from scope_ptz.bench.engine.judgement_scores import judgements_in
from scope_ptz.bench.engine.sample_files import stored_run_in
from scope_ptz.bench.engine.stored_run import FRAME_HEIGHT_PX, FRAME_WIDTH_PX, StoredRun, sample_name, trace_of
from scope_ptz.bench.engine.trial_records import trial_of
from scope_ptz.bench.scoring.trials import Judgement, LogFault, LogFinding, Trial
from scope_ptz.bench.tasks.files import digest_of
from scope_ptz.bench.tasks.published import preset_viewpoints, published_digest, published_tasks
from scope_ptz.bench.tasks.splits import SPLITS
from scope_ptz.bench.tasks.task_wording import facts_of
from scope_ptz.errors import ScopeError, TraceError

TRIAL = "trial"
"""Metadata key under which a score stores the trial."""
MAX_CACHED = 4096
"""Maximum number of trials that are kept in memory, so that reading a log again does not execute its checks again."""
TIME_TOLERANCE_S = 1e-6
"""Tolerance for the scene time at the start of a run, in seconds."""
_COMPARED = (
    "headline", "error_mode", "checks", "collateral", "outcome", "answer", "steps", "tool_calls", "bad_calls",
    "perception_failures", "server_events", "input_tokens", "output_tokens", "timings", "looks",
)  # fmt: skip
"""Fields of a stored trial that are compared with the recomputed one, the most important first."""
_VALUES = {"correct": "C", "incorrect": "I", "unscored": "N"}

_CACHE: dict[str, Trial] = {}


@dataclass(frozen=True, slots=True)
class TracedTrial:
    """A trial computed from a trace.

    Attributes:
        trial: The trial.
        findings: The contradictions that were found.
        entry: The entry of the trial. For a published task, it contains the published task.
        trace_digest: Digest of the trace; empty if there is none.
        models: The planner and the perception that the trace names; empty if there is none.
    """

    trial: Trial
    findings: tuple[LogFinding, ...]
    entry: Entry
    trace_digest: str = ""
    models: tuple[str, str] = ("", "")


def published_entry(entry: Entry) -> tuple[Entry, bool]:
    """Return an entry with the published task of the same id, and whether the task or the facts in ``entry`` differ from it.

    An entry whose task is not published is returned unchanged.
    """
    found = entry_of_published(entry.facts.id, entry.facts.viewpoint)
    if found is None or entry.imported is not None:
        return entry, False
    same_task = entry.task is not None and digest_of([entry.task]) == published_digest(entry.facts.id)
    same_start = (entry.facts, entry.world, entry.time_s) == (found.facts, found.world, found.time_s)
    return found, not (same_task and same_start)


def entry_of_published(task_id: str, viewpoint: str = "") -> Entry | None:
    """Return the entry of a published task; None if there is none.

    Args:
        task_id: The id of the task.
        viewpoint: The viewpoint of its preset, which is used only if the package does not contain the scene.
    """
    task = published_tasks().get(task_id)
    if task is None:
        return None
    known = preset_viewpoints(task.world)
    if known is not None:
        viewpoint = known[0].get(task.preset, "")
    return Entry(facts=facts_of(task, viewpoint), world=task.world, time_s=task.time_s, task=task)


def published_run(stored_run: StoredRun, world: str) -> StoredRun:
    """Return the data of a run with the presets of the scene in the package, if the package contains the scene."""
    known = preset_viewpoints(world)
    return stored_run if known is None else replace(stored_run, presets=known[0], home=known[1])


def scored_trial(
    entry: Entry, stored_run: StoredRun, epoch: int, path: Path, judgements: tuple[Judgement, ...] = (), *, failed: bool = False
) -> tuple[Trial, LogFinding | None]:
    """Return the trial of a run, computed from its trace, and the fault of the trace if it has one.

    Args:
        entry: The entry that was run.
        stored_run: The stored data of the run.
        epoch: Number of the run of this entry, from 1.
        path: The log. Error messages name it.
        judgements: The judgements of the run.
        failed: Whether the log records that the run ended with an error. The trace of such a run may be missing or cut off.
    """
    name = sample_name(entry.facts.id, epoch)
    try:
        trace = trace_of(stored_run.trace, path)
        if trace is None or trace.ended is None:
            if not failed:
                what = "has no trace" if trace is None else "has a trace without an end"
                return _unusable(entry, epoch, judgements, "trace-missing", f"the run {what} although it did not fail")
        elif fault := next(_faults(trace, entry, stored_run), None):
            return _unusable(entry, epoch, judgements, "trace-damaged", fault)
        return trial_of(entry, stored_run, epoch, path, judgements), None
    except TraceError:
        return _unusable(entry, epoch, judgements, "trace-damaged", f"the trace of {name} cannot be read")
    except (ScopeError, ValidationError, ValueError, TypeError, KeyError, AttributeError) as error:
        detail = f"the checks cannot be executed on the trace ({type(error).__name__})"
        return _unusable(entry, epoch, judgements, "trace-damaged", detail)


def traced_trial(sample: Mapping[str, Any], path: Path, split: str) -> TracedTrial:
    """Compute the trial of a sample from its trace, with all judgements, and compare it with the score in the log.

    Args:
        sample: The sample as JSON data.
        path: The log.
        split: The split on the run card. Every task of a published split must be a published task.

    Raises:
        TraceError: The sample contains no task.
    """
    scores = sample.get("scores") or {}
    entry, differs = _entry_of(sample)
    judgements, epoch = judgements_in(scores), int(sample["epoch"])
    name = sample_name(entry.facts.id, epoch)
    findings = []
    if differs:
        findings.append(LogFinding(kind="task-differs", sample=name, detail="its task is not the published one"))
    stored_run = published_run(stored_run_in(sample) or StoredRun("", {}, ""), entry.world)
    digest = hashlib.sha256(stored_run.trace.encode()).hexdigest() if stored_run.trace else ""
    unknown = split in SPLITS and entry.task is not None and published_digest(entry.facts.id) is None
    fault: LogFinding | None
    if str(sample.get("id")) != entry.facts.id:
        trial, fault = _unusable(entry, epoch, judgements, "task-differs", "the sample contains the task of another sample")
    elif unknown:
        detail = f"it is not a task of the published split {split}"
        trial, fault = _unusable(entry, epoch, judgements, "task-unknown", detail)
    else:
        failed = sample.get("error") is not None
        trial, fault = _cached_trial(entry, stored_run, epoch, path, judgements, failed=failed)
    if fault is not None:
        findings.append(fault)
    else:
        findings += _score_findings(trial, scores)
    return TracedTrial(trial, tuple(findings), entry, digest, _models(stored_run))


def _entry_of(sample: Mapping[str, Any]) -> tuple[Entry, bool]:
    """Return ``published_entry`` of a sample. The published task also replaces a copy that cannot be read."""
    try:
        return published_entry(Entry.of_metadata(sample["metadata"]))
    except TraceError:
        published = entry_of_published(str(sample.get("id")))
        if published is None:
            raise
        return published, True


def _models(stored_run: StoredRun) -> tuple[str, str]:
    """Return the names of planner and perception in the first line of a trace."""
    try:
        started = json.loads(stored_run.trace.partition("\n")[0])
        return str(started["planner"]), str(started["perception"])
    except (ValueError, KeyError, TypeError):
        return "", ""


def _cached_trial(
    entry: Entry, stored_run: StoredRun, epoch: int, path: Path, judgements: tuple[Judgement, ...], *, failed: bool
) -> tuple[Trial, LogFinding | None]:
    """Return ``scored_trial``. Trials without a fault are kept in memory, under a digest of everything that determines them."""
    content = (
        entry.metadata(), stored_run.trace, sorted(stored_run.presets.items()), stored_run.home, stored_run.sees,
        bool(stored_run.pictures), sorted(stored_run.truths.items()), epoch, failed,
        [judgement.model_dump(mode="json") for judgement in judgements],
    )  # fmt: skip
    key = hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()
    if key in _CACHE:
        return _CACHE[key], None
    trial, fault = scored_trial(entry, stored_run, epoch, path, judgements, failed=failed)
    if fault is None:
        while len(_CACHE) >= MAX_CACHED:
            _CACHE.pop(next(iter(_CACHE)), None)
        _CACHE[key] = trial
    return trial, fault


def _faults(trace: Trace, entry: Entry, stored_run: StoredRun) -> Iterator[str]:
    """Yield the contradictions in a trace, and those between the trace and the task that it should be a run of."""
    started, facts = trace.started, entry.facts
    if started.instruction != facts.instruction.encode("utf-8", "replace").decode().strip():
        yield "the trace is of another instruction"
    if started.simulated and (started.scene, started.viewpoint) != (entry.world, facts.viewpoint):
        yield f"the trace begins at {started.viewpoint} of {started.scene}, and not at {facts.viewpoint} of {entry.world}"
    if (started.frame_width, started.frame_height) != (FRAME_WIDTH_PX, FRAME_HEIGHT_PX):
        yield f"the frames have {started.frame_width}x{started.frame_height} pixels, and not {FRAME_WIDTH_PX}x{FRAME_HEIGHT_PX}"
    if abs(started.scene_time_s - entry.time_s) > TIME_TOLERANCE_S:
        yield f"the trace begins at {started.scene_time_s:g} s of scene time, and not at {entry.time_s:g} s"
    if stored_run.pictures and stored_run.sees and not any(decided.view for decided in trace.decisions):
        yield "the log states that the planner was shown frames, but the trace contains none"
    yield from trace_faults(trace)


def _unusable(entry: Entry, epoch: int, judgements: tuple[Judgement, ...], kind: LogFault, detail: str) -> tuple[Trial, LogFinding]:
    """Return an unscored trial and the finding about it."""
    name = sample_name(entry.facts.id, epoch)
    return unscored(entry, epoch, detail, judgements), LogFinding(kind=kind, sample=name, detail=detail)


def unscored(entry: Entry, epoch: int, reason: str, judgements: tuple[Judgement, ...] = ()) -> Trial:
    """Return a trial without a verdict, which counts as not correct.

    It is scored by the checks even if only a judge could score it, because a missing verdict of a judge would exclude it.
    """
    return Trial(
        task=entry.facts, epoch=epoch, sample=sample_name(entry.facts.id, epoch), headline="unscored", reason=reason, outcome=None,
        answer="", judgements=judgements,
    )  # fmt: skip


def _score_findings(trial: Trial, scores: Mapping[str, Any]) -> Iterator[LogFinding]:
    """Yield a finding if the latest score of the checks in the log differs from the recomputed trial."""
    score = next((s for s in reversed(list(scores.values())) if TRIAL in (s.get("metadata") or {})), None)
    if score is None or trial.scored_by == "judge":
        return
    try:
        stored = Trial.model_validate({**score["metadata"][TRIAL], "task": trial.task})
    except (ValidationError, TypeError):
        yield LogFinding(kind="score-differs", sample=trial.sample, detail="its stored score is damaged")
        return
    found = _difference(stored, trial)
    if not found and trial.headline in _VALUES and score.get("value") != _VALUES[trial.headline]:
        found = f"its stored score has the value {score.get('value')}, but the checks give {trial.headline}"
    if found:
        yield LogFinding(kind="score-differs", sample=trial.sample, detail=found)


def _difference(stored: Trial, trial: Trial) -> str:
    """Describe the first difference between a stored trial and the recomputed one; empty if there is none."""
    for name in _COMPARED:
        before, now = getattr(stored, name), getattr(trial, name)
        if name == "checks":
            before, now = ({check.name: check.passed for check in checks} for checks in (before, now))
        if before != now:
            long = len(f"{before}{now}") > 200
            return f"its stored score differs in {name}" + ("" if long else f": stored {before}, recomputed {now}")
    return ""
