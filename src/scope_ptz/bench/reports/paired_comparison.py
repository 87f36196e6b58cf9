"""Differences between model pairs on the tasks that both did, and what could have been seen at all."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from math import sqrt
from statistics import median

import numpy as np

from scope_ptz.bench.reports.report_runs import ReportRun, viewpoint
from scope_ptz.bench.reports.sections import Section
from scope_ptz.bench.reports.tables import Column, ReportTable
from scope_ptz.bench.statistics.clustered import IntervalEstimate, Scores, detectable, difference, macro_weights, two_sided_p
from scope_ptz.bench.statistics.paired import cluster_bootstrap, holm, mcnemar_exact

ALPHA = 0.05
SEED = 0


@dataclass(frozen=True, slots=True)
class PairedComparison:
    """``macro``: first minus second over shared tasks; ``bootstrap``: the same by drawing viewpoints; ``least``: smallest
    difference found with 80% power."""

    first: str
    second: str
    shared: int
    macro: IntervalEstimate
    bootstrap: tuple[float, float] | None
    only_first: int
    only_second: int
    p_mcnemar: float
    p_clustered: float | None
    least: float | None


def compare(first: ReportRun, second: ReportRun) -> PairedComparison | None:
    """Compare two runs of one dataset over the tasks that both did; None when there are none."""
    return compare_scores(first.label, second.label, _task_means(first), _task_means(second))


TaskMeans = dict[str, tuple[str, str, float]]


def _task_means(run: ReportRun) -> TaskMeans:
    """Category, viewpoint and mean outcome by task: repeats of a task are one observation."""
    found: dict[str, list[bool]] = {}
    about = {t.task.id: (t.task.category, viewpoint(t)) for t in run.scored_trials}
    for trial in run.scored_trials:
        found.setdefault(trial.task.id, []).append(trial.headline == "correct")
    return {task: (*about[task], sum(values) / len(values)) for task, values in found.items()}


def compare_scores(first: str, second: str, one: TaskMeans, other: TaskMeans) -> PairedComparison | None:
    """The same for outcomes by task, given as category, viewpoint and mean outcome."""
    shared = sorted(one.keys() & other.keys())
    if not shared:
        return None
    values = np.array([one[task][2] - other[task][2] for task in shared])
    scores = Scores(values, tuple(one[task][0] for task in shared), tuple(one[task][1] for task in shared))
    found = difference(scores, macro_weights(scores))
    if found is None:
        return None
    better, worse = int(np.sum(values > 0)), int(np.sum(values < 0))
    least = None if not found.se else detectable(found.se, found.clusters)
    drawn = cluster_bootstrap(scores, seed=SEED)
    p_mcnemar, p_clustered = mcnemar_exact(better, worse), two_sided_p(found)
    return PairedComparison(first, second, len(shared), found, drawn, better, worse, p_mcnemar, p_clustered, least)


def comparison_table(key: str, title: str, found: Sequence[PairedComparison], notes: tuple[str, ...] = ()) -> ReportTable:
    """A row a comparison, p values adjusted among all of them."""
    columns = (
        Column("first", "First"),
        Column("second", "Second"), Column("tasks", "Shared tasks", "count"),
        Column("difference", "First minus second, macro (points)", "points"), Column("bootstrap", "Bootstrap interval (points)"),
        Column("only_first", "Better: first", "count"), Column("only_second", "Better: second", "count"),
        Column("p_mcnemar", "McNemar p", "p"), Column("p_mcnemar_holm", "Holm", "p"),
        Column("p_clustered", "Clustered p", "p"), Column("p_clustered_holm", "Holm", "p"),
        Column("differ", "Differ"), Column("least", "Least that could be seen (points)", "width"),
    )  # fmt: skip
    mcnemar, clustered = holm([c.p_mcnemar for c in found]), holm([c.p_clustered for c in found])
    rows = tuple(
        (
            c.first,
            c.second, c.shared, c.macro, _interval(c.bootstrap), c.only_first, c.only_second,
            c.p_mcnemar, mcnemar[n], c.p_clustered, clustered[n], differ(mcnemar[n], clustered[n]), c.least,
        )
        for n, c in enumerate(found)
    )  # fmt: skip
    return ReportTable(key, title, columns, rows, notes)


def differ(*adjusted: float | None) -> str:
    """Two runs are said to differ only when every test says so after adjustment."""
    return "yes" if all(p is not None and p < ALPHA for p in adjusted) else "not shown"


def _interval(bounds: tuple[float, float] | None) -> str | None:
    return None if bounds is None else f"{100 * bounds[0]:+.1f} to {100 * bounds[1]:+.1f}"


def comparison_section(runs: Sequence[ReportRun]) -> Section:
    """Every two ranked runs of the main task set."""
    found = [c for one, two in combinations(runs, 2) if (c := compare(one, two)) is not None]
    text = [
        "Two runs are compared on the tasks that both did, task by task; repeats of a task are averaged first. McNemar's "
        "exact test asks "
        "whether the tasks on which they differ favour one side (with repeats it is the sign test of the tasks' means). The "
        "clustered "
        "test also allows for tasks of a viewpoint being alike. P values are adjusted by Holm's method for the number of "
        "comparisons, "
        "and two runs are said to differ only when both adjusted p values are below 0.05."
    ]
    single = _resolution(runs)
    if not found:
        return Section(
            "comparison", "Differences between model pairs", (*text, "Fewer than two model pairs: not measured."), (), (single,)
        )
    number = sum(row[11] == "yes" for row in comparison_table("x", "x", found).rows)
    seen = [c.least for c in found if c.least is not None]
    resolved = (
        f" At 80% power, differences of {100 * median(seen):.1f} points (median of the comparisons) could be seen." if seen else ""
    )
    text.append(f"{number} of {len(found)} comparisons show a difference.{resolved}")
    notes = (
        f"Bootstrap: 10,000 draws of viewpoints with replacement, percentile interval, seed {SEED}; a cross-check of the "
        "interval beside "
        "it. Better: tasks that one of the two did better. Least that could be seen: the true difference that the clustered "
        "test finds with "
        "80% power, (t at 97.5% + t at 80%) times the standard error, before adjustment for many tests.",
    )
    table = comparison_table("comparisons", "Paired comparisons", found, notes)
    folded = frozenset({"comparisons"}) if len(found) > 12 else frozenset[str]()
    return Section("comparison", "Differences between model pairs", tuple(text), (), (table, single), folded)


def _resolution(runs: Sequence[ReportRun]) -> ReportTable:
    """What an unpaired comparison with a run of the same precision could see."""
    columns = (
        Column("run", "Run"), Column("se", "Standard error of macro (points)", "width"),
        Column("viewpoints", "Viewpoints", "count"), Column("least", "Least that could be seen, unpaired (points)", "width"),
    )  # fmt: skip
    rows = []
    for run in runs:
        found = run.macro
        se = found.se if found else None
        clusters = found.clusters if found else 0
        rows.append((run.label, se, clusters, None if not se else detectable(sqrt(2) * se, clusters)))
    notes = (
        "The difference to another run of the same precision over other tasks that would be found with 80% power. Pairing by task "
        "usually sees smaller ones.",
    )
    return ReportTable("resolution", "Smallest difference that could be seen", columns, tuple(rows), notes)
