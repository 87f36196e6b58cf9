"""Gymnasium's requirements for every environment: spaces, seeds, vectors and registration."""

from __future__ import annotations

import gc
import json
import subprocess
import sys
import weakref
from collections.abc import Callable
from typing import Any

import anyio
import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import scope_ptz.gym as scope_gym
from scope_ptz.errors import InputError, UnknownNameError
from scope_ptz.gym.world import MAX_SCENES, World
from scope_ptz.simulator.pack import Scene, list_scenes, load_scene
from tests.gym.conftest import COUNTING, TURNING, YARD

Make = Callable[..., Any]
TASK, MOVES, SEARCH = "scope_ptz/Task-v0", "scope_ptz/TaskContinuous-v0", "scope_ptz/Search-v0"
SMALL = (160, 90)
VARIANTS: dict[str, tuple[str, dict[str, Any]]] = {
    "tools": (TASK, {"task": COUNTING, "frame_size": SMALL}),
    "tools, noisy": (TASK, {"task": COUNTING, "frame_size": SMALL, "perception": "noisy"}),
    "moves": (MOVES, {"task": TURNING, "frame_size": SMALL}),
    "search": (SEARCH, {"scene": YARD}),
    "search, noisy": (SEARCH, {"scene": YARD, "perception": "noisy"}),
    "search, detections only": (SEARCH, {"scene": YARD, "perception": "ground-truth", "frames": False}),
}


def test_every_environment_is_tested() -> None:
    assert {name for name, _ in VARIANTS.values()} == set(scope_gym.ENVIRONMENTS)


@pytest.mark.usefixtures("shipped", "yard")
@pytest.mark.parametrize("variant", VARIANTS)
def test_check_env(variant: str, make: Make) -> None:
    name, options = VARIANTS[variant]
    check_env(make(name, **options))


@pytest.mark.full
@pytest.mark.parametrize("name", scope_gym.ENVIRONMENTS)
def test_check_env_with_default_options(name: str, make: Make) -> None:
    check_env(make(name))


def rollout(env: Any, seed: int, steps: int = 5) -> list[Any]:
    """Return the observations, rewards and infos of some random actions, with frames as bytes."""
    env.action_space.seed(seed)
    records: list[Any] = [env.reset(seed=seed)]
    for _ in range(steps):
        observation, reward, terminated, truncated, info = env.step(env.action_space.sample())
        records.append((observation, reward, terminated, truncated, info))
        if terminated or truncated:
            records.append(env.reset())
    return [_comparable(record) for record in records]


