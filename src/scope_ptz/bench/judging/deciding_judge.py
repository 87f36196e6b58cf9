"""Whose verdict is a run's where only a judge can score it, and several have judged.

One judge decides for all such runs of a log, so that no share mixes two: the one that is asked for by name, else the one that was
first with a verdict on most of them. It does not change when another judge is added.
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
    """Who judged: one model under two prompts is two judges."""
    return f"{judgement.judge} ({judgement.prompt})"


def first_verdict(judgements: Iterable[Judgement]) -> Judgement | None:
    """The first judgement that is a verdict."""
    return next((j for j in judgements if j.verdict in VERDICTS), None)


def deciding_judge(trials: Iterable[Trial], wanted: str = "") -> str | None:
    """The judge that decides on runs of a log that only a judge can score; None where none has given a verdict on any.

    ``wanted``: its name, with or without its prompt; of several prompts that which was first. As long as it has given no verdict,
    another decides.
    """
    first, further = Counter[str](), Counter[str]()
    for trial in trials:
        if trial.scored_by == "judge":
            by_judge = list(dict.fromkeys(judge_of(j) for j in trial.judgements if j.verdict in VERDICTS))
            first.update(by_judge[:1])
            further.update(by_judge)
    named = [judge for judge in further if wanted and wanted in (judge, judge.partition(" (")[0])]
    candidates = named or list(further)
    return max(candidates, key=lambda judge: (first[judge], further[judge]), default=None)


def verdict_by(judgements: Sequence[Judgement], judge: str | None = None) -> dict[str, Any]:
    """Headline, reason and error mode of a run that only a judge can score. ``judge``: the one that decides; None for whoever was
    first. A judge whose server failed takes nothing back of what it has said before."""
    own = [j for j in judgements if judge is None or judge_of(j) == judge]
    said = first_verdict(own)
    if said is not None:
        mode = (said.error_mode or ErrorMode.REASONING) if said.verdict == "incorrect" else None
        return {"headline": said.verdict, "reason": said.reason or f"said {said.judge}", "error_mode": mode}
    last = next((j for j in reversed(own) if j.verdict != "failed"), own[-1] if own else None)
    if last is not None:
        reason = f"the judge {last.judge} gave no verdict ({last.verdict})"
    elif judgements:
        reason = f"{judge} has given no verdict, and another judge does not count here"
    else:
        reason = "no judge has said anything yet, and there are no checks of this answer"
    return {"headline": "unscored", "reason": reason, "error_mode": None}


def decided_by_one_judge(trials: Sequence[Trial], wanted: str = "") -> list[Trial]:
    """The runs of a log, those that only a judge can score by the judge that decides. Its judgements stand first in each."""
    judge = deciding_judge(trials, wanted)
    if judge is None:
        return list(trials)
    return [_by(trial, judge) if trial.scored_by == "judge" else trial for trial in trials]


def _by(trial: Trial, judge: str) -> Trial:
    ordered = tuple(sorted(trial.judgements, key=lambda j: judge_of(j) != judge))
    verdict = {} if trial.headline == "infrastructure" else verdict_by(ordered, judge)
    return trial.model_copy(update={**verdict, "judgements": ordered})


def check_decides(trials: Sequence[Trial], wanted: str) -> None:
    """Raises ``InputError`` unless this judge has given a verdict on a run that only a judge can score."""
    found = deciding_judge(trials, wanted)
    if found is None or wanted not in (found, found.partition(" (")[0]):
        known = dict.fromkeys(judge_of(j) for t in trials if t.scored_by == "judge" for j in t.judgements if j.verdict in VERDICTS)
        raise InputError(
            f"'{wanted}' has given no verdict on a run that only a judge can score, so it cannot decide. "
            f"Those that have: {', '.join(known) or 'none'}."
        )


def decider_of(trials: Iterable[Trial]) -> str | None:
    """The judge whose verdicts the headlines of a log's runs are, where only a judge can score them."""
    rows = (t for t in trials if t.scored_by == "judge" and t.headline in VERDICTS)
    return next((judge_of(said) for trial in rows if (said := first_verdict(trial.judgements)) is not None), None)


def other_judges_note(trials: Sequence[Trial]) -> str:
    """What is to be said where several judges have given verdicts on runs that only a judge can score; empty where not."""
    judge = decider_of(trials)
    rows = [trial for trial in trials if trial.scored_by == "judge"]
    others = [o for o in dict.fromkeys(judge_of(j) for t in rows for j in t.judgements if j.verdict in VERDICTS) if o != judge]
    if judge is None or not others:
        return ""
    runs = f"the {len(rows)} runs that only a judge can score" if len(rows) > 1 else "the run that only a judge can score"
    return (
        f"{judge} decides on {runs}; what {', '.join(others)} said stands beside it and changes no share "
        "(another decides with: scope bench rescore LOG --decides NAME)"
    )
