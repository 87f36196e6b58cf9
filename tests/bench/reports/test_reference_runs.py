"""Classification of runs as references and pairs, and the wording for incorrect and unscored trials."""

from __future__ import annotations

import re
from statistics import fmean
from typing import Any

import pytest

from scope_ptz.agent.timing import Timings
from scope_ptz.bench.reports.assemble import EvaluationReport, build_report
from scope_ptz.bench.reports.report_runs import report_runs
from scope_ptz.bench.scoring.trials import Evaluation, ModelCard
from scope_ptz.registry import load_registry
from tests.bench.reports.sample_evaluations import card, evaluation, facts, trial
from tests.bench.reports.test_report import row, table

TASKS = facts(4)
PAIRS = (("qwen3-4b", "moondream3"), ("qwen3-30b-a3b", "moondream3"))


def uniform(planner: str, perception: str, headline: str, **extra: Any) -> Evaluation:
    """Return an evaluation in which all tasks have the same result."""
    run_card = card(planner, perception, **extra)
    if perception == "noisy":
        run_card = run_card.model_copy(update={"perception": ModelCard(name="noisy", deterministic=True)})
    return Evaluation(card=run_card, trials=tuple(trial(t, headline) for t in TASKS), wanted=len(TASKS))


def build(*evaluations: Evaluation) -> EvaluationReport:
    return build_report(evaluations, load_registry())


def chart(report: EvaluationReport, key: str) -> Any:
    return next(c for section in report.sections for c in section.charts if c.key == key)


def section_text(report: EvaluationReport, key: str) -> str:
    return " ".join(next(section for section in report.sections if section.key == key).text)


def test_noisy_perception_and_ground_truth_are_different_systems() -> None:
    pair = uniform(*PAIRS[0], "incorrect")
    report = build(pair, uniform(PAIRS[0][0], "noisy", "correct"))
    cells = row(report, "oracle", "qwen3-4b + moondream3")
    assert (cells["macro_rerun"], cells["gain_rerun"]) == (None, None)
    assert "run again" not in chart(report, "chart-oracle").alt
    both = build(pair, uniform(PAIRS[0][0], "noisy", "incorrect"), uniform(PAIRS[0][0], "ground-truth", "correct"))
    assert row(both, "oracle", "qwen3-4b + moondream3")["macro_rerun"] == pytest.approx(1.0)


@pytest.mark.full
def test_the_audit_compares_with_runs_without_models_and_noise_only() -> None:
    pairs = [uniform(*pair, "incorrect") for pair in PAIRS]
    noise = [uniform("grammar", "noisy", "incorrect"), uniform("qwen3-4b", "ground-truth", "incorrect")]
    report = build(*pairs, *noise, uniform("grammar", "ground-truth", "correct"))
    assert {row(report, "audit", t.id)["reference"] for t in TASKS} == {1.0}
    assert {row(build(*pairs, *noise), "audit", t.id)["reference"] for t in TASKS} == {None}
    assert [r.label for r in report_runs([*pairs, *noise], load_registry()) if r.is_exact_reference] == []
    assert "grammar planner with ground-truth perception" in section_text(
        report, "audit"
    ) and "exact reference" not in section_text(report, "audit")


def test_no_result_is_described_as_exact_by_construction() -> None:
    text = section_text(build(uniform(*PAIRS[0], "correct"), uniform("grammar", "noisy", "correct")), "accuracy")
    assert (
        "exact by construction" not in text and "exact about what is visible" in text and "may misunderstand an instruction" in text
    )


def timed_evaluation(planner: str, seconds: float, calls: int, **extra: Any) -> Evaluation:
    timings = Timings(planner_s=seconds, perception_s=1.0, total_s=seconds + 1.5)
    trials = tuple(trial(t, timings=timings, tool_calls={"adjust_ptz": calls}) for t in TASKS)
    return Evaluation(card=card(planner, "moondream3", **extra), trials=trials, wanted=len(trials))


