"""The figures of a report, recomputed from its trials in another way, and claims that a report must not make."""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from statistics import fmean, median

import pytest

from scope_ptz.agent.timing import Timings
from scope_ptz.bench.reports.assemble import EvaluationReport, build_report
from scope_ptz.bench.reports.report_runs import CATEGORY_TITLES, report_runs, timing_run
from scope_ptz.bench.reports.tables import CellValue, MarkedCell, ReportTable, cell_text, cell_value
from scope_ptz.bench.reports.writer import render_html
from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.bench.scoring.trials import Evaluation, Trial
from scope_ptz.bench.statistics.clustered import IntervalEstimate
from scope_ptz.errors import InputError
from scope_ptz.registry import load_registry
from tests.bench.reports.sample_evaluations import card, evaluation, facts, trial

BEST = "qwen3-30b-a3b + moondream3"
PARTIAL = "qwen3-4b + qwen2.5-vl-7b [24 of the 48 tasks]"
"""Label of a pair with fewer tasks than the others."""
PERCEPTION_MODES = {ErrorMode.VLM_COUNTING, ErrorMode.VLM_QUERY}


def table(report: EvaluationReport, key: str) -> ReportTable:
    return next(t for t in report.tables if t.key == key)


def row(report: EvaluationReport, key: str, label: str) -> dict[str, str | int | float | None]:
    """Return the row with this label in its first cell, with estimates reduced to their values."""
    found = table(report, key)
    values = next(r for r in found.rows if cell_value(r[0]) == label)
    plain = {}
    for column, value in zip(found.columns, values, strict=True):
        cell = cell_value(value)
        plain[column.name] = cell.value if isinstance(cell, IntervalEstimate) else cell
    return plain


def find_evaluation(evaluations: list[Evaluation], pair: str, variant: str = "", split: str = "core") -> Evaluation:
    return next(e for e in evaluations if (e.card.pair, e.card.variant, e.card.split) == (pair, variant, split))


def scored_trials(run: Evaluation) -> list[Trial]:
    return [t for t in run.trials if t.headline != "infrastructure"]


def macro(trials: list[Trial], is_correct: dict[str, bool] | None = None) -> float:
    by_category = defaultdict(list)
    for t in trials:
        by_category[t.task.category].append(t.headline == "correct" if is_correct is None else is_correct[t.sample])
    return fmean(fmean(values) for values in by_category.values())


def test_accuracy_matches_the_trials(report: EvaluationReport, evaluations: list[Evaluation]) -> None:
    for pair in ("qwen3-4b + moondream2", "qwen3-4b-fp8 + moondream3", BEST):
        trials = scored_trials(find_evaluation(evaluations, pair))
        shown = row(report, "accuracy", pair)
        assert shown["micro"] == pytest.approx(fmean(t.headline == "correct" for t in trials))
        assert shown["macro"] == pytest.approx(macro(trials))
        for category in CATEGORY_TITLES:
            expected = [t.headline == "correct" for t in trials if t.task.category == category]
            assert shown[category] == pytest.approx(fmean(expected))
        assert shown["tasks"] == 48


def test_bounds_include_unscored_trials(report: EvaluationReport, evaluations: list[Evaluation]) -> None:
    found = Counter(t.headline for t in find_evaluation(evaluations, "qwen3-4b + qwen2.5-vl-7b").trials)
    assert found["unscored"] and found["infrastructure"]
    shown = row(report, "outcomes", PARTIAL)
    total = sum(found.values())
    assert (shown["correct"], shown["unscored"], shown["infrastructure"]) == (
        found["correct"], found["unscored"], found["infrastructure"],
    )  # fmt: skip
    assert shown["share"] == pytest.approx(found["correct"] / (total - found["infrastructure"]))
    assert shown["at_least"] == pytest.approx(found["correct"] / total)
    assert shown["at_most"] == pytest.approx((total - found["incorrect"]) / total)


