"""Measure the agreement between raters.

The raters are the executable checks, the judges (each repeat is a separate rater) and people. The known verdicts on gold runs count
as another rater.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import combinations
from typing import Any, Literal

from scope_ptz.bench.judging.kappa import KappaResult, cohen_agreement, fleiss_agreement
from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.bench.scoring.trials import Evaluation, Judgement, Trial

CORRECT, INCORRECT = "correct", "incorrect"
RaterKind = Literal["checks", "judge", "person", "gold"]


@dataclass(frozen=True, slots=True)
class Rating:
    """A rater's verdict on a run. ``mode`` is the error mode of an incorrect run; None if the rater did not assign one."""

    correct: bool
    mode: ErrorMode | None = None

    @property
    def verdict(self) -> str:
        """The rating as a verdict: "correct" or "incorrect"."""
        return CORRECT if self.correct else INCORRECT


@dataclass(frozen=True, slots=True)
class RatedRun:
    """The key of a rated run. ``cluster`` is the task, because runs of the same task are not independent."""

    log: str
    sample: str
    cluster: Hashable


@dataclass
class Rater:
    """A rater and its ratings.

    Attributes:
        name: Name of the rater.
        kind: Whether the rater is the checks, a judge, a person or the gold verdict.
        group: Name of the rater's group. The repeats of a judge form a group.
        ratings: The ratings by run.
        other_verdicts: Number of runs with a verdict that is not a rating ("unscored", "failed", ...), by verdict.
    """

    name: str
    kind: RaterKind
    group: str
    ratings: dict[RatedRun, Rating] = field(default_factory=dict)
    other_verdicts: Counter[str] = field(default_factory=Counter)


@dataclass(frozen=True)
class RaterPair:
    """The agreement between two raters on the runs that both rated.

    ``modes`` is their agreement on the error modes of the runs to which both assigned one.
    """

    first: str
    second: str
    verdicts: KappaResult
    modes: KappaResult


@dataclass(frozen=True)
class RaterGroup:
    """The agreement within a group of raters on the runs that all of them rated.

    ``title`` describes the group, such as "people". ``partly_rated`` is the number of runs that only some of the raters rated.
    """

    raters: tuple[str, ...]
    title: str
    verdicts: KappaResult
    partly_rated: int


@dataclass(frozen=True)
class AgreementReport:
    """The agreement between all raters, in pairs and in groups."""

    raters: tuple[Rater, ...]
    pairs: tuple[RaterPair, ...]
    groups: tuple[RaterGroup, ...]

    def as_dict(self) -> dict[str, Any]:
        """Return the report as JSON data."""
        return {
            "raters": [
                {
                    "name": rater.name,
                    "kind": rater.kind,
                    "rated": len(rater.ratings),
                    "correct": sum(rating.correct for rating in rater.ratings.values()),
                    "apart": dict(rater.other_verdicts),
                }
                for rater in self.raters
            ],
            "pairs": [
                {"first": p.first, "second": p.second, "verdicts": p.verdicts.as_dict(), "modes": p.modes.as_dict()}
                for p in self.pairs
            ],
            "groups": [
                {"raters": list(g.raters), "what": g.title, "left_out": g.partly_rated, **g.verdicts.as_dict()} for g in self.groups
            ],
        }


def measure_agreement(raters: Sequence[Rater], seed: int = 1) -> AgreementReport:
    """Measure the agreement between raters, in pairs and in groups.

    Only the first repeat of a judge is compared with other raters. All repeats of a judge are compared with each other.

    Args:
        raters: The raters.
        seed: Seed for the bootstrap intervals.
    """
    first_of_group = {rater.group: rater for rater in reversed(raters)}
    first_raters = [rater for rater in raters if first_of_group[rater.group] is rater]
    repeats: dict[str, list[Rater]] = {}
    for rater in raters:
        repeats.setdefault(rater.group, []).append(rater)
    pairs = [_pair(first, second, seed) for first, second in combinations(first_raters, 2)]
    pairs += [_pair(first, second, seed) for group in repeats.values() for first, second in combinations(group, 2)]
    groups = [_group(group, f"repeats of {group[0].name}", seed) for group in repeats.values() if len(group) > 1]
    for kind, title in (("judge", "judges"), ("person", "people")):
        same_kind = [rater for rater in first_raters if rater.kind == kind]
        if len(same_kind) > 1:
            groups.append(_group(same_kind, title, seed))
    return AgreementReport(tuple(raters), tuple(p for p in pairs if p.verdicts.runs), tuple(g for g in groups if g.verdicts.runs))