def test_variants_are_not_pairs_in_latency_tables() -> None:
    report = build(
        timed_evaluation("qwen3-4b", 2.0, 2),
        timed_evaluation("qwen3-4b", 50.0, 9, variant="short"),
        timed_evaluation("qwen3-30b-a3b", 3.0, 4),
    )
    assert "2 of 2 model pairs. They were timed only while" in section_text(report, "latency")
    assert "2 pairs of models" in report.summary[0]
    cells = row(report, "latency_planner", "qwen3-4b")
    assert (cells["trial_median"], cells["calls"], cells["pairs"], cells["pairs_all"]) == (2.0, 2.0, 1, 1)
    assert row(report, "latency_eyes", "moondream3")["calls"] == pytest.approx(3.0)


def test_tool_calls_cover_all_pairs_including_contended_runs() -> None:
    logs = [timed_evaluation(planner, 2.0, calls) for planner, calls in (("qwen3-4b", 2), ("qwen3-30b-a3b", 3), ("qwen3-32b", 7))]
    report = build(*logs, timed_evaluation("qwen3-4b", 1.0, 2, contended=False, concurrency=1))
    cells = row(report, "latency_eyes", "moondream3")
    assert (cells["contended"], cells["pairs"], cells["pairs_all"]) == ("alone", 1, 3)
    assert cells["calls"] == pytest.approx(fmean([2, 3, 7]))


def test_incorrect_and_unscored_trials_are_distinguished() -> None:
    trials = tuple(trial(t, ("incorrect", "unscored", "correct", "incorrect")[n % 4]) for n, t in enumerate(TASKS))
    report = build(Evaluation(card=card(*PAIRS[0]), trials=trials, wanted=len(trials)))
    assert any("16 of 16 incorrect trials; 8 more are unscored and have no error mode." in line for line in report.summary)
    text = section_text(report, "errors")
    assert "exactly one error mode to every incorrect trial" in text and "Unscored trials" in text
    assert table(report, "error_modes").title.startswith("Incorrect trials")
    unscored = next(t.task.id for t in trials if t.headline == "unscored")
    assert (row(report, "failed_tasks", unscored)["failed"], row(report, "failed_tasks", unscored)["unscored"]) == (1, 1)


def test_costs_name_the_role_of_their_tokens() -> None:
    found = table(build(uniform(*PAIRS[0], "correct")), "costs")
    assert "those of the planner, as reported by its server" in found.notes[0]
    assert "tokens of the perception model are not counted" in found.notes[0]


def test_long_settings_are_prose_columns() -> None:
    found = table(build(uniform(*PAIRS[0], "correct")), "runs")
    kinds = {column.name: column.kind for column in found.columns}
    assert {kinds[name] for name in ("sampling", "planner_reported", "eyes_reported")} == {"prose"}


def test_bars_without_height_are_not_drawn() -> None:
    # Only the bars of the unranked run have edges. It has one error mode: one bar in the plot and one in the legend.
    svg = chart(build(uniform(*PAIRS[0], "incorrect"), uniform("grammar", "ground-truth", "incorrect")), "chart-error-modes").svg
    edged = re.findall(r'<path d="([^"]*)"[^>]*stroke: #22262b; stroke-width: 0.6', svg)
    assert len(edged) == 2


def test_a_dashed_outline_differs_from_the_fill_of_its_marker() -> None:
    from scope_ptz.bench.reports.choice.candidates import rank_candidates

    runs = report_runs([evaluation(*pair, TASKS, 0.6, broken_share=0.0) for pair in PAIRS[:1]], load_registry())
    (found,) = rank_candidates(runs, runs)
    assert found.on_front and found.contended
    svg = chart(build(*(r.evaluation for r in runs)), "chart-front").svg
    assert svg.count("stroke-dasharray") >= 2, "a dashed outline in the plot and one in the legend"
    outlines = [part for part in re.findall(r'style="([^"]*)"', svg) if "stroke-dasharray" in part and "fill: #" in part]
    assert outlines and all("stroke: var(--ink)" in part for part in outlines), (
        "a dashed outline must not have the colour of its fill"
    )