def test_only_model_pairs_are_ranked(report: EvaluationReport) -> None:
    unranked = {"grammar + ground-truth", "qwen3-30b-a3b + ground-truth", "qwen3-30b-a3b + blind, blind"}
    for key in ("accuracy", "comparisons", "resolution", "design_points", "memory_fits", "quantised", "oracle"):
        cells = {str(cell_value(value)) for values in table(report, key).rows for value in values}
        assert not unranked & cells, key
    for key in ("spread_planner", "spread_eyes", "latency_planner", "latency_eyes", "latency_views", "mixtures"):
        words = " ".join(str(cell_value(value)) for values in table(report, key).rows for value in values)
        assert not any(name in words for name in ("grammar", "ground-truth", "blind")), key
    others = table(report, "accuracy_not_ranked")
    assert {cell_value(values[0]) for values in others.rows} == unranked
    assert not any(isinstance(v, MarkedCell) and (v.best or v.best_of_all) for values in others.rows for v in values)
    assert any("grammar planner or ground-truth perception" in warning for warning in report.warnings)


def test_the_best_is_marked_among_runs_of_the_same_tasks(report: EvaluationReport) -> None:
    rows = {str(cell_value(values[0])): values for values in table(report, "accuracy").rows}
    names = [column.name for column in table(report, "accuracy").columns]
    at = names.index("macro")
    comparable = [label for label in rows if "lite" not in label and "qwen2.5" not in label]
    best = max(comparable, key=lambda label: _value(rows[label][at]))
    assert [label for label, values in rows.items() if isinstance(values[at], MarkedCell) and values[at].best_of_all] == [best]  # type: ignore[union-attr]
    partial = rows[PARTIAL][at]
    assert isinstance(partial, MarkedCell) and partial.note == "over 4 of 8 categories" and not partial.best
    assert any("different tasks from most pairs" in warning and "qwen2.5-vl-7b" in warning for warning in report.warnings)


def _value(cell: CellValue) -> float:
    plain = cell_value(cell)
    assert isinstance(plain, IntervalEstimate)
    return plain.value


def test_error_modes_are_counted_by_rules_and_by_the_judge(report: EvaluationReport, evaluations: list[Evaluation]) -> None:
    trials = scored_trials(find_evaluation(evaluations, BEST))
    rules = Counter(t.error_mode for t in trials if t.error_mode)
    shown = row(report, "error_modes", BEST)
    assert {mode: shown[mode.value] for mode in ErrorMode} == {mode: rules[mode] for mode in ErrorMode}
    assert shown["failed"] == sum(t.headline == "incorrect" for t in trials)
    judgements = [t.judgements[0] for t in trials]
    judged = Counter(j.error_mode for j in judgements if j.verdict == "incorrect")
    assert row(report, "error_modes_judge", BEST)["reasoning"] == judged[ErrorMode.REASONING]
    shown = row(report, "judge", BEST)
    assert shown["unparseable"] == sum(j.verdict == "unparseable" for j in judgements)
    clear = [t for t in trials if t.judgements[0].verdict != "unparseable"]
    is_correct = {t.sample: t.judgements[0].verdict == "correct" for t in clear}
    assert shown["macro_judge"] == pytest.approx(macro(clear, is_correct))
    assert shown["macro_checks"] == pytest.approx(macro(clear))


