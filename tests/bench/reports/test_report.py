"""The figures of a report, recomputed from its trials in another way, and claims that a report must not make."""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from statistics import fmean, median

import pytest

from scope_ptz.agent.timing import Timings
from scope_ptz.bench.reports.assemble import EvaluationReport, build_report
from scope_ptz.bench.reports.report_runs import CATEGORY_TITLES, report_runs, timing_run
from scope_ptz.bench.reports.tables import CellValue, MarkedCell, ReportTable, cell_text, unmarked
from scope_ptz.bench.reports.writer import html
from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.bench.scoring.trials import Evaluation, Trial
from scope_ptz.bench.statistics.clustered import IntervalEstimate
from scope_ptz.errors import InputError
from scope_ptz.registry import load_registry
from tests.bench.reports.making import card, evaluation, facts, trial

BEST = "qwen3-30b-a3b + moondream3"
PARTIAL = "qwen3-4b + qwen2.5-vl-7b [24 of the 48 tasks]"
"""A pair over fewer tasks than the others: its label says so."""
LOOKS = {ErrorMode.VLM_COUNTING, ErrorMode.VLM_QUERY}


def table(report: EvaluationReport, key: str) -> ReportTable:
    return next(t for t in report.tables if t.key == key)


def row(report: EvaluationReport, key: str, first: str) -> dict[str, str | int | float | None]:
    """Return a row by its first cell, with estimates as their values."""
    found = table(report, key)
    values = next(r for r in found.rows if unmarked(r[0]) == first)
    plain = {}
    for column, value in zip(found.columns, values, strict=True):
        cell = unmarked(value)
        plain[column.name] = cell.value if isinstance(cell, IntervalEstimate) else cell
    return plain


def log(evaluations: list[Evaluation], pair: str, variant: str = "", split: str = "core") -> Evaluation:
    return next(e for e in evaluations if (e.card.pair, e.card.variant, e.card.split) == (pair, variant, split))


def scored(found: Evaluation) -> list[Trial]:
    return [t for t in found.trials if t.headline != "infrastructure"]


def macro(trials: list[Trial], right: dict[str, bool] | None = None) -> float:
    by_category = defaultdict(list)
    for t in trials:
        by_category[t.task.category].append(t.headline == "correct" if right is None else right[t.sample])
    return fmean(fmean(values) for values in by_category.values())


def test_accuracy_matches_the_trials(report: EvaluationReport, evaluations: list[Evaluation]) -> None:
    for pair in ("qwen3-4b + moondream2", "qwen3-4b-fp8 + moondream3", BEST):
        trials = scored(log(evaluations, pair))
        told = row(report, "accuracy", pair)
        assert told["micro"] == pytest.approx(fmean(t.headline == "correct" for t in trials))
        assert told["macro"] == pytest.approx(macro(trials))
        for category in CATEGORY_TITLES:
            own = [t.headline == "correct" for t in trials if t.task.category == category]
            assert told[category] == pytest.approx(fmean(own))
        assert told["tasks"] == 48


def test_bounds_include_unscored_trials(report: EvaluationReport, evaluations: list[Evaluation]) -> None:
    found = Counter(t.headline for t in log(evaluations, "qwen3-4b + qwen2.5-vl-7b").trials)
    assert found["unscored"] and found["infrastructure"]
    told = row(report, "outcomes", PARTIAL)
    total = sum(found.values())
    assert (told["correct"], told["unscored"], told["infrastructure"]) == (
        found["correct"], found["unscored"], found["infrastructure"],
    )  # fmt: skip
    assert told["share"] == pytest.approx(found["correct"] / (total - found["infrastructure"]))
    assert told["at_least"] == pytest.approx(found["correct"] / total)
    assert told["at_most"] == pytest.approx((total - found["incorrect"]) / total)


def test_only_model_pairs_are_ranked(report: EvaluationReport) -> None:
    apart = {"grammar + ground-truth", "qwen3-30b-a3b + ground-truth", "qwen3-30b-a3b + blind, blind"}
    for key in ("accuracy", "comparisons", "resolution", "design_points", "memory_fits", "quantised", "oracle"):
        cells = {str(unmarked(value)) for values in table(report, key).rows for value in values}
        assert not apart & cells, key
    for key in ("spread_planner", "spread_eyes", "latency_planner", "latency_eyes", "latency_views", "mixtures"):
        words = " ".join(str(unmarked(value)) for values in table(report, key).rows for value in values)
        assert not any(name in words for name in ("grammar", "ground-truth", "blind")), key
    others = table(report, "accuracy_not_ranked")
    assert {unmarked(values[0]) for values in others.rows} == apart
    assert not any(isinstance(v, MarkedCell) and (v.best or v.best_of_all) for values in others.rows for v in values)
    assert any("grammar planner or ground-truth perception" in warning for warning in report.warnings)


