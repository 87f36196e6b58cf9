"""The judge whose verdicts a report shows."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from scope_ptz.bench.judging.deciding_judge import first_verdict
from scope_ptz.bench.judging.judgement_tally import VERDICTS
from scope_ptz.bench.reports.report_runs import ReportRun
from scope_ptz.bench.scoring.trials import Judgement, Trial


def judge_name(runs: Sequence[ReportRun]) -> str | None:
    """Return the judge whose verdicts a report shows; None if there is no judge.

    It is the judge that decides most of the trials that only a judge can score, else the judge with verdicts on most trials. Ties
    are resolved by name. A judge whose server always failed is chosen only if there is no other.
    """
    decides, gave, asked = Counter[str](), Counter[str](), Counter[str]()
    for trial in (trial for run in runs for trial in run.scored_trials):
        first = first_verdict(trial.judgements)  # The deciding judge comes first in a log.
        if trial.scored_by == "judge" and first is not None:
            decides[first.judge] += 1
        gave.update({j.judge for j in trial.judgements if j.verdict in VERDICTS})
        asked.update({j.judge for j in trial.judgements})
    return min(asked, key=lambda name: (-decides[name], -gave[name], -asked[name], name)) if asked else None


def verdicts(trials: Sequence[Trial], judge: str) -> list[tuple[Trial, Judgement]]:
    """Return each trial that a judge judged, with its first verdict, or with its first judgement if none is a verdict."""
    found = []
    for trial in trials:
        own = sorted((j for j in trial.judgements if j.judge == judge), key=lambda j: j.repeat)
        if own:
            found.append((trial, first_verdict(own) or own[0]))
    return found
