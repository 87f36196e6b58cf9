"""Find ties between runs: equal accuracy, or a difference that is not significant in the paired comparisons."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

from scope_ptz.bench.reports.paired_comparison import PairedComparison, are_differences_significant, compare
from scope_ptz.bench.reports.report_runs import ReportRun

ROUNDING = 1e-9
"""Values that differ by less than this are considered equal."""
MAX_NAMED = 4
"""Maximum number of tied runs that a sentence names."""


@dataclass(frozen=True, slots=True)
class Distinctions:
    """The paired comparisons between runs, and the pairs of runs that differ significantly.

    P values are adjusted for all comparisons, because the runs with extreme values are selected after the fact.

    Attributes:
        comparisons: The comparisons.
        distinct_labels: The labels of the two runs in each comparison with a significant difference.
    """

    comparisons: tuple[PairedComparison, ...]
    distinct_labels: frozenset[frozenset[str]]

    def are_distinct(self, first: ReportRun, second: ReportRun) -> bool:
        """Return whether two runs differ significantly."""
        return frozenset({first.label, second.label}) in self.distinct_labels


def compare_all(runs: Sequence[ReportRun]) -> Distinctions:
    """Compare every pair of runs on their shared tasks."""
    comparisons = [c for first, two in combinations(runs, 2) if (c := compare(first, two)) is not None]
    significant = are_differences_significant(comparisons)
    labels = frozenset(frozenset({c.first, c.second}) for c, differs in zip(comparisons, significant, strict=True) if differs)
    return Distinctions(tuple(comparisons), labels)


@dataclass(frozen=True, slots=True)
class Leaders:
    """The runs with the highest macro accuracy, and the runs that are not distinguishable from them.

    Attributes:
        highest: The runs with the highest macro accuracy. There are several if their accuracies are equal.
        close: Other runs that are not distinguishable from at least one run in ``highest``.
        others: The remaining runs, which are distinguishable from all runs in ``highest``.
    """

    highest: tuple[ReportRun, ...]
    close: tuple[ReportRun, ...]
    others: tuple[ReportRun, ...]

    def standing(self, run: ReportRun) -> str:
        """Describe how a run compares with the highest accuracy."""
        if run in self.highest:
            return "equal highest" if len(self.highest) > 1 else "highest"
        return "not distinguishable" if run in self.close else "lower"


def find_leaders(runs: Sequence[ReportRun], distinctions: Distinctions) -> Leaders | None:
    """Find the leaders among runs on the same tasks. Return None if no run has an accuracy."""
    order = sorted((run for run in runs if run.macro), key=lambda run: -_value(run))
    if not order:
        return None
    highest = tuple(run for run in order if _value(run) > _value(order[0]) - ROUNDING)
    below = order[len(highest) :]
    close = tuple(run for run in below if not all(distinctions.are_distinct(run, best) for best in highest))
    return Leaders(highest, close, tuple(run for run in below if run not in close))


def _value(run: ReportRun) -> float:
    return run.macro.value if run.macro else 0.0


def join_names(names: Sequence[str], max_named: int = MAX_NAMED) -> str:
    """Join names with commas and "and". If there are more than ``max_named``, the rest are only counted."""
    if len(names) > max_named:
        return f"{', '.join(names[: max_named - 1])} and {len(names) - max_named + 1} more"
    return " and ".join(filter(None, (", ".join(names[:-1]), names[-1]))) if names else ""


def extreme_names(values: Sequence[tuple[float, str]]) -> tuple[str, str]:
    """Return the names of the lowest and the highest value. Names with equal values are joined.

    Args:
        values: The values with their names. There must be at least one.
    """
    low, high = min(values)[0], max(values)[0]
    return (
        ", ".join(sorted(name for value, name in values if value < low + ROUNDING)),
        ", ".join(sorted(name for value, name in values if value > high - ROUNDING)),
    )
