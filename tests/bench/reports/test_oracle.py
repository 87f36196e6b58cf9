"""The oracle setting: each oracle is compared with its own baseline, and means cover the same pairs."""

from __future__ import annotations

from statistics import fmean
from typing import Any

import pytest

from scope_ptz.bench.reports.assemble import EvaluationReport, build_report
from scope_ptz.bench.reports.sections import Chart
from scope_ptz.bench.reports.tables import MarkedCell, ReportTable, unmarked
from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.bench.scoring.trials import Evaluation, Judgement
from scope_ptz.bench.statistics.clustered import IntervalEstimate
from scope_ptz.registry import load_registry
from tests.bench.reports.making import JUDGE, card, facts, trial
from tests.bench.reports.test_report import row, table

TASKS = facts(4)
"""32, four of each category."""


def run(planner: str, eyes: str, wrong: int, *, judged_wrong: int | None = None, number: int = 32) -> Evaluation:
    """A run that fails the first ``wrong`` of each four tasks (``judged_wrong`` by the judge), half of them due to perception."""
    trials = []
    for at, task in enumerate(TASKS[:number]):
        place = at % 4
        further: dict[str, Any] = {"error_mode": ErrorMode.VLM_QUERY if place % 2 == 0 else ErrorMode.SCOPE}
        if judged_wrong is not None:
            fails = place < judged_wrong
            said = Judgement(
                judge=JUDGE, prompt="standard-1", verdict="incorrect" if fails else "correct",
                error_mode=further["error_mode"] if fails else None,
            )  # fmt: skip
            further["judgements"] = (said,)
        headline = "incorrect" if place < wrong else "correct"
        trials.append(trial(task, headline, **(further if headline == "incorrect" else further | {"error_mode": None})))
    return Evaluation(card=card(planner, eyes), trials=tuple(trials), wanted=number)


def build(*evaluations: Evaluation) -> EvaluationReport:
    return build_report(evaluations, load_registry())


def chart(report: EvaluationReport) -> Chart:
    return next(c for section in report.sections for c in section.charts if c.key == "chart-oracle")


def cell(found: ReportTable, first: str, name: str) -> Any:
    at = [column.name for column in found.columns].index(name)
    return next(values[at] for values in found.rows if unmarked(values[0]) == first)


def test_each_oracle_is_shown_with_the_baseline_of_its_own_verdicts() -> None:
    # By the checks 75%, by the judge 50%. Relabelled: 100% by the checks' rules, 75% by the judge.
    made = build(run("qwen3-4b", "moondream3", 1, judged_wrong=2), run("qwen3-4b", "ground-truth", 0))
    told = row(made, "oracle", "qwen3-4b + moondream3")
    assert [told[n] for n in ("macro_checks", "oracle_rules", "macro_rerun")] == pytest.approx([0.75, 1.0, 1.0])
    assert [told[n] for n in ("macro_judge", "oracle_judge")] == pytest.approx([0.5, 0.75])
    drawn = chart(made)
    checks = "by the checks: measured 75.0%, VLM errors counted as correct 100.0%, rerun with ground-truth perception 100.0%"
    assert checks in drawn.alt and "by the judge: measured 50.0%, VLM errors counted as correct 75.0%" in drawn.alt
    assert drawn.svg.index("Macro accuracy by the checks") < drawn.svg.index("Macro accuracy by the judge")


def test_without_a_judge_there_is_no_judge_panel() -> None:
    drawn = chart(build(run("qwen3-4b", "moondream3", 1)))
    assert "by the checks" in drawn.svg and "by the judge" not in drawn.svg and "by the judge" not in drawn.alt


def test_means_cover_the_pairs_that_have_both_settings() -> None:
    # Two pairs judged, one not; one run again. No mean mixes them.
    made = build(
        run("qwen3-4b", "moondream3", 1, judged_wrong=1),
        run("qwen3-30b-a3b", "moondream3", 2, judged_wrong=3),
        run("qwen3-32b", "moondream3", 4),
        run("qwen3-30b-a3b", "ground-truth", 1),
    )
    found, mean, again = table(made, "oracle"), "Mean of the pairs", "Mean of the pairs run again"
    assert row(made, "oracle", mean)["macro_checks"] == pytest.approx(fmean([0.75, 0.5, 0.0]))
    assert row(made, "oracle", mean)["macro_judge"] == pytest.approx(fmean([0.75, 0.25]))
    assert cell(found, mean, "macro_judge").note == cell(found, mean, "oracle_judge").note == "over 2 of 3 pairs"
    assert cell(found, mean, "macro_checks").note == "" and cell(found, mean, "macro_rerun") == ""
    told = row(made, "oracle", again)
    assert (told["macro_checks"], told["macro_rerun"], told["gain_rerun"]) == pytest.approx((0.5, 0.75, 0.25))
    assert cell(found, again, "macro_checks").note == "over 1 of 3 pairs"
    assert "Mean" not in chart(made).alt


def test_a_repeated_run_over_other_tasks_is_reported_for_shared_tasks_and_not_plotted() -> None:
    made = build(run("qwen3-4b", "moondream3", 1), run("qwen3-4b", "ground-truth", 0, number=16))
    shown = cell(table(made, "oracle"), "qwen3-4b + moondream3", "macro_rerun")
    assert isinstance(shown, MarkedCell) and shown.note == "on 16 of its 32 tasks"
    assert isinstance(shown.value, IntervalEstimate) and shown.value.n == 16
    assert "run again" not in chart(made).alt
