"""Select the judge whose verdicts a report shows."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from scope_ptz.bench.judging.deciding_judge import first_verdict
from scope_ptz.bench.judging.judgement_tally import VERDICTS
from scope_ptz.bench.reports.report_runs import ReportRun
from scope_ptz.bench.scoring.trials import Judgement, Trial


def judge_name(runs: Sequence[ReportRun]) -> str | None:
    """Return the judge whose verdicts a report shows; None if no run was judged.

    This is the judge that decides the largest number of the trials that only a judge can score. Ties, and reports without such
    trials, are resolved by the number of trials with a verdict by the judge, then by the number of trials that it judged, then by
    name. A judge without any verdict is selected only if no judge has given a verdict.
    """
    deciding, with_verdict, judged = Counter[str](), Counter[str](), Counter[str]()
    for trial in (trial for run in runs for trial in run.scored_trials):
        first = first_verdict(trial.judgements)  # The deciding judge comes first in a log.
        if trial.scored_by == "judge" and first is not None:
            deciding[first.judge] += 1
        with_verdict.update({j.judge for j in trial.judgements if j.verdict in VERDICTS})
        judged.update({j.judge for j in trial.judgements})
    return min(judged, key=lambda name: (-deciding[name], -with_verdict[name], -judged[name], name), default=None)


def verdicts(trials: Sequence[Trial], judge: str) -> list[tuple[Trial, Judgement]]:
    """Return the trials that a judge judged, each with one judgement.

    This is the first judgement with a verdict. If no judgement has a verdict, it is the first judgement.
    """
    rows = []
    for trial in trials:
        judgements = sorted((j for j in trial.judgements if j.judge == judge), key=lambda j: j.repeat)
        if judgements:
            rows.append((trial, first_verdict(judgements) or judgements[0]))
    return rows
