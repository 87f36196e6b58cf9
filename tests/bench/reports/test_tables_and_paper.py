"""Cells as text, in CSV and in Markdown, and the results copied from the paper."""

from __future__ import annotations

import csv
import io
from dataclasses import replace

import pytest

from scope_ptz.bench.reports.details.paper import load_paper
from scope_ptz.bench.reports.tables import Column, MarkedCell, ReportTable, cell_text, csv_text, escape, markdown_text
from scope_ptz.bench.statistics.clustered import IntervalEstimate
from scope_ptz.registry import load_registry

INTERVAL = IntervalEstimate(0.7383, 0.7, 0.8, 0.02, 100, 12)


@pytest.mark.parametrize(
    ("value", "kind", "text"),
    [
        (0.7383, "share", "73.8"), (INTERVAL, "share", "73.8 (70.0 to 80.0)"), (-0.0481, "points", "-4.8"),
        (0.02, "points", "+2.0"),
        (0.02, "width", "2.0"), (0.0, "count", "0"), (None, "count", "not measured"), (0.0004, "p", "< 0.001"),
        (1.234, "ratio", "1.23x"), (12345, "count", "12,345"), (0.0123, "seconds", "0.01"), (0.0012, "seconds", "< 0.01"),
            (9.184, "seconds", "9.18"),
        (0.00213, "usd", "0.0021"), ("", "text", ""), (MarkedCell(None), "share", "not measured"),
        (IntervalEstimate(0.5, None, None, None, 2, 1), "share", "50.0 (interval unknown)"),
        (replace(INTERVAL, single_cluster_strata=("single_call", "ocr")), "share", "73.8 (70.0 to 80.0, without single call, ocr)"),
    ],
)  # fmt: skip
def test_cells_as_text(value: object, kind: object, text: str) -> None:
    assert cell_text(value, kind) == text  # type: ignore[arg-type]


def small_table(text: str = "a") -> ReportTable:
    columns = (Column("run", "Run"), Column("macro", "Macro (%)", "share"), Column("cost", "Cost", "usd"))
    return ReportTable(
        "key", "A | title", columns, ((text, INTERVAL, None), ("b", MarkedCell(0.5, best=True), 1.5)), ("Note.",), {0: "group"}
    )


def test_csv_has_full_precision_and_empty_fields_for_missing_values() -> None:
    rows = list(csv.DictReader(io.StringIO(csv_text(small_table()))))
    assert rows[0] == {"group": "group", "run": "a", "macro": "0.7383", "macro_low": "0.7", "macro_high": "0.8", "cost": ""}
    assert rows[1] == {"group": "group", "run": "b", "macro": "0.5", "macro_low": "", "macro_high": "", "cost": "1.5"}


def test_strata_missing_from_an_interval_are_named_in_csv() -> None:
    columns = (Column("run", "Run"), Column("macro", "Macro (%)", "share"))
    narrow = replace(INTERVAL, single_cluster_strata=("single_call", "ocr"))
    rows = list(
        csv.DictReader(io.StringIO(csv_text(ReportTable("key", "T", columns, (("a", narrow), ("b", INTERVAL), ("c", None))))))
    )
    assert [row["macro_without"] for row in rows] == ["single_call ocr", "", ""]
    assert (rows[0]["macro"], rows[0]["macro_low"], rows[2]["macro_high"]) == ("0.7383", "0.7", "")


@pytest.mark.parametrize("text", ["=HYPERLINK(1)", "+1", "-1+cmd", "@SUM(A1)", "\t=1"])
def test_text_is_never_a_formula_in_a_spreadsheet(text: str) -> None:
    (row, _) = csv.DictReader(io.StringIO(csv_text(small_table(text))))
    assert row["run"] == f"'{text}"


def test_markdown_characters_are_escaped() -> None:
    text = markdown_text(small_table("<img src=x onerror=alert(1)> [link](http://x) | `code` **b**\n# h"))
    line = next(row for row in text.splitlines() if "img" in row)
    assert "<img" not in line and "](" not in line and line.replace("\\|", "").count("|") == 4
    assert "**50.0**" in text and "not measured" in text and "73.8 (70.0 to 80.0)" in text.replace("\\", "")
    assert escape("plain words 12.5") == "plain words 12.5"


def test_a_row_of_the_wrong_length_is_refused() -> None:
    with pytest.raises(ValueError, match="must have 1 values; got 2"):
        ReportTable("key", "Title", (Column("a", "A"),), ((1, 2),))


def test_the_papers_averages_are_the_means_of_its_categories() -> None:
    paper = load_paper()
    assert sum(c.tasks for c in paper.categories) == 536
    for row in paper.accuracy:
        mean = sum(row.category(c.category) for c in paper.categories) / len(paper.categories)
        assert row.average == pytest.approx(mean, abs=0.07), row.line
    best = max(paper.accuracy, key=lambda row: row.average)
    assert (best.planner, best.eyes, best.average) == ("qwen3-30b-a3b", "moondream3", 73.8)
    assert paper.micro_average_percent(best) == pytest.approx(72.4, abs=0.05)
    assert sum(row.average for row in paper.accuracy) / 19 == pytest.approx(66.2, abs=0.05)


def test_all_but_one_of_the_papers_shares_are_multiples_of_one_task() -> None:
    paper = load_paper()
    impossible = [
        (row.line, c.category)
        for row in paper.accuracy
        for c in paper.categories
        if min(abs(row.category(c.category) - 100 * k / c.tasks) for k in range(c.tasks + 1)) > 0.051
    ]
    assert impossible == [(428, "comparative")]


def test_the_papers_pairs_and_models_are_those_of_the_registry() -> None:
    paper, registry = load_paper(), load_registry()
    theirs = {(row.planner, row.eyes): row.average for row in paper.accuracy}
    ours = {(pair.planner, pair.perception): pair.paper_average for pair in registry.pairs.values() if pair.origin == "paper"}
    assert theirs == ours and len(theirs) == 19
    for model in paper.models:
        known = registry.model(model.name)
        assert (known.size_b, known.active_b, known.precision) == (model.size_b, model.active_b, model.precision)
    assert {row.name for row in paper.latency} <= set(registry.models)


def test_the_spreads_in_the_paper_follow_from_its_table() -> None:
    paper = load_paper()
    by_perception: dict[str, list[float]] = {}
    by_planner: dict[str, list[float]] = {}
    for row in paper.accuracy:
        by_perception.setdefault(row.eyes, []).append(row.average)
        by_planner.setdefault(row.planner, []).append(row.average)
    spreads = sorted(max(v) - min(v) for v in by_perception.values() if len(v) > 1)
    assert [spreads[0], spreads[-1]] == pytest.approx([5.6, 12.4])
    assert max(max(v) - min(v) for v in by_planner.values()) == pytest.approx(6.9)
