"""``track_object`` keeps a moving target in view and reports correctly for how long."""

from __future__ import annotations

from typing import Any

import anyio
import pytest

from scope_ptz.errors import CameraError
from scope_ptz.geometry import Limits, Pose
from scope_ptz.perception.base import Detections
from scope_ptz.tools.context import ToolContext
from scope_ptz.tools.registry import run_tool
from scope_ptz.tools.track_object import TrackResult
from tests.support.analytic import AnalyticCamera, AnalyticPerception, MemoryStore, StepClock, moving_object, solid


def track(camera: AnalyticCamera, perception: AnalyticPerception, duration_s: float = 10) -> TrackResult:
    arguments = {"description": "van", "duration_s": duration_s}
    result = anyio.run(run_tool, ToolContext(camera, perception, MemoryStore()), "track_object", arguments)
    assert isinstance(result, TrackResult)
    return result


@pytest.mark.parametrize("rate", [(8.0, 0.0), (-12.0, 0.5), (0.0, -2.0), (0.0, 0.0)])
def test_a_drifting_target_is_tracked(rate: tuple[float, float]) -> None:
    camera = AnalyticCamera(start=Pose(0, -5, 1))
    result = track(camera, AnalyticPerception([moving_object("van", 5, -8, rate)]))
    assert result.found
    assert result.held_share == 1.0
    assert camera.clock.now_s() == pytest.approx(10, abs=0.2)
    assert camera.now.pan_deg == pytest.approx(5 + 10 * rate[0], abs=8)
    assert all(point.seen for point in result.path)


def test_the_nearest_of_several_is_tracked() -> None:
    moving, still = moving_object("van", 5, -8, (8, 0)), solid("van", -20, -8, (2, 4, 2), 25)
    camera = AnalyticCamera(start=Pose(0, -5, 1))
    track(camera, AnalyticPerception([moving, still]))
    assert camera.now.pan_deg == pytest.approx(85, abs=8)


def test_a_target_beyond_the_pan_stop_is_reported_as_lost() -> None:
    camera = AnalyticCamera(start=Pose(130, -5, 1), limits=Limits(min_pan_deg=-140, max_pan_deg=140))
    result = track(camera, AnalyticPerception([moving_object("van", 130, -5, (12, 0))]))
    assert result.clamped == ("pan",)
    assert result.held_share < 1.0
    assert "pan limit" in result.message


def test_a_target_that_crosses_the_pan_stop_is_tracked_from_the_other_side() -> None:
    camera = AnalyticCamera(start=Pose(150, -5, 1))
    result = track(camera, AnalyticPerception([moving_object("van", 150, -5, (8, 0))]))
    assert result.held_share > 0.9
    assert camera.now.pan_deg == pytest.approx(-130, abs=8)


def test_tracking_ends_with_an_error_while_scene_time_is_stopped() -> None:
    class StoppedClock(StepClock):
        async def sleep(self, seconds: float) -> None:
            pass

    camera = AnalyticCamera(start=Pose(0, -5, 1), clock=StoppedClock(held=True))
    with pytest.raises(CameraError, match="Scene time is stopped"):
        track(camera, AnalyticPerception([moving_object("van", 5, -8, (8, 0))]))


def test_no_target() -> None:
    camera = AnalyticCamera()
    result = track(camera, AnalyticPerception([]))
    assert (result.found, result.held_share, camera.visited) == (False, 0.0, [])


def test_a_target_that_vanishes_counts_as_lost_time() -> None:
    perception = AnalyticPerception([moving_object("van", 0, -5, (2, 0))])
    detect = perception.detect

    async def half(frame: Any, description: str) -> Detections:
        found = await detect(frame, description)
        return found if frame.time_s < 5 else found.model_copy(update={"boxes": ()})

    perception.detect = half  # type: ignore[method-assign]
    assert track(AnalyticCamera(), perception).held_share == pytest.approx(0.5, abs=0.1)
