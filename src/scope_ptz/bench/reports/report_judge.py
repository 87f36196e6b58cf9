"""Select the judge whose verdicts are shown in a report."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from scope_ptz.bench.judging.deciding_judge import first_verdict
from scope_ptz.bench.judging.judgement_tally import VERDICTS
from scope_ptz.bench.reports.report_runs import ReportRun
from scope_ptz.bench.scoring.trials import Judgement, Trial


def select_judge(runs: Sequence[ReportRun]) -> str | None:
    """Select the judge whose verdicts are shown in a report; return None if no run was judged.

    This is the judge that decides the largest number of the trials that only a judge can score. Ties are resolved by the number of
    trials on which the judge gave a verdict, then by the number of trials that it judged, then by name. A judge without verdicts is
    selected only if no judge has given a verdict.
    """
    deciding, with_verdict, judged = Counter[str](), Counter[str](), Counter[str]()
    for trial in (trial for run in runs for trial in run.scored_trials):
        first = first_verdict(trial.judgements)  # The deciding judge comes first in a log.
        if trial.scored_by == "judge" and first is not None:
            deciding[first.judge] += 1
        with_verdict.update({j.judge for j in trial.judgements if j.verdict in VERDICTS})
        judged.update({j.judge for j in trial.judgements})
    return min(judged, key=lambda name: (-deciding[name], -with_verdict[name], -judged[name], name), default=None)


def trials_judged_by(trials: Sequence[Trial], judge: str) -> list[tuple[Trial, Judgement]]:
    """Return the trials that a judge has judged, each with a single judgement.

    This is the first judgement with a verdict or, if there is none, the first judgement.
    """
    rows = []
    for trial in trials:
        judgements = sorted((j for j in trial.judgements if j.judge == judge), key=lambda j: j.repeat)
        if judgements:
            rows.append((trial, first_verdict(judgements) or judgements[0]))
    return rows
