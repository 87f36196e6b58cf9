"""The Inspect scorer that runs the executable checks.

It uses only the stored data of a run, so scoring can be repeated offline.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from inspect_ai.scorer import (
    CORRECT,
    INCORRECT,
    NOANSWER,
    Metric,
    SampleScore,
    Score,
    Scorer,
    Target,
    accuracy,
    grouped,
    metric,
    scorer,
    stderr,
)
from inspect_ai.solver import TaskState

from scope_ptz.bench.engine.context import EvalContext, TrueCount
from scope_ptz.bench.engine.entries import Entry
from scope_ptz.bench.engine.stored_run import STORE, StoredRun, sample_name, trace_of
from scope_ptz.bench.engine.traces.scored_trials import published_entry, scored_trial, with_packaged_presets
from scope_ptz.bench.engine.traces.traced_trials import TRIAL, cached_trial
from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.bench.scoring.trials import LogFinding, Trial
from scope_ptz.bench.scoring.verdict import Headline

CHECKS = "checks"
"""Name of the scorer in logs."""
_VALUES: Mapping[Headline, str] = {"correct": CORRECT, "incorrect": INCORRECT, "unscored": NOANSWER}
"""Inspect's score value for each outcome. Runs with an infrastructure failure have no value."""


@metric(scores="unreduced")
def error_modes() -> Metric:
    """Count failed runs by error mode."""

    def count(scores: list[SampleScore]) -> Any:
        modes = [(score.score.metadata or {}).get("error_mode") for score in scores]
        return {mode.value: modes.count(mode.value) for mode in ErrorMode}

    return count


METRICS = (
    accuracy(),
    stderr(cluster="place"),
    grouped(accuracy(), "category", all="groups", all_label="macro"),
    error_modes(),
)


def checks_scorer(context: EvalContext | None = None) -> Scorer:
    """Return the scorer that runs the executable checks of a task.

    A run with an infrastructure failure gets a score without a value, which metrics ignore.

    Args:
        context: Resources of the evaluation: the watcher is notified of each trial, and the ground truth is used to distinguish
            miscounts from wrong conclusions. If None, the checks use only the contents of the log.
    """

    @scorer(metrics=list(METRICS), name=CHECKS)
    def checks() -> Scorer:
        async def score(state: TaskState, target: Target) -> Score:  # noqa: ARG001 - Inspect's signature
            return score_of(await _trial(state, context))

        return score

    return checks()


async def _trial(state: TaskState, context: EvalContext | None) -> Trial:
    """Return the trial of a sample. If the run is incorrect, the true counts are computed once and stored in the sample."""
    entry, _ = published_entry(Entry.of_metadata(state.metadata))
    folder = Path(entry.facts.scene)
    stored = state.store.get(STORE)
    stored_run = with_packaged_presets(StoredRun.from_store(stored) if stored else StoredRun("", {}, ""), entry.world)
    trial, fault = _scored(entry, stored_run, state.epoch, folder)
    needs_truths = trial.headline == "incorrect" and fault is None and not stored_run.truths
    if needs_truths and context is not None and context.true_count is not None:
        stored_run = await _with_truths(entry, stored_run, context.true_count)
        if stored_run.truths:
            state.store.set(STORE, stored_run.to_store())
            trial, _ = _scored(entry, stored_run, state.epoch, folder)
    if context is not None:
        context.watcher.run_ended(sample_name(entry.facts.id, state.epoch), trial)
    return trial


def _scored(entry: Entry, stored_run: StoredRun, epoch: int, folder: Path) -> tuple[Trial, LogFinding | None]:
    """Return the result of ``scored_trial``. A complete run is cached, because its log is usually read soon afterwards."""
    trial, fault = cached_trial(entry, stored_run, epoch, folder)
    return (trial, None) if fault is None else scored_trial(entry, stored_run, epoch, folder, failed=True)


async def _with_truths(entry: Entry, stored_run: StoredRun, true_count: TrueCount) -> StoredRun:
    """Add the true count for every counting call to the data of a run."""
    trace = trace_of(stored_run.trace, Path(entry.facts.scene))
    if trace is None:
        return stored_run
    truths = dict[str, int | None]()
    for number, call in enumerate(stored_run.episode(trace).calls):
        for observation in call.observations:
            if observation.kind == "count":
                truths[str(number)] = await true_count(entry.world, observation)
    return replace(stored_run, truths=truths)


def score_of(trial: Trial) -> Score:
    """Convert a trial to an Inspect score whose metadata contains the trial."""
    metadata = {
        "headline": trial.headline,
        "error_mode": trial.error_mode.value if trial.error_mode else None,
        TRIAL: trial.model_dump(mode="json", exclude={"task", "judgements", "labels"}, exclude_defaults=True),
    }
    if trial.headline == "infrastructure":
        return Score.unscored(reason="infrastructure", answer=trial.answer, explanation=trial.reason, metadata=metadata)
    return Score(value=_VALUES[trial.headline], answer=trial.answer, explanation=trial.reason, metadata=metadata)
