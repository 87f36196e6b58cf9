"""Ties between runs: equal accuracy, and differences that the paired comparisons do not show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

from scope_ptz.bench.reports.paired_comparison import PairedComparison, compare, shown_differences
from scope_ptz.bench.reports.report_runs import ReportRun

ROUNDING = 1e-9
"""Values that differ by less than this are equal."""
MAX_NAMED = 4
"""Maximum number of tied runs that a sentence names."""


@dataclass(frozen=True, slots=True)
class Distinctions:
    """The paired comparisons of a set of runs, and the pairs of runs that they tell apart.

    P values are adjusted for all comparisons of the set, because the runs with the extreme values are chosen after the fact.

    Attributes:
        comparisons: The comparisons.
        different: The labels of the runs of each comparison that shows a difference.
    """

    comparisons: tuple[PairedComparison, ...]
    different: frozenset[frozenset[str]]

    def told_apart(self, one: ReportRun, other: ReportRun) -> bool:
        """Return whether the comparison of two runs shows a difference."""
        return frozenset({one.label, other.label}) in self.different


def distinguish(runs: Sequence[ReportRun]) -> Distinctions:
    """Compare each run with each other run on their shared tasks."""
    comparisons = [c for one, two in combinations(runs, 2) if (c := compare(one, two)) is not None]
    shown = shown_differences(comparisons)
    different = frozenset(frozenset({c.first, c.second}) for c, is_shown in zip(comparisons, shown, strict=True) if is_shown)
    return Distinctions(tuple(comparisons), different)


@dataclass(frozen=True, slots=True)
class Leaders:
    """The runs with the highest macro accuracy, and the runs that are not told apart from them.

    Attributes:
        highest: The runs with the highest macro accuracy. There are several if their values are equal.
        close: Other runs that are not told apart from at least one of the highest.
        others: All remaining runs, each of which is told apart from all the highest.
    """

    highest: tuple[ReportRun, ...]
    close: tuple[ReportRun, ...]
    others: tuple[ReportRun, ...]

    def standing(self, run: ReportRun) -> str:
        """Describe how a run compares with the highest accuracy."""
        if run in self.highest:
            return "equal highest" if len(self.highest) > 1 else "highest"
        return "not told apart" if run in self.close else "lower"


def leaders(runs: Sequence[ReportRun], distinctions: Distinctions) -> Leaders | None:
    """Return the leaders among runs over the same tasks; None if no run has an accuracy."""
    order = sorted((run for run in runs if run.macro), key=lambda run: -_value(run))
    if not order:
        return None
    highest = tuple(run for run in order if _value(run) > _value(order[0]) - ROUNDING)
    below = order[len(highest) :]
    close = tuple(run for run in below if not all(distinctions.told_apart(run, best) for best in highest))
    return Leaders(highest, close, tuple(run for run in below if run not in close))


def _value(run: ReportRun) -> float:
    return run.macro.value if run.macro else 0.0


def listed(names: Sequence[str], max_named: int = MAX_NAMED) -> str:
    """Join names with commas and "and". Names beyond ``max_named`` are only counted."""
    if len(names) > max_named:
        return f"{', '.join(names[: max_named - 1])} and {len(names) - max_named + 1} more"
    return " and ".join(filter(None, (", ".join(names[:-1]), names[-1]))) if names else ""


def extremes(values: Sequence[tuple[float, str]]) -> tuple[str, str]:
    """Return the names of the lowest and of the highest value. Names with equal values are joined.

    Args:
        values: The values with their names; at least one.
    """
    low, high = min(values)[0], max(values)[0]
    return (
        ", ".join(sorted(name for value, name in values if value < low + ROUNDING)),
        ", ".join(sorted(name for value, name in values if value > high - ROUNDING)),
    )
