"""The oracle setting: each oracle is compared with its own baseline, and means cover the same pairs."""

from __future__ import annotations

from statistics import fmean
from typing import Any

import pytest

from scope_ptz.bench.reports.assemble import EvaluationReport, build_report
from scope_ptz.bench.reports.sections import Chart
from scope_ptz.bench.reports.tables import MarkedCell, ReportTable, cell_value
from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.bench.scoring.trials import Evaluation, Judgement
from scope_ptz.bench.statistics.clustered import IntervalEstimate
from scope_ptz.registry import load_registry
from tests.bench.reports.sample_evaluations import JUDGE, card, facts, trial
from tests.bench.reports.test_report import row, table

TASKS = facts(4)
"""32 tasks, four of each category."""


def run(planner: str, perception: str, wrong: int, *, judged_wrong: int | None = None, number: int = 32) -> Evaluation:
    """Return an evaluation that fails ``wrong`` of every four tasks (``judged_wrong`` by the judge), half due to perception."""
    trials = []
    for index, task in enumerate(TASKS[:number]):
        position = index % 4
        extra: dict[str, Any] = {"error_mode": ErrorMode.VLM_QUERY if position % 2 == 0 else ErrorMode.SCOPE}
        if judged_wrong is not None:
            fails = position < judged_wrong
            judgement = Judgement(
                judge=JUDGE, prompt="standard-1", verdict="incorrect" if fails else "correct",
                error_mode=extra["error_mode"] if fails else None,
            )  # fmt: skip
            extra["judgements"] = (judgement,)
        headline = "incorrect" if position < wrong else "correct"
        trials.append(trial(task, headline, **(extra if headline == "incorrect" else extra | {"error_mode": None})))
    return Evaluation(card=card(planner, perception), trials=tuple(trials), wanted=number)


def build(*evaluations: Evaluation) -> EvaluationReport:
    return build_report(evaluations, load_registry())


def chart(report: EvaluationReport) -> Chart:
    return next(c for section in report.sections for c in section.charts if c.key == "chart-oracle")


def cell(report_table: ReportTable, label: str, name: str) -> Any:
    at = [column.name for column in report_table.columns].index(name)
    return next(values[at] for values in report_table.rows if cell_value(values[0]) == label)


def test_each_oracle_is_shown_with_the_baseline_of_its_own_verdicts() -> None:
    # Accuracy is 75% by the checks and 50% by the judge. With VLM errors counted as correct, it is 100% and 75%.
    report = build(run("qwen3-4b", "moondream3", 1, judged_wrong=2), run("qwen3-4b", "ground-truth", 0))
    cells = row(report, "oracle", "qwen3-4b + moondream3")
    assert [cells[n] for n in ("macro_checks", "oracle_rules", "macro_rerun")] == pytest.approx([0.75, 1.0, 1.0])
    assert [cells[n] for n in ("macro_judge", "oracle_judge")] == pytest.approx([0.5, 0.75])
    oracle_chart = chart(report)
    checks = "by the checks: measured 75.0%, VLM errors counted as correct 100.0%, rerun with ground-truth perception 100.0%"
    assert checks in oracle_chart.alt and "by the judge: measured 50.0%, VLM errors counted as correct 75.0%" in oracle_chart.alt
    assert oracle_chart.svg.index("Macro accuracy by the checks") < oracle_chart.svg.index("Macro accuracy by the judge")


def test_without_a_judge_there_is_no_judge_panel() -> None:
    oracle_chart = chart(build(run("qwen3-4b", "moondream3", 1)))
    assert "by the checks" in oracle_chart.svg and "by the judge" not in oracle_chart.svg and "by the judge" not in oracle_chart.alt


def test_means_cover_the_pairs_that_have_both_settings() -> None:
    # Two of three pairs are judged, and one is rerun. Each mean covers the same pairs in both settings.
    report = build(
        run("qwen3-4b", "moondream3", 1, judged_wrong=1),
        run("qwen3-30b-a3b", "moondream3", 2, judged_wrong=3),
        run("qwen3-32b", "moondream3", 4),
        run("qwen3-30b-a3b", "ground-truth", 1),
    )
    found, mean, rerun_mean = table(report, "oracle"), "Mean of the pairs", "Mean of the pairs run again"
    assert row(report, "oracle", mean)["macro_checks"] == pytest.approx(fmean([0.75, 0.5, 0.0]))
    assert row(report, "oracle", mean)["macro_judge"] == pytest.approx(fmean([0.75, 0.25]))
    assert cell(found, mean, "macro_judge").note == cell(found, mean, "oracle_judge").note == "over 2 of 3 pairs"
    assert cell(found, mean, "macro_checks").note == "" and cell(found, mean, "macro_rerun") == ""
    cells = row(report, "oracle", rerun_mean)
    assert (cells["macro_checks"], cells["macro_rerun"], cells["gain_rerun"]) == pytest.approx((0.5, 0.75, 0.25))
    assert cell(found, rerun_mean, "macro_checks").note == "over 1 of 3 pairs"
    assert "Mean" not in chart(report).alt


def test_a_repeated_run_on_other_tasks_is_reported_for_shared_tasks_and_not_plotted() -> None:
    report = build(run("qwen3-4b", "moondream3", 1), run("qwen3-4b", "ground-truth", 0, number=16))
    rerun_cell = cell(table(report, "oracle"), "qwen3-4b + moondream3", "macro_rerun")
    assert isinstance(rerun_cell, MarkedCell) and rerun_cell.note == "on 16 of its 32 tasks"
    assert isinstance(rerun_cell.value, IntervalEstimate) and rerun_cell.value.n == 16
    assert "run again" not in chart(report).alt
