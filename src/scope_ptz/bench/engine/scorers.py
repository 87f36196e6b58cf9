"""Scorers of the engine: the executable checks. They need nothing but what a run left, so that they can be repeated offline."""

from __future__ import annotations

from collections.abc import Mapping
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

from scope_ptz.bench.engine.context import EQUIPMENT
from scope_ptz.bench.engine.entries import Entry
from scope_ptz.bench.engine.sampling import STORE, Kept, sample_name, trace_of
from scope_ptz.bench.engine.scoring import trial_of
from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.bench.scoring.trials import Trial
from scope_ptz.bench.scoring.verdict import Headline

CHECKS = "checks"
TRIAL = "trial"
_VALUES: Mapping[Headline, str] = {"correct": CORRECT, "incorrect": INCORRECT, "unscored": NOANSWER}


@metric(scores="unreduced")
def error_modes() -> Metric:
    """How many runs failed in each of the eight ways."""

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


@scorer(metrics=list(METRICS), name=CHECKS)
def checks() -> Scorer:
    """The executable checks of a run. A run that infrastructure broke has a score without a value, which no metric counts."""

    async def score(state: TaskState, target: Target) -> Score:  # noqa: ARG001 - the engine's signature
        entry, lent = Entry.of_metadata(state.metadata), EQUIPMENT.get()
        left = state.store.get(STORE)
        kept = Kept.of_store(left) if left else Kept("", {}, "")
        trial = trial_of(entry, kept, state.epoch, Path(entry.facts.scene))
        if trial.headline == "incorrect" and lent is not None and lent.truth is not None and not kept.truths:
            kept = await _with_truths(entry, kept)
            state.store.set(STORE, kept.as_store())
            trial = trial_of(entry, kept, state.epoch, Path(entry.facts.scene))
        if lent is not None:
            lent.watcher.ended(sample_name(entry.facts.id, state.epoch), trial)
        return score_of(trial)

    return score


async def _with_truths(entry: Entry, kept: Kept) -> Kept:
    """The run with the true number beside every count, which tells a miscount from a wrong conclusion."""
    lent, trace = EQUIPMENT.get(), trace_of(kept.trace, Path(entry.facts.scene))
    if lent is None or lent.truth is None or trace is None:
        return kept
    truths = dict[str, int | None]()
    for number, call in enumerate(kept.episode(trace).calls):
        for look in call.observations:
            if look.how == "count":
                truths[str(number)] = await lent.truth(entry.world, look)
    return Kept(kept.trace, kept.presets, kept.home, kept.sees, kept.pictures, truths)


def score_of(trial: Trial) -> Score:
    """A judged run as a score of the engine; the run's record goes with it."""
    metadata = {
        "headline": trial.headline,
        "error_mode": trial.error_mode.value if trial.error_mode else None,
        TRIAL: trial.model_dump(mode="json", exclude={"task", "judgements", "labels"}, exclude_defaults=True),
    }
    if trial.headline == "infrastructure":
        return Score.unscored(reason="infrastructure", answer=trial.answer, explanation=trial.reason, metadata=metadata)
    return Score(value=_VALUES[trial.headline], answer=trial.answer, explanation=trial.reason, metadata=metadata)
