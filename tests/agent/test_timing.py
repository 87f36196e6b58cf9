"""A timed camera passes calls to the wrapped camera and measures their duration."""

from __future__ import annotations

import pytest

from scope_ptz.agent.timing import Stopwatch, TimedCamera
from scope_ptz.camera.guard.wrapper import CameraWrapper
from scope_ptz.camera.lens import DEFAULT_STEP, FocusAction, LensState
from scope_ptz.camera.simulated import SimulatedCamera
from scope_ptz.simulator.pack import Scene


class CameraWithLens(CameraWrapper):
    """A camera that records the commands to its lens."""

    def __init__(self, scene: Scene) -> None:
        super().__init__(SimulatedCamera(scene))
        self.steps: list[tuple[FocusAction, float]] = []

    async def lens(self) -> LensState:
        return LensState(focus=0.5)

    async def set_focus(self, action: FocusAction, *, step: float = DEFAULT_STEP) -> LensState:
        self.steps.append((action, step))
        return await self.lens()


@pytest.mark.anyio
async def test_lens_commands_reach_the_wrapped_camera(analytic_scene: Scene) -> None:
    camera, watch = CameraWithLens(analytic_scene), Stopwatch()
    timed = TimedCamera(camera, watch)
    assert await timed.lens() == LensState(focus=0.5)
    assert await timed.set_focus("near", step=0.2) == LensState(focus=0.5)
    assert camera.steps == [("near", 0.2)]
    assert watch.read().camera_s > 0
