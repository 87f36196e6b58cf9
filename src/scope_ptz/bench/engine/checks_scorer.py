"""The executable checks as an Inspect scorer. They read only what a run stored, so they can be repeated offline."""

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
from scope_ptz.bench.engine.samples import STORE, Kept, sample_name, trace_of
from scope_ptz.bench.engine.trial_records import trial_of
from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.bench.scoring.trials import Trial
from scope_ptz.bench.scoring.verdict import Headline

CHECKS = "checks"
TRIAL = "trial"
_VALUES: Mapping[Headline, str] = {"correct": CORRECT, "incorrect": INCORRECT, "unscored": NOANSWER}


@metric(scores="unreduced")
def error_modes() -> Metric:
    """Count the failed runs by error mode."""

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
    """Return the scorer that applies the executable checks of a task.

    A run that infrastructure broke has a score without a value, which no metric counts.

    Args:
        context: Its watcher receives the trial, and its ground truth distinguishes miscounts from wrong conclusions. If None,
            the checks use only the contents of the log.
    """

    @scorer(metrics=list(METRICS), name=CHECKS)
    def checks() -> Scorer:
        async def score(state: TaskState, target: Target) -> Score:  # noqa: ARG001 - the engine's signature
            return score_of(await _trial(state, context))

        return score

    return checks()


async def _trial(state: TaskState, context: EvalContext | None) -> Trial:
    """Return the trial of a sample. True counts of an incorrect run are looked up once and stored in the sample."""
    entry = Entry.of_metadata(state.metadata)
    where = Path(entry.facts.scene)
    stored = state.store.get(STORE)
    kept = Kept.of_store(stored) if stored else Kept("", {}, "")
    trial = trial_of(entry, kept, state.epoch, where)
    if trial.headline == "incorrect" and context is not None and context.true_count is not None and not kept.truths:
        kept = await _with_truths(entry, kept, context.true_count)
        if kept.truths:
            state.store.set(STORE, kept.as_store())
            trial = trial_of(entry, kept, state.epoch, where)
    if context is not None:
        context.watcher.ended(sample_name(entry.facts.id, state.epoch), trial)
    return trial


async def _with_truths(entry: Entry, kept: Kept, true_count: TrueCount) -> Kept:
    """Return the data of a run with the true count for every counting call."""
    trace = trace_of(kept.trace, Path(entry.facts.scene))
    if trace is None:
        return kept
    truths = dict[str, int | None]()
    for number, call in enumerate(kept.episode(trace).calls):
        for observation in call.observations:
            if observation.how == "count":
                truths[str(number)] = await true_count(entry.world, observation)
    return replace(kept, truths=truths)


def score_of(trial: Trial) -> Score:
    """Return a trial as an Inspect score, with the whole trial in its metadata."""
    metadata = {
        "headline": trial.headline,
        "error_mode": trial.error_mode.value if trial.error_mode else None,
        TRIAL: trial.model_dump(mode="json", exclude={"task", "judgements", "labels"}, exclude_defaults=True),
    }
    if trial.headline == "infrastructure":
        return Score.unscored(reason="infrastructure", answer=trial.answer, explanation=trial.reason, metadata=metadata)
    return Score(value=_VALUES[trial.headline], answer=trial.answer, explanation=trial.reason, metadata=metadata)