def _pair(first: Rater, second: Rater, seed: int) -> RaterPair:
    shared = [item for item in first.ratings if item in second.ratings]
    both = [(item, first.ratings[item], second.ratings[item]) for item in shared]
    with_modes = [(item, a.mode.value, b.mode.value) for item, a, b in both if a.mode is not None and b.mode is not None]
    return RaterPair(
        first.name,
        second.name,
        cohen_agreement(
            [a.verdict for _, a, _ in both], [b.verdict for _, _, b in both], [item.cluster for item, _, _ in both], seed
        ),
        cohen_agreement(
            [a for _, a, _ in with_modes], [b for _, _, b in with_modes], [item.cluster for item, _, _ in with_modes], seed
        ),
    )


def _group(raters: Sequence[Rater], title: str, seed: int) -> RaterGroup:
    rated_by_any = {item for rater in raters for item in rater.ratings}
    shared = [item for item in raters[0].ratings if all(item in rater.ratings for rater in raters)]
    rows = [[rater.ratings[item].verdict for rater in raters] for item in shared]
    agreement = fleiss_agreement(rows, [item.cluster for item in shared], seed)
    return RaterGroup(tuple(rater.name for rater in raters), title, agreement, len(rated_by_any) - len(shared))


def collect_raters(evaluations: Iterable[Evaluation]) -> list[Rater]:
    """Collect the raters of evaluations: the checks first, then judges, people and gold verdicts."""
    collector = _RaterCollector()
    for evaluation in evaluations:
        for trial in evaluation.trials:
            collector.add(trial, evaluation.log or evaluation.card.run_id)
    order = {"checks": 0, "judge": 1, "person": 2, "gold": 3}
    return sorted(collector.raters.values(), key=lambda rater: (order[rater.kind], rater.group, rater.name))


class _RaterCollector:
    """Collects the ratings of trials by rater."""

    def __init__(self) -> None:
        self.raters: dict[str, Rater] = {}

    def add(self, trial: Trial, log: str) -> None:
        """Add the ratings of one trial."""
        item = RatedRun(log, trial.sample, trial.task.paraphrase_of or trial.task.id)
        if trial.scored_by == "checks":
            self._rate("the checks", "checks", "the checks", item, trial.headline, trial.error_mode)
        for name, group, judgement in judgements_with_raters(trial.judgements):
            self._rate(name, "judge", group, item, judgement.verdict, judgement.error_mode)
        for label in trial.labels:
            self._rate(label.by, "person", label.by, item, label.verdict, label.error_mode)

    def _rate(self, name: str, kind: RaterKind, group: str, item: RatedRun, verdict: str, mode: ErrorMode | None) -> None:
        rater = self.raters.setdefault(f"{kind}:{name}", Rater(name, kind, f"{kind}:{group}"))
        add_rating(rater, item, verdict, mode)


def add_rating(rater: Rater, item: RatedRun, verdict: str, mode: ErrorMode | None) -> None:
    """Add a verdict to a rater. Verdicts other than "correct" and "incorrect" are only counted."""
    if verdict in (CORRECT, INCORRECT):
        rater.ratings[item] = Rating(verdict == CORRECT, mode)
    else:
        rater.other_verdicts[verdict] += 1


def judgements_with_raters(judgements: Sequence[Judgement]) -> Iterator[tuple[str, str, Judgement]]:
    """Yield the judgements of a run with the names of their raters. A model with two prompts counts as two judges.

    Yields:
        The name of the rater, such as "gpt-oss-120b (judge-1) #2" for the second judgement; the name of the judge; the judgement.
    """
    times = Counter[str]()
    for judgement in judgements:
        group = f"{judgement.judge} ({judgement.prompt})"
        times[group] += 1
        yield (group if times[group] == 1 else f"{group} #{times[group]}"), group, judgement
