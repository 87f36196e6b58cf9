"""Runs on other tasks or with another model are marked wherever they appear."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pytest

from scope_ptz.bench.reports.assemble import EvaluationReport, build_report
from scope_ptz.bench.reports.chart_style import bar_styles
from scope_ptz.bench.reports.display_names import unexpected_model
from scope_ptz.bench.reports.report_runs import main_tasks, report_runs
from scope_ptz.bench.reports.tables import cell_value
from scope_ptz.bench.scoring.trials import Evaluation, ModelCard
from scope_ptz.bench.tasks.task_facts import TaskFacts
from scope_ptz.registry import load_registry
from tests.bench.reports.sample_evaluations import evaluation, facts
from tests.bench.reports.test_report import row, table

TASKS = facts(4)
PAIRS = ("qwen3-4b", "qwen3-30b-a3b")


def run(planner: str, perception: str, tasks: Sequence[TaskFacts] = TASKS, **extra: Any) -> Evaluation:
    return evaluation(planner, perception, tasks, 0.6, **{"broken_share": 0.0, **extra})


def with_other_ids(tasks: Sequence[TaskFacts]) -> list[TaskFacts]:
    return [t.model_copy(update={"id": f"{t.id}5"}) for t in tasks]


def charts(report: EvaluationReport) -> dict[str, str]:
    return {chart.key: chart.alt + chart.svg for section in report.sections for chart in section.charts}


def test_trials_that_wait_for_a_judge_are_neither_correct_nor_incorrect() -> None:
    complete = run("qwen3-4b", "moondream3")
    waiting = complete.trials[0].model_copy(update={"headline": "unscored", "scored_by": "judge", "judgements": ()})
    (before,) = report_runs([complete], load_registry())
    (after,) = report_runs([complete.model_copy(update={"trials": (waiting, *complete.trials[1:])})], load_registry())
    assert len(after.scored_trials) == len(before.scored_trials) - 1
    assert waiting in after.main_trials and waiting not in after.scored_trials


@pytest.fixture(scope="module")
def mixed() -> EvaluationReport:
    """Return a report on two pairs and a reference on the same tasks, and a third pair and a reference on other tasks."""
    pairs = [run(planner, "moondream3") for planner in PAIRS]
    elsewhere = run("grammar", "ground-truth", [*TASKS[:3], *with_other_ids(TASKS[3:20])])
    return build_report(
        [*pairs, run("qwen3-4b-fp8", "moondream3", TASKS[:10]), elsewhere, run("qwen3-4b", "ground-truth")], load_registry()
    )


FEWER = "qwen3-4b-fp8 + moondream3 [10 of the 32 tasks]"
OTHERS = "grammar + ground-truth [20 tasks, 3 of the 32 shared]"


@pytest.mark.full
def test_runs_on_other_tasks_are_listed_first_and_marked_everywhere(mixed: EvaluationReport) -> None:
    before = " ".join(mixed.warnings)
    assert f"These pairs were run on different tasks from most pairs: {FEWER}." in before
    assert f"from the model pairs, as their labels state: {OTHERS}." in before
    for found in mixed.tables:
        for values in found.rows:
            first = str(cell_value(values[0]))
            if first.startswith(("grammar + ground-truth", "qwen3-4b-fp8 + moondream3")):
                assert first in (OTHERS, FEWER), found.key
    chart_texts = charts(mixed)
    for key in ("chart-accuracy", "chart-error-modes"):
        assert "20 tasks, 3" in chart_texts[key] and "10 of the" in chart_texts[key]
    assert "Hollow: runs on other tasks" in next(c.title for s in mixed.sections for c in s.charts if c.key == "chart-accuracy")


def test_only_pairs_on_the_main_tasks_are_counted_and_averaged(mixed: EvaluationReport) -> None:
    assert "2 pairs of models on the main task set (32 tasks); 1 more pair on other tasks." in mixed.summary[0]
    shares = [row(mixed, "scope", f"{planner} + moondream3")["current"] for planner in PAIRS]
    assert row(mixed, "scope", "Mean of the model pairs")["current"] == pytest.approx(sum(map(float, shares)) / 2)  # type: ignore[arg-type]
    assert {cell_value(values[0]) for values in table(mixed, "design_points").rows} == {
        f"{planner} + moondream3" for planner in PAIRS
    }


def test_runs_on_the_same_tasks_are_not_marked() -> None:
    runs = report_runs([run("qwen3-4b", "moondream3"), run("grammar", "ground-truth")], load_registry())
    assert [(r.label, r.task_difference) for r in runs] == [("qwen3-4b + moondream3", ""), ("grammar + ground-truth", "")]
    assert main_tasks(runs) == {t.id for t in TASKS}
    report = build_report([run("qwen3-4b", "moondream3")], load_registry())
    assert "1 pair of models on the main task set (32 tasks)." in report.summary[0]
    assert not any("other tasks" in line for line in report.warnings)


def test_reference_runs_are_distinguished_in_the_chart_of_error_modes() -> None:
    references = [run(planner, "ground-truth") for planner in (*PAIRS, "qwen3-4b-fp8", "grammar", "qwen3-32b", "qwen3-14b")]
    runs = report_runs([run("qwen3-4b", "moondream3"), *references], load_registry())
    styles = bar_styles(runs)
    assert len(set(styles)) == len(runs)
    assert all((hatch is None) is r.ranked for r, (_, hatch) in zip(runs, styles, strict=True))


def run_with_served_model(planner: str, model: str, **extra: Any) -> Evaluation:
    template = run(planner, "moondream3", **extra)
    reported = {"model": model, "/v1/models id": model}
    return template.model_copy(
        update={
            "card": template.card.model_copy(update={"planner": template.card.planner.model_copy(update={"reported": reported})})
        }
    )


def test_a_server_that_reported_another_model_is_noted_in_and_before_rankings() -> None:
    other = "qwen3-30b-a3b (served: m-9701)"
    report = build_report([run_with_served_model("qwen3-30b-a3b", "m-9701"), run("qwen3-4b", "moondream3")], load_registry())
    label = f"{other} + moondream3"
    for key in ("accuracy", "outcomes", "latency_stages", "design_points", "oracle", "error_modes", "costs", "runs"):
        firsts = {str(cell_value(values[0])) for values in table(report, key).rows}
        assert label in firsts and not any("30b" in first and first != label for first in firsts), key
    assert other in {cell_value(values[0]) for values in table(report, "latency_planner").rows}
    chart_texts = charts(report)
    assert all("served: m-9701" in chart_texts[key] for key in ("chart-accuracy", "chart-front", "chart-oracle"))
    (line,) = [line for line in report.warnings if "a model other than" in line]
    assert other in line and "qwen3-4b " not in line


def test_a_different_served_model_is_a_different_system() -> None:
    requested, other = (
        run_with_served_model("qwen3-4b", "Qwen/Qwen3-4B-Instruct-2507"),
        run_with_served_model("qwen3-4b", "m-1", contended=False),
    )
    runs = report_runs([requested, other], load_registry())
    assert len({r.system for r in runs}) == 2
    report = build_report([requested, other], load_registry())
    assert row(report, "design_points", "qwen3-4b + moondream3")["contended"] == "contended"


@pytest.mark.parametrize(
    ("reported", "expected"),
    [
        ({}, None),
        ({"model": "Qwen/Qwen3-4B-Instruct-2507"}, None),
        ({"model": "qwen3-4b"}, None),
        ({"model": "/models/qwen3-4b-instruct-2507"}, None),
        ({"model": "planner", "/v1/models id": "planner", "/v1/models root": "Qwen/Qwen3-4B-Instruct-2507"}, None),
        # The requested name decides, not the other models of the server.
        ({"model": "llama-3", "/v1/models id": "Qwen/Qwen3-4B-Instruct-2507"}, "llama-3"),
        ({"model": "llama-3", "/v1/models id": "x", "/v1/models root": "Qwen/Qwen3-4B-Instruct-2507"}, "llama-3"),
        ({"/v1/models id": "m-1"}, "m-1"),
        ({"/version version": "0.9"}, None),
    ],
)
def test_which_names_count_as_another_model(reported: dict[str, str], expected: str | None) -> None:
    model = load_registry().model("qwen3-4b")
    assert unexpected_model(ModelCard(name="qwen3-4b", registry="qwen3-4b", reported=reported), model) == expected
    assert unexpected_model(ModelCard(name="mine", reported=reported), None) is None
