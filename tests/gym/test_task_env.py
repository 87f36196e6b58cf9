"""Episodes of benchmark tasks: rewards and verdicts are those of the benchmark's checks."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import anyio
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from scope_ptz.bench.program_runner import ProgramRunner
from scope_ptz.bench.scoring.checks import CheckResult
from scope_ptz.bench.scoring.verdict import Verdict, score_episode
from scope_ptz.bench.tasks.task import Task
from scope_ptz.errors import InputError, UnknownNameError
from scope_ptz.factory.validation_perception import ground_truth_tools
from scope_ptz.gym import finish_action, move_action, movement_tasks, tool_action
from scope_ptz.gym.rewards import CHECKS, DEFAULT_WEIGHTS, CheckRewards
from scope_ptz.gym.shared_scenes import shared_scene
from scope_ptz.gym.task_choice import select_tasks
from scope_ptz.taskgen.facts.answer_phrasing import correct_answers
from scope_ptz.taskgen.facts.robust import TASK_CAMERA
from tests.gym.conftest import COUNTING, TURNING

pytestmark = pytest.mark.usefixtures("shipped")

Make = Callable[..., Any]
TASK, MOVES = "scope_ptz/Task-v0", "scope_ptz/TaskContinuous-v0"
SMALL = (32, 18)  # too small for the agent's own looks to cover evidence


def run_reference(env: Any, task: Task, answer: str) -> tuple[dict[str, float], dict[str, Any], list[dict[str, Any]]]:
    """Make the calls of a task's reference program, then answer. Return the summed terms, the last info and all infos."""
    _, info = env.reset(seed=1, options={"task": task})
    infos, total = [info], dict[str, float]()
    actions = [tool_action(call.tool, **call.arguments) for call in task.reference]
    outcome = task.behaviour.outcomes[0]
    for action in (*actions, finish_action(answer, outcome)):
        _, reward, terminated, truncated, info = env.step(action)
        assert reward == pytest.approx(sum(info["reward_terms"].values()))
        for name, value in info["reward_terms"].items():
            total[name] = total.get(name, 0.0) + value
        infos.append(info)
    assert terminated
    assert not truncated
    return total, info, infos


def answer_to(task: Task) -> str:
    return next(iter(correct_answers(task.expected)), "Done.") or "Done."


def sample() -> list[Task]:
    """One task of each category in the scene of these tests."""
    tasks = [task for task in select_tasks("core") if task.world == "highway-works" and task.reference]
    return list({task.category: task for task in reversed(tasks)}.values())


@pytest.mark.full
@pytest.mark.parametrize("task", sample(), ids=lambda task: task.id)
def test_a_reference_program_earns_the_verdict_and_every_check(task: Task, make: Make) -> None:
    env = make(TASK, task=task, frame_size=SMALL)
    total, info, infos = run_reference(env, task, answer_to(task))
    assert info["verdict"] == "correct", info["reason"]
    assert total["verdict"] == 1.0
    began_passing = {name for name, state in infos[0]["checks"].items() if state == "passed"}
    gained = {name for name in info["checks"] if name not in began_passing}
    assert {name: value for name, value in total.items() if name != "verdict" and value} == pytest.approx(
        dict.fromkeys(gained, 0.1)
    )


@pytest.mark.parametrize("answer", ["There is 1 worker in a white helmet.", "There are 3 workers in white helmets."])
def test_the_checks_are_those_of_the_benchmark(answer: str, make: Make) -> None:
    (task,) = select_tasks(COUNTING)
    env = make(TASK, task=task, frame_size=SMALL)
    _, info, _ = run_reference(env, task, answer)
    scene = shared_scene(task.world)
    runner = ProgramRunner(scene, ground_truth_tools({task.world: scene}), TASK_CAMERA)
    verdict = score_episode(task, anyio.run(lambda: runner.run(task, task.reference, answer)))
    assert info["verdict"] == verdict.headline
    assert info["checks"] == {check.name: "passed" if check.passed else "failed" for check in verdict.checks}


def test_a_wrong_answer_earns_no_verdict(make: Make) -> None:
    (task,) = select_tasks(COUNTING)
    total, info, _ = run_reference(make(TASK, task=task, frame_size=SMALL), task, "There are 3 workers in white helmets.")
    assert info["verdict"] == "incorrect"
    assert "verdict" not in total
    assert "answer" not in total


def test_an_answer_without_a_look_fails_the_check_of_coverage(make: Make) -> None:
    env = make(TASK, task=COUNTING, frame_size=SMALL)
    env.reset(seed=1)
    *_, info = env.step(finish_action("There is 1 worker in a white helmet."))
    assert info["checks"]["answer"] == "passed"
    assert info["checks"]["coverage"] == "failed"
    assert info["verdict"] == "incorrect"


def test_frames_that_the_agent_sees_count_as_looks(make: Make) -> None:
    """At 1280x720 the frame shows the evidence as well as a tool's frame does."""
    states = []
    for size in (SMALL, (1280, 720)):
        env = make(TASK, task=COUNTING, frame_size=size)
        env.reset(seed=1)
        *_, info = env.step(tool_action("adjust_ptz", zoom_factor=2.5))
        states.append(info["checks"]["coverage"])
    assert states == ["failed", "passed"]


