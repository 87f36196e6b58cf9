"""Every check, passing and failing, and the resulting verdict."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.bench.scoring.checks import check_pose, framing_of, run_checks
from scope_ptz.bench.scoring.episode import CameraPosition, Episode, SavedPicture
from scope_ptz.bench.scoring.required_calls import missing_in_any_order, missing_in_order
from scope_ptz.bench.scoring.verdict import score_episode
from scope_ptz.bench.tasks.expected import ActionOnly, Number
from scope_ptz.bench.tasks.task import Argument, Behaviour, Forbidden, Framing, RequiredCall, Task
from scope_ptz.errors import ScopeError
from scope_ptz.geometry import Pose, pan_tilt_deg
from tests.bench.sample_runs import (
    AT_HIGHWAY,
    FRAME,
    GO_HIGHWAY,
    START,
    Step,
    count_step,
    final,
    play,
    query_step,
    samples,
    task,
    view,
)

SAMPLES = samples()
COUNT_TASK, COUNT_RUN = SAMPLES[0]
SWEEP_TASK, _ = SAMPLES[1]


def outcome_of(name: str, checked_task: Task, episode: Episode) -> bool | None:
    return next(check.passed for check in run_checks(checked_task, episode) if check.name == name)


def action(behaviour: Behaviour, **extra: Any) -> Task:
    return task(900, "single_call", ActionOnly(), [], behaviour=behaviour, **extra)


@pytest.mark.parametrize(("checked_task", "episode"), SAMPLES, ids=[t.id for t, _ in SAMPLES])
def test_every_sample_passes_and_an_empty_run_fails(checked_task: Task, episode: Episode) -> None:
    assert score_episode(checked_task, episode).headline == "correct"
    idle = play([], episode.answer)
    assert score_episode(checked_task, idle).headline == "incorrect"
    assert score_episode(checked_task, play([], "I did nothing.")).headline != "correct"


@pytest.mark.parametrize("text", ["none", "0", "yes", "no", "5", "red"])
@pytest.mark.parametrize("checked_task", [t for t, _ in SAMPLES], ids=[t.id for t, _ in SAMPLES])
def test_no_answer_passes_without_an_observation(checked_task: Task, text: str) -> None:
    assert score_episode(checked_task, play([], text)).headline != "correct"


@pytest.mark.parametrize(
    ("text", "passed"),
    [("5 cones", True), ("four cones", False), ("several cones", None), ("I cannot tell.", False), ("", None)],
)
def test_the_answer_check(text: str, passed: bool | None) -> None:
    episode = replace(COUNT_RUN, answer=text)
    assert outcome_of("answer", COUNT_TASK, episode) is passed
    headline = {True: "correct", False: "incorrect", None: "unscored"}[passed]
    assert score_episode(COUNT_TASK, episode).headline == headline


def test_a_missing_answer_is_incorrect() -> None:
    for outcome in ("step_limit", "budget"):
        assert score_episode(COUNT_TASK, replace(COUNT_RUN, outcome=outcome)).headline == "incorrect"
    assert score_episode(COUNT_TASK, replace(COUNT_RUN, outcome="clarification", answer="Which cones?")).headline == "incorrect"


@pytest.mark.parametrize(
    ("steps", "passed"),
    [
        ([GO_HIGHWAY, count_step(5)], True),
        ([count_step(5), GO_HIGHWAY], False),
        ([GO_HIGHWAY, query_step("5", "How many cones are there?")], True),
        ([GO_HIGHWAY, count_step(5, "clouds")], False),
        ([GO_HIGHWAY, ("count_objects", {"description": "cones"}, {"error": "the server is down", "fault": "perception"})], False),
        ([count_step(5, view="full"), GO_HIGHWAY], True),
        ([GO_HIGHWAY, ("adjust_ptz", {"zoom_factor": 2.0}), count_step(5), ("adjust_ptz", {"zoom_factor": 0.5})], False),
    ],
)
def test_the_coverage_check(steps: list[Step], passed: bool) -> None:
    assert outcome_of("coverage", COUNT_TASK, play(steps, "5")) is passed


@pytest.mark.parametrize(
    ("pan", "tilt", "zoom", "viewpoint", "passed"),
    [
        (0.0, 0.0, 1.0, "mast", True),
        (0.5, -0.5, 1.03, "mast", True),
        (0.51, 0.0, 1.0, "mast", False),
        (0.0, 0.51, 1.0, "mast", False),
        (0.0, 0.0, 1.031, "mast", False),
        (0.0, 0.0, 0.96, "mast", False),
        (360.0, 0.0, 1.0, "mast", True),
        (0.0, 0.0, 1.0, "bridge", False),
    ],
)
def test_the_pose_check(pan: float, tilt: float, zoom: float, viewpoint: str, passed: bool) -> None:
    expected = action(Behaviour(final=final(AT_HIGHWAY)))
    pose = AT_HIGHWAY.pose
    end = CameraPosition(viewpoint, Pose(pose.pan_deg + pan, pose.tilt_deg + tilt, pose.zoom * zoom))
    result = check_pose(expected, replace(COUNT_RUN, final=end))
    assert result is not None
    assert result.passed is passed


HIGHWAY = RequiredCall(tool="go_to_preset", arguments={"name": Argument(equals="highway")})
PICTURE = RequiredCall(tool="take_image")
CONES = RequiredCall(
    tool="count_objects", arguments={"description": Argument(mentions=("cone",)), "view": Argument(equals="current")}
)


def steps_right(times: int) -> RequiredCall:
    return RequiredCall(tool="adjust_ptz", arguments={"pan_deg": Argument(equals=15.0, within=0.1)}, times=times)


RIGHT: Step = ("adjust_ptz", {"pan_deg": 15.0})
TAKE: Step = ("take_image", {})


@pytest.mark.parametrize(
    ("required", "steps", "ordered", "any_order"),
    [
        ([HIGHWAY, PICTURE], [GO_HIGHWAY, TAKE], True, True),
        ([HIGHWAY, PICTURE], [TAKE, GO_HIGHWAY], False, True),
        ([HIGHWAY, PICTURE], [GO_HIGHWAY, count_step(1), TAKE], True, True),
        ([HIGHWAY, PICTURE], [GO_HIGHWAY], False, False),
        ([HIGHWAY], [("go_to_preset", {"name": "gate"})], False, False),
        ([HIGHWAY], [("go_to_preset", {"name": "highway"}, {"error": "no"})], False, False),
        ([CONES], [count_step(3, "traffic cones")], True, True),
        ([CONES], [count_step(3, "traffic cones", "full")], False, False),
        ([CONES], [("count_objects", {"description": "cone"}, {"count": 3})], True, True),
        ([steps_right(2)], [RIGHT, RIGHT], True, True),
        ([steps_right(2)], [RIGHT], False, False),
        ([steps_right(1)], [("adjust_ptz", {"pan_deg": -15.0})], False, False),
        ([PICTURE, HIGHWAY, PICTURE], [TAKE, GO_HIGHWAY, TAKE], True, True),
        ([PICTURE, HIGHWAY, PICTURE], [GO_HIGHWAY, TAKE, TAKE], False, True),
    ],
)
def test_required_calls(required: list[RequiredCall], steps: list[Step], ordered: bool, any_order: bool) -> None:
    calls = play(steps, "").calls
    assert (missing_in_order(required, calls) is None) is ordered
    assert (missing_in_any_order(required, calls) is None) is any_order


def test_zoom_percent_matches_its_factor_and_calls_are_matched_in_any_order() -> None:
    twice = RequiredCall(tool="adjust_ptz", arguments={"zoom_factor": Argument(equals=2.0, within=0.01)})
    assert missing_in_order([twice], play([("adjust_ptz", {"zoom_percent": 100.0})], "").calls) is None
    any_count, cones = RequiredCall(tool="count_objects"), CONES
    assert missing_in_any_order([any_count, cones], play([count_step(1, "cones"), count_step(2, "cars")], "").calls) is None


def test_forbidden_calls() -> None:
    still = action(Behaviour(forbidden=Forbidden(tools=("adjust_ptz",), changes=("zoom", "pan"))))
    assert outcome_of("forbidden", still, play([count_step(2)], "")) is True
    assert outcome_of("forbidden", still, play([("adjust_ptz", {"pan_deg": 1.0}), ("adjust_ptz", {"pan_deg": -1.0})], "")) is False
    zoomed = play(
        [("zoom_to_object", {"description": "van"}, {"found": True, "pose": {"pan_deg": 10, "tilt_deg": -10, "zoom": 3}})], ""
    )
    assert outcome_of("forbidden", still, zoomed) is False
    failed: Step = ("adjust_ptz", {"pan_deg": 900.0}, {"error": "wrong"})
    assert outcome_of("forbidden", still, play([failed], "")) is True


def test_the_expected_number_of_pictures_must_exist() -> None:
    two = action(Behaviour(pictures=2))
    assert outcome_of("pictures", two, play([TAKE, TAKE], "")) is True
    assert outcome_of("pictures", two, play([TAKE], "")) is False
    assert outcome_of("pictures", two, play([TAKE, TAKE, TAKE], "")) is False
    missing_picture = replace(play([TAKE, TAKE], ""), pictures=(SavedPicture("a.png", True), SavedPicture("b.png", False)))
    assert outcome_of("pictures", two, missing_picture) is False
    unverified = replace(missing_picture, pictures=(SavedPicture("a.png"), SavedPicture("b.png")))
    assert outcome_of("pictures", two, unverified) is True


@given(st.floats(-170, 170), st.floats(-50, 20), st.floats(0.55, 0.95), st.floats(-0.03, 0.03))
def test_framing_measures_fill_and_offset(pan: float, tilt: float, fill: float, off: float) -> None:
    frame = FRAME.view(Pose(pan, tilt, 3.0))
    low, high = 0.5 - fill / 2, 0.5 + fill / 2
    corners = frame.directions([[low + off, 0.4], [high + off, 0.4], [high + off, 0.6], [low + off, 0.6]])
    pans, tilts = pan_tilt_deg(corners)
    outline = tuple((float(p), float(t)) for p, t in zip(pans, tilts, strict=True))
    episode = replace(COUNT_RUN, final=CameraPosition("mast", Pose(pan, tilt, 3.0)))
    measured, offset = framing_of(outline, episode)
    assert measured == pytest.approx(fill, abs=1e-3)
    assert offset == pytest.approx(abs(off), abs=1e-3)
    framing_task = action(Behaviour(framing=Framing(instance="x", viewpoint="mast", outline_deg=outline)))
    if not (abs(fill - 0.6) < 1e-3 or abs(fill - 0.9) < 1e-3 or abs(abs(off) - 0.02) < 1e-3):
        assert outcome_of("framing", framing_task, episode) is (0.6 <= fill <= 0.9 and abs(off) <= 0.02)
    assert outcome_of("framing", framing_task, replace(episode, final=CameraPosition("bridge", Pose(pan, tilt, 3.0)))) is False
    assert outcome_of("framing", framing_task, replace(episode, final=CameraPosition("mast", Pose(pan + 180, -tilt, 3.0)))) is False


def test_the_right_calls_with_a_wrong_answer_and_the_right_answer_at_a_wrong_pose_both_fail() -> None:
    assert score_episode(COUNT_TASK, replace(COUNT_RUN, answer="6")).headline == "incorrect"
    wrong_pose = play([GO_HIGHWAY, count_step(5), ("adjust_ptz", {"pan_deg": 3.0})], "There are 5 cones.")
    assert [c.name for c in score_episode(COUNT_TASK, wrong_pose).checks if not c.passed] == ["pose"]


@pytest.mark.parametrize(
    ("changes", "headline"),
    [
        ({"outcome": None}, "infrastructure"),
        ({"outcome": "camera_error"}, "infrastructure"),
        ({"outcome": "cancelled"}, "infrastructure"),
        ({"outcome": "planner_error", "failure": "total-timeout"}, "infrastructure"),
        ({"outcome": "planner_error", "failure": "empty"}, "incorrect"),
        ({"outcome": "planner_error", "failure": None}, "incorrect"),
        ({"outcome": "step_limit"}, "incorrect"),
        ({"outcome": "budget"}, "incorrect"),
    ],
)
def test_infrastructure_failures_are_a_separate_outcome(changes: dict[str, Any], headline: str) -> None:
    assert score_episode(COUNT_TASK, replace(COUNT_RUN, **changes)).headline == headline


def test_failed_perception_is_infrastructure_unless_the_agent_claims_an_observation() -> None:
    failed_perception: list[Step] = [
        GO_HIGHWAY,
        ("count_objects", {"description": "cones"}, {"error": "timeout", "fault": "perception"}),
    ]
    assert score_episode(COUNT_TASK, play(failed_perception, "I could not see: perception failed.")).headline == "infrastructure"
    assert score_episode(COUNT_TASK, play(failed_perception, "There are 5 cones.")).headline == "incorrect"
    assert score_episode(COUNT_TASK, play([*failed_perception, count_step(5)], "There are 5 cones.")).headline == "correct"


def test_a_reaction_is_judged_by_the_outcome() -> None:
    refusal = action(
        Behaviour(outcomes=("refused", "clarification"), forbidden=Forbidden(changes=("pan", "tilt"))), stratum="reaction"
    )
    assert score_episode(refusal, play([], "There is no such preset.", outcome="refused")).headline == "correct"
    assert score_episode(refusal, play([], "Done.", outcome="answered")).headline == "incorrect"
    assert score_episode(refusal, play([GO_HIGHWAY], "No.", outcome="refused")).headline == "incorrect"


def test_a_task_without_checks_is_an_error() -> None:
    empty = COUNT_TASK.model_copy(update={"expected": ActionOnly(), "behaviour": Behaviour(), "evidence": ()})
    with pytest.raises(ScopeError, match="no check"):
        score_episode(empty, COUNT_RUN)


def test_collateral_changes_are_reported_but_do_not_affect_the_verdict() -> None:
    count_here = task(901, "counting", Number(value=2, unit=("cone",)), [count_step(2)], evidence=[view(START)])
    assert not score_episode(count_here, play([count_step(2)], "2")).moved_needlessly
    with_a_move = score_episode(count_here, play([count_step(2), ("adjust_ptz", {"pan_deg": 30.0})], "2"))
    assert (with_a_move.headline, with_a_move.moved_needlessly) == ("correct", True)
    assert not score_episode(COUNT_TASK, COUNT_RUN).moved_needlessly