def test_the_best_is_marked_among_runs_of_the_same_tasks(report: EvaluationReport) -> None:
    rows = {str(unmarked(values[0])): values for values in table(report, "accuracy").rows}
    names = [column.name for column in table(report, "accuracy").columns]
    at = names.index("macro")
    comparable = [label for label in rows if "lite" not in label and "qwen2.5" not in label]
    best = max(comparable, key=lambda label: _value(rows[label][at]))
    assert [label for label, values in rows.items() if isinstance(values[at], MarkedCell) and values[at].best_of_all] == [best]  # type: ignore[union-attr]
    partial = rows[PARTIAL][at]
    assert isinstance(partial, MarkedCell) and partial.note == "over 4 of 8 categories" and not partial.best
    assert any("different tasks from most pairs" in warning and "qwen2.5-vl-7b" in warning for warning in report.warnings)


def _value(cell: CellValue) -> float:
    plain = unmarked(cell)
    assert isinstance(plain, IntervalEstimate)
    return plain.value


def test_error_modes_are_counted_by_rules_and_by_the_judge(report: EvaluationReport, evaluations: list[Evaluation]) -> None:
    trials = scored(log(evaluations, BEST))
    rules = Counter(t.error_mode for t in trials if t.error_mode)
    told = row(report, "error_modes", BEST)
    assert {mode: told[mode.value] for mode in ErrorMode} == {mode: rules[mode] for mode in ErrorMode}
    assert told["failed"] == sum(t.headline == "incorrect" for t in trials)
    said = [t.judgements[0] for t in trials]
    judged = Counter(j.error_mode for j in said if j.verdict == "incorrect")
    assert row(report, "error_modes_judge", BEST)["reasoning"] == judged[ErrorMode.REASONING]
    told = row(report, "judge", BEST)
    assert told["unparseable"] == sum(j.verdict == "unparseable" for j in said)
    clear = [t for t in trials if t.judgements[0].verdict != "unparseable"]
    right = {t.sample: t.judgements[0].verdict == "correct" for t in clear}
    assert told["macro_judge"] == pytest.approx(macro(clear, right))
    assert told["macro_checks"] == pytest.approx(macro(clear))


def test_the_oracle_setting_both_ways(report: EvaluationReport, evaluations: list[Evaluation]) -> None:
    trials = scored(log(evaluations, BEST))
    told = row(report, "oracle", BEST)
    lifted = {t.sample: t.headline == "correct" or t.error_mode in LOOKS for t in trials}
    assert told["oracle_rules"] == pytest.approx(macro(trials, lifted))
    clear = [t for t in trials if t.judgements[0].verdict != "unparseable"]
    by_judge = {t.sample: t.judgements[0].verdict == "correct" or t.judgements[0].error_mode in LOOKS for t in clear}
    assert told["oracle_judge"] == pytest.approx(macro(clear, by_judge))
    failed = [t.judgements[0].error_mode for t in clear if t.judgements[0].verdict == "incorrect"]
    assert told["perception_judge"] == pytest.approx(fmean(mode in LOOKS for mode in failed))
    again = log(evaluations, "qwen3-30b-a3b + ground-truth")
    assert told["macro_rerun"] == pytest.approx(macro(scored(again)))
    both = {t.task.id: t for t in scored(again)}
    gains = defaultdict(list)
    for t in trials:
        if t.task.id in both:
            gains[t.task.category].append((both[t.task.id].headline == "correct") - (t.headline == "correct"))
    assert told["gain_rerun"] == pytest.approx(fmean(fmean(values) for values in gains.values()))
    assert row(report, "oracle", "qwen3-4b + moondream2")["macro_rerun"] is None
    pairs = [values for values in table(report, "oracle").rows if str(unmarked(values[0])).startswith("qwen")]
    mean = row(report, "oracle", "Mean of the pairs")["oracle_rules"]
    assert mean == pytest.approx(fmean(_value(values[5]) for values in pairs))


def test_spreads_vary_one_role_only(report: EvaluationReport) -> None:
    by_pair = {str(unmarked(v[0])): _value(v[1]) for v in table(report, "accuracy").rows}
    values = [by_pair[f"{planner} + moondream2"] for planner in ("qwen3-4b", "qwen3-4b-fp8", "qwen3-30b-a3b")]
    assert row(report, "spread_planner", "moondream2")["spread"] == pytest.approx(max(values) - min(values))
    values = [by_pair[f"qwen3-30b-a3b + {eyes}"] for eyes in ("moondream2", "moondream3")]
    assert row(report, "spread_eyes", "qwen3-30b-a3b")["spread"] == pytest.approx(max(values) - min(values))