def test_wrong_calls_are_reported_to_the_agent(make: Make) -> None:
    env = make(TASK, task=COUNTING, frame_size=SMALL)
    env.reset(seed=1)
    observation, _, terminated, _, _ = env.step(tool_action("go_to_preset", name="the moon"))
    assert not terminated
    assert observation["result"].startswith("Error: There is no preset 'the moon'")
    observation, *_ = env.step(tool_action("count_objects", description="cones"))
    assert observation["result"].endswith("(seen by ground-truth).")


def test_an_episode_is_truncated_at_the_step_limit(make: Make) -> None:
    env = make(TASK, task=COUNTING, frame_size=SMALL, max_steps=2)
    env.reset(seed=1)
    assert env.step(tool_action("get_presets"))[2:4] == (False, False)
    *_, terminated, truncated, info = env.step(tool_action("get_presets"))
    assert (terminated, truncated) == (False, True)
    assert info["verdict"] == "incorrect"
    assert "step_limit" in info["reason"]


def test_continuous_moves_fulfil_a_task(make: Make) -> None:
    env = make(MOVES, task=TURNING, frame_size=SMALL)
    observation, _ = env.reset(seed=1)
    assert observation["instruction"] == "Please rotate the camera 8 degrees to the right and zoom in by a factor of 3."
    observation, reward, *_ = env.step(move_action(8.0, 0.0, 3.0))
    assert observation["pose"] == pytest.approx([24.0, -18.0, 3.0], abs=1e-3)
    assert reward == pytest.approx(0.1)
    _, reward, _, _, info = env.step(move_action(8.0))
    assert info["reward_terms"] == {"pose": -0.1}
    env.step(move_action(-8.0))
    *_, info = env.step(move_action(finish=True))
    assert info["verdict"] == "correct"
    assert info["reward_terms"] == {"outcome": 0.1, "verdict": 1.0}


def test_movement_tasks_need_only_moves(make: Make) -> None:
    tasks = movement_tasks()
    assert len(tasks) > 40
    assert make(MOVES, task="core").tasks == tasks
    assert all({call.tool for call in task.reference} <= {"adjust_ptz", "zoom_to_object", "get_presets"} for task in tasks), {
        call.tool for task in tasks for call in task.reference
    }


def test_the_seed_determines_the_tasks(make: Make) -> None:
    env = make(TASK, task=[COUNTING, TURNING], frame_size=SMALL)
    drawn = [env.reset(seed=seed)[1]["task"] for seed in range(8)]
    assert set(drawn) == {COUNTING, TURNING}
    assert drawn == [env.reset(seed=seed)[1]["task"] for seed in range(8)]


@pytest.mark.full
def test_the_reference_programs_of_the_lite_split_are_correct(make: Make) -> None:
    env = make(TASK, task="lite", frame_size=SMALL)
    wrong = {}
    for task in env.tasks:
        _, info, _ = run_reference(env, task, answer_to(task))
        if info["verdict"] != "correct":
            wrong[task.id] = info["reason"]
    assert not wrong


results = st.lists(
    st.dictionaries(st.sampled_from(CHECKS), st.sampled_from([True, False, None])).map(
        lambda states: tuple(CheckResult(name, passed, "") for name, passed in states.items())  # type: ignore[arg-type]
    ),
    min_size=2,
    max_size=8,
)


@pytest.mark.full
@given(results)
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_partial_credit_cannot_be_collected_twice(steps: list[tuple[CheckResult, ...]]) -> None:
    rewards = CheckRewards({"pose": 0.5})
    rewards.begin(steps[0])
    total = dict.fromkeys(CHECKS, 0.0)
    for checks in steps[1:]:
        for name, value in rewards.terms(checks).items():
            total[name] += value
    for name in CHECKS:
        weight = 0.5 if name == "pose" else DEFAULT_WEIGHTS[name]
        first, last = (any(c.name == name and c.passed for c in checks) for checks in (steps[0], steps[-1]))
        assert np.isclose(total[name], weight * (last - first))


def test_the_weights_of_rewards() -> None:
    passed = (CheckResult("pose", True, ""),)
    only_verdict = CheckRewards(dict.fromkeys(CHECKS, 0.0))
    only_verdict.begin(())
    assert only_verdict.terms(passed, Verdict("t", "correct", passed, False, "")) == {"verdict": 1.0}
    only_verdict.begin(())
    assert only_verdict.terms(passed, Verdict("t", "unscored", passed, False, "")) == {}
    with pytest.raises(UnknownNameError):
        CheckRewards({"poses": 1.0})
    with pytest.raises(InputError, match="finite"):
        CheckRewards({"pose": float("nan")})


@pytest.mark.full
def test_moves_alone_reach_the_final_pose_of_every_movement_task(make: Make) -> None:
    """The evidence of some tasks must be seen in large frames."""
    large, small = (make(MOVES, frame_size=size) for size in ((1280, 720), (160, 90)))
    wrong = {}
    for task in small.tasks:
        final, env = task.behaviour.final, large if any(view.must_look for view in task.evidence) else small
        observation, _ = env.reset(seed=1, options={"task": task})
        for _ in range(2 if final else 0):  # one action turns by at most 180 degrees
            pan_deg, tilt_deg, zoom = (float(v) for v in observation["pose"])
            observation, *_ = env.step(move_action(final.pan_deg - pan_deg, final.tilt_deg - tilt_deg, final.zoom / zoom))
        *_, info = env.step(move_action(finish=True))
        if final and info["verdict"] != "correct":
            wrong[task.id] = info["reason"]
    assert not wrong
