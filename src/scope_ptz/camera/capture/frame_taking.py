"""Take the frames of a capture: presets, sweeps, and close-ups of areas with fine detail."""

from __future__ import annotations

from collections.abc import AsyncIterator, Awaitable, Callable, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from functools import partial

import anyio
from anyio import to_thread

from scope_ptz.camera.base import Arrival, Camera
from scope_ptz.camera.capture.close_ups import choose_close_ups
from scope_ptz.camera.capture.plan import OVERLAP, Ranges, plan_poses, without_repeats
from scope_ptz.camera.capture.session import CaptureSession, CaptureSettings
from scope_ptz.camera.control import ControlHeldError
from scope_ptz.camera.guard.guarded_camera import GuardedCamera, KeepOutError
from scope_ptz.camera.guard.mounted_camera import MountedCamera
from scope_ptz.camera.guard.rules import CameraRules
from scope_ptz.camera.guard.wrapper import layers
from scope_ptz.errors import CameraError, InputError, UnknownNameError
from scope_ptz.geometry import Limits, Pose

CLOSE_UP_ZOOM = 4.0
"""Magnification of close-ups. If the camera's maximum magnification is lower, that is used instead."""

CLOSE_UPS = 40
"""Default maximum number of close-ups."""

RETURN_S = 30.0
"""Seconds allowed for returning the camera to its original pose after a failed or cancelled capture."""

ATTEMPTS, RETRY_S = 3, 2.0
"""Maximum number of attempts to take a picture when the camera fails, and seconds between attempts."""

HOME = "home"
"""Key of the frame at the camera's home position."""

Progress = Callable[[str, int, int], None]
"""A function that is called with the name of a phase, its number of finished steps, and its total number of steps."""


@dataclass(frozen=True, slots=True)
class CaptureOptions:
    """The options of a capture.

    Attributes:
        ranges: The part of the camera's range to capture.
        zooms: Magnifications at which the whole range is captured, in addition to the widest one.
        close_ups: Maximum number of close-ups of areas with fine detail.
        overlap: Fraction of a frame that the next one also shows.
    """

    ranges: Ranges = field(default_factory=Ranges)
    zooms: tuple[float, ...] = ()
    close_ups: int = CLOSE_UPS
    overlap: float = OVERLAP


def settings_of(camera: Camera, options: CaptureOptions) -> CaptureSettings:
    """Return the settings of a capture.

    Raises:
        InputError: A range, zoom or number is invalid, or the camera's field of view is unknown.
    """
    info = camera.info
    if "field of view" in info.assumed:
        raise InputError(
            f"The field of view of {info.name} is unknown, so its pictures cannot be stitched. Measure it with "
            "`scope camera calibrate`, or give it in the spec: ?hfov_wide=...&hfov_tele=..."
        )
    limits = options.ranges.within(info.limits)
    for zoom in options.zooms:
        if not limits.min_zoom < zoom <= limits.max_zoom:
            raise InputError(
                f"A zoom to capture must be above {limits.min_zoom:g} and at most {limits.max_zoom:g}; got {zoom:g}. "
                f"The widest zoom is always captured."
            )
    if options.close_ups < 0:
        raise InputError(f"The number of close-ups must be 0 or more; got {options.close_ups}.")
    for zoom in (limits.min_zoom, *options.zooms):
        plan_poses(info, limits, zoom, options.overlap)
    rules = camera.rules if isinstance(camera, GuardedCamera) else CameraRules()
    return CaptureSettings(
        camera=info.name,
        frame_width=info.frame_width,
        frame_height=info.frame_height,
        pan_range_deg=(limits.min_pan_deg, limits.max_pan_deg),
        tilt_range_deg=(limits.min_tilt_deg, limits.max_tilt_deg),
        zoom_range=(limits.min_zoom, limits.max_zoom),
        pan_endless=limits.pan_endless,
        zoom_table=info.optics.table,
        zooms=tuple(sorted(set(options.zooms))),
        close_ups=options.close_ups,
        overlap=options.overlap,
        keep_out=rules.keep_out,
        masks=rules.masks,
        rolled=_may_roll(camera),
    )


def limits_of(settings: CaptureSettings) -> Limits:
    """Return the captured limits."""
    return Limits(
        *settings.pan_range_deg, *settings.tilt_range_deg, *settings.zoom_range, pan_endless=settings.pan_endless
    )  # fmt: skip


@dataclass(frozen=True, slots=True)
class PlannedSweep:
    """A planned sweep of a capture.

    Attributes:
        zoom: Its magnification.
        pictures: The number of its pictures.
    """

    zoom: float
    pictures: int


