"""Conformance checks for point centring, focus and iris."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from contextlib import AbstractAsyncContextManager
from typing import Any

from scope_ptz.camera.base import Camera
from scope_ptz.camera.conformance_checks import expect, expect_error, middle_pose
from scope_ptz.camera.lens import FOCUS_ACTIONS, IRIS_ACTIONS
from scope_ptz.errors import CameraError, InputError
from scope_ptz.geometry import angle_between_deg, direction

_STEP = 0.1


class LensConformance(ABC):
    """Checks for ``centre_on``, ``lens``, ``set_focus`` and ``set_iris``. ``CameraConformance`` includes them."""

    angle_tolerance_deg: float
    zoom_tolerance: float

    @abstractmethod
    def camera(self) -> AbstractAsyncContextManager[Camera]:
        """Return a context manager that opens a camera and closes it on exit."""

    async def test_a_point_in_the_picture_is_centred(self) -> None:
        async with self.camera() as camera:
            info = camera.info
            pixel_deg = info.optics.hfov_deg(info.limits.min_zoom) / info.frame_width
            for point in ((0.7, 0.35), (0.2, 0.9), (0.5, 0.5)):
                await camera.move(middle_pose(info))
                point_direction = (await camera.frame()).projection.directions(point)
                arrival = await camera.centre_on(*point)
                off_deg = float(angle_between_deg(direction(arrival.pose.pan_deg, arrival.pose.tilt_deg), point_direction))
                expect(off_deg <= 2 * self.angle_tolerance_deg + pixel_deg, f"the point {point} is {off_deg:.2f} degrees off")
                expect(not arrival.clamped, f"centring {point} was reported as clamped: {arrival.clamped}")
                zoom = arrival.pose.zoom / middle_pose(info).zoom
                expect(abs(zoom - 1) <= self.zoom_tolerance, f"centring changed the zoom by a factor of {zoom:.3f}")

    async def test_centring_zooms_by_a_factor(self) -> None:
        async with self.camera() as camera:
            info = camera.info
            before = (await camera.move(middle_pose(info))).pose
            factor = min(1.5, info.optics.focal(info.limits.max_zoom) / info.optics.focal(before.zoom))
            after = (await camera.centre_on(0.4, 0.5, zoom_factor=factor)).pose
            zoomed = info.optics.focal(after.zoom) / info.optics.focal(before.zoom)
            expect(abs(zoomed / factor - 1) <= 2 * self.zoom_tolerance, f"zoomed by {zoomed:.3f} instead of {factor:.3f}")

    async def test_centring_stops_at_limits(self) -> None:
        async with self.camera() as camera:
            await camera.move(middle_pose(camera.info))
            arrival = await camera.centre_on(0.5, 0.5, zoom_factor=1000.0)
            expect(arrival.clamped == ("zoom",), f"clamped should be ('zoom',), not {arrival.clamped}")
            closest = camera.info.limits.max_zoom
            expect(
                abs(arrival.pose.zoom / closest - 1) <= self.zoom_tolerance,
                f"the camera zoomed to {arrival.pose.zoom}, not {closest}",
            )

    async def test_points_outside_the_picture_are_rejected(self) -> None:
        async with self.camera() as camera:
            before = await camera.pose()
            for x, y, factor in ((1.2, 0.5, 1.0), (0.5, -0.1, 1.0), (math.nan, 0.5, 1.0), (0.5, 0.5, 0.0), (0.5, 0.5, math.inf)):
                await expect_error(InputError, camera.centre_on(x, y, zoom_factor=factor))
            after = await camera.pose()
            off_deg = angle_between_deg(direction(before.pan_deg, before.tilt_deg), direction(after.pan_deg, after.tilt_deg))
            expect(float(off_deg) <= self.angle_tolerance_deg, f"a rejected point turned the camera to {after}")

    async def test_focus_actions_match_the_capabilities(self) -> None:
        async with self.camera() as camera:
            offered = camera.info.capabilities.focus
            await _expect_refusals(camera.set_focus, offered, FOCUS_ACTIONS)
            try:
                if "near" in offered:
                    before, nearer = await camera.lens(), await camera.set_focus("near", step=_STEP)
                    farther = await camera.set_focus("far", step=_STEP)
                    expect(nearer.autofocus is not True, "a focus step left autofocus on")
                    if before.focus is not None and nearer.focus is not None and farther.focus is not None:
                        expect(nearer.focus < before.focus, f"'near' moved the focus from {before.focus} to {nearer.focus}")
                        expect(farther.focus > nearer.focus, f"'far' moved the focus from {nearer.focus} to {farther.focus}")
                if "once" in offered:
                    once = await camera.set_focus("once")
                    expect(once.autofocus is False, "one-push focus left autofocus on")
                    later = await camera.lens()
                    expect(later.focus == once.focus, f"after one-push focus, the focus moved from {once.focus} to {later.focus}")
                if "auto" in offered and "manual" in offered:
                    expect((await camera.set_focus("auto")).autofocus is True, "autofocus is not on")
                    expect((await camera.set_focus("manual")).autofocus is False, "autofocus is not off")
            finally:
                if "auto" in offered:
                    await camera.set_focus("auto")

    async def test_iris_actions_match_the_capabilities(self) -> None:
        async with self.camera() as camera:
            offered = camera.info.capabilities.iris
            await _expect_refusals(camera.set_iris, offered, IRIS_ACTIONS)
            try:
                if "open" in offered:
                    before, opened = await camera.lens(), await camera.set_iris("open", step=_STEP)
                    closed = await camera.set_iris("close", step=2 * _STEP)
                    expect(opened.autoiris is not True, "an iris step left the automatic iris on")
                    if before.iris is not None and opened.iris is not None and closed.iris is not None:
                        expect(opened.iris > before.iris, f"'open' moved the iris from {before.iris} to {opened.iris}")
                        expect(closed.iris < before.iris, f"'close' moved the iris from {opened.iris} to {closed.iris}")
                if "auto" in offered and "manual" in offered:
                    expect((await camera.set_iris("manual")).autoiris is False, "the automatic iris is not off")
                    expect((await camera.set_iris("auto")).autoiris is True, "the automatic iris is not on")
            finally:
                if "auto" in offered:
                    await camera.set_iris("auto")

    async def test_lens_raises_without_focus_and_iris(self) -> None:
        async with self.camera() as camera:
            capabilities = camera.info.capabilities
            if not capabilities.focus and not capabilities.iris:
                await expect_error(CameraError, camera.lens())


async def _expect_refusals(set_action: Any, offered: tuple[str, ...], known: tuple[str, ...]) -> None:
    await expect_error(InputError, set_action("sideways"))
    for step in (0.0, -0.1, 1.5, math.nan):
        await expect_error(InputError, set_action(known[-1], step=step))
    for action in set(known) - set(offered):
        await expect_error(CameraError, set_action(action))