def test_the_oracle_setting_both_ways(report: EvaluationReport, evaluations: list[Evaluation]) -> None:
    trials = scored_trials(find_evaluation(evaluations, BEST))
    shown = row(report, "oracle", BEST)
    corrected = {t.sample: t.headline == "correct" or t.error_mode in PERCEPTION_MODES for t in trials}
    assert shown["oracle_rules"] == pytest.approx(macro(trials, corrected))
    clear = [t for t in trials if t.judgements[0].verdict != "unparseable"]
    by_judge = {t.sample: t.judgements[0].verdict == "correct" or t.judgements[0].error_mode in PERCEPTION_MODES for t in clear}
    assert shown["oracle_judge"] == pytest.approx(macro(clear, by_judge))
    failed = [t.judgements[0].error_mode for t in clear if t.judgements[0].verdict == "incorrect"]
    assert shown["perception_judge"] == pytest.approx(fmean(mode in PERCEPTION_MODES for mode in failed))
    rerun_log = find_evaluation(evaluations, "qwen3-30b-a3b + ground-truth")
    assert shown["macro_rerun"] == pytest.approx(macro(scored_trials(rerun_log)))
    rerun = {t.task.id: t for t in scored_trials(rerun_log)}
    gains = defaultdict(list)
    for t in trials:
        if t.task.id in rerun:
            gains[t.task.category].append((rerun[t.task.id].headline == "correct") - (t.headline == "correct"))
    assert shown["gain_rerun"] == pytest.approx(fmean(fmean(values) for values in gains.values()))
    assert row(report, "oracle", "qwen3-4b + moondream2")["macro_rerun"] is None
    pairs = [values for values in table(report, "oracle").rows if str(cell_value(values[0])).startswith("qwen")]
    mean = row(report, "oracle", "Mean of the pairs")["oracle_rules"]
    assert mean == pytest.approx(fmean(_value(values[5]) for values in pairs))


def test_spreads_vary_one_role_only(report: EvaluationReport) -> None:
    by_pair = {str(cell_value(v[0])): _value(v[1]) for v in table(report, "accuracy").rows}
    values = [by_pair[f"{planner} + moondream2"] for planner in ("qwen3-4b", "qwen3-4b-fp8", "qwen3-30b-a3b")]
    assert row(report, "spread_planner", "moondream2")["spread"] == pytest.approx(max(values) - min(values))
    values = [by_pair[f"qwen3-30b-a3b + {perception}"] for perception in ("moondream2", "moondream3")]
    assert row(report, "spread_eyes", "qwen3-30b-a3b")["spread"] == pytest.approx(max(values) - min(values))


def test_scope_and_comparisons(report: EvaluationReport, evaluations: list[Evaluation]) -> None:
    trials = scored_trials(find_evaluation(evaluations, BEST))
    shown = row(report, "scope", BEST)
    current, full = ([t.headline == "correct" for t in trials if t.task.scope == scope] for scope in ("current", "full"))
    assert shown["difference"] == pytest.approx(fmean(current) - fmean(full))
    other = {t.task.id: t.headline == "correct" for t in scored_trials(find_evaluation(evaluations, "qwen3-4b-fp8 + moondream3"))}
    pairs = [(other[t.task.id], t.headline == "correct") for t in trials if t.task.id in other]
    found = next(v for v in table(report, "comparisons").rows if (v[0], v[1]) == ("qwen3-4b-fp8 + moondream3", BEST))
    cells = dict(zip((c.name for c in table(report, "comparisons").columns), found, strict=True))
    assert cells["tasks"] == len(pairs)
    assert cells["only_first"] == sum(a and not b for a, b in pairs)
    assert cells["only_second"] == sum(b and not a for a, b in pairs)
    adjusted = cells["p_mcnemar_holm"]
    assert isinstance(adjusted, float) and isinstance(cells["p_mcnemar"], float) and adjusted >= cells["p_mcnemar"]


def test_latency_comes_from_the_run_without_contention(report: EvaluationReport, evaluations: list[Evaluation]) -> None:
    latency_run = scored_trials(find_evaluation(evaluations, BEST, split="lite"))
    expected = [t.timings.total_s - t.timings.camera_s - t.timings.render_s for t in latency_run]
    assert row(report, "design_points", BEST)["latency_s"] == pytest.approx(median(expected))
    assert row(report, "design_points", BEST)["contended"] == "alone"
    assert row(report, "latency_stages", BEST)["contended"] == "contended"
    expected = [t.timings.perception_s for t in scored_trials(find_evaluation(evaluations, BEST))]
    assert row(report, "latency_stages", BEST)["perception_s_median"] == pytest.approx(median(expected))
    assert row(report, "latency_planner", "qwen3-4b-fp8")["contended"] == "contended"
    assert row(report, "latency_planner", "qwen3-4b-fp8")["calls"] == pytest.approx(2.0)


