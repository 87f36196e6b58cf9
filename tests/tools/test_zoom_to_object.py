"""``zoom_to_object`` frames a target from any start pose, or reports the limit that prevents it."""

from __future__ import annotations

import anyio
import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from scope_ptz.camera.base import CameraInfo
from scope_ptz.geometry import Perspective, Pose
from scope_ptz.tools.context import ToolContext
from scope_ptz.tools.registry import run_tool
from scope_ptz.tools.zoom_to_object import ZoomResult
from tests.support.analytic import HEIGHT, WIDTH, AnalyticCamera, AnalyticPerception, MemoryStore, Thing, solid


def truth(info: CameraInfo, pose: Pose, thing: Thing) -> tuple[float, float, float]:
    """Return the fill of the limiting side and the offsets of the middle, computed from all points."""
    view = Perspective(pose.pan_deg, pose.tilt_deg, info.optics.hfov_deg(pose.zoom), WIDTH, HEIGHT)
    points = view.points(thing.cloud)
    low, high = points.min(axis=0), points.max(axis=0)
    middle = (low + high) / 2 - 0.5
    return float((high - low).max()), float(middle[0]), float(middle[1])


def zoom(camera: AnalyticCamera, perception: AnalyticPerception, description: str = "van") -> ZoomResult:
    result = anyio.run(run_tool, ToolContext(camera, perception, MemoryStore()), "zoom_to_object", {"description": description})
    assert isinstance(result, ZoomResult)
    return result


@settings(max_examples=60, deadline=None)
@given(
    start=st.builds(Pose, st.floats(-179, 179), st.floats(-60, 30), st.floats(1, 5)),
    place=st.tuples(st.floats(0.02, 0.98), st.floats(0.02, 0.98)),
    size=st.tuples(st.floats(0.3, 12), st.floats(0.3, 12), st.floats(0.3, 4)),
    distance_m=st.floats(9, 80),
    spin_deg=st.floats(0, 180),
)
def test_target_ends_in_the_middle_at_its_size(
    start: Pose, place: tuple[float, float], size: tuple[float, float, float], distance_m: float, spin_deg: float
) -> None:
    camera = AnalyticCamera(start=start)
    view = Perspective(start.pan_deg, start.tilt_deg, camera.info.optics.hfov_deg(start.zoom), WIDTH, HEIGHT)
    towards = view.directions(np.array(place))
    pan, tilt = np.degrees(np.arctan2(towards[0], towards[1])), np.degrees(np.arcsin(towards[2]))
    thing = solid("van", float(pan), float(tilt), size, distance_m, spin_deg)
    perception = AnalyticPerception([thing])
    result = zoom(camera, perception)
    assume(result.found)
    assert len(perception.asked) <= 3
    fill, dx, dy = truth(camera.info, camera.now, thing)
    if not result.limited_by:
        assert abs(dx) <= 0.02
        assert abs(dy) <= 0.02
        assert 0.6 <= fill <= 0.9
    else:
        at_stop = {
            "pan": abs(abs(camera.now.pan_deg) - 179) < 1e-6,
            "tilt": camera.now.tilt_deg in (-60, 30),
            "zoom": camera.now.zoom in (1, 5),
        }
        assert all(at_stop[axis] for axis in result.limited_by)


@given(start=st.builds(Pose, st.floats(-150, 150), st.floats(-55, 25), st.floats(1, 5)))
@settings(max_examples=25, deadline=None)
def test_nothing_found_moves_nothing(start: Pose) -> None:
    camera = AnalyticCamera(start=start)
    result = zoom(camera, AnalyticPerception([]), "unicorn")
    assert not result.found
    assert camera.visited == []
    assert "Nothing" in result.message


def test_of_several_objects_the_first_is_taken_and_the_count_is_reported() -> None:
    camera = AnalyticCamera()
    near, far = solid("van", -12, -5, (2, 5, 2), 20), solid("van", 14, -3, (2, 5, 2), 30)
    result = zoom(camera, AnalyticPerception([near, far]))
    assert result.matches == 2
    assert "2 match" in result.message
    assert abs(camera.now.pan_deg - -12) < 3


def test_a_failed_perception_call_does_not_move_the_camera() -> None:
    camera = AnalyticCamera(start=Pose(10, -5, 1))
    perception = AnalyticPerception([solid("van", 20, -5, (2, 5, 2), 40)])
    detect = perception.detect

    async def once(frame, description):  # type: ignore[no-untyped-def]
        found = await detect(frame, description)
        perception.fail = True
        return found

    perception.detect = once  # type: ignore[method-assign]
    try:
        zoom(camera, perception)
    except Exception as error:
        assert "switched off" in str(error)
        assert camera.now == Pose(10, -5, 1)
    else:
        raise AssertionError("the failure was swallowed")
