"""Capture the site of a camera as a scene: open the camera, take the frames and write the scene.

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
    from scope_ptz.camera.capture.frame_taking import CaptureOptions, PlannedSweep, Progress
    from scope_ptz.camera.capture.session import CaptureSession

_KEBAB = re.compile(r"[a-z0-9]+(-[a-z0-9]+)*")


@dataclass(frozen=True, slots=True)
class CapturedScene:
    """The result of a capture.

    Attributes:
        name: The scene's name.
        folder: The scene's folder.
        frames: Number of frames.
        registered: Number of frames whose pose was measured from image features. The others keep their reported poses.
        correction_deg: Median angle between reported and adjusted orientations; None if nothing was registered.
        largest_correction_deg: The largest such angle; None if nothing was registered.
        residual_px: Root mean square distance of matched features in pixels; None if nothing was registered.
        focal_factor: Ratio of measured to reported focal length at the widest zoom; None if nothing was registered.
        tiles: Number of tiles, which are sharper than the panorama.
        unseen_share: Fraction of the directions within the camera's range that no frame shows.
        presets: The presets of the scene.
        omitted_presets: Presets of the camera that the scene lacks, because they are outside the captured range.
        refused: Number of poses that the rules of the site did not permit.
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
    """What a capture would do.

    Attributes:
        camera: The camera's name.
        pan_range_deg: The pan range that would be captured.
        tilt_range_deg: The tilt range that would be captured.
        presets: The presets that would be visited, in addition to the home position.
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
    """Return the folder of a new scene.

    Args:
        camera: The camera's spec, whose name in ``scope.yaml`` is the default name of the scene.
        to: The folder of scenes.
        name: Name of the scene; None for the camera's name.

    Raises:
        InputError: The name is missing, is not in kebab-case, or is that of a variation.
        OutputError: The folder already exists.
    """
    from scope_ptz.simulator.pack import variation_of

    chosen = parse_camera(camera).name if name is None else name
    if not chosen:
        raise InputError("The scene needs a name: add --name, for example --name my-yard.")
    if not _KEBAB.fullmatch(chosen):
        raise InputError(
            f"The name of a scene must have lower-case letters, digits and single hyphens, such as my-yard; got '{chosen[:60]}'. "
            "Give one with --name."
        )
    if variation_of(chosen)[1] is not None:
        raise InputError(f"'{chosen}' is the name of a variation of a scene. Choose a name that does not end in -v and a number.")
    folder = to / chosen
    if folder.exists():
        raise OutputError(f"{folder} already exists. Choose another --name, or remove the folder to capture the scene again.")
    return folder


async def capture_scene(camera: str, folder: Path, options: CaptureOptions, progress: Progress) -> CapturedScene:
    """Capture a scene from a camera. To resume an interrupted capture, call this function again with the same arguments.

    Args:
        camera: The camera's spec.
        folder: The scene's folder, from ``scene_folder``.
        options: The options of the capture.
        progress: Called with the name of a phase, the number of finished steps, and the number of all its steps.

    Raises:
        InputError: The spec or an option is invalid, or the camera's field of view is unknown.
        ControlHeldError: Another program controls the camera, or captures into the same folder.
        CameraError: The camera fails. Frames taken before the failure stay stored.
        OutputError: The folder cannot be written, or contains an unfinished capture with other settings.
    """
    from anyio import to_thread

    work = folder.with_name(f".{folder.name}.capture")
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{folder.parent} cannot be written: {error.strerror or error}.") from error
    lock = _acquire_lock(folder)
    try:
        session = await _take(camera, work, options, progress)
        return await to_thread.run_sync(build_scene, session, folder, progress)
    finally:
        lock.release()


async def plan_capture(camera: str, options: CaptureOptions) -> CapturePlan:
    """Return what ``capture_scene`` would do with the same arguments. The camera does not move, and nothing is written.

    Raises:
        InputError: The spec or an option is invalid, or the camera's field of view is unknown.
        CameraError: The camera fails.
    """
    from scope_ptz.camera.capture.frame_taking import close_up_zoom, planned_sweeps, settings_of

    async with await open_camera(camera, actor=_actor()) as opened:
        settings = settings_of(opened.camera, options)
        presets = _presets_in_reach(opened)
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
    from scope_ptz.camera.capture.frame_taking import settings_of, take_frames
    from scope_ptz.camera.capture.session import CaptureSession

    actor = _actor()
    async with await open_camera(camera, actor=actor) as opened:
        settings = settings_of(opened.camera, options)
        session = CaptureSession(work, settings, datetime.now(UTC).isoformat(timespec="seconds"))
        if not session.complete:
            await take_frames(opened.camera, session, progress, holder=actor, presets=_presets_in_reach(opened))
    return session


def _acquire_lock(folder: Path) -> ControlLock:
    """Acquire and return a lock that keeps other programs from capturing into the same folder."""
    lock = ControlLock(f"The capture of {folder}", f"capture {folder.resolve()}", load_settings().cache_dir / "control")
    lock.acquire(_actor())
    return lock


def _actor() -> str:
    return f"scope camera capture: {user_name()}"


def _presets_in_reach(opened: OpenCamera) -> list[str] | None:
    """Return the presets that can be reached without leaving the optical centre; None if all of them can."""
    if opened.scene is None:
        return None
    file = opened.scene.file
    home = next(preset for preset in file.presets if preset.name == file.home_preset)
    return [preset.name for preset in file.presets if preset.viewpoint == home.viewpoint]


def build_scene(session: CaptureSession, folder: Path, progress: Progress) -> CapturedScene:
    """Register the frames of a capture, write them as a scene, and remove the unfinished capture.

    Args:
        session: The capture, with all its frames.
        folder: The scene's folder, which must not exist yet.
        progress: Called with the name of a phase, the number of finished steps, and the number of all its steps.

    Raises:
        OutputError: The folder cannot be written, or a stored frame is damaged.
    """
    from scope_ptz.camera.capture.registration import register
    from scope_ptz.camera.capture.scene_writer import write_scene

    found = register(session, progress)
    written = write_scene(session, found, folder, progress)
    session.remove()
    good = [angle for angle, used in zip(found.corrections_deg, found.registered, strict=True) if used]
    factors = sorted(found.focal_factors)
    captured = written.file.captured
    return CapturedScene(
        name=folder.name,
        folder=folder,
        frames=len(found.shots),
        registered=len(good),
        correction_deg=median(good) if good else None,
        largest_correction_deg=max(good, default=None),
        residual_px=found.residual_px if good else None,
        focal_factor=factors[0][1] if factors else None,
        tiles=written.tiles,
        unseen_share=captured.unseen_share if captured else 0.0,
        presets=tuple(preset.name for preset in written.file.presets),
        omitted_presets=written.omitted_presets,
        refused=session.refused,
    )
