"""The rules of a site hold for every command, and frames show nothing that they hide."""

from __future__ import annotations

import json
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scope_ptz.camera.base import Camera
from scope_ptz.camera.conformance import CameraConformance
from scope_ptz.camera.guard.audit import AuditLog
from scope_ptz.camera.guard.guarded_camera import GuardedCamera, KeepOutError
from scope_ptz.camera.guard.masking import mask_frame
from scope_ptz.camera.guard.rules import CameraRules, PixelMask, Region, SoftLimits, nearest_outside
from scope_ptz.errors import ConfigError, OutputError
from scope_ptz.geometry import AXIS_M5075_G, Limits, Perspective, Pose, direction, pan_tilt_deg
from scope_ptz.tools.context import pose_text
from scope_ptz.tools.sweep import sweep
from tests.camera.guard.worlds import HEIGHT, WIDTH, SphereCamera, pixel_points

pytestmark = pytest.mark.anyio
WINDOWS = Region(name="windows", pan_deg=(20.0, 50.0), tilt_deg=(-15.0, 10.0))

angles = st.floats(-180, 180)
regions = st.builds(
    lambda left, width, bottom, height: Region(name="r", pan_deg=(left, left + width), tilt_deg=(bottom, bottom + height)),
    st.floats(-170, 170), st.floats(1, 150), st.floats(-60, 20), st.floats(1, 60),
)  # fmt: skip


class TestConformanceWithoutRules(CameraConformance):
    same_picture_mean_difference = 0.0

    @asynccontextmanager
    async def camera(self) -> AsyncIterator[Camera]:
        yield GuardedCamera(SphereCamera(), CameraRules())


class TestConformanceWithRules(CameraConformance):
    """Within its narrower limits a guarded camera is a camera like any other."""

    same_picture_mean_difference = 0.0

    @asynccontextmanager
    async def camera(self) -> AsyncIterator[Camera]:
        limits = SoftLimits(min_pan_deg=-90, max_pan_deg=90, min_tilt_deg=-40, max_tilt_deg=20, max_zoom=4)
        yield GuardedCamera(SphereCamera(), CameraRules(soft_limits=limits))


@given(regions, angles, st.floats(-60, 30))
def test_the_nearest_permitted_pose_is_permitted(region: Region, pan_deg: float, tilt_deg: float) -> None:
    pose, limits = Pose(pan_deg, tilt_deg, 1.0), Limits()
    outside = nearest_outside(pose, (region,), limits)
    if not region.contains(pan_deg, tilt_deg):
        assert outside == pose
    elif outside is not None:
        assert not region.contains(outside.pan_deg, outside.tilt_deg)
        assert limits.clamp(outside)[1] == ()


@settings(max_examples=50)
@given(regions, angles, st.floats(-60, 30), st.sampled_from([1.0, 2.0, 5.0]))
def test_no_frame_shows_a_pixel_of_a_hidden_region(region: Region, pan_deg: float, tilt_deg: float, zoom: float) -> None:
    from scope_ptz.camera.base import Frame

    hfov_deg = AXIS_M5075_G.hfov_deg(zoom)
    view = Perspective(pan_deg, tilt_deg, hfov_deg, WIDTH, HEIGHT)
    directions = view.directions(pixel_points())
    frame = Frame(np.full((HEIGHT, WIDTH, 3), 200, np.uint8), Pose(pan_deg, tilt_deg, zoom), hfov_deg, 0.0, view)
    shown = mask_frame(frame, (region,), ()).image[..., 0] > 0
    pan, tilt = pan_tilt_deg(directions)
    inside = np.array([region.contains(p, t) for p, t in zip(pan.ravel(), tilt.ravel(), strict=True)]).reshape(pan.shape)
    assert not (shown & inside).any()
    # Nothing far from the region is hidden: a margin of three grid cells is.
    margin = hfov_deg / WIDTH * 16
    if region.width_deg + 2 * margin < 360 and abs(tilt_deg) + hfov_deg / 2 < 75:
        near = Region(
            name="n",
            pan_deg=(region.pan_deg[0] - 4 * margin, region.pan_deg[1] + 4 * margin),
            tilt_deg=(region.tilt_deg[0] - margin, region.tilt_deg[1] + margin),
        )
        outside = ~np.array([near.contains(p, t) for p, t in zip(pan.ravel(), tilt.ravel(), strict=True)]).reshape(pan.shape)
        if near.width_deg > region.width_deg:
            assert shown[outside].all()


async def test_a_move_into_a_keep_out_region_ends_at_its_edge_and_says_so() -> None:
    camera = GuardedCamera(SphereCamera(), CameraRules(keep_out=(WINDOWS,)))
    arrival = await camera.move(Pose(25.0, -5.0, 2.0))
    assert arrival.pose == Pose(20.0, -5.0, 2.0)
    assert arrival.clamped == ("pan",)
    assert "held back by the keep-out region 'windows'" in pose_text(arrival)


async def test_a_region_without_an_edge_within_the_limits_is_refused() -> None:
    everywhere = Region(name="everything", pan_deg=(-180.0, 180.0))
    camera = GuardedCamera(inner := SphereCamera(), CameraRules(keep_out=(everywhere,)))
    with pytest.raises(KeepOutError, match="everything"):
        await camera.move(Pose(25.0, -5.0, 2.0))
    assert inner.moves == 0


