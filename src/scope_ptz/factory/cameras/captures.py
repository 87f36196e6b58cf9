"""Capture a camera's site as a scene: open the camera, take the frames, and write the scene.

An interrupted capture can be resumed.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING

from scope_ptz.camera.control import ControlLock, user_name
from scope_ptz.errors import InputError, OutputError
from scope_ptz.factory.cameras.opening import OpenCamera, open_camera
from scope_ptz.factory.cameras.parsing import parse_camera
from scope_ptz.settings import load_settings

if TYPE_CHECKING:
    from scope_ptz.camera.capture.frame_taking import CaptureOptions, PlannedSweep
    from scope_ptz.camera.capture.progress import Progress
    from scope_ptz.camera.capture.session import CaptureSession

_KEBAB = re.compile(r"[a-z0-9]+(-[a-z0-9]+)*")


@dataclass(frozen=True, slots=True)
class CapturedScene:
    """The result of a capture.

    Attributes:
        name: The scene's name.
        folder: The scene's folder.
        frames: Number of frames.
        registered: Number of frames whose pose was measured from image features. The others rely on their reported poses.
        correction_deg: Median angle between reported and adjusted orientations; None if nothing was registered.
        largest_correction_deg: Maximum angle between reported and adjusted orientations; None if nothing was registered.
        residual_px: Root mean square error of the matches in pixels; None if nothing was registered.
        focal_factor: Ratio of measured to reported focal length at the widest zoom; None if nothing was registered.
        tiles: Number of tiles, which are sharper than the panorama.
        unseen_share: Fraction of the directions in the camera's range that no frame covers.
        presets: The scene's presets.
        omitted_presets: The camera's presets that were omitted because they are outside the captured range.
        refused: Number of poses that the site's rules did not permit.
    """

    name: str
    folder: Path
    frames: int
    registered: int
    correction_deg: float | None
    largest_correction_deg: float | None
    residual_px: float | None
    focal_factor: float | None
    tiles: int
    unseen_share: float
    presets: tuple[str, ...]
    omitted_presets: tuple[str, ...]
    refused: int


@dataclass(frozen=True, slots=True)
class CapturePlan:
    """The plan of a capture.

    Attributes:
        camera: The camera's name.
        pan_range_deg: The pan range to capture.
        tilt_range_deg: The tilt range to capture.
        presets: The presets to visit, in addition to the home position.
        sweeps: The sweeps over the range.
        close_ups: Maximum number of close-ups.
        close_up_zoom: Magnification of the close-ups; None if there are none.
    """

    camera: str
    pan_range_deg: tuple[float, float]
    tilt_range_deg: tuple[float, float]
    presets: tuple[str, ...]
    sweeps: tuple[PlannedSweep, ...]
    close_ups: int
    close_up_zoom: float | None


def scene_folder(camera: str, to: Path, name: str | None) -> Path:
    """Return the folder for a new scene.

    Args:
        camera: The camera's spec. Its name in ``scope.yaml`` is the default scene name.
        to: The scenes folder.
        name: The scene's name; None for the camera's name.

    Raises:
        InputError: The name is missing, is not in kebab-case, or is reserved for variations.
        OutputError: The folder already exists.
    """
    from scope_ptz.simulator.pack import variation_of

    scene_name = parse_camera(camera).name if name is None else name
    if not scene_name:
        raise InputError("The scene must have a name. Add --name, for example --name my-yard.")
    if not _KEBAB.fullmatch(scene_name):
        raise InputError(
            "A scene name must consist of lower-case letters, digits and single hyphens, such as my-yard; "
            f"got '{scene_name[:60]}'. Choose a name with --name."
        )
    if variation_of(scene_name)[1] is not None:
        raise InputError(f"'{scene_name}' is the name of a scene variation. Choose a name that does not end in -v and a number.")
    folder = to / scene_name
    if folder.exists():
        raise OutputError(f"{folder} already exists. Choose another --name, or remove the folder to capture the scene again.")
    return folder


async def capture_scene(camera: str, folder: Path, options: CaptureOptions, progress: Progress) -> CapturedScene:
    """Capture a scene from a camera. To resume an interrupted capture, call this function again with the same arguments.

    Args:
        camera: The camera's spec.
        folder: The scene's folder, from ``scene_folder``.
        options: The capture options.
        progress: Called with the name of a phase, the number of finished steps, and the total number of steps.

    Raises:
        InputError: The spec or an option is invalid, or the camera's field of view is unknown.
        ControlHeldError: Another program has control of the camera, or is capturing to the same folder.
        CameraError: The camera failed. Frames that were already taken remain stored.
        OutputError: The folder cannot be written to, or contains an unfinished capture with different settings.
    """
    from anyio import to_thread

    work = folder.with_name(f".{folder.name}.capture")
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{folder.parent} cannot be written to: {error.strerror or error}.") from error
    lock = _acquire_lock(folder)
    try:
        session = await _take(camera, work, options, progress)
        return await to_thread.run_sync(build_scene, session, folder, progress)
    finally:
        lock.release()


async def plan_capture(camera: str, options: CaptureOptions) -> CapturePlan:
    """Plan a capture. The camera does not move, and nothing is written.

    Args:
        camera: The camera's spec.
        options: The capture options.

    Raises:
        InputError: The spec or an option is invalid, or the camera's field of view is unknown.
        CameraError: The camera failed.
    """
    from scope_ptz.camera.capture.frame_taking import capture_settings, close_up_zoom, planned_sweeps

    async with await open_camera(camera, actor=_actor()) as opened:
        settings = capture_settings(opened.camera, options)
        presets = _reachable_presets(opened)
        if presets is None:
            presets = [preset.name for preset in await opened.camera.presets()]
        zoom = close_up_zoom(settings)
        return CapturePlan(
            camera=settings.camera,
            pan_range_deg=settings.pan_range_deg,
            tilt_range_deg=settings.tilt_range_deg,
            presets=tuple(presets),
            sweeps=tuple(planned_sweeps(opened.camera, settings)),
            close_ups=settings.close_ups if zoom is not None else 0,
            close_up_zoom=zoom,
        )


async def _take(camera: str, work: Path, options: CaptureOptions, progress: Progress) -> CaptureSession:
    from scope_ptz.camera.capture.frame_taking import capture_settings, take_frames
    from scope_ptz.camera.capture.session import CaptureSession

    actor = _actor()
    async with await open_camera(camera, actor=actor) as opened:
        settings = capture_settings(opened.camera, options)
        session = CaptureSession(work, settings, datetime.now(UTC).isoformat(timespec="seconds"))
        if not session.is_complete:
            await take_frames(opened.camera, session, progress, holder=actor, presets=_reachable_presets(opened))
    return session


def _acquire_lock(folder: Path) -> ControlLock:
    """Acquire a lock that prevents other programs from capturing to the same folder."""
    lock = ControlLock(f"The capture of {folder}", f"capture {folder.resolve()}", load_settings().cache_dir / "control")
    lock.acquire(_actor())
    return lock


def _actor() -> str:
    return f"scope camera capture: {user_name()}"


def _reachable_presets(opened: OpenCamera) -> list[str] | None:
    """Return the presets at the camera's viewpoint; None, which means all presets, for a camera without a scene."""
    if opened.scene is None:
        return None
    file = opened.scene.file
    home = next(preset for preset in file.presets if preset.name == file.home_preset)
    return [preset.name for preset in file.presets if preset.viewpoint == home.viewpoint]


