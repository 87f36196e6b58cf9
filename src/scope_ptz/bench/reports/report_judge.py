"""Whose judgements a report speaks of."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from scope_ptz.bench.judging.deciding_judge import first_verdict
from scope_ptz.bench.judging.judgement_tally import VERDICTS
from scope_ptz.bench.reports.report_runs import ReportRun
from scope_ptz.bench.scoring.trials import Judgement, Trial


def judge_name(runs: Sequence[ReportRun]) -> str | None:
    """The judge that decides on most trials that only a judge can score; else the one with a verdict on most trials, of equals the
    first by name. None where there is no judge. One whose server always failed is named only where there is no other."""
    decides, gave, asked = Counter[str](), Counter[str](), Counter[str]()
    for trial in (trial for run in runs for trial in run.scored_trials):
        said = first_verdict(trial.judgements)  # In a log the judge that decides stands first.
        if trial.scored_by == "judge" and said is not None:
            decides[said.judge] += 1
        gave.update({j.judge for j in trial.judgements if j.verdict in VERDICTS})
        asked.update({j.judge for j in trial.judgements})
    return min(asked, key=lambda name: (-decides[name], -gave[name], -asked[name], name)) if asked else None


def verdicts(trials: Sequence[Trial], judge: str) -> list[tuple[Trial, Judgement]]:
    """Each trial that this judge judged, with the first judgement that is a verdict; where none is, with its first."""
    found = []
    for trial in trials:
        own = sorted((j for j in trial.judgements if j.judge == judge), key=lambda j: j.repeat)
        if own:
            found.append((trial, first_verdict(own) or own[0]))
    return found
