"""Compute the trial of a run from its trace, the published task and the published presets.

A missing, damaged or contradictory trace results in an unscored trial, which does not count as correct.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from pydantic import ValidationError

from scope_ptz.agent.trace import Trace
from scope_ptz.agent.trace_faults import trace_faults
from scope_ptz.bench.engine.entries import Entry
from scope_ptz.bench.engine.stored_run import FRAME_HEIGHT_PX, FRAME_WIDTH_PX, StoredRun, sample_name, trace_of
from scope_ptz.bench.engine.trial_records import trial_of
from scope_ptz.bench.scoring.trials import Judgement, LogFault, LogFinding, Trial
from scope_ptz.bench.tasks.files import digest_of
from scope_ptz.bench.tasks.published import preset_viewpoints, published_digest, published_tasks
from scope_ptz.bench.tasks.task_wording import facts_of
from scope_ptz.errors import ScopeError, TraceError

TIME_TOLERANCE_S = 1e-6
"""Tolerance for the scene time at the start of a run, in seconds."""


def published_entry(entry: Entry, *, published_split: bool = False) -> tuple[Entry, bool]:
    """Return the published version of an entry, and whether ``entry`` differs from it.

    An entry whose task is not published is returned unchanged. A private task may have the same id as a published one, so an entry
    counts as published only if its scene and instruction are also the same.

    Args:
        entry: The entry from a log or a submission.
        published_split: Whether the entry belongs to a published split. If so, only the id is compared.
    """
    found = published_task_entry(entry.facts.id, entry.facts.viewpoint)
    if found is None:
        return entry, False
    same_wording = (entry.world, entry.facts.instruction) == (found.world, found.facts.instruction)
    if not (published_split or same_wording or entry.task is None):
        return entry, False
    same_task = entry.task is not None and entry.imported is None and digest_of([entry.task]) == published_digest(entry.facts.id)
    same_start = (entry.facts, entry.world, entry.time_s) == (found.facts, found.world, found.time_s)
    return found, not (same_task and same_start)


def published_task_entry(task_id: str, viewpoint: str = "") -> Entry | None:
    """Return the entry for a published task; None if the id is not that of a published task.

    Args:
        task_id: The id of the task.
        viewpoint: The viewpoint of the task's preset. It is used only if the package does not contain the scene.
    """
    task = published_tasks().get(task_id)
    if task is None:
        return None
    known = preset_viewpoints(task.world)
    if known is not None:
        viewpoint = known[0].get(task.preset, "")
    return Entry(facts=facts_of(task, viewpoint), world=task.world, time_s=task.time_s, task=task)


def with_packaged_presets(stored_run: StoredRun, world: str) -> StoredRun:
    """Return a run's data with the presets of the packaged scene, or unchanged if the package does not contain the scene."""
    known = preset_viewpoints(world)
    return stored_run if known is None else replace(stored_run, presets=known[0], home=known[1])


def scored_trial(
    entry: Entry, stored_run: StoredRun, epoch: int, path: Path, judgements: tuple[Judgement, ...] = (), *, failed: bool = False
) -> tuple[Trial, LogFinding | None]:
    """Compute the trial of a run from its trace. Return the trial, and a finding if the trace is faulty.

    Args:
        entry: The entry that was run.
        stored_run: The stored data of the run.
        epoch: Number of the run of this entry, from 1.
        path: The log, for error messages.
        judgements: The judgements of the run.
        failed: Whether the run ended with an error according to the log. The trace of such a run may be missing or incomplete.
    """
    name = sample_name(entry.facts.id, epoch)
    try:
        trace = trace_of(stored_run.trace, path)
        if trace is None or trace.ended is None:
            if not failed:
                problem = "has no trace" if trace is None else "has a trace without an end"
                return unusable_trial(entry, epoch, judgements, "trace-missing", f"the run {problem} although it did not fail")
        elif fault := next(_faults(trace, entry, stored_run), None):
            return unusable_trial(entry, epoch, judgements, "trace-damaged", fault)
        return trial_of(entry, stored_run, epoch, path, judgements), None
    except TraceError:
        return unusable_trial(entry, epoch, judgements, "trace-damaged", f"the trace of {name} cannot be read")
    except (ScopeError, ValidationError, ValueError, TypeError, KeyError, AttributeError) as error:
        detail = f"the checks cannot be executed on the trace ({type(error).__name__})"
        return unusable_trial(entry, epoch, judgements, "trace-damaged", detail)


def _faults(trace: Trace, entry: Entry, stored_run: StoredRun) -> Iterator[str]:
    """Yield the contradictions within a trace, and between the trace and its task."""
    started, facts = trace.started, entry.facts
    if started.instruction != facts.instruction.encode("utf-8", "replace").decode().strip():
        yield "the trace is for a different instruction"
    if started.simulated and (started.scene, started.viewpoint) != (entry.world, facts.viewpoint):
        yield f"the trace begins at {started.viewpoint} of {started.scene}, and not at {facts.viewpoint} of {entry.world}"
    if (started.frame_width, started.frame_height) != (FRAME_WIDTH_PX, FRAME_HEIGHT_PX):
        yield f"the frames have {started.frame_width}x{started.frame_height} pixels, and not {FRAME_WIDTH_PX}x{FRAME_HEIGHT_PX}"
    if abs(started.scene_time_s - entry.time_s) > TIME_TOLERANCE_S:
        yield f"the trace begins at {started.scene_time_s:g} s of scene time, and not at {entry.time_s:g} s"
    if stored_run.pictures and stored_run.sees and not any(decided.view for decided in trace.decisions):
        yield "the log states that the planner was shown frames, but the trace contains none"
    yield from trace_faults(trace)


def unusable_trial(
    entry: Entry, epoch: int, judgements: tuple[Judgement, ...], kind: LogFault, detail: str
) -> tuple[Trial, LogFinding]:
    """Return an unscored trial and a finding that states the reason."""
    name = sample_name(entry.facts.id, epoch)
    return unscored_trial(entry, epoch, detail, judgements), LogFinding(kind=kind, sample=name, detail=detail)


def unscored_trial(entry: Entry, epoch: int, reason: str, judgements: tuple[Judgement, ...] = ()) -> Trial:
    """Return a trial without a verdict, which does not count as correct.

    ``scored_by`` is left at "checks": with "judge", the trial would be treated as awaiting a verdict and left out of the accuracy.
    """
    return Trial(
        task=entry.facts, epoch=epoch, sample=sample_name(entry.facts.id, epoch), headline="unscored", reason=reason, outcome=None,
        answer="", judgements=judgements,
    )  # fmt: skip
