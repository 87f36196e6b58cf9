"""Compare the intervals of a report on simulated runs with the known strengths."""

from __future__ import annotations

from statistics import fmean

from scope_ptz.bench.reports.assemble import EvaluationReport
from scope_ptz.bench.reports.report_runs import CATEGORY_TITLES
from scope_ptz.bench.reports.tables import cell_value
from scope_ptz.bench.statistics.clustered import IntervalEstimate
from tests.bench.reports.simulated.strengths import Pair, paper_pairs


def interval_coverage(report: EvaluationReport) -> dict[str, tuple[int, int]]:
    """Return, for each quantity, the number of intervals that contain the known value and the number of all intervals."""
    counts: dict[str, list[bool]] = {}
    for pair in paper_pairs():
        accuracy = cells(report, "accuracy", pair)
        counts.setdefault("macro accuracy", []).append(contains(accuracy["macro"], pair.macro))
        inside = [contains(accuracy[name], pair.accuracy[name]) for name in CATEGORY_TITLES]
        counts.setdefault("accuracy by category", []).extend(inside)
        oracle = fmean(pair.corrected(name) for name in CATEGORY_TITLES)
        counts.setdefault("oracle setting", []).append(contains(cells(report, "oracle", pair)["oracle_rules"], oracle))
    return {quantity: (sum(values), len(values)) for quantity, values in counts.items()}


def cells(report: EvaluationReport, key: str, pair: Pair) -> dict[str, object]:
    """Return the cells of a pair's row in a table, by column name."""
    table = next(t for t in report.tables if t.key == key)
    row = next(r for r in table.rows if cell_value(r[0]) == pair.label)
    return {column.name: cell_value(value) for column, value in zip(table.columns, row, strict=True)}


def contains(estimate: object, value: float) -> bool:
    """Return whether an estimate's interval contains a value."""
    assert isinstance(estimate, IntervalEstimate) and estimate.low is not None and estimate.high is not None
    return estimate.low <= value <= estimate.high
