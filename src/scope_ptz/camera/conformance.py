"""The conformance suite for the ``Camera`` contract.

With pytest, subclass ``CameraConformance`` and provide the camera; each ``test_`` method is a test::

    @pytest.mark.anyio
    class TestMyCamera(CameraConformance):
        @asynccontextmanager
        async def camera(self):
            yield MyCamera(...)

Without pytest, ``await TestMyCamera().findings()`` runs all checks and returns those that failed.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from contextlib import AbstractAsyncContextManager, aclosing

import anyio
import anyio.lowlevel
import numpy as np

from scope_ptz.camera.base import Arrival, Camera, CameraInfo
from scope_ptz.camera.conformance_checks import expect, expect_error, middle_pose, pan_turn_deg, target_poses
from scope_ptz.camera.conformance_lens import LensConformance
from scope_ptz.camera.control import ControlHeldError
from scope_ptz.errors import CameraError, InputError, UnknownNameError
from scope_ptz.geometry import Perspective, Pose


class CameraConformance(LensConformance, ABC):
    """Checks for the ``Camera`` contract. Increase the tolerances for real motors and encoders."""

    angle_tolerance_deg: float = 0.05
    """Maximum difference in pan or tilt, in degrees."""

    zoom_tolerance: float = 0.02
    """Maximum relative difference in magnification."""

    field_tolerance: float = 0.02
    """Maximum relative difference between a frame's field of view and the zoom table."""
    same_picture_mean_difference: float = 2.0
    """Maximum mean difference (out of 255) between two pictures at the same pose. It allows for noise and moving objects."""
    driving_s: float = 0.5
    """Duration of a drive in seconds on the camera's clock."""
    stopping_s: float = 0.5
    """Maximum time in seconds that the camera takes to stop after a drive."""

    @abstractmethod
    def camera(self) -> AbstractAsyncContextManager[Camera]:
        """Return a context manager that opens a camera and closes it on exit."""

    async def findings(self) -> dict[str, str]:
        """Run all checks and return the failure messages by check name."""
        failed = {}
        for name in sorted(n for n in dir(self) if n.startswith("test_")):
            try:
                await getattr(self, name)()
            except Exception as error:  # any exception in a check is a failure
                failed[name] = f"{type(error).__name__}: {error}"
        return failed

    async def test_info_is_consistent(self) -> None:
        async with self.camera() as camera:
            info = camera.info
            limits = info.limits
            expect(bool(info.name), "the camera's name is empty")
            expect(limits.min_pan_deg < limits.max_pan_deg, "pan limits are not in order")
            expect(limits.min_tilt_deg < limits.max_tilt_deg, "tilt limits are not in order")
            expect(0 < limits.min_zoom <= limits.max_zoom, "zoom limits are not in order")
            expect(info.frame_width > 0 and info.frame_height > 0, "the frame size is not positive")
            expect(info.optics.min_zoom <= limits.min_zoom + 1e-6, "the zoom table does not reach the widest zoom")
            expect(info.optics.max_zoom >= limits.max_zoom - 1e-6, "the zoom table does not reach the closest zoom")

    async def test_starts_within_limits(self) -> None:
        async with self.camera() as camera:
            pose = await camera.pose()
            _, clamped = camera.info.limits.clamp(pose)
            expect(not clamped, f"the camera starts at {pose}, outside its own limits")

    async def test_move_arrives_and_stays(self) -> None:
        async with self.camera() as camera:
            for target in target_poses(camera.info):
                arrival = await camera.move(target)
                self._expect_at(arrival.pose, target, camera.info)
                expect(arrival.clamped == (), f"{target} is within the limits, but {arrival.clamped} was reported as clamped")
                self._expect_at(await camera.pose(), arrival.pose, camera.info)

    async def test_positive_is_right_and_up(self) -> None:
        async with self.camera() as camera:
            start = middle_pose(camera.info)
            arrival = await camera.move(start)
            moved = await camera.move(arrival.pose.turned(pan_deg=6.0, tilt_deg=4.0))
            expect(pan_turn_deg(moved.pose, arrival.pose) > 5.0, "a positive pan did not turn the camera right")
            expect(moved.pose.tilt_deg - arrival.pose.tilt_deg > 3.0, "a positive tilt did not turn the camera up")

    async def test_clamping_is_reported(self) -> None:
        async with self.camera() as camera:
            limits = camera.info.limits
            centre = middle_pose(camera.info)
            await camera.move(centre)
            for target, axis in (
                (Pose(centre.pan_deg, limits.max_tilt_deg + 20, centre.zoom), "tilt"),
                (Pose(centre.pan_deg, limits.min_tilt_deg - 500, centre.zoom), "tilt"),
                (Pose(centre.pan_deg, centre.tilt_deg, limits.max_zoom * 3), "zoom"),
                (Pose(centre.pan_deg, centre.tilt_deg, limits.min_zoom / 3), "zoom"),
            ):
                arrival = await camera.move(target)
                expect(arrival.clamped == (axis,), f"{target}: clamped should be {(axis,)}, not {arrival.clamped}")
                self._expect_at(arrival.pose, limits.clamp(target)[0], camera.info)

    async def test_pan_stops_or_wraps(self) -> None:
        async with self.camera() as camera:
            limits = camera.info.limits
            centre = middle_pose(camera.info)
            for pan_deg in (limits.max_pan_deg + 15, limits.min_pan_deg - 15):
                target = Pose(pan_deg, centre.tilt_deg, centre.zoom)
                arrival = await camera.move(target)
                expected, clamped = limits.clamp(target)
                self._expect_at(arrival.pose, expected, camera.info)
                expect(arrival.clamped == clamped, f"pan {pan_deg}: clamped should be {clamped}, not {arrival.clamped}")

    async def test_frame_geometry_is_consistent(self) -> None:
        async with self.camera() as camera:
            info = camera.info
            for target in target_poses(info):
                arrival = await camera.move(target)
                frame = await camera.frame()
                expect(
                    (frame.width, frame.height) == (info.frame_width, info.frame_height),
                    "the frame size differs from the size in info",
                )
                expect(not frame.image.flags.writeable, "a frame's image must be read-only")
                self._expect_at(frame.pose, arrival.pose, info)
                field = info.optics.hfov_deg(frame.pose.zoom)
                expect(
                    abs(frame.hfov_deg / field - 1) <= self.field_tolerance,
                    f"the field of view is {frame.hfov_deg}, but {field} in the table",
                )
                view = frame.projection
                expect(isinstance(view, Perspective), "a camera's frame must be a perspective view")
                expect(
                    (view.width, view.height) == (frame.width, frame.height),
                    "the projection's size differs from the image's size",
                )
                centre = view.directions((0.5, 0.5))
                aim = Perspective(frame.pose.pan_deg, frame.pose.tilt_deg, 30.0, 10, 10).directions((0.5, 0.5))
                expect(float(centre @ aim) > math.cos(math.radians(0.1)), "the pose does not point at the centre of the frame")

    async def test_one_pose_gives_one_picture(self) -> None:
        async with self.camera() as camera:
            pose, other_pose, *_ = target_poses(camera.info)
            with camera.hold_time():
                await camera.move(pose)
                first = await camera.frame()
                await camera.move(other_pose)
                other = await camera.frame()
                await camera.move(pose)
                repeated = await camera.frame()
            repeat_difference = float(np.abs(first.image.astype(float) - repeated.image).mean())
            move_difference = float(np.abs(first.image.astype(float) - other.image).mean())
            expect(
                repeat_difference <= self.same_picture_mean_difference,
                f"after returning to {pose}, the picture differs by {repeat_difference:.2f} out of 255",
            )
            expect(move_difference > repeat_difference, "a move does not change the picture")

    async def test_presets_are_stable_and_reachable(self) -> None:
        async with self.camera() as camera:
            presets = await camera.presets()
            names = [p.name for p in presets]
            expect(len(set(names)) == len(names), f"two presets share a name: {names}")
            expect(presets == await camera.presets(), "the list of presets changed although no preset was edited")
            for name in names:
                first = await camera.go_to_preset(name)
                await camera.move(middle_pose(camera.info))
                arrival = await camera.go_to_preset(name)
                self._expect_at(arrival.pose, first.pose, camera.info)
                self._expect_at(await camera.pose(), first.pose, camera.info)

    async def test_unknown_preset_is_rejected(self) -> None:
        async with self.camera() as camera:
            before = await camera.pose()
            for name in ("no such preset", "../../etc/passwd", ""):
                try:
                    await camera.go_to_preset(name)
                except UnknownNameError:
                    continue
                raise AssertionError(f"going to the unknown preset {name!r} did not raise UnknownNameError")
            self._expect_at(await camera.pose(), before, camera.info)

    async def test_home_does_not_depend_on_history(self) -> None:
        async with self.camera() as camera:
            home = await camera.go_home()
            for target in target_poses(camera.info):
                await camera.move(target)
                arrival = await camera.go_home()
                self._expect_at(arrival.pose, home.pose, camera.info)

    async def test_home_is_known_before_the_first_move(self) -> None:
        async with self.camera() as camera:
            home = await camera.go_home()
        async with self.camera() as camera:
            await camera.move(target_poses(camera.info)[1])
            self._expect_at((await camera.go_home()).pose, home.pose, camera.info)

    async def test_stop_ends_a_move(self) -> None:
        async with self.camera() as camera:
            start = (await camera.move(target_poses(camera.info)[0])).pose
            target = target_poses(camera.info)[1]
            arrivals: list[Arrival] = []

            async def go() -> None:
                arrivals.append(await camera.move(target))

            async with anyio.create_task_group() as group:
                group.start_soon(go)
                await anyio.lowlevel.checkpoint()
                await camera.stop()
            stopped = await camera.pose()
            self._expect_at(arrivals[0].pose, stopped, camera.info)
            low, high = sorted((start.pan_deg, target.pan_deg))
            expect(low - 1 <= stopped.pan_deg <= high + 1, f"stopped at {stopped}, not between {start} and {target}")
            self._expect_at(await camera.pose(), stopped, camera.info)

    async def test_drive_moves_until_stopped(self) -> None:
        async with self.camera() as camera:
            start = (await camera.move(middle_pose(camera.info))).pose
            top = camera.info.capabilities.top_speed
            if not camera.info.capabilities.drives:
                await expect_error(CameraError, camera.drive(5.0))
                self._expect_at(await camera.pose(), start, camera.info)
                return
            await camera.drive(-top.pan_dps / 4, top.tilt_dps / 8, timeout_s=5.0)
            await camera.clock.sleep(self.driving_s)
            await camera.stop()
            stopped = await camera.pose()
            if top.pan_dps:
                expect(pan_turn_deg(stopped, start) < -1.0, f"after driving left from {start}, the camera is at {stopped}")
            if top.tilt_dps:
                expect(stopped.tilt_deg > start.tilt_deg + 0.5, f"after driving up from {start}, the camera is at {stopped}")
            await camera.clock.sleep(self.driving_s)
            self._expect_at(await camera.pose(), stopped, camera.info)

    async def test_drive_stops_after_its_timeout(self) -> None:
        async with self.camera() as camera:
            top = camera.info.capabilities.top_speed
            if not top.pan_dps:
                return
            start = (await camera.move(middle_pose(camera.info))).pose
            await camera.drive(top.pan_dps / 4, timeout_s=self.driving_s / 2)
            await camera.clock.sleep(self.driving_s / 2 + self.stopping_s)
            ended = await camera.pose()
            expect(pan_turn_deg(ended, start) > 0.5, f"after driving right from {start}, the camera is at {ended}")
            await camera.clock.sleep(self.driving_s)
            self._expect_at(await camera.pose(), ended, camera.info)

    async def test_drive_zooms_and_stays_within_limits(self) -> None:
        async with self.camera() as camera:
            top, limits = camera.info.capabilities.top_speed, camera.info.limits
            if not top.zoom_rate:
                return
            start = (await camera.move(middle_pose(camera.info))).pose
            await camera.drive(zoom_rate=top.zoom_rate * 100, timeout_s=10.0)
            await camera.clock.sleep(math.log2(limits.max_zoom / start.zoom) / top.zoom_rate + self.stopping_s)
            closest = await camera.pose()
            await camera.stop()
            expect(closest.zoom > 1.2 * start.zoom, f"after zooming in from {start}, the camera is at {closest}")
            expect(
                closest.zoom <= limits.max_zoom * (1 + self.zoom_tolerance), f"the camera is at {closest}, beyond its zoom limit"
            )
            self._expect_at(closest, Pose(start.pan_deg, start.tilt_deg, closest.zoom), camera.info)

    async def test_drive_rejects_invalid_values(self) -> None:
        async with self.camera() as camera:
            before = await camera.pose()
            await expect_error(InputError, camera.drive(math.nan))
            await expect_error(InputError, camera.drive(0.0, math.inf))
            for timeout_s in (0.0, -1.0, math.nan, 1e9):
                await expect_error(InputError, camera.drive(5.0, timeout_s=timeout_s))
            self._expect_at(await camera.pose(), before, camera.info)

    async def test_frames_follow_the_camera(self) -> None:
        async with self.camera() as camera:
            first = (await camera.move(target_poses(camera.info)[0])).pose
            second, seen = target_poses(camera.info)[1], []
            async with aclosing(camera.frames()) as stream:
                async for frame in stream:
                    seen.append(frame)
                    if len(seen) == 3:
                        await camera.move(second)
                    if len(seen) > 3 and self._is_at(frame.pose, second, camera.info):
                        break
                    expect(len(seen) < 500, f"the stream does not show {second} after a move to it")
            self._expect_at(seen[0].pose, first, camera.info)
            times = [frame.time_s for frame in seen]
            expect(times == sorted(times), "the frames in a stream go back in time")
            info = camera.info
            expect(
                all((f.width, f.height) == (info.frame_width, info.frame_height) for f in seen),
                "the size of a streamed frame differs from the size in info",
            )
            expect(bool(np.any(seen[0].image != seen[-1].image)), "the stream shows the same picture for two poses")

    async def test_frames_reject_an_invalid_rate(self) -> None:
        async with self.camera() as camera:
            for rate_hz in (0.0, -5.0, math.nan):
                await expect_error(InputError, anext(camera.frames(rate_hz=rate_hz)))

    async def test_presets_can_be_saved_and_removed(self) -> None:
        async with self.camera() as camera:
            before = await camera.presets()
            if not camera.info.capabilities.edits_presets:
                await expect_error(CameraError, camera.save_preset("conformance-check"))
                return
            saved_pose = (await camera.move(target_poses(camera.info)[1])).pose
            await camera.save_preset("conformance-check")
            try:
                names = [preset.name for preset in await camera.presets()]
                expect(sorted(names) == sorted([*(p.name for p in before), "conformance-check"]), f"after saving: {names}")
                await camera.move(middle_pose(camera.info))
                self._expect_at((await camera.go_to_preset("conformance-check")).pose, saved_pose, camera.info)
                other = (await camera.move(middle_pose(camera.info))).pose
                await camera.save_preset("conformance-check")
                await camera.move(saved_pose)
                self._expect_at((await camera.go_to_preset("conformance-check")).pose, other, camera.info)
            finally:
                await camera.remove_preset("conformance-check")
            expect(await camera.presets() == before, "saving and removing a preset changed the others")
            await expect_error(UnknownNameError, camera.remove_preset("conformance-check"))

    async def test_invalid_preset_names_are_rejected(self) -> None:
        async with self.camera() as camera:
            before = await camera.presets()
            for name in ("", "  ", " spaced ", "x" * 300, "two\nlines", "bell\a"):
                await expect_error(InputError, camera.save_preset(name))
            expect(await camera.presets() == before, "a rejected preset changed the list")

    async def test_one_controller_at_a_time(self) -> None:
        async with self.camera() as camera:
            async with camera.control("first operator"):
                try:
                    async with camera.control("second operator"):
                        raise AssertionError("two controllers had control at the same time")
                except ControlHeldError as error:
                    expect("first operator" in str(error), f"the error does not name the holder of control: {error}")
            async with camera.control("second operator"):
                pass

    async def test_clock_advances(self) -> None:
        async with self.camera() as camera:
            before = camera.clock.now_s()
            await camera.clock.sleep(0.05)
            expect(camera.clock.now_s() > before, "sleeping on the camera's clock did not advance its time")
            first, second = await camera.frame(), await camera.frame()
            expect(second.time_s >= first.time_s, "frames go back in time")

    def _expect_at(self, pose: Pose, expected: Pose, info: CameraInfo) -> None:
        expect(self._is_at(pose, expected, info), f"the camera is at {pose}, not at {expected}")

    def _is_at(self, pose: Pose, expected: Pose, info: CameraInfo) -> bool:
        pan_off = abs(pan_turn_deg(pose, expected)) if info.limits.pan_endless else abs(pose.pan_deg - expected.pan_deg)
        return (
            pan_off <= self.angle_tolerance_deg
            and abs(pose.tilt_deg - expected.tilt_deg) <= self.angle_tolerance_deg
            and abs(pose.zoom - expected.zoom) <= self.zoom_tolerance * expected.zoom
        )