def _comparable(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.shape, str(value.dtype), value.tobytes()
    if isinstance(value, dict):
        return {name: _comparable(part) for name, part in value.items()}
    return tuple(map(_comparable, value)) if isinstance(value, tuple) else value


@pytest.mark.usefixtures("shipped", "yard")
@pytest.mark.parametrize("variant", VARIANTS)
def test_same_seed_same_rollout(variant: str, make: Make) -> None:
    name, options = VARIANTS[variant]
    one, other = make(name, **options), make(name, **options)
    first = rollout(one, 7)
    assert first == rollout(other, 7) == rollout(one, 7)
    assert first != rollout(other, 8)


@pytest.mark.usefixtures("yard")
def test_a_vector_steps_like_its_environments_and_shares_their_scene(make: Make) -> None:
    options: dict[str, Any] = {"scene": YARD, "perception": "noisy"}
    vector = gymnasium.make_vec(SEARCH, num_envs=2, vectorization_mode="sync", **options)
    singles = [make(SEARCH, **options) for _ in range(2)]
    vector.action_space.seed(1)
    observations, _ = vector.reset(seed=5)
    expected = [single.reset(seed=5 + index)[0] for index, single in enumerate(singles)]
    for _ in range(3):
        assert observations in vector.observation_space
        for index, observation in enumerate(expected):
            assert _comparable(observation["frame"]) == _comparable(observations["frame"][index])
            assert observation["target"] == observations["target"][index]
        actions = vector.action_space.sample()
        actions[:, 3] = -1  # no submission, so no episode ends
        observations, *_ = vector.step(actions)
        expected = [single.step(action)[0] for single, action in zip(singles, actions, strict=True)]
    scenes = {id(env.unwrapped._world.scene) for env in (*vector.envs, *singles)}  # type: ignore[attr-defined]
    assert len(scenes) == 1
    vector.close()


@pytest.mark.full
@pytest.mark.usefixtures("yard")
def test_a_vector_of_processes() -> None:
    vector = gymnasium.make_vec(
        f"scope_ptz.gym:{SEARCH}", num_envs=2, vectorization_mode="async", scene=YARD, vector_kwargs={"context": "spawn"}
    )
    try:
        observations, _ = vector.reset(seed=5)
        assert observations["frame"].shape == (2, 360, 640, 3)
        _, rewards, *_ = vector.step(vector.action_space.sample())
        assert rewards.shape == (2,)
    finally:
        vector.close()


@pytest.mark.usefixtures("yard")
def test_environments_work_inside_an_event_loop_such_as_a_notebook(make: Make) -> None:
    async def in_a_cell() -> None:
        env = make(SEARCH, scene=YARD)
        env.reset(seed=1)
        env.step(scope_gym.move_action(20))

    anyio.run(in_a_cell)


@pytest.mark.usefixtures("yard")
@pytest.mark.parametrize("variant", ["tools", "search"])
def test_the_order_of_calls(variant: str, make: Make) -> None:
    name, options = VARIANTS[variant]
    env = make(name, **options)
    end = scope_gym.finish_action("Done.") if name == TASK else scope_gym.move_action(finish=True)
    with pytest.raises(InputError, match=r"reset\(\)"):
        env.step(end)
    env.reset(seed=1)
    assert env.step(end)[2]
    with pytest.raises(InputError, match=r"reset\(\)"):
        env.step(end)
    env.reset(seed=1)
    env.close()
    env.close()
    env.reset(seed=1)  # a closed environment opens its scene again


def test_wrong_options(make: Make) -> None:
    for options, message in (
        ({"task": "scope1-nowhere-counting-001"}, "There is no task"),
        ({"task": ()}, "No task was given"),
        ({"frame_size": (0, 90)}, "frame_size"),
        ({"frame_size": (160.0, 90)}, "frame_size"),
        ({"max_steps": 0}, "max_steps"),
    ):
        with pytest.raises(InputError, match=message):
            make(TASK, **options)
    with pytest.raises(UnknownNameError, match="reward term"):
        make(TASK, task=COUNTING, reward_weights={"answr": 1.0})
    with pytest.raises(InputError, match="an answer in words"):
        make(MOVES, task=COUNTING)
    with pytest.raises(InputError, match="sees nothing"):
        make(SEARCH, frames=False)
    with pytest.raises(UnknownNameError, match="scene"):
        make(SEARCH, scene="atlantis").reset()


def test_gymnasium_is_needed_by_this_package_only() -> None:
    program = """
import json, sys
import scope_ptz, scope_ptz.contracts, scope_ptz.cli.app
before = "gymnasium" in sys.modules
sys.modules["gymnasium"] = None
try:
    import scope_ptz.gym
except ImportError as error:
    print(json.dumps([before, str(error)]))
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120, check=True)
    loaded, message = json.loads(done.stdout)
    assert not loaded
    assert 'pip install "scope-ptz[gym]"' in message


def test_a_world_keeps_only_its_last_scenes_open(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scope_ptz.gym.world.shared_scene", load_scene)  # scenes that no other test keeps open
    world = World("ground-truth", SMALL, SMALL)
    opened: list[weakref.ref[Scene]] = []
    for name in (*list_scenes(), *list_scenes()):
        opened.append(weakref.ref(world.scene_by_name(name)))
        gc.collect()
        assert opened[-1]() is not None
        assert len({id(scene()) for scene in opened if scene() is not None}) <= MAX_SCENES
    world.close()


@pytest.mark.usefixtures("yard")
def test_the_variations_of_a_scene_share_its_layers() -> None:
    world = World("ground-truth", SMALL, SMALL)
    original, varied, other = (world.scene_by_name(name) for name in (YARD, f"{YARD}-v1", f"{YARD}-v2"))
    assert len({scene.viewpoint("mast") for scene in (original, varied, other)}) == 1
    again = weakref.ref(original)
    del original
    gc.collect()
    assert again() is world.scene_by_name(YARD), "a variation keeps its scene open"
    world.close()


@pytest.mark.usefixtures("yard")
def test_a_world_finds_a_closed_scene_again() -> None:
    world = World("ground-truth", SMALL, SMALL)
    frames = []
    for name in (YARD, f"{YARD}-v1", f"{YARD}-v2", YARD):
        world.open(name, world.scene_by_name(name).file.home_preset, 1.0, 0)
        frames.append(world.picture(world.pose))
    np.testing.assert_array_equal(frames[0], frames[-1])
    world.close()
