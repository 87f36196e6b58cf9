"""The conformance suite of the ``Camera`` contract.

With pytest, subclass it and make the camera; every ``test_`` method is a test::

    @pytest.mark.anyio
    class TestMyCamera(CameraConformance):
        @asynccontextmanager
        async def camera(self):
            yield MyCamera(...)

Without pytest, ``await TestMyCamera().findings()`` runs all checks and returns the failures.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from contextlib import AbstractAsyncContextManager

import anyio
import anyio.lowlevel
import numpy as np

from scope_ptz.camera.base import Arrival, Camera, CameraInfo
from scope_ptz.errors import UnknownNameError
from scope_ptz.geometry import Perspective, Pose, wrap_pan_deg


class CameraConformance(ABC):
    """Checks of the ``Camera`` contract. Widen the tolerances for real motors and encoders."""

    angle_tolerance_deg: float = 0.05
    zoom_tolerance: float = 0.02
    field_tolerance: float = 0.02
    """Allowed difference between a frame's field of view and the zoom table, as a share."""
    same_picture_mean_difference: float = 2.0
    """Allowed mean difference (of 255) between two pictures of one pose, for noise and moving things."""

    @abstractmethod
    def camera(self) -> AbstractAsyncContextManager[Camera]:
        """Open a camera and release it afterwards."""

    async def findings(self) -> dict[str, str]:
        """Run all checks and return name and reason of each failure."""
        failed = {}
        for name in sorted(n for n in dir(self) if n.startswith("test_")):
            try:
                await getattr(self, name)()
            except Exception as error:  # a check that breaks in any way has failed
                failed[name] = f"{type(error).__name__}: {error}"
        return failed

    async def test_info_is_consistent(self) -> None:
        async with self.camera() as camera:
            info = camera.info
            limits = info.limits
            _expect(bool(info.name), "the camera has no name")
            _expect(limits.min_pan_deg < limits.max_pan_deg, "pan limits are not in order")
            _expect(limits.min_tilt_deg < limits.max_tilt_deg, "tilt limits are not in order")
            _expect(0 < limits.min_zoom <= limits.max_zoom, "zoom limits are not in order")
            _expect(info.frame_width > 0 and info.frame_height > 0, "frames have no size")
            _expect(info.optics.min_zoom <= limits.min_zoom + 1e-6, "the zoom table does not reach the widest zoom")
            _expect(info.optics.max_zoom >= limits.max_zoom - 1e-6, "the zoom table does not reach the closest zoom")

    async def test_starts_within_limits(self) -> None:
        async with self.camera() as camera:
            pose = await camera.pose()
            _, clamped = camera.info.limits.clamp(pose)
            _expect(not clamped, f"it starts at {pose}, beyond its own limits")

    async def test_move_arrives_and_stays(self) -> None:
        async with self.camera() as camera:
            for wanted in _poses(camera.info):
                arrival = await camera.move(wanted)
                self._expect_at(arrival.pose, wanted, camera.info)
                _expect(arrival.clamped == (), f"{wanted} is within the limits, yet {arrival.clamped} was called clamped")
                self._expect_at(await camera.pose(), arrival.pose, camera.info)

    async def test_positive_is_right_and_up(self) -> None:
        async with self.camera() as camera:
            start = _middle(camera.info)
            arrival = await camera.move(start)
            moved = await camera.move(arrival.pose.turned(pan_deg=6.0, tilt_deg=4.0))
            _expect(_turn(moved.pose, arrival.pose) > 5.0, "a positive pan did not turn right")
            _expect(moved.pose.tilt_deg - arrival.pose.tilt_deg > 3.0, "a positive tilt did not turn up")

    async def test_clamps_and_says_so(self) -> None:
        async with self.camera() as camera:
            limits = camera.info.limits
            middle = _middle(camera.info)
            await camera.move(middle)
            for wanted, axis in (
                (Pose(middle.pan_deg, limits.max_tilt_deg + 20, middle.zoom), "tilt"),
                (Pose(middle.pan_deg, limits.min_tilt_deg - 500, middle.zoom), "tilt"),
                (Pose(middle.pan_deg, middle.tilt_deg, limits.max_zoom * 3), "zoom"),
                (Pose(middle.pan_deg, middle.tilt_deg, limits.min_zoom / 3), "zoom"),
            ):
                arrival = await camera.move(wanted)
                _expect(arrival.clamped == (axis,), f"{wanted}: clamped should be {(axis,)}, is {arrival.clamped}")
                self._expect_at(arrival.pose, limits.clamp(wanted)[0], camera.info)

    async def test_pan_stops_or_wraps(self) -> None:
        async with self.camera() as camera:
            limits = camera.info.limits
            middle = _middle(camera.info)
            for beyond in (limits.max_pan_deg + 15, limits.min_pan_deg - 15):
                wanted = Pose(beyond, middle.tilt_deg, middle.zoom)
                arrival = await camera.move(wanted)
                expected, clamped = limits.clamp(wanted)
                self._expect_at(arrival.pose, expected, camera.info)
                _expect(arrival.clamped == clamped, f"pan {beyond}: clamped should be {clamped}, is {arrival.clamped}")

    async def test_frame_carries_its_geometry(self) -> None:
        async with self.camera() as camera:
            info = camera.info
            for wanted in _poses(info):
                arrival = await camera.move(wanted)
                frame = await camera.frame()
                _expect(
                    (frame.width, frame.height) == (info.frame_width, info.frame_height), "the frame's size is not as announced"
                )
                _expect(not frame.image.flags.writeable, "a frame's image must be read-only")
                self._expect_at(frame.pose, arrival.pose, info)
                field = info.optics.hfov_deg(frame.pose.zoom)
                _expect(abs(frame.hfov_deg / field - 1) <= self.field_tolerance, f"field of view {frame.hfov_deg}, table {field}")
                view = frame.projection
                _expect(isinstance(view, Perspective), "a camera's frame is a perspective view")
                _expect((view.width, view.height) == (frame.width, frame.height), "the projection has another size than the image")
                towards = view.directions((0.5, 0.5))
                aim = Perspective(frame.pose.pan_deg, frame.pose.tilt_deg, 30.0, 10, 10).directions((0.5, 0.5))
                _expect(float(towards @ aim) > math.cos(math.radians(0.1)), "the middle of the frame is not where the pose points")

    async def test_one_pose_gives_one_picture(self) -> None:
        async with self.camera() as camera:
            there, elsewhere, *_ = _poses(camera.info)
            with camera.hold_time():
                await camera.move(there)
                first = await camera.frame()
                await camera.move(elsewhere)
                other = await camera.frame()
                await camera.move(there)
                again = await camera.frame()
            same = float(np.abs(first.image.astype(float) - again.image).mean())
            differs = float(np.abs(first.image.astype(float) - other.image).mean())
            _expect(same <= self.same_picture_mean_difference, f"back at {there} the picture differs by {same:.2f} of 255")
            _expect(differs > same, "a move does not change the picture")

    async def test_presets_are_stable_and_reachable(self) -> None:
        async with self.camera() as camera:
            presets = await camera.presets()
            names = [p.name for p in presets]
            _expect(len(set(names)) == len(names), f"two presets share a name: {names}")
            _expect(presets == await camera.presets(), "the list of presets changes by itself")
            for name in names:
                first = await camera.go_to_preset(name)
                await camera.move(_middle(camera.info))
                again = await camera.go_to_preset(name)
                self._expect_at(again.pose, first.pose, camera.info)
                self._expect_at(await camera.pose(), first.pose, camera.info)

    async def test_unknown_preset_is_refused(self) -> None:
        async with self.camera() as camera:
            before = await camera.pose()
            for name in ("no such preset", "../../etc/passwd", ""):
                try:
                    await camera.go_to_preset(name)
                except UnknownNameError:
                    continue
                raise AssertionError(f"going to the unknown preset {name!r} raised no UnknownNameError")
            self._expect_at(await camera.pose(), before, camera.info)

    async def test_home_does_not_depend_on_history(self) -> None:
        async with self.camera() as camera:
            home = await camera.go_home()
            for wanted in _poses(camera.info):
                await camera.move(wanted)
                back = await camera.go_home()
                self._expect_at(back.pose, home.pose, camera.info)

    async def test_home_is_known_before_the_first_move(self) -> None:
        async with self.camera() as camera:
            home = await camera.go_home()
        async with self.camera() as camera:
            await camera.move(_poses(camera.info)[1])
            self._expect_at((await camera.go_home()).pose, home.pose, camera.info)

    async def test_stop_ends_a_move(self) -> None:
        async with self.camera() as camera:
            start = (await camera.move(_poses(camera.info)[0])).pose
            target = _poses(camera.info)[1]
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
            _expect(low - 1 <= stopped.pan_deg <= high + 1, f"stopped at {stopped}, not between {start} and {target}")
            self._expect_at(await camera.pose(), stopped, camera.info)

    async def test_clock_goes_forward(self) -> None:
        async with self.camera() as camera:
            before = camera.clock.now_s()
            await camera.clock.sleep(0.05)
            _expect(camera.clock.now_s() > before, "sleeping on the camera's clock does not let its time go by")
            first, second = await camera.frame(), await camera.frame()
            _expect(second.time_s >= first.time_s, "frames go back in time")

    def _expect_at(self, pose: Pose, wanted: Pose, info: CameraInfo) -> None:
        pan_off = abs(_turn(pose, wanted)) if info.limits.pan_endless else abs(pose.pan_deg - wanted.pan_deg)
        _expect(
            pan_off <= self.angle_tolerance_deg
            and abs(pose.tilt_deg - wanted.tilt_deg) <= self.angle_tolerance_deg
            and abs(pose.zoom - wanted.zoom) <= self.zoom_tolerance * wanted.zoom,
            f"the camera is at {pose}, it should be at {wanted}",
        )


def _poses(info: CameraInfo) -> list[Pose]:
    """Return four poses well within the limits and far from each other."""
    limits = info.limits
    shares = ((0.5, 0.6, 0.0), (0.8, 0.4, 0.7), (0.2, 0.8, 0.3), (0.55, 0.2, 1.0))
    return [
        Pose(
            limits.min_pan_deg + pan * (limits.max_pan_deg - limits.min_pan_deg),
            limits.min_tilt_deg + tilt * (limits.max_tilt_deg - limits.min_tilt_deg),
            limits.min_zoom + zoom * (limits.max_zoom - limits.min_zoom),
        )
        for pan, tilt, zoom in shares
    ]


def _middle(info: CameraInfo) -> Pose:
    limits = info.limits
    pan, tilt = (limits.min_pan_deg + limits.max_pan_deg) / 2, (limits.min_tilt_deg + limits.max_tilt_deg) / 2
    return Pose(pan, tilt, math.sqrt(limits.min_zoom * limits.max_zoom))


def _turn(pose: Pose, since: Pose) -> float:
    return wrap_pan_deg(pose.pan_deg - since.pan_deg)


def _expect(condition: bool, otherwise: str) -> None:
    if not condition:
        raise AssertionError(otherwise)
