"""A full report on 19 simulated pairs contains every result of the paper and recovers the known strengths."""

from __future__ import annotations

from math import log
from pathlib import Path
from statistics import fmean

import numpy as np
import pytest

from scope_ptz.bench.human_runs import read_result
from scope_ptz.bench.reports.assemble import EvaluationReport, build_report
from scope_ptz.bench.reports.details.paper import load_paper
from scope_ptz.bench.reports.report_runs import CATEGORY_TITLES, ReportRun, report_runs
from scope_ptz.bench.reports.tables import cell_value
from scope_ptz.bench.reports.terminal import terminal_lines
from scope_ptz.bench.reports.writer import render_html, render_markdown
from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.registry import load_registry
from tests.bench.reports.simulated.items import core_items, other_items
from tests.bench.reports.simulated.recovery import cells, contains, interval_coverage
from tests.bench.reports.simulated.runs import FAILURE, evaluation, full_sweep, store
from tests.bench.reports.simulated.strengths import (
    HIGH_LOSS,
    JUDGE_AGREEMENT,
    PANORAMA_RATIO,
    UNSCORED_SHARE,
    Pair,
    normal_population,
    paper_pairs,
    success_probabilities,
    viewpoint_effects,
)
from tests.bench.reports.test_report import row, table

PAPER_RESULTS = {
    "tab:evalcats, tasks by category": ("tasks", ("tasks",)),
    "tab:errormodes, the error modes": ("paper_modes", ("description",)),
    "tab:models, size, active parameters and precision": ("models", ("size_b", "active_b", "precision", "kind")),
    "tab:cat-metrics-by-model, accuracy": ("accuracy", (*CATEGORY_TITLES, "macro", "micro")),
    "tab:latency-summary, vision-language models": ("latency_eyes", ("look_median", "trial_median", "calls")),
    "tab:latency-summary, small language models": ("latency_planner", ("step_median", "trial_median", "calls")),
    "tab:latency-summary, current view to panorama": ("latency_views", ("eyes_median", "ratio")),
    "fig:error-counts-by-mode": ("error_modes", tuple(mode.value for mode in ErrorMode)),
    "the error modes by the judge": ("error_modes_judge", tuple(mode.value for mode in ErrorMode)),
    "spread if only the planner changes": ("spread_planner", ("pairs",)),
    "spread if only the perception model changes": ("spread_eyes", ("pairs",)),
    "the oracle setting": ("oracle", ("macro_judge", "oracle_judge", "perception_judge", "oracle_rules", "perception_rules")),
    "scope sensitivity": ("scope", ("current", "full", "difference")),
    "mixture-of-experts against dense planners": ("mixtures", ("moe_macro", "dense_macro", "moe_latency_s", "difference")),
    "quantisation": ("quantised", ("difference", "p_mcnemar")),
    "the accuracy-latency balance": ("choice", ("macro", "latency_s", "p95_s", "inference_s", "memory_gb")),
}
"""Results in the paper, and the tables and columns of a report that must contain them.

The paper's other table (the tools) and its other figures (an example, the architecture, the scenes) contain no results.
"""
CHARTS = {
    "chart-front", "chart-accuracy", "chart-error-modes", "chart-error-modes-judge", "chart-oracle", "chart-time"
}  # fmt: skip
BY_PAIR = ("accuracy", "error_modes", "oracle", "scope", "choice", "design_points", "latency_stages")


@pytest.fixture(scope="module")
def full(tmp_path_factory: pytest.TempPathFactory) -> EvaluationReport:
    paths = store(full_sweep(), tmp_path_factory.mktemp("logs"))
    assert all(path.name.startswith("simulated-") for path in paths)
    return build_report([read_result(path) for path in paths], load_registry())


