"""Stages of latency: camera time, which includes rendering, is separate from the time of a planner-perception pair."""

from __future__ import annotations

from statistics import median

import pytest

from scope_ptz.agent.records import Called, RecordedPose
from scope_ptz.agent.timing import PerceptionReply, Timings
from scope_ptz.bench.reports.assemble import EvaluationReport, build_report
from scope_ptz.bench.reports.tables import CellValue, cell_value
from scope_ptz.bench.scoring.trials import Evaluation, ObservationTime, Trial
from scope_ptz.planner.base import ToolCall, ToolOutcome
from scope_ptz.registry import load_registry
from tests.bench.reports.sample_evaluations import card, facts, trial
from tests.bench.reports.test_report import BEST, find_evaluation, row, scored_trials, table

SLOW_RENDERING = Timings(planner_s=1.0, perception_s=0.5, camera_s=0.25, render_s=40.0, total_s=42.0)


def views(report: EvaluationReport, perception: str) -> dict[str, dict[str, CellValue]]:
    """Return the rows of a perception model in the table of views, by view."""
    found = table(report, "latency_views")
    start = next(number for number, name in found.groups.items() if name == perception)
    names = [column.name for column in found.columns]
    return {str(values[0]): dict(zip(names, values, strict=True)) for values in found.rows[start : start + 2]}


def timed_evaluation(planner: str, *trials: Trial) -> Evaluation:
    return Evaluation(card=card(planner, "moondream3", contended=False), trials=trials, wanted=len(trials))


def test_camera_time_is_not_part_of_the_time_of_a_pair() -> None:
    assert (SLOW_RENDERING.capture_s, SLOW_RENDERING.own_s, SLOW_RENDERING.tools_s) == pytest.approx((40.25, 1.75, 0.25))
    # Rendering that overlaps with perception does not make the tools' time negative.
    overlapping = Timings(planner_s=1.0, perception_s=2.0, render_s=1.5, total_s=4.0)
    assert (overlapping.own_s, overlapping.tools_s) == pytest.approx((3.0, 0.0))


def test_perception_time_of_a_call_is_the_sum_of_its_replies() -> None:
    replies = tuple(PerceptionReply(kind="detect", result={}, frame_time_s=0, wall_s=wall_s) for wall_s in (0.02, 0.03))
    outcome = ToolOutcome(call=ToolCall(id="1", name="count_objects", arguments={}), result={})
    pose = RecordedPose(pan_deg=0, tilt_deg=0, zoom=1)
    called = Called(step=1, index=0, outcome=outcome, scene_time_s=0, pose=pose, timings=SLOW_RENDERING, replies=replies)
    assert called.perception_s == pytest.approx(0.05)


def test_rendering_time_affects_neither_latency_nor_ranking() -> None:
    tasks = facts(2)
    quick = Timings(planner_s=1.5, perception_s=0.5, camera_s=0.0, render_s=0.1, total_s=2.2)
    report = build_report(
        [
            timed_evaluation("qwen3-4b", *(trial(t, timings=SLOW_RENDERING) for t in tasks)),
            timed_evaluation("qwen3-30b-a3b", *(trial(t, timings=quick) for t in tasks)),
        ],
        load_registry(),
    )
    # The first pair requested views that are slow to render. It is still the faster and smaller pair, so it dominates the other.
    slow, fast = (row(report, "design_points", f"{planner} + moondream3") for planner in ("qwen3-30b-a3b", "qwen3-4b"))
    assert (fast["latency_s"], slow["latency_s"]) == pytest.approx((1.75, 2.1))
    assert (fast["front"], slow["front"]) == ("yes", "no")
    cells = row(report, "latency_stages", "qwen3-4b + moondream3")
    stages = [cells[f"{stage}_median"] for stage in ("planner_s", "perception_s", "tools_s", "own_s", "capture_s", "total_s")]
    assert stages == pytest.approx([1.0, 0.5, 0.25, 1.75, 40.25, 42.0])
    section_texts = {section.key: " ".join(section.text) for section in report.sections}
    assert "all stages without the camera" in section_texts["latency"] and "without the camera" in section_texts["design"]
    chart = next(chart for section in report.sections for chart in section.charts if chart.key == "chart-front")
    assert "without the camera" in chart.svg and "1.75 s" in chart.alt and "42" not in chart.alt


