"""The comparison section: paired comparisons between model pairs on shared tasks, and the smallest detectable differences."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt
from statistics import median

import numpy as np

from scope_ptz.bench.reports.report_runs import ReportRun, viewpoint
from scope_ptz.bench.reports.sections import Section
from scope_ptz.bench.reports.tables import Column, ReportTable
from scope_ptz.bench.statistics.clustered import (
    IntervalEstimate,
    Scores,
    detectable_difference,
    difference,
    macro_weights,
    two_sided_p,
)
from scope_ptz.bench.statistics.paired import cluster_bootstrap, holm, mcnemar_exact

ALPHA = 0.05
"""Significance level of all tests."""
SEED = 0
"""Seed for the bootstrap."""


@dataclass(frozen=True, slots=True)
class PairedComparison:
    """The comparison between two runs on their shared tasks.

    Attributes:
        first: Label of the first run.
        second: Label of the second run.
        shared: Number of shared tasks.
        macro: Macro accuracy of the first run minus that of the second.
        bootstrap: Bootstrap interval for the difference; None with fewer than two viewpoints.
        first_wins: Number of tasks on which the first run is better.
        second_wins: Number of tasks on which the second run is better.
        p_mcnemar: P value of McNemar's exact test.
        p_clustered: P value of the t test with clustered standard errors; None if unknown.
        smallest_detectable: The smallest true difference that the clustered test detects with 80% power; None if unknown.
    """

    first: str
    second: str
    shared: int
    macro: IntervalEstimate
    bootstrap: tuple[float, float] | None
    first_wins: int
    second_wins: int
    p_mcnemar: float
    p_clustered: float | None
    smallest_detectable: float | None


def compare(first: ReportRun, second: ReportRun) -> PairedComparison | None:
    """Compare two runs on their shared tasks; return None if there are no shared tasks."""
    return compare_scores(first.label, second.label, _task_means(first), _task_means(second))


TaskMeans = dict[str, tuple[str, str, float]]
"""The category, viewpoint and mean outcome of each task, by task id."""


def _task_means(run: ReportRun) -> TaskMeans:
    """Return the category, viewpoint and mean outcome of each task. Repeats of a task count as one observation."""
    outcomes: dict[str, list[bool]] = {}
    groups = {t.task.id: (t.task.category, viewpoint(t)) for t in run.scored_trials}
    for trial in run.scored_trials:
        outcomes.setdefault(trial.task.id, []).append(trial.headline == "correct")
    return {task: (*groups[task], sum(values) / len(values)) for task, values in outcomes.items()}


def compare_scores(first: str, second: str, first_means: TaskMeans, second_means: TaskMeans) -> PairedComparison | None:
    """Compare two runs, given their task means, on the shared tasks; return None if there are no shared tasks.

    Args:
        first: Label of the first run.
        second: Label of the second run.
        first_means: Task means of the first run.
        second_means: Task means of the second run.
    """
    shared = sorted(first_means.keys() & second_means.keys())
    if not shared:
        return None
    values = np.array([first_means[task][2] - second_means[task][2] for task in shared])
    categories, viewpoints = (tuple(first_means[task][index] for task in shared) for index in (0, 1))
    scores = Scores(values, categories, viewpoints)
    estimate = difference(scores, macro_weights(scores))
    if estimate is None:
        return None
    first_wins, second_wins = int(np.sum(values > 0)), int(np.sum(values < 0))
    least = None if not estimate.se else detectable_difference(estimate.se, estimate.clusters)
    bootstrap = cluster_bootstrap(scores, seed=SEED)
    p_mcnemar, p_clustered = mcnemar_exact(first_wins, second_wins), two_sided_p(estimate)
    return PairedComparison(first, second, len(shared), estimate, bootstrap, first_wins, second_wins, p_mcnemar, p_clustered, least)


def comparison_table(key: str, title: str, comparisons: Sequence[PairedComparison], notes: tuple[str, ...] = ()) -> ReportTable:
    """Return a table with one row per comparison. P values are adjusted for the number of comparisons in the table."""
    columns = (
        Column("first", "First"),
        Column("second", "Second"), Column("tasks", "Shared tasks", "count"),
        Column("difference", "First minus second, macro (points)", "points"), Column("bootstrap", "Bootstrap interval (points)"),
        Column("only_first", "Better: first", "count"), Column("only_second", "Better: second", "count"),
        Column("p_mcnemar", "McNemar p", "p"), Column("p_mcnemar_holm", "Holm", "p"),
        Column("p_clustered", "Clustered p", "p"), Column("p_clustered_holm", "Holm", "p"),
        Column("differ", "Differ"), Column("least", "Smallest detectable difference (points)", "width"),
    )  # fmt: skip
    mcnemar, clustered = _adjusted_p_values(comparisons)
    rows = tuple(
        (
            c.first,
            c.second, c.shared, c.macro, _interval(c.bootstrap), c.first_wins, c.second_wins,
            c.p_mcnemar, mcnemar[n], c.p_clustered, clustered[n], difference_text(mcnemar[n], clustered[n]), c.smallest_detectable,
        )
        for n, c in enumerate(comparisons)
    )  # fmt: skip
    return ReportTable(key, title, columns, rows, notes)


def are_differences_significant(comparisons: Sequence[PairedComparison]) -> list[bool]:
    """Return, for each comparison, whether its difference is significant after adjustment for the number of comparisons."""
    return [difference_text(*p_values) == "yes" for p_values in zip(*_adjusted_p_values(comparisons), strict=True)]


def _adjusted_p_values(comparisons: Sequence[PairedComparison]) -> tuple[list[float | None], list[float | None]]:
    """Return the adjusted p values of McNemar's test and of the clustered test."""
    return holm([c.p_mcnemar for c in comparisons]), holm([c.p_clustered for c in comparisons])


