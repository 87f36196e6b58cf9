"""Perception backends in the environments: models get pixels, failures are reported, and the caller's objects stay open."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from scope_ptz.camera.base import Frame
from scope_ptz.errors import InputError, PerceptionError
from scope_ptz.gym import tool_action
from scope_ptz.perception.base import Answer, Box, Caption, Detections, Perception, Points
from tests.gym.conftest import COUNTING, YARD

Make = Callable[..., Any]


class FakeModel(Perception):
    """A fake of a vision model. It reports one box in every frame, remembers the frames, and can be set to fail."""

    name = "fake-model"

    def __init__(self) -> None:
        self.frames: list[Frame] = []
        self.fails = self.closed = False

    async def detect(self, frame: Frame, description: str) -> Detections:
        if self.fails:
            raise PerceptionError("The fake model does not answer.")
        self.frames.append(frame)
        return Detections(boxes=(Box(x_min=0.4, y_min=0.2, x_max=0.6, y_max=0.6),), source=self.name)

    async def caption(self, frame: Frame) -> Caption:
        raise NotImplementedError

    async def query(self, frame: Frame, question: str) -> Answer:
        raise NotImplementedError

    async def point(self, frame: Frame, description: str) -> Points:
        raise NotImplementedError

    async def close(self) -> None:
        self.closed = True


@pytest.mark.usefixtures("yard")
def test_a_model_looks_at_the_frames_of_a_search(make: Make) -> None:
    model = FakeModel()
    env = make("scope_ptz/Search-v0", scene=YARD, perception=model)
    observation, _ = env.reset(seed=1)
    assert observation["detection"] == pytest.approx([1.0, 0.5, 0.4, 0.2, 0.4])
    assert (model.frames[-1].image == observation["frame"]).all()
    assert model.frames[-1].image.any()
    model.fails = True
    with pytest.raises(PerceptionError, match="does not answer"):
        env.reset(seed=2)
    env.close()
    assert not model.closed


@pytest.mark.usefixtures("shipped")
def test_a_model_looks_at_the_frames_of_tools(make: Make) -> None:
    model = FakeModel()
    env = make("scope_ptz/Task-v0", task=COUNTING, perception=model, frame_size=(32, 18))
    env.reset(seed=1)
    observation, *_ = env.step(tool_action("count_objects", description="cars"))
    assert observation["result"] == "1 of 'cars' in the current view (seen by fake-model)."
    assert model.frames[-1].image.shape == (720, 1280, 3)
    assert model.frames[-1].image.any()
    model.fails = True
    observation, _, terminated, _, _ = env.step(tool_action("count_objects", description="cars"))
    assert observation["result"] == "Error: The fake model does not answer."
    assert not terminated


@pytest.mark.usefixtures("yard")
def test_an_unknown_backend(make: Make) -> None:
    with pytest.raises(InputError, match="telepathy"):
        make("scope_ptz/Search-v0", scene=YARD, perception="telepathy").reset(seed=1)