def test_scope_and_comparisons(report: EvaluationReport, evaluations: list[Evaluation]) -> None:
    trials = scored(log(evaluations, BEST))
    told = row(report, "scope", BEST)
    current, full = ([t.headline == "correct" for t in trials if t.task.scope == scope] for scope in ("current", "full"))
    assert told["difference"] == pytest.approx(fmean(current) - fmean(full))
    other = {t.task.id: t.headline == "correct" for t in scored(log(evaluations, "qwen3-4b-fp8 + moondream3"))}
    pairs = [(other[t.task.id], t.headline == "correct") for t in trials if t.task.id in other]
    found = next(v for v in table(report, "comparisons").rows if (v[0], v[1]) == ("qwen3-4b-fp8 + moondream3", BEST))
    cells = dict(zip((c.name for c in table(report, "comparisons").columns), found, strict=True))
    assert cells["tasks"] == len(pairs)
    assert cells["only_first"] == sum(a and not b for a, b in pairs)
    assert cells["only_second"] == sum(b and not a for a, b in pairs)
    adjusted = cells["p_mcnemar_holm"]
    assert isinstance(adjusted, float) and isinstance(cells["p_mcnemar"], float) and adjusted >= cells["p_mcnemar"]


def test_latency_comes_from_the_run_without_contention(report: EvaluationReport, evaluations: list[Evaluation]) -> None:
    alone = scored(log(evaluations, BEST, split="lite"))
    own = [t.timings.total_s - t.timings.camera_s - t.timings.render_s for t in alone]
    assert row(report, "design_points", BEST)["latency_s"] == pytest.approx(median(own))
    assert row(report, "design_points", BEST)["contended"] == "alone"
    assert row(report, "latency_stages", BEST)["contended"] == "contended"
    own = [t.timings.perception_s for t in scored(log(evaluations, BEST))]
    assert row(report, "latency_stages", BEST)["perception_s_median"] == pytest.approx(median(own))
    assert row(report, "latency_planner", "qwen3-4b-fp8")["contended"] == "contended"
    assert row(report, "latency_planner", "qwen3-4b-fp8")["calls"] == pytest.approx(2.0)


def test_repeats_wordings_and_variants(report: EvaluationReport, evaluations: list[Evaluation]) -> None:
    by_task = defaultdict(list)
    for t in scored(log(evaluations, "qwen3-4b + moondream2")):
        by_task[t.task.id].append(t.headline == "correct")
    shares = [math.comb(sum(v), 2) / math.comb(len(v), 2) for v in by_task.values() if len(v) >= 2]
    assert row(report, "repeats", "qwen3-4b + moondream2")["pass_2"] == pytest.approx(fmean(shares))
    assert {unmarked(values[0]) for values in table(report, "repeats").rows} == {"qwen3-4b + moondream2"}
    groups = defaultdict(list)
    for t in scored(log(evaluations, BEST, split="paraphrase")):
        groups[t.task.paraphrase_of].append(t.headline == "correct")
    originals = {
        t.task.id: t.headline == "correct" for split in ("lite", "core") for t in scored(log(evaluations, BEST, split=split))
    }
    whole = [[*values, originals[origin]] for origin, values in groups.items() if origin in originals]
    assert row(report, "wording", BEST)["all"] == pytest.approx(fmean(all(v) for v in whole))
    assert row(report, "prompts", "qwen3-4b + moondream3, prompt short-1")["second"] == "qwen3-4b + moondream3"
    requests = [t for t in log(evaluations, BEST, split="reaction").trials if t.headline != "infrastructure"]
    told = row(report, "reactions", f"{BEST}, reaction split")
    assert told["correct"] == pytest.approx(fmean(t.headline == "correct" for t in requests))