def build_scene(session: CaptureSession, folder: Path, progress: Progress) -> CapturedScene:
    """Register the frames of a capture, write the scene, and remove the capture's working folder.

    Args:
        session: The capture, with all of its frames.
        folder: The scene's folder, which must not exist yet.
        progress: Called with the name of a phase, the number of finished steps, and the total number of steps.

    Raises:
        OutputError: The folder cannot be written to, or a stored frame is missing or damaged.
    """
    from scope_ptz.camera.capture.registration import register
    from scope_ptz.camera.capture.scene_writer import write_scene

    registration = register(session, progress)
    written = write_scene(session, registration, folder, progress)
    session.remove()
    corrections_deg = [
        angle_deg for angle_deg, used in zip(registration.corrections_deg, registration.registered, strict=True) if used
    ]
    factors = sorted(registration.focal_factors)
    captured = written.file.captured
    return CapturedScene(
        name=folder.name,
        folder=folder,
        frames=len(registration.shots),
        registered=len(corrections_deg),
        correction_deg=median(corrections_deg) if corrections_deg else None,
        largest_correction_deg=max(corrections_deg, default=None),
        residual_px=registration.residual_px if corrections_deg else None,
        focal_factor=factors[0][1] if factors else None,
        tiles=written.tiles,
        unseen_share=captured.unseen_share if captured else 0.0,
        presets=tuple(preset.name for preset in written.file.presets),
        omitted_presets=written.omitted_presets,
        refused=session.refused,
    )
