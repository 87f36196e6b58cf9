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
from scope_ptz.camera.capture.plan import OVERLAP, Ranges, exclude_known_poses, plan_poses
from scope_ptz.camera.capture.progress import Progress
from scope_ptz.camera.capture.session import CaptureSession, CaptureSettings
from scope_ptz.camera.control import ControlHeldError
from scope_ptz.camera.guard.guarded_camera import GuardedCamera, KeepOutError
from scope_ptz.camera.guard.mounted_camera import MountedCamera
from scope_ptz.camera.guard.rules import CameraRules
from scope_ptz.camera.guard.wrapper import layers
from scope_ptz.errors import CameraError, InputError, UnknownNameError
from scope_ptz.geometry import Limits, Pose

CLOSE_UP_ZOOM = 4.0
"""Magnification of close-ups, unless the camera's maximum magnification is lower."""

DEFAULT_CLOSE_UPS = 40
"""Default maximum number of close-ups."""

RETURN_TIMEOUT_S = 30.0
"""Maximum time in seconds to return the camera to its original pose after a failed or cancelled capture."""

ATTEMPTS, RETRY_S = 3, 2.0
"""Maximum number of attempts to take a picture, and seconds to wait between attempts."""

HOME = "home"
"""Key of the frame at the camera's home position."""


@dataclass(frozen=True, slots=True)
class CaptureOptions:
    """The options of a capture.

    Attributes:
        ranges: The part of the camera's range to capture.
        zooms: Additional magnifications at which to capture the whole range.
        close_ups: Maximum number of close-ups of areas with fine detail.
        overlap: Fraction of a frame that overlaps the next one.
    """

    ranges: Ranges = field(default_factory=Ranges)
    zooms: tuple[float, ...] = ()
    close_ups: int = DEFAULT_CLOSE_UPS
    overlap: float = OVERLAP


def capture_settings(camera: Camera, options: CaptureOptions) -> CaptureSettings:
    """Return the settings for a capture.

    Raises:
        InputError: A range, zoom or number is invalid, or the camera's field of view is unknown.
    """
    info = camera.info
    if "field of view" in info.assumed:
        raise InputError(
            f"The field of view of {info.name} is unknown, so its pictures cannot be stitched. Measure it with "
            "`scope camera calibrate`, or add it to the camera spec: ?hfov_wide=...&hfov_tele=..."
        )
    limits = options.ranges.within(info.limits)
    for zoom in options.zooms:
        if not limits.min_zoom < zoom <= limits.max_zoom:
            raise InputError(
                f"Each zoom must be above {limits.min_zoom:g} and at most {limits.max_zoom:g}; got {zoom:g}. "
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
        rolled=_has_rolled_frames(camera),
    )


def captured_limits(settings: CaptureSettings) -> Limits:
    """Return the limits of the captured range."""
    return Limits(
        *settings.pan_range_deg, *settings.tilt_range_deg, *settings.zoom_range, pan_endless=settings.pan_endless
    )  # fmt: skip


@dataclass(frozen=True, slots=True)
class PlannedSweep:
    """A planned sweep.

    Attributes:
        zoom: Magnification.
        pictures: Number of pictures.
    """

    zoom: float
    pictures: int


def planned_sweeps(camera: Camera, settings: CaptureSettings) -> list[PlannedSweep]:
    """Return the planned sweeps in order, without close-ups, which depend on the pictures."""
    limits = captured_limits(settings)
    zooms = (limits.min_zoom, *settings.zooms)
    return [PlannedSweep(zoom, len(plan_poses(camera.info, limits, zoom, settings.overlap))) for zoom in zooms]


def close_up_zoom(settings: CaptureSettings) -> float | None:
    """Return the magnification for close-ups; None if none are to be taken."""
    lowest, highest = settings.zoom_range
    zoom = min(CLOSE_UP_ZOOM, highest)
    return zoom if settings.close_ups and zoom >= 1.2 * lowest else None


async def take_frames(
    camera: Camera, session: CaptureSession, progress: Progress, *, holder: str, presets: Sequence[str] | None = None
) -> None:
    """Take the frames that a capture is missing. The camera returns to its original pose, even after an error or cancellation.

    Args:
        camera: The camera.
        session: The capture, which stores the frames.
        progress: Called after every frame.
        holder: The name shown to other clients as the holder of control.
        presets: Names of the presets at which to take pictures; None for all of them.

    Raises:
        ControlHeldError: Another client controls the camera.
        CameraError: The camera failed. Frames that were already taken remain stored.
        OutputError: A frame cannot be stored.
    """
    async with camera.control(holder), _return_afterwards(camera):
        frame_taker = _FrameTaker(camera, session, progress)
        await frame_taker.presets([preset.name for preset in await camera.presets()] if presets is None else presets)
        limits = captured_limits(session.settings)
        wide = plan_poses(camera.info, limits, limits.min_zoom, session.settings.overlap)
        await frame_taker.sweep("Wide pictures", _zoom_name(limits.min_zoom), wide)
        for zoom in session.settings.zooms:
            await frame_taker.sweep(
                f"Pictures at {zoom:g}x", _zoom_name(zoom), plan_poses(camera.info, limits, zoom, session.settings.overlap)
            )
        await frame_taker.close_ups(limits)
    session.finish()


class _FrameTaker:
    def __init__(self, camera: Camera, session: CaptureSession, progress: Progress) -> None:
        self._camera, self._session, self._progress = camera, session, progress

    async def presets(self, names: Sequence[str]) -> None:
        """Take a picture at the home position and at each preset, because operators use these views most."""
        camera = self._camera
        for number, name in enumerate(("", *names)):
            go = partial(camera.go_to_preset, name) if name else camera.go_home
            await self._take(f"preset-{name}" if name else HOME, go, preset=name)
            self._progress("Presets", number + 1, len(names) + 1)

    async def sweep(self, part: str, name: str, poses: Sequence[Pose]) -> None:
        """Take a picture at each pose."""
        for number, pose in enumerate(poses):
            await self._take(f"{name}-{number:03d}", partial(self._camera.move, pose))
            self._progress(part, number + 1, len(poses))

    async def _take(self, key: str, go: Callable[[], Awaitable[Arrival]], preset: str = "") -> None:
        """Go to a pose and store a picture, unless one is already stored. After a camera error, wait and try again."""
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
            new_poses = exclude_known_poses(candidates, captured, hfov_deg)
            poses = await to_thread.run_sync(choose_close_ups, session, info, new_poses, session.settings.close_ups)
            session.store_close_ups(poses)
        await self.sweep("Close-ups", "close-up", poses)


@asynccontextmanager
async def _return_afterwards(camera: Camera) -> AsyncIterator[None]:
    """Return a context manager that moves the camera back to its original pose on exit, after stopping it if there was an error."""
    start = await camera.pose()
    try:
        yield
    except BaseException:
        # The camera may not respond after a failure. Raise the original error in any case.
        with anyio.move_on_after(RETURN_TIMEOUT_S, shield=True):
            try:
                await camera.stop()
                await camera.move(start)
            except CameraError:
                pass
        raise
    await camera.move(start)


def _has_rolled_frames(camera: Camera) -> bool:
    return any(isinstance(layer, MountedCamera) for layer in layers(camera))


def _zoom_name(zoom: float) -> str:
    return f"{zoom:g}x"
