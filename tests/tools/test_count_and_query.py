"""Counting and querying in the current view and the full scene; the sweep and its panorama."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import anyio
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scope_ptz.camera.base import Camera, Frame
from scope_ptz.errors import CameraError, PerceptionError
from scope_ptz.geometry import Limits, Perspective, Pose, direction
from scope_ptz.perception.base import Agreement, Box, Detections
from scope_ptz.tools.context import ToolContext
from scope_ptz.tools.count_objects import CountResult
from scope_ptz.tools.query_answer import AnswerResult
from scope_ptz.tools.registry import run_tool
from scope_ptz.tools.results import Result
from scope_ptz.tools.sweep import plan_sweep, sweep
from tests.support.analytic import HEIGHT, WIDTH, AnalyticCamera, AnalyticPerception, MemoryStore, colour_of, moving_object, solid


class HoldingCamera(AnalyticCamera):
    """A camera whose clock stops while a sweep holds the time."""

    @contextmanager
    def hold_time(self) -> Iterator[None]:
        self.clock.held = True
        yield
        self.clock.held = False


def call(camera: Camera, perception: AnalyticPerception, name: str, **arguments: Any) -> Result:
    return anyio.run(run_tool, ToolContext(camera, perception, MemoryStore()), name, arguments)


def cones() -> AnalyticPerception:
    return AnalyticPerception([solid("cones", pan, -8, (0.6, 0.6, 1), 15) for pan in (-170, -100, -10, 5, 60, 178)])


def test_current_counts_objects_in_view_and_full_counts_everything_once() -> None:
    current = call(HoldingCamera(), cones(), "count_objects", description="cones")
    full = call(HoldingCamera(), cones(), "count_objects", description="cones", view="full")
    assert isinstance(current, CountResult)
    assert isinstance(full, CountResult)
    assert (current.count, full.count) == (2, 6)
    assert len(full.boxes) == 6


def test_a_failed_perception_call_is_an_error_and_never_a_zero() -> None:
    perception = cones()
    perception.fail = True
    with pytest.raises(PerceptionError, match="switched off"):
        call(HoldingCamera(), perception, "count_objects", description="cones")


def test_notes_of_perception_are_part_of_the_result() -> None:
    perception = cones()

    async def detect(frame: Frame, description: str) -> Detections:
        doubt = Agreement(other="vlm", said="7 found", share=0.2)
        boxes = (Box(x_min=0.1, y_min=0.1, x_max=0.2, y_max=0.2),)
        return Detections(
            source="owl", boxes=boxes, complete=False, notes=("The reply was cut off: there may be more.",), agreement=doubt
        )

    perception.detect = detect  # type: ignore[method-assign]
    result = call(HoldingCamera(), perception, "count_objects", description="cones")
    assert isinstance(result, CountResult)
    assert (result.count, result.complete) == (1, False)
    assert result.message.startswith("At least 1 of 'cones'")
    assert "cut off: there may be more." in result.message and "vlm sees it differently: 7 found." in result.message


def test_query_answers_from_the_requested_view() -> None:
    answer = call(HoldingCamera(), cones(), "query_answer", question="how many things?")
    assert isinstance(answer, AnswerResult)
    assert answer.answer == "6 things"
    assert answer.view == "current"


def test_the_panorama_shows_every_direction_at_its_place() -> None:
    frame = anyio.run(sweep, HoldingCamera(start=Pose(33, -4, 3)))
    xs, ys = np.meshgrid((np.arange(frame.width) + 0.5) / frame.width, (np.arange(frame.height) + 0.5) / frame.height)
    exact = colour_of(frame.projection.directions(np.stack([xs, ys], axis=-1))).astype(int)
    difference = np.abs(frame.image.astype(int) - exact)
    assert difference.max() <= 6
    assert difference.mean() < 0.6


def test_a_sweep_takes_one_instant_and_returns_to_the_pose() -> None:
    camera = HoldingCamera(start=Pose(33, -4, 3))
    perception = AnalyticPerception([moving_object("dog", 0, -5, (20, 0))])
    call(camera, perception, "count_objects", description="dog", view="full")
    assert camera.now == Pose(33, -4, 3)
    assert camera.clock.time_s == 0.0


def test_a_sweep_returns_to_the_pose_even_if_a_frame_fails() -> None:
    class Blind(HoldingCamera):
        async def frame(self) -> Frame:
            raise CameraError("no picture")

    camera = Blind(start=Pose(33, -4, 3))
    with pytest.raises(CameraError, match="no picture"):
        anyio.run(sweep, camera)
    assert camera.now == Pose(33, -4, 3)


@settings(max_examples=60, deadline=None)
@given(
    limits=st.builds(
        Limits,
        min_pan_deg=st.floats(-180, -20),
        max_pan_deg=st.floats(20, 180),
        min_tilt_deg=st.floats(-90, -20),
        max_tilt_deg=st.floats(-10, 90),
        pan_endless=st.booleans(),
    )
)
def test_every_panorama_block_is_in_its_frame_and_within_limits(limits: Limits) -> None:
    camera = AnalyticCamera(limits=limits)
    for block in plan_sweep(camera.info):
        assert limits.clamp(block.pose)[1] == ()
        pose = block.pose
        view = Perspective(pose.pan_deg, pose.tilt_deg, camera.info.optics.hfov_deg(pose.zoom), WIDTH, HEIGHT)
        for pan in np.linspace(block.left_pan_deg, block.right_pan_deg, 7):
            for tilt in np.linspace(block.bottom_tilt_deg, block.top_tilt_deg, 7):
                x, y = view.points(direction(pan, tilt))
                assert -0.001 <= x <= 1.001
                assert -0.001 <= y <= 1.001