def test_repeats_wordings_and_variants(report: EvaluationReport, evaluations: list[Evaluation]) -> None:
    by_task = defaultdict(list)
    for t in scored_trials(find_evaluation(evaluations, "qwen3-4b + moondream2")):
        by_task[t.task.id].append(t.headline == "correct")
    shares = [math.comb(sum(v), 2) / math.comb(len(v), 2) for v in by_task.values() if len(v) >= 2]
    assert row(report, "repeats", "qwen3-4b + moondream2")["pass_2"] == pytest.approx(fmean(shares))
    assert {cell_value(values[0]) for values in table(report, "repeats").rows} == {"qwen3-4b + moondream2"}
    groups = defaultdict(list)
    for t in scored_trials(find_evaluation(evaluations, BEST, split="paraphrase")):
        groups[t.task.paraphrase_of].append(t.headline == "correct")
    originals = {
        t.task.id: t.headline == "correct"
        for split in ("lite", "core")
        for t in scored_trials(find_evaluation(evaluations, BEST, split=split))
    }
    whole = [[*values, originals[origin]] for origin, values in groups.items() if origin in originals]
    assert row(report, "wording", BEST)["all"] == pytest.approx(fmean(all(v) for v in whole))
    assert row(report, "prompts", "qwen3-4b + moondream3, prompt short-1")["second"] == "qwen3-4b + moondream3"
    requests = [t for t in find_evaluation(evaluations, BEST, split="reaction").trials if t.headline != "infrastructure"]
    shown = row(report, "reactions", f"{BEST}, reaction split")
    assert shown["correct"] == pytest.approx(fmean(t.headline == "correct" for t in requests))


def test_costs_conduct_and_audit(report: EvaluationReport, evaluations: list[Evaluation]) -> None:
    trials = find_evaluation(evaluations, BEST).trials
    shown = row(report, "costs", BEST)
    assert shown["cost_usd"] == pytest.approx(sum(t.cost_usd or 0 for t in trials))
    assert shown["input_tokens"] == 3000 * len(trials)
    not_broken = [t for t in trials if t.headline != "infrastructure"]
    assert row(report, "conduct", BEST)["collateral"] == pytest.approx(fmean(t.collateral for t in not_broken))
    by_task = defaultdict(list)
    for pair in ("qwen3-4b + moondream2", "qwen3-4b-fp8 + moondream2", "qwen3-30b-a3b + moondream2", "qwen3-4b + moondream3",
                 "qwen3-4b-fp8 + moondream3", BEST, "qwen3-4b + qwen2.5-vl-7b"):  # fmt: skip
        for t in scored_trials(find_evaluation(evaluations, pair)):
            by_task[t.task.id].append(t.headline == "correct")
    low = {task for task, values in by_task.items() if fmean(values) <= 0.25}
    assert {cell_value(values[0]) for values in table(report, "audit").rows} == low and low


def test_figures_of_the_paper_are_separate_and_labelled(report: EvaluationReport) -> None:
    panel = report.sections[-1]
    assert panel.key == "paper" and "not comparable task by task" in panel.text[0]
    assert len(table(report, "paper_accuracy").rows) == 19
    assert all(t.title.startswith("The paper: ") for t in panel.tables)
    assert not any(t.key.startswith("paper") for section in report.sections[:-1] for t in section.tables)


