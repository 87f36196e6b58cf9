"""Whose judgements a report speaks of."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from scope_ptz.bench.reports.runs import Run
from scope_ptz.bench.trials import Judgement, Trial


def judge_name(runs: Sequence[Run]) -> str | None:
    """The judge with the most first judgements of these runs; of equals the first by name. None where there is no judge."""
    counted = Counter(judge for run in runs for trial in run.scored for judge in {j.judge for j in trial.judgements})
    return min(counted, key=lambda name: (-counted[name], name)) if counted else None


def verdicts(trials: Sequence[Trial], judge: str) -> list[tuple[Trial, Judgement]]:
    """Each trial that this judge judged, with its first judgement."""
    found = []
    for trial in trials:
        own = sorted((j for j in trial.judgements if j.judge == judge), key=lambda j: j.repeat)
        if own:
            found.append((trial, own[0]))
    return found
