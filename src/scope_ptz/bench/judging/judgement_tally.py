"""Count judgements by result, and find runs that still need a judgement."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from scope_ptz.bench.judging.rubrics import prompt_version
from scope_ptz.bench.scoring.trials import Judgement, Trial

VERDICTS = ("correct", "incorrect")
"""The results of judgements that are verdicts. The other results are "unparseable" and "failed"."""
_MAX_FAILURE_CHARS = 300
"""Maximum length of a failure reason in characters."""


@dataclass(frozen=True, slots=True)
class JudgementTally:
    """The number of judgements with each result. ``failure`` is the reason for the first failure, as one line."""

    verdicts: int = 0
    unparseable: int = 0
    failed: int = 0
    failure: str = ""

    @classmethod
    def of(cls, judgements: Iterable[Judgement]) -> JudgementTally:
        """Count judgements by result."""
        rows = list(judgements)
        failed = [judgement.reason for judgement in rows if judgement.verdict == "failed"]
        return cls(
            verdicts=sum(judgement.verdict in VERDICTS for judgement in rows),
            unparseable=sum(judgement.verdict == "unparseable" for judgement in rows),
            failed=len(failed),
            failure=" ".join(failed[0].split())[:_MAX_FAILURE_CHARS] if failed else "",
        )

    def __add__(self, other: JudgementTally) -> JudgementTally:
        return JudgementTally(
            self.verdicts + other.verdicts, self.unparseable + other.unparseable, self.failed + other.failed,
            self.failure or other.failure,
        )  # fmt: skip

    @property
    def total(self) -> int:
        """Total number of judgements."""
        return self.verdicts + self.unparseable + self.failed

    @property
    def summary(self) -> str:
        """The counts as text."""
        return f"{self.verdicts} with a verdict, {self.unparseable} unparseable, {self.failed} failed"


def lacks_verdict(trial: Trial) -> bool:
    """Return whether only a judge can score a run, but no judge has given a verdict. Such runs are excluded from accuracies."""
    return trial.scored_by == "judge" and trial.headline == "unscored"


def needs_judgement(trial: Trial) -> bool:
    """Return whether a run without a verdict still needs a judgement.

    A run needs a judgement if it was not judged, if the judge's server failed, or if only judges other than the deciding one have
    judged it.
    """
    return lacks_verdict(trial) and not any(judgement.verdict == "unparseable" for judgement in trial.judgements)


def requested_judgements(trials: Iterable[Trial], judge: str, repeats: int) -> list[Judgement | None]:
    """Return the requested judgements of every run by one judge with the current prompt.

    Runs with an infrastructure failure are not judged.

    Args:
        trials: The runs.
        judge: Name of the judge.
        repeats: Number of judgements per run.

    Returns:
        One item per requested judgement; None for each judgement that is missing.
    """
    judgements: list[Judgement | None] = []
    for trial in trials:
        if trial.headline != "infrastructure":
            by_index = {j.repeat: j for j in trial.judgements if (j.judge, j.prompt) == (judge, prompt_version())}
            judgements += [by_index.get(index) for index in range(repeats)]
    return judgements


def judge_of_every_run(trials: Iterable[Trial], judge: str, repeats: int) -> str | None:
    """Return the name of a judge that has judged every run ``repeats`` times without failure; None if there is none.

    Args:
        trials: The runs.
        judge: Name of the judge to consider; empty to consider all judges.
        repeats: Number of judgements per run.
    """
    rows = list(trials)
    names = [judge] if judge else dict.fromkeys(j.judge for trial in rows for j in trial.judgements)
    return next(
        (n for n in names if all(j is not None and j.verdict != "failed" for j in requested_judgements(rows, n, repeats))), None
    )