@pytest.mark.full
def test_the_report_contains_every_result_of_the_paper(full: EvaluationReport) -> None:
    for paper_result, (key, columns) in PAPER_RESULTS.items():
        found = table(full, key)
        names = [column.name for column in found.columns]
        assert found.rows, paper_result
        for values in found.rows:
            if str(cell_value(values[0])).startswith("Mean of"):
                continue
            for name in columns:
                assert cell_value(values[names.index(name)]) not in (None, ""), (paper_result, values[0], name)
    assert {chart.key for section in full.sections for chart in section.charts} == CHARTS
    labels = {pair.label for pair in paper_pairs()}
    assert len(labels) == len(load_paper().accuracy) == 19
    for key in BY_PAIR:
        assert labels <= {cell_value(values[0]) for values in table(full, key).rows}, key
    tasks = {values[0]: values[1] for values in table(full, "tasks").rows}
    assert tasks == {CATEGORY_TITLES[c.category]: c.tasks for c in load_paper().categories} | {"All": 536}


@pytest.mark.full
def test_every_name_is_marked_as_simulated(full: EvaluationReport) -> None:
    assert full.notice.startswith("All runs of this report are simulated: no model was run.")
    assert full.notice in render_html(full) and next(iter(terminal_lines(full))) == full.notice
    assert "simulated: no model was run" in render_markdown(full)[:300]
    assert all(run.label.startswith("simulated-") for run in full.runs)
    for key in BY_PAIR:
        names = (str(cell_value(values[0])) for values in table(full, key).rows)
        assert all(name.startswith(("simulated-", "Mean of")) for name in names), key


@pytest.mark.full
def test_the_known_strengths_are_within_the_intervals(full: EvaluationReport) -> None:
    counts = interval_coverage(full)
    # Viewpoint effects are shared by all pairs of a report, so its intervals miss together. The rate over many reports
    # is tested below.
    assert {quantity: total for quantity, (_, total) in counts.items()} == {
        "macro accuracy": 19, "accuracy by category": 152, "oracle setting": 19
    }  # fmt: skip
    assert all(inside >= 0.8 * total for inside, total in counts.values()), counts


@pytest.mark.full
def test_latencies_error_modes_losses_and_the_judge_are_recovered(full: EvaluationReport) -> None:
    for pair in paper_pairs():
        planner = row(full, "latency_planner", f"simulated-{pair.planner}")["trial_median"]
        assert isinstance(planner, float) and abs(log(planner / pair.planner_s)) < 0.1, pair
        agreement = row(full, "judge", pair.label)["agreement"]
        assert isinstance(agreement, float) and abs(agreement - JUDGE_AGREEMENT) < 0.045
        modes = row(full, "error_modes", pair.label)
        failed, share = modes["failed"], modes["perception"]
        assert isinstance(failed, int) and isinstance(share, float)
        assert abs(share - pair.perception_share) < 4 * (0.25 / failed) ** 0.5
    for name in ("moondream2", "moondream2-4bit", "moondream3", "qwen2.5-vl-7b"):
        expected = {pair.perception_s for pair in paper_pairs() if pair.perception == name}
        views = table(full, "latency_views")
        start = next(n for n, group in views.groups.items() if group == f"simulated-{name}")
        median, ratio = views.rows[start][3], views.rows[start + 1][5]
        assert isinstance(median, float) and abs(log(median / expected.pop())) < 0.1
        assert isinstance(ratio, float) and abs(log(ratio / PANORAMA_RATIO)) < 0.15
    text = " ".join(full.problems)
    assert len(full.problems) == 2 and FAILURE in text and " + ".join(f"simulated-{name}" for name in HIGH_LOSS) in text


@pytest.mark.full
def test_the_known_order_is_not_contradicted(full: EvaluationReport) -> None:
    """A pair that is shown to be better is better, and the truly best pair is among the leaders."""
    truth = {pair.label: pair.macro for pair in paper_pairs()}
    for values in table(full, "comparisons").rows:
        if values[11] == "yes":
            better, worse = (values[0], values[1]) if unmarked_value(values[3]) > 0 else (values[1], values[0])
            assert truth[str(better)] > truth[str(worse)]
    standings = {str(cell_value(values[0])): values[3] for values in table(full, "choice").rows}
    best = max(truth, key=lambda label: truth[label])
    assert standings[best] in ("highest", "not distinguishable")


def unmarked_value(cell: object) -> float:
    return float(cell.value)  # type: ignore[attr-defined]