async def test_a_preset_inside_a_region_is_left_at_once() -> None:
    camera = GuardedCamera(SphereCamera(), CameraRules(keep_out=(WINDOWS,)))
    arrival = await camera.go_to_preset("gate")
    assert WINDOWS.contains(40.0, -10.0)
    assert not WINDOWS.contains(arrival.pose.pan_deg, arrival.pose.tilt_deg)
    assert arrival.limited_by == "the keep-out region 'windows'"


async def test_frames_and_streams_are_masked() -> None:
    rules = CameraRules(keep_out=(WINDOWS,), masks=(PixelMask(left=0.0, top=0.9, right=1.0, bottom=1.0),))
    camera = GuardedCamera(SphereCamera(), rules)
    await camera.move(Pose(10.0, 0.0, 1.0))
    single = await camera.frame()
    streamed = await anext(camera.frames())
    for frame in (single, streamed):
        assert not frame.image[int(0.9 * HEIGHT) :].any()
        x, y = frame.projection.points(np.array([np.sin(np.radians(30.0)), np.cos(np.radians(30.0)), 0.0]))
        assert not frame.image[int(y * HEIGHT), int(x * WIDTH)].any()
        assert frame.image[HEIGHT // 2, 10].any()
        assert frame.origin is None


async def test_a_drive_never_enters_a_region_or_leaves_the_soft_limits() -> None:
    rules = CameraRules(keep_out=(WINDOWS,), soft_limits=SoftLimits(min_pan_deg=-30.0))
    inner = SphereCamera()
    camera = GuardedCamera(inner, rules)
    for pan_dps in (50.0, -50.0):
        await camera.move(Pose(0.0, -5.0, 1.0))
        for _ in range(60):
            try:
                await camera.drive(pan_dps, timeout_s=0.5)
            except KeepOutError:
                break
            await camera.clock.sleep(0.1)
            pose = await inner.pose()
            assert -30.0 <= pose.pan_deg <= 20.0
        await camera.clock.sleep(5.0)
        pose = await inner.pose()
        assert -30.0 <= pose.pan_deg <= 20.0
        assert abs(pose.pan_deg) > 4.0


async def test_small_turns_are_skipped_and_zooming_is_not() -> None:
    camera = GuardedCamera(inner := SphereCamera(), CameraRules(dead_zone_deg=0.5))
    start = await camera.pose()
    arrival = await camera.move(start.turned(pan_deg=0.3))
    assert arrival.pose == start
    assert "dead zone" in arrival.limited_by
    assert inner.moves == 0
    await camera.move(start.turned(pan_deg=0.3).zoomed(2.0))
    await camera.move((await camera.pose()).turned(pan_deg=1.0))
    assert inner.moves == 2


async def test_moves_keep_their_distance_in_time() -> None:
    camera = GuardedCamera(SphereCamera(), CameraRules(min_interval_s=2.0))
    await camera.move(Pose(10.0, 0.0, 1.0))
    before = camera.clock.now_s()
    await camera.move(Pose(20.0, 0.0, 1.0))
    assert camera.clock.now_s() - before >= 2.0 - 1e-9


async def test_soft_limits_that_leave_nothing_are_refused() -> None:
    with pytest.raises(ConfigError, match="leave no tilt range"):
        GuardedCamera(SphereCamera(), CameraRules(soft_limits=SoftLimits(min_tilt_deg=80.0)))


async def test_the_audit_log_says_who_moved_what(tmp_path: Path) -> None:
    path = tmp_path / "logs" / "audit.jsonl"
    for actor in ("anna", "bob"):
        camera = GuardedCamera(SphereCamera(), CameraRules(keep_out=(WINDOWS,)), AuditLog(path, "yard", actor))
        await camera.move(Pose(25.0, -5.0, 2.0))
        await camera.drive(-5.0)
        await camera.stop()
        await camera.save_preset("spot")
        await camera.close()
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    assert [line["event"] for line in lines] == ["move", "arrived", "drive", "stop", "preset saved"] * 2
    assert {line["actor"] for line in lines} == {"anna", "bob"}
    assert lines[0]["target"]["pan_deg"] == 20.0
    assert lines[0]["requested"]["pan_deg"] == 25.0
    assert path.stat().st_mode & 0o077 == 0


def test_an_audit_log_that_cannot_be_written_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="cannot be written"):
        AuditLog(tmp_path, "yard", "anna")


@pytest.mark.parametrize("fields", [
    {"name": "", "pan_deg": (0, 1)}, {"name": "x", "pan_deg": (3, 3)}, {"name": "x", "pan_deg": (0, 1), "tilt_deg": (5, 5)},
    {"name": "x", "pan_deg": (0, float("nan"))}, {"name": "x", "pan_deg": (0, 1), "tilt": (0, 1)},
])  # fmt: skip
def test_wrong_regions_are_refused(fields: dict[str, object]) -> None:
    with pytest.raises(ValueError, match="validation error"):
        Region.model_validate(fields)


async def test_a_sweep_goes_around_a_keep_out_region_and_never_shows_it() -> None:
    camera = GuardedCamera(SphereCamera(), CameraRules(keep_out=(WINDOWS,)))
    start = await camera.pose()
    panorama = await sweep(camera)
    assert await camera.pose() == start
    for pan_deg, tilt_deg, hidden in ((35.0, 0.0, True), (21.0, -14.0, True), (-90.0, -10.0, False), (120.0, 0.0, False)):
        x, y = panorama.projection.points(direction(pan_deg, tilt_deg))
        pixel = panorama.image[int(y * panorama.height), int(x * panorama.width)]
        assert bool(pixel.any()) is not hidden
