"""An unfinished capture on disk: its settings, frames and poses. Running the command again resumes it."""

from __future__ import annotations

import json
import shutil
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import cv2
import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from scope_ptz.camera.base import Frame
from scope_ptz.camera.guard.rules import PixelMask, Region
from scope_ptz.errors import CameraError, OutputError
from scope_ptz.geometry import Perspective, Pose

SETTINGS_FILE, FRAMES_FILE, CLOSE_UPS_FILE = "capture.json", "frames.jsonl", "close-ups.json"


class _StoredModel(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class CaptureSettings(_StoredModel):
    """The settings of a capture. A capture can be resumed only with the same settings.

    Attributes:
        camera: Name of the camera, including its address.
        frame_width: Width of a frame in pixels.
        frame_height: Height of a frame in pixels.
        pan_range_deg: Captured pan range in degrees.
        tilt_range_deg: Captured tilt range in degrees.
        zoom_range: Lowest and highest magnification.
        pan_endless: Whether pan has no stops.
        zoom_table: Rows of magnification and reported horizontal field of view in degrees.
        zooms: Additional magnifications at which the whole range is captured.
        close_ups: Maximum number of close-ups.
        overlap: Fraction of a frame that overlaps the next one.
        keep_out: Regions that must not be shown.
        masks: Rectangles that are hidden in every frame.
        rolled: Whether frames were turned upright and have black corners.
    """

    format: Literal[1] = 1
    camera: str
    frame_width: int
    frame_height: int
    pan_range_deg: tuple[float, float]
    tilt_range_deg: tuple[float, float]
    zoom_range: tuple[float, float]
    pan_endless: bool
    zoom_table: tuple[tuple[float, float], ...]
    zooms: tuple[float, ...]
    close_ups: int
    overlap: float
    keep_out: tuple[Region, ...] = ()
    masks: tuple[PixelMask, ...] = ()
    rolled: bool = False


class Shot(_StoredModel):
    """A captured frame, or a pose that the site's rules do not permit.

    Attributes:
        key: Its name in the plan, such as ``1x-007``; unique within a capture.
        file: Name of the picture file; empty if there is none.
        pan_deg: Reported pan in degrees at the time of exposure.
        tilt_deg: Reported tilt in degrees at the time of exposure.
        zoom: Reported magnification.
        hfov_deg: Reported horizontal field of view in degrees.
        preset: Name of the preset at which it was taken; empty if none.
        taken_s: The time at which it was taken, in Unix seconds.
    """

    key: str
    file: str = Field(default="", pattern=r"^(\d{5}\.png)?$")
    pan_deg: float
    tilt_deg: float
    zoom: float
    hfov_deg: float
    preset: str = ""
    taken_s: float = 0.0

    @property
    def pose(self) -> Pose:
        """The reported pose."""
        return Pose(self.pan_deg, self.tilt_deg, self.zoom)


class _State(_StoredModel):
    settings: CaptureSettings
    started_at: str
    complete: bool = False


class CaptureSession:
    """The folder of an unfinished capture.

    Args:
        folder: The folder, which is created if needed.
        settings: The settings of the capture.
        started_at: The time at which it began, in UTC as ISO 8601. A resumed capture keeps its original time.

    Raises:
        OutputError: The folder contains a capture with different settings, or cannot be read or written to.
    """

    def __init__(self, folder: Path, settings: CaptureSettings, started_at: str) -> None:
        self.folder, self.settings = folder, settings
        self._shots: dict[str, Shot] = {}
        self._next_number = 0
        self._state = _State(settings=settings, started_at=started_at)
        if folder.exists():
            self._resume()
        else:
            self._write(SETTINGS_FILE, self._state.model_dump_json(indent=1))

    @property
    def started_at(self) -> str:
        """The time at which the capture began."""
        return self._state.started_at

    @property
    def is_complete(self) -> bool:
        """Whether every frame has been taken."""
        return self._state.complete

    @property
    def shots(self) -> tuple[Shot, ...]:
        """The frames taken so far, in order."""
        return tuple(shot for shot in self._shots.values() if shot.file)

    @property
    def refused(self) -> int:
        """Number of poses that the site's rules did not permit."""
        return sum(not shot.file for shot in self._shots.values())

    def find(self, key: str) -> Shot | None:
        """Return the frame or refused pose with a key; None if there is none."""
        return self._shots.get(key)

    def add(self, key: str, frame: Frame, preset: str = "") -> Shot:
        """Store a frame.

        Raises:
            CameraError: The frame is not a perspective view, does not have the capture's frame size, or cannot be encoded.
            OutputError: The frame cannot be written.
        """
        size = (self.settings.frame_width, self.settings.frame_height)
        if not isinstance(frame.projection, Perspective):
            raise CameraError(
                "A capture requires perspective frames, but the camera returned a panorama. Use a perspective stream."
            )
        if (frame.width, frame.height) != size:
            raise CameraError(
                f"The camera's picture size changed from {size[0]}x{size[1]} to {frame.width}x{frame.height} pixels during the "
                "capture. Set a fixed picture size in the camera, and run the same command again."
            )
        view = frame.projection
        name = f"{self._next_number:05d}.png"
        self._next_number += 1
        encoded, content = cv2.imencode(".png", cv2.cvtColor(frame.image, cv2.COLOR_RGB2BGR), [cv2.IMWRITE_PNG_COMPRESSION, 1])
        if not encoded:
            raise CameraError("A frame from the camera cannot be encoded.")
        self._write(name, content.tobytes())
        shot = Shot(
            key=key,
            file=name,
            pan_deg=view.pan_deg,
            tilt_deg=view.tilt_deg,
            zoom=frame.pose.zoom,
            hfov_deg=view.hfov_deg,
            preset=preset,
            taken_s=time.time(),
        )
        self._append(shot)
        return shot

    def add_refused(self, key: str, pose: Pose) -> None:
        """Record a pose that the site's rules do not permit."""
        self._append(Shot(key=key, pan_deg=pose.pan_deg, tilt_deg=pose.tilt_deg, zoom=pose.zoom, hfov_deg=0.0))

    def image(self, shot: Shot) -> NDArray[np.uint8]:
        """Return a frame's picture as (H, W, 3) RGB.

        Raises:
            OutputError: The file is missing or damaged.
        """
        picture = cv2.imread(str(self.folder / shot.file), cv2.IMREAD_COLOR_RGB)
        if picture is None or picture.shape[:2] != (self.settings.frame_height, self.settings.frame_width):
            raise OutputError(
                f"{self.folder / shot.file} is missing or damaged. Remove {self.folder}, and capture the scene again."
            )
        return np.asarray(picture, np.uint8)

    def close_ups(self) -> list[Pose] | None:
        """Return the stored close-up poses; None if they have not been chosen yet."""
        path = self.folder / CLOSE_UPS_FILE
        if not path.exists():
            return None
        try:
            return [Pose(*map(float, row)) for row in json.loads(path.read_text(encoding="utf-8"))]
        except (OSError, ValueError, TypeError):
            return None  # the close-ups are chosen again

    def store_close_ups(self, poses: Sequence[Pose]) -> None:
        """Store the close-up poses."""
        self._write(CLOSE_UPS_FILE, json.dumps([(pose.pan_deg, pose.tilt_deg, pose.zoom) for pose in poses]))

    def finish(self) -> None:
        """Record that every frame has been taken."""
        self._state = self._state.model_copy(update={"complete": True})
        self._write(SETTINGS_FILE, self._state.model_dump_json(indent=1))

    def remove(self) -> None:
        """Remove the folder."""
        shutil.rmtree(self.folder, ignore_errors=True)

    def _resume(self) -> None:
        try:
            state = _State.model_validate_json((self.folder / SETTINGS_FILE).read_bytes())
            lines = (
                (self.folder / FRAMES_FILE).read_text(encoding="utf-8").splitlines() if (self.folder / FRAMES_FILE).exists() else []
            )
        except (OSError, ValidationError, UnicodeDecodeError) as error:
            raise OutputError(
                f"{self.folder} does not contain a capture that can be resumed. Remove the folder, and run the command again."
            ) from error
        changed = [name for name, value in state.settings if value != getattr(self.settings, name)]
        if changed:
            raise OutputError(
                f"{self.folder} contains an unfinished capture with a different {changed[0].replace('_', ' ')}. Run the command "
                "with the same options to resume it, or remove the folder to start over."
            )
        self._state = state
        for line in lines:
            try:
                shot = Shot.model_validate_json(line)
            except ValidationError:
                continue  # the process was killed while writing this line, so the frame will be taken again
            if not shot.file or (self.folder / shot.file).is_file():
                self._shots[shot.key] = shot
        self._next_number = max((int(shot.file[:5]) + 1 for shot in self._shots.values() if shot.file), default=0)

    def _append(self, shot: Shot) -> None:
        self._shots[shot.key] = shot
        try:
            path = self.folder / FRAMES_FILE
            truncated = path.exists() and path.stat().st_size and not path.read_bytes().endswith(b"\n")
            with path.open("a", encoding="utf-8") as file:
                file.write(("\n" if truncated else "") + shot.model_dump_json() + "\n")
        except OSError as error:
            raise self._write_error(error) from error

    def _write(self, name: str, content: str | bytes) -> None:
        """Write a file atomically."""
        data = content.encode() if isinstance(content, str) else content
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            temporary = self.folder / f".{name}.new"
            temporary.write_bytes(data)
            temporary.replace(self.folder / name)
        except OSError as error:
            raise self._write_error(error) from error

    def _write_error(self, error: OSError) -> OutputError:
        return OutputError(f"The capture cannot be stored in {self.folder}: {error.strerror or error}.")