def difference_text(*adjusted: float | None) -> str:
    """Return "yes" if every adjusted p value is below 0.05, otherwise "not shown"."""
    return "yes" if all(p is not None and p < ALPHA for p in adjusted) else "not shown"


def _interval(bounds: tuple[float, float] | None) -> str | None:
    return None if bounds is None else f"{100 * bounds[0]:+.1f} to {100 * bounds[1]:+.1f}"


def comparison_section(runs: Sequence[ReportRun], comparisons: Sequence[PairedComparison]) -> Section:
    """Return the section that compares each pair of runs.

    Args:
        runs: The runs of the model pairs.
        comparisons: The comparisons between all pairs of runs.
    """
    text = [
        "Two runs are compared task by task on their shared tasks; repeats of a task are averaged first. McNemar's exact test "
        "checks whether one run is better on significantly more tasks than the other (with repeats it is the sign test of the "
        "tasks' means). The clustered test also accounts for the similarity of tasks at one viewpoint. P values are adjusted for "
        "the number of comparisons by Holm's method. Two runs are reported to differ only if both adjusted p values are below 0.05."
    ]
    unpaired = _unpaired_table(runs)
    if not comparisons:
        return Section(
            "comparison",
            "Differences between model pairs",
            (*text, "There are fewer than two model pairs, so this is not measured."),
            (),
            (unpaired,),
        )
    number = sum(are_differences_significant(comparisons))
    smallest = [c.smallest_detectable for c in comparisons if c.smallest_detectable is not None]
    power = (
        f" With 80% power, differences of {100 * median(smallest):.1f} points (median of the comparisons) are detectable."
        if smallest
        else ""
    )
    text.append(f"{number} of {len(comparisons)} comparisons show a difference.{power}")
    notes = (
        f"Bootstrap: percentile interval of 10,000 draws of viewpoints with replacement (seed {SEED}), as a check of the other "
        "interval. Better: number of tasks on which one run is better. Smallest detectable difference: the smallest true "
        "difference that the clustered test detects with 80% power, (t at 97.5% + t at 80%) times the standard error, before "
        "adjustment for multiple tests.",
    )
    table = comparison_table("comparisons", "Paired comparisons", comparisons, notes)
    folded = frozenset({"comparisons"}) if len(comparisons) > 12 else frozenset[str]()
    return Section("comparison", "Differences between model pairs", tuple(text), (), (table, unpaired), folded)


def _unpaired_table(runs: Sequence[ReportRun]) -> ReportTable:
    """Return a table with the smallest difference that each run can show in an unpaired comparison with an equally precise run."""
    columns = (
        Column("run", "Run"), Column("se", "Standard error of macro (points)", "width"),
        Column("viewpoints", "Viewpoints", "count"), Column("least", "Smallest detectable difference, unpaired (points)", "width"),
    )  # fmt: skip
    rows = []
    for run in runs:
        se = run.macro.se if run.macro else None
        clusters = run.macro.clusters if run.macro else 0
        rows.append((run.label, se, clusters, None if not se else detectable_difference(sqrt(2) * se, clusters)))
    notes = (
        "The smallest difference that is detected with 80% power if the other run is equally precise but covers other tasks. "
        "Paired comparisons usually detect smaller differences.",
    )
    return ReportTable("resolution", "Smallest detectable difference", columns, tuple(rows), notes)