def planned_sweeps(camera: Camera, settings: CaptureSettings) -> list[PlannedSweep]:
    """Return the sweeps of a capture in order. Close-ups are not included, because they depend on the pictures."""
    limits = limits_of(settings)
    zooms = (limits.min_zoom, *settings.zooms)
    return [PlannedSweep(zoom, len(plan_poses(camera.info, limits, zoom, settings.overlap))) for zoom in zooms]


def close_up_zoom(settings: CaptureSettings) -> float | None:
    """Return the magnification of close-ups; None if the capture has none."""
    lowest, highest = settings.zoom_range
    zoom = min(CLOSE_UP_ZOOM, highest)
    return zoom if settings.close_ups and zoom >= 1.2 * lowest else None


async def take_frames(
    camera: Camera, session: CaptureSession, progress: Progress, *, holder: str, presets: Sequence[str] | None = None
) -> None:
    """Take the missing frames of a capture. The camera returns to its original pose, even after an error or a cancellation.

    Args:
        camera: The camera.
        session: The capture, which stores the frames.
        progress: Called after every frame.
        holder: The name that other clients see as the camera's controller.
        presets: Names of the presets at which to take pictures; None for all.

    Raises:
        ControlHeldError: Another client controls the camera.
        CameraError: The camera fails. Frames that were already taken remain stored.
        OutputError: A frame cannot be stored.
    """
    async with camera.control(holder), _return_afterwards(camera):
        taker = _Taker(camera, session, progress)
        await taker.presets([preset.name for preset in await camera.presets()] if presets is None else presets)
        limits = limits_of(session.settings)
        wide = plan_poses(camera.info, limits, limits.min_zoom, session.settings.overlap)
        await taker.sweep("Wide pictures", _name(limits.min_zoom), wide)
        for zoom in session.settings.zooms:
            await taker.sweep(
                f"Pictures at {zoom:g}x", _name(zoom), plan_poses(camera.info, limits, zoom, session.settings.overlap)
            )
        await taker.close_ups(limits)
    session.finish()


class _Taker:
    def __init__(self, camera: Camera, session: CaptureSession, progress: Progress) -> None:
        self._camera, self._session, self._progress = camera, session, progress

    async def presets(self, names: Sequence[str]) -> None:
        """Take a picture at the home position and at each preset, because operators use these views most."""
        camera = self._camera
        for number, name in enumerate(("", *names)):
            go = partial(camera.go_to_preset, name) if name else camera.go_home
            await self._shoot(f"preset-{name}" if name else HOME, go, preset=name)
            self._progress("Presets", number + 1, len(names) + 1)

    async def sweep(self, part: str, name: str, poses: Sequence[Pose]) -> None:
        """Take a picture at each pose."""
        for number, pose in enumerate(poses):
            await self._shoot(f"{name}-{number:03d}", partial(self._camera.move, pose))
            self._progress(part, number + 1, len(poses))

    async def _shoot(self, key: str, go: Callable[[], Awaitable[Arrival]], preset: str = "") -> None:
        """Go to a pose and store a picture, unless it is already stored. After a camera failure, wait and try again."""
        if self._session.find(key) is not None:
            return
        for attempt in range(ATTEMPTS):
            try:
                await go()
                frame = await self._camera.frame()
            except KeepOutError:
                self._session.add_refused(key, await self._camera.pose())
                return
            except (ControlHeldError, UnknownNameError):
                raise
            except CameraError:
                if attempt == ATTEMPTS - 1:
                    raise
                await anyio.sleep(RETRY_S)
            else:
                self._session.add(key, frame, preset=preset)
                return

    async def close_ups(self, limits: Limits) -> None:
        """Take close-ups where the wide pictures have the finest detail."""
        session, info = self._session, self._camera.info
        zoom = close_up_zoom(session.settings)
        if zoom is None:
            return
        poses = session.close_ups()
        if poses is None:
            hfov_deg = info.optics.hfov_deg(zoom)
            candidates = plan_poses(info, limits, zoom, 0.12)
            captured = [shot.pose for shot in session.shots]
            fresh = without_repeats(candidates, captured, hfov_deg)
            poses = await to_thread.run_sync(choose_close_ups, session, info, fresh, session.settings.close_ups)
            session.store_close_ups(poses)
        await self.sweep("Close-ups", "close-up", poses)


@asynccontextmanager
async def _return_afterwards(camera: Camera) -> AsyncIterator[None]:
    """Return a context that moves the camera back to its original pose at the end. After an error, it stops the camera first."""
    start = await camera.pose()
    try:
        yield
    except BaseException:
        # After a failure, the camera may not answer. The original error is raised in any case.
        with anyio.move_on_after(RETURN_S, shield=True):
            try:
                await camera.stop()
                await camera.move(start)
            except CameraError:
                pass
        raise
    await camera.move(start)


def _may_roll(camera: Camera) -> bool:
    return any(isinstance(each, MountedCamera) for each in layers(camera))


def _name(zoom: float) -> str:
    return f"{zoom:g}x"