def test_costs_conduct_and_audit(report: EvaluationReport, evaluations: list[Evaluation]) -> None:
    trials = log(evaluations, BEST).trials
    told = row(report, "costs", BEST)
    assert told["cost_usd"] == pytest.approx(sum(t.cost_usd or 0 for t in trials))
    assert told["input_tokens"] == 3000 * len(trials)
    kept = [t for t in trials if t.headline != "infrastructure"]
    assert row(report, "conduct", BEST)["collateral"] == pytest.approx(fmean(t.collateral for t in kept))
    by_task = defaultdict(list)
    for pair in ("qwen3-4b + moondream2", "qwen3-4b-fp8 + moondream2", "qwen3-30b-a3b + moondream2", "qwen3-4b + moondream3",
                 "qwen3-4b-fp8 + moondream3", BEST, "qwen3-4b + qwen2.5-vl-7b"):  # fmt: skip
        for t in scored(log(evaluations, pair)):
            by_task[t.task.id].append(t.headline == "correct")
    low = {task for task, values in by_task.items() if fmean(values) <= 0.25}
    assert {unmarked(values[0]) for values in table(report, "audit").rows} == low and low


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
    made = build_report([found], load_registry())
    label = "unknown-planner + unknown-eyes"
    told = row(made, "latency_stages", label)
    assert all(told[name] is None for name in told if name.endswith(("_median", "_p95")))
    told = row(made, "design_points", label)
    assert (told["latency_s"], told["memory_gb"], told["front"]) == (None, None, None)
    told = row(made, "costs", label)
    assert (told["input_tokens"], told["cost_usd"], told["judge_tokens"]) == (None, None, None)
    told = row(made, "oracle", label)
    assert (told["macro_judge"], told["oracle_judge"], told["macro_rerun"], told["perception_rules"]) == (None, None, None, None)
    assert cell_text(None, "share") == cell_text(None, "count") == "not measured"
    words = " ".join(line for section in made.sections for line in section.text)
    assert "not measured" in words and "fewer than two model pairs" in words


def test_an_unfinished_run_is_reported_and_an_empty_one_is_refused() -> None:
    whole = evaluation("qwen3-4b", "moondream2", facts(2), 0.6)
    cut = whole.model_copy(update={"trials": whole.trials[:5]})
    assert any("5 of 16 trials" in problem for problem in build_report([cut], load_registry()).problems)
    with pytest.raises(InputError, match="no finished run"):
        build_report([whole.model_copy(update={"trials": ()})], load_registry())


def test_two_logs_of_one_pair_are_distinguished() -> None:
    one, two = (evaluation("qwen3-4b", "moondream2", facts(2), 0.6, seed=seed) for seed in (1, 2))
    made = build_report([one, two], load_registry())
    assert [run.label for run in made.runs] == ["qwen3-4b + moondream2 #1", "qwen3-4b + moondream2 #2"]


def test_labels_contain_only_what_distinguishes_runs() -> None:
    tasks = facts(1)
    shared = evaluation("qwen3-4b", "moondream2", tasks, 0.6, split="lite", latency_s=(9.0, 9.0))
    alone = evaluation("qwen3-4b", "moondream2", tasks, 0.6, split="lite", contended=False, latency_s=(1.0, 1.0))
    runs = report_runs([shared, alone], load_registry())
    assert {run.label for run in runs} == {"qwen3-4b + moondream2", "qwen3-4b + moondream2, timed alone"}
    assert timing_run(runs[0], runs).evaluation is alone
    # A latency run that was broken off tells nothing yet: what it holds are other tasks.
    cut = report_runs([shared, alone.model_copy(update={"trials": alone.trials[:3]})], load_registry())
    assert timing_run(cut[0], cut).evaluation is shared
    several = report_runs([shared, evaluation("qwen3-4b", "moondream2", tasks, 0.6)], load_registry())
    assert {run.label for run in several} == {"qwen3-4b + moondream2", "qwen3-4b + moondream2, lite split"}


def test_categories_with_one_viewpoint_are_named_with_the_macro_average() -> None:
    # Two categories with tasks of two viewpoints each, one with a single task.
    tasks = [t for t in facts(2) if t.category in ("counting", "ocr")] + [facts(1)[2]]
    made = build_report([evaluation("qwen3-4b", "moondream2", tasks, 0.6, seed=3, spoiled=0.0)], load_registry())
    names = [column.name for column in table(made, "accuracy").columns]
    cells = dict(zip(names, map(unmarked, table(made, "accuracy").rows[0]), strict=True))
    whole, single = cells["macro"], cells["location"]
    assert isinstance(whole, IntervalEstimate) and (whole.without, whole.low is None) == (("location",), False)
    assert isinstance(single, IntervalEstimate) and single.low is None
    page = html(made)
    assert "without location" in page and "interval unknown" in page
    assert "without location" in made.sections[0].text[0]


def test_one_viewpoint_gives_no_interval() -> None:
    tasks = [t.model_copy(update={"scene": "a", "viewpoint": "b"}) for t in facts(2)]
    made = build_report([evaluation("qwen3-4b", "moondream2", tasks, 0.6)], load_registry())
    cell = unmarked(table(made, "accuracy").rows[0][1])
    assert isinstance(cell, IntervalEstimate) and cell.low is None and cell_text(cell, "share").count("to") == 0
