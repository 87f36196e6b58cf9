"""Active search: targets, submissions, scores and baselines."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.errors import InputError
from scope_ptz.gym import SearchOutcome, move_action, search_score, success_within
from scope_ptz.gym.baselines import Greedy, RandomActions, RandomLooks, Sweep, run_search
from scope_ptz.gym.search_targets import true_boxes
from scope_ptz.simulator.truth import view_truth
from tests.gym.conftest import YARD

pytestmark = pytest.mark.usefixtures("yard")

Make = Callable[..., Any]
SEARCH = "scope_ptz/Search-v0"
outcomes = st.lists(st.builds(SearchOutcome, st.booleans(), st.integers(1, 30)), min_size=1, max_size=40)


def point_at_target(env: Any) -> Any:
    """The action that points the camera at the target, by the ground truth of the scene."""
    poses = env._targets._poses_by_name()[env.target]
    pose = next(p for p in poses if env._targets._is_suitable(env.target, p))
    now = env._world.pose
    return move_action(pose.pan_deg - now.pan_deg, pose.tilt_deg - now.tilt_deg)


def visible_names(env: Any) -> set[str]:
    world = env._world
    view = world.geometry.view(world.pose)
    return {s.instance.name for s in view_truth(world.scene, world.camera.viewpoint, view, world.time_s).visible}


@pytest.mark.parametrize("seed", range(6))
def test_the_target_is_out_of_view_at_the_start_and_can_be_found(seed: int, make: Make) -> None:
    env = make(SEARCH, scene=YARD)
    observation, info = env.reset(seed=seed)
    assert observation["target"] == info["target"] == env.target
    assert env.target not in visible_names(env)
    for _ in range(3):  # one action turns by at most 180 degrees
        _, reward, terminated, truncated, info = env.step(point_at_target(env))
        assert info["reward_terms"] == {"look": -0.01}
        assert not terminated
        assert not truncated
    assert env.target in visible_names(env)
    _, reward, terminated, truncated, info = env.step(move_action(finish=True))
    assert (reward, terminated, truncated) == (1.0, True, False)
    assert info["reward_terms"] == {"success": 1.0}
    assert info["success"] is True
    assert info["looks"] == 4
    assert info["score"] == pytest.approx(1 - 3 / 30)


def test_a_target_at_the_edge_of_the_view_is_no_success(make: Make) -> None:
    env = make(SEARCH, scene=YARD)
    env.reset(seed=1)
    for _ in range(3):
        env.step(point_at_target(env))
    env.step(move_action(18.0))  # about a quarter of the frame
    assert true_boxes(env._world, env._world.pose, env.target)
    *_, info = env.step(move_action(finish=True))
    assert info["success"] is False
    assert info["score"] == 0.0


def test_a_submission_at_the_start_fails(make: Make) -> None:
    env = make(SEARCH, scene=YARD)
    env.reset(seed=2)
    _, reward, terminated, _, info = env.step(move_action(finish=True))
    assert (reward, terminated, info["success"], info["looks"]) == (0.0, True, False, 1)


def test_looks_are_limited(make: Make) -> None:
    env = make(SEARCH, scene=YARD, max_looks=2)
    env.reset(seed=1)
    assert env.step(move_action(10))[2:4] == (False, False)
    _, reward, terminated, truncated, info = env.step(move_action(10))
    assert (reward, terminated, truncated) == (0, False, True)
    assert info["success"] is False
    assert info["looks"] == 2


def test_the_last_look_can_be_submitted(make: Make) -> None:
    env = make(SEARCH, scene=YARD, max_looks=4)
    env.reset(seed=3)
    for _ in range(3):
        env.step(point_at_target(env))
    *_, info = env.step(move_action(finish=True))
    assert info["success"] is True


def test_detections_are_those_of_perception(make: Make) -> None:
    env = make(SEARCH, scene=YARD, perception="ground-truth")
    observation, _ = env.reset(seed=4)
    assert observation["detection"].tolist() == [0.0] * 5
    for _ in range(3):
        observation, *_ = env.step(point_at_target(env))
    (box, *_) = true_boxes(env._world, env._world.pose, env.target)
    assert observation["detection"] == pytest.approx([1.0, *box.centre, box.width, box.height])


def test_targets_can_be_chosen(make: Make) -> None:
    env = make(SEARCH, scene=YARD, targets=["ball 5"])
    assert env.reset(seed=1)[1]["target"] == "ball 5"
    assert make(SEARCH, scene=YARD).reset(seed=1, options={"target": "ball 5"})[1]["target"] == "ball 5"
    with pytest.raises(InputError, match="no suitable target named unicorn"):
        make(SEARCH, scene=YARD, targets=["unicorn"]).reset(seed=1)


@pytest.mark.full
@pytest.mark.parametrize("policy", [RandomLooks, Sweep, Greedy])
def test_baselines_find_targets_with_perfect_perception(policy: type[Any], make: Make) -> None:
    env = make(SEARCH, scene=YARD, perception="ground-truth", frames=False)
    found = [run_search(env, policy(), seed) for seed in range(6)]
    assert sum(outcome.success for outcome in found) >= 5
    assert found == [run_search(env, policy(), seed) for seed in range(6)]


def test_random_actions_score_lowest(make: Make) -> None:
    env = make(SEARCH, scene=YARD, frames=False, perception="ground-truth")
    found = [run_search(env, RandomActions(), seed) for seed in range(6)]
    assert sum(outcome.success for outcome in found) <= 2


@given(outcomes, st.integers(1, 30))
def test_success_within_looks(searches: list[SearchOutcome], budget: int) -> None:
    curve = success_within(searches, range(1, 31))
    assert curve == sorted(curve)
    assert success_within(searches, [budget]) == [
        sum(s.success for s in searches if not (s.success and s.looks > budget)) / len(searches)
    ]
    area = np.mean(curve)
    assert np.isclose(area, np.mean([search_score(s.success, s.looks, 30) for s in searches]))


def test_no_searches() -> None:
    with pytest.raises(ValueError, match="no searches"):
        success_within([], [1])