@pytest.mark.full
def test_the_simulation_has_the_strengths_that_it_states() -> None:
    items, pair = core_items(), paper_pairs()[0]
    assert len(items) == 536
    effects = [viewpoint_effects(items, seed) for seed in range(150)]
    means = np.mean([success_probabilities(pair, items, e) for e in effects], axis=0)
    for category, accuracy in pair.accuracy.items():
        expected = [means[n] for n, item in enumerate(items) if item.facts.category == category]
        assert fmean(expected) == pytest.approx(accuracy, abs=0.015)
    oracle = pair.with_perfect_perception().accuracy["counting"]
    assert oracle == pytest.approx(pair.accuracy["counting"] + (1 - pair.accuracy["counting"]) * (1 - UNSCORED_SHARE) * 0.35)


def interval_hits(pair: Pair, seeds: range, *, new_items: bool) -> tuple[list[bool], list[bool]]:
    """Return whether the macro and category intervals contain the known values, for each replicate.

    With ``new_items``, each replicate draws other items from the same population. The intervals allow for this.
    """
    population = normal_population() if new_items else None
    macro: list[bool] = []
    by_category: list[bool] = []
    for seed in seeds:
        items = other_items(seed) if new_items else core_items()
        (run,) = report_runs([evaluation(pair, seed, items, population)], load_registry())
        macro.append(contains(run.macro, pair.macro))
        by_category += [contains(category_share(run, name), value) for name, value in pair.accuracy.items()]
    return macro, by_category


def category_share(run: ReportRun, name: str) -> object:
    from scope_ptz.bench.reports.report_runs import scores_of
    from scope_ptz.bench.statistics.clustered import proportion

    return proportion(scores_of([t for t in run.scored_trials if t.task.category == name]))


@pytest.mark.full
def test_about_95_percent_of_intervals_contain_the_truth() -> None:
    macro, by_category = interval_hits(paper_pairs()[8], range(40), new_items=True)
    assert 0.88 <= fmean(macro) <= 1.0 and 0.92 <= fmean(by_category) <= 0.99


@pytest.mark.full
@pytest.mark.parametrize(("new_items", "limits"), [(True, (0.93, 0.99)), (False, (0.95, 0.995))])
def test_about_95_percent_of_many_intervals_contain_the_truth(new_items: bool, limits: tuple[float, float]) -> None:
    """With the same tasks, more than 95% do, because the intervals also allow for other tasks."""
    results = [interval_hits(pair, range(1000, 1150), new_items=new_items) for pair in (paper_pairs()[n] for n in (0, 8, 14, 18))]
    macro, by_category = (fmean(value for result in results for value in result[n]) for n in (0, 1))
    assert limits[0] <= macro <= limits[1] and limits[0] <= by_category <= limits[1], (macro, by_category)


@pytest.mark.full
def test_differences_between_pairs_are_covered() -> None:
    from scope_ptz.bench.reports.paired_comparison import compare

    one, other = paper_pairs()[0], paper_pairs()[8]
    inside = []
    for seed in range(2000, 2300):
        first, second = report_runs([evaluation(one, seed), evaluation(other, seed)], load_registry())
        found = compare(first, second)
        assert found is not None
        truth = one.macro - other.macro if first.label == one.label else other.macro - one.macro
        inside.append(contains(found.macro, truth))
    assert 0.92 <= fmean(inside) <= 0.99


@pytest.mark.full
def test_difficulty_is_checked_on_items_with_independent_difficulties(full: EvaluationReport) -> None:
    text = " ".join(next(s for s in full.sections if s.key == "difficulty").text)
    assert "classes by item statistics" in text
    assert len(table(full, "items").rows) == 536
    assert cells(full, "choice", paper_pairs()[0])["number"] is not None


@pytest.mark.full
def test_the_command_reads_stored_simulations(tmp_path: Path) -> None:
    from typer.testing import CliRunner

    from scope_ptz.cli.app import app

    paths = store([evaluation(pair, items=core_items()[::9]) for pair in paper_pairs()[:3]], tmp_path / "logs")
    run_result = CliRunner().invoke(app, ["bench", "report", *map(str, paths), "--out", str(tmp_path / "report"), "--no-pages"])
    assert run_result.exit_code == 0, run_result.output
    assert run_result.stdout.startswith("All runs of this report are simulated")
    assert (tmp_path / "report" / "charts" / "chart-front.svg").is_file()
