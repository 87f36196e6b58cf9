"""Select the deciding judge, whose verdicts count for the runs that only a judge can score.

A single judge decides all these runs of a log, so that verdicts from different judges are never averaged. The deciding judge is the
requested one, if it has given a verdict on one of these runs. Otherwise it is the judge that gave the first verdict on most of the
runs. Later judgements by other judges do not change the selection.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from typing import Any

from scope_ptz.bench.judging.judgement_tally import VERDICTS
from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.bench.scoring.trials import Judgement, Trial
from scope_ptz.errors import InputError


def judge_of(judgement: Judgement) -> str:
    """Return the name of a judgement's judge. A model with two prompts counts as two judges."""
    return f"{judgement.judge} ({judgement.prompt})"


def first_verdict(judgements: Iterable[Judgement]) -> Judgement | None:
    """Return the first judgement with a verdict."""
    return next((j for j in judgements if j.verdict in VERDICTS), None)


def deciding_judge(trials: Iterable[Trial], requested: str = "") -> str | None:
    """Return the judge whose verdicts count for the runs of a log that only a judge can score.

    Args:
        trials: The trials of the log.
        requested: Name of the requested judge, with or without its prompt. If it has given no verdict, another judge decides.

    Returns:
        The name of the judge, or None if no judge has given a verdict on such a run.
    """
    first_verdicts, verdicts = Counter[str](), Counter[str]()
    for trial in trials:
        if trial.scored_by == "judge":
            by_judge = list(dict.fromkeys(judge_of(j) for j in trial.judgements if j.verdict in VERDICTS))
            first_verdicts.update(by_judge[:1])
            verdicts.update(by_judge)
    matches = [judge for judge in verdicts if requested and requested in (judge, judge.partition(" (")[0])]
    candidates = matches or list(verdicts)
    return max(candidates, key=lambda judge: (first_verdicts[judge], verdicts[judge]), default=None)


def verdict_by(judgements: Sequence[Judgement], judge: str | None = None) -> dict[str, Any]:
    """Return the headline, reason and error mode of a run that only a judge can score.

    The first verdict counts, even if a later judgement by the same judge failed.

    Args:
        judgements: The judgements of the run.
        judge: The deciding judge; None for the judge that gave the first verdict.
    """
    relevant = [j for j in judgements if judge is None or judge_of(j) == judge]
    verdict = first_verdict(relevant)
    if verdict is not None:
        mode = (verdict.error_mode or ErrorMode.REASONING) if verdict.verdict == "incorrect" else None
        return {"headline": verdict.verdict, "reason": verdict.reason or f"verdict of {verdict.judge}", "error_mode": mode}
    last = next((j for j in reversed(relevant) if j.verdict != "failed"), relevant[-1] if relevant else None)
    if last is not None:
        reason = f"the judge {last.judge} gave no verdict ({last.verdict})"
    elif judgements:
        reason = f"the deciding judge {judge} has given no verdict on this run"
    else:
        reason = "no judge has given a verdict yet, and no check can score this answer"
    return {"headline": "unscored", "reason": reason, "error_mode": None}


def with_deciding_verdicts(trials: Sequence[Trial], requested: str = "") -> list[Trial]:
    """Return the trials of a log, with the verdicts of the deciding judge on the runs that only a judge can score.

    In the trials of these runs, the judgements by the deciding judge come first.
    """
    judge = deciding_judge(trials, requested)
    if judge is None:
        return list(trials)
    return [_with_verdict_by(trial, judge) if trial.scored_by == "judge" else trial for trial in trials]


def _with_verdict_by(trial: Trial, judge: str) -> Trial:
    ordered = tuple(sorted(trial.judgements, key=lambda j: judge_of(j) != judge))
    verdict = {} if trial.headline == "infrastructure" else verdict_by(ordered, judge)
    return trial.model_copy(update={**verdict, "judgements": ordered})


def check_can_decide(trials: Sequence[Trial], requested: str) -> None:
    """Check that a requested judge can be the deciding judge.

    Raises:
        InputError: The judge has given no verdict on a run that only a judge can score.
    """
    judge = deciding_judge(trials, requested)
    if judge is None or requested not in (judge, judge.partition(" (")[0]):
        judges = dict.fromkeys(judge_of(j) for t in trials if t.scored_by == "judge" for j in t.judgements if j.verdict in VERDICTS)
        raise InputError(
            f"'{requested}' has given no verdict on a run that only a judge can score, so it cannot decide. "
            f"Judges with such verdicts: {', '.join(judges) or 'none'}."
        )


def reported_judge(trials: Iterable[Trial]) -> str | None:
    """Return the judge whose verdicts are reported for the runs that only a judge can score."""
    rows = (t for t in trials if t.scored_by == "judge" and t.headline in VERDICTS)
    return next((judge_of(first) for trial in rows if (first := first_verdict(trial.judgements)) is not None), None)


def other_judges_note(trials: Sequence[Trial]) -> str:
    """Return a note about the judges other than the deciding judge; empty if there are none."""
    judge = reported_judge(trials)
    rows = [trial for trial in trials if trial.scored_by == "judge"]
    others = [o for o in dict.fromkeys(judge_of(j) for t in rows for j in t.judgements if j.verdict in VERDICTS) if o != judge]
    if judge is None or not others:
        return ""
    runs = f"the {len(rows)} runs that only a judge can score" if len(rows) > 1 else "the run that only a judge can score"
    return (
        f"{judge} decides on {runs}; the verdicts of {', '.join(others)} do not affect the accuracy "
        "(to select another judge, run scope bench rescore LOG --decides NAME)"
    )