def test_capture_time_is_separate_from_perception_time(report: EvaluationReport, evaluations: list[Evaluation]) -> None:
    alone = scored_trials(find_evaluation(evaluations, BEST, split="lite"))
    by_view = {view: [call for t in alone for call in t.looks if call.view == view] for view in ("current", "full")}
    found = views(report, "moondream3")
    for title, view in (("Current view", "current"), ("Panorama", "full")):
        cells = found[title]
        assert (cells["looks"], cells["contended"]) == (len(by_view[view]), "alone")
        assert cells["eyes_median"] == pytest.approx(median(call.eyes_s for call in by_view[view]))
        assert cells["capture_median"] == pytest.approx(median(call.capture_s for call in by_view[view]))
        assert cells["call_median"] == pytest.approx(median(call.call_s for call in by_view[view]))
    medians = [median(call.eyes_s for call in by_view[view]) for view in ("full", "current")]
    assert found["Panorama"]["ratio"] == pytest.approx(medians[0] / medians[1])
    perception_cells = row(report, "latency_eyes", "moondream3")
    assert perception_cells["look_median"] == pytest.approx(median(call.eyes_s for t in alone for call in t.looks))
    assert perception_cells["capture_median"] == pytest.approx(0.25)


def test_perception_time_of_a_call_is_at_most_that_of_its_trial() -> None:
    looks = (ObservationTime(view="current", eyes_s=0.02, capture_s=5.3, call_s=5.4),)
    timings = Timings(planner_s=0.1, perception_s=0.02, render_s=5.3, total_s=5.5)
    rows = [trial(t, timings=timings, looks=looks) for t in facts(1)]
    cells = row(build_report([timed_evaluation("qwen3-4b", *rows)], load_registry()), "latency_eyes", "moondream3")
    assert (cells["look_median"], cells["trial_median"], cells["capture_median"]) == pytest.approx((0.02, 0.02, 5.3))


def test_runs_without_perception_calls_have_no_perception_times() -> None:
    report = build_report([timed_evaluation("qwen3-4b", *(trial(t, timings=SLOW_RENDERING) for t in facts(1)))], load_registry())
    cells = row(report, "latency_eyes", "moondream3")
    assert (cells["look_median"], cells["look_p95"], cells["capture_median"], cells["trial_median"]) == (None, None, None, 0.5)
    current = views(report, "moondream3")["Current view"]
    assert current["looks"] == 0
    parts = ("eyes_median", "eyes_p95", "ratio", "capture_median", "capture_p95", "call_median")
    assert [cell_value(current[name]) for name in parts] == [None] * len(parts)


def test_a_report_states_which_part_of_a_hybrid_planner_planned() -> None:
    first, second, *_ = facts(2)
    by_grammar = trial(first, steps=2, planned_by={"grammar": 2}, timings=Timings(planner_s=0.01, total_s=1.0))
    by_both = trial(second, steps=2, planned_by={"model": 2}, timings=Timings(planner_s=3.0, total_s=4.0))
    report = build_report([timed_evaluation("hybrid:qwen3-4b", by_grammar, by_both)], load_registry())
    cells = row(report, "latency_hybrid", "hybrid:qwen3-4b + moondream3")
    assert (cells["grammar_steps"], cells["model_steps"], cells["without_model"]) == (2, 2, 0.5)
    assert (cells["grammar_step_median"], cells["model_step_median"]) == pytest.approx((0.005, 1.5))


def test_other_trials_are_stored_without_the_parts() -> None:
    assert "planned_by" not in trial(facts(1)[0]).model_dump()
    assert all(
        t.key != "latency_hybrid" for t in build_report([timed_evaluation("qwen3-4b", trial(facts(1)[0]))], load_registry()).tables
    )