def test_unmeasured_quantities_are_never_numbers() -> None:
    tasks = facts(2)
    trials = tuple(trial(t, timings=Timings(), tool_calls={}) for t in tasks)
    found = Evaluation(card=card("unknown-planner", "unknown-eyes", sampling={}, seed=None), trials=trials, wanted=len(trials))
    report = build_report([found], load_registry())
    label = "unknown-planner + unknown-eyes"
    shown = row(report, "latency_stages", label)
    assert all(shown[name] is None for name in shown if name.endswith(("_median", "_p95")))
    shown = row(report, "design_points", label)
    assert (shown["latency_s"], shown["memory_gb"], shown["front"]) == (None, None, None)
    shown = row(report, "costs", label)
    assert (shown["input_tokens"], shown["cost_usd"], shown["judge_tokens"]) == (None, None, None)
    shown = row(report, "oracle", label)
    assert (shown["macro_judge"], shown["oracle_judge"], shown["macro_rerun"], shown["perception_rules"]) == (
        None,
        None,
        None,
        None,
    )
    assert cell_text(None, "share") == cell_text(None, "count") == "not measured"
    words = " ".join(line for section in report.sections for line in section.text)
    assert "not measured" in words and "fewer than two model pairs" in words


def test_an_unfinished_run_is_reported_and_an_empty_one_is_refused() -> None:
    whole = evaluation("qwen3-4b", "moondream2", facts(2), 0.6)
    cut = whole.model_copy(update={"trials": whole.trials[:5]})
    assert any("5 of 16 trials" in problem for problem in build_report([cut], load_registry()).problems)
    with pytest.raises(InputError, match="no finished run"):
        build_report([whole.model_copy(update={"trials": ()})], load_registry())


def test_two_logs_of_one_pair_are_distinguished() -> None:
    one, two = (evaluation("qwen3-4b", "moondream2", facts(2), 0.6, seed=seed) for seed in (1, 2))
    report = build_report([one, two], load_registry())
    assert [run.label for run in report.runs] == ["qwen3-4b + moondream2 #1", "qwen3-4b + moondream2 #2"]


def test_labels_contain_only_what_distinguishes_runs() -> None:
    tasks = facts(1)
    shared = evaluation("qwen3-4b", "moondream2", tasks, 0.6, split="lite", latency_s=(9.0, 9.0))
    latency_run = evaluation("qwen3-4b", "moondream2", tasks, 0.6, split="lite", contended=False, latency_s=(1.0, 1.0))
    runs = report_runs([shared, latency_run], load_registry())
    assert {run.label for run in runs} == {"qwen3-4b + moondream2", "qwen3-4b + moondream2, timed alone"}
    assert timing_run(runs[0], runs).evaluation is latency_run
    # An interrupted latency run is not used, because it covers other tasks.
    cut = report_runs([shared, latency_run.model_copy(update={"trials": latency_run.trials[:3]})], load_registry())
    assert timing_run(cut[0], cut).evaluation is shared
    several = report_runs([shared, evaluation("qwen3-4b", "moondream2", tasks, 0.6)], load_registry())
    assert {run.label for run in several} == {"qwen3-4b + moondream2", "qwen3-4b + moondream2, lite split"}


def test_categories_with_one_viewpoint_are_named_with_the_macro_average() -> None:
    # Two categories with tasks of two viewpoints each, one with a single task.
    tasks = [t for t in facts(2) if t.category in ("counting", "ocr")] + [facts(1)[2]]
    report = build_report([evaluation("qwen3-4b", "moondream2", tasks, 0.6, seed=3, broken_share=0.0)], load_registry())
    names = [column.name for column in table(report, "accuracy").columns]
    cells = dict(zip(names, map(cell_value, table(report, "accuracy").rows[0]), strict=True))
    whole, single = cells["macro"], cells["location"]
    assert isinstance(whole, IntervalEstimate) and (whole.single_cluster_strata, whole.low is None) == (("location",), False)
    assert isinstance(single, IntervalEstimate) and single.low is None
    page = render_html(report)
    assert "without location" in page and "interval unknown" in page
    assert "without location" in report.sections[0].text[0]


def test_one_viewpoint_gives_no_interval() -> None:
    tasks = [t.model_copy(update={"scene": "a", "viewpoint": "b"}) for t in facts(2)]
    report = build_report([evaluation("qwen3-4b", "moondream2", tasks, 0.6)], load_registry())
    cell = cell_value(table(report, "accuracy").rows[0][1])
    assert isinstance(cell, IntervalEstimate) and cell.low is None and cell_text(cell, "share").count("to") == 0
