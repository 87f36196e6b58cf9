"""Camera profiles: the results of probing and calibrating a camera, stored as JSON in the configuration folder."""

from __future__ import annotations

import hashlib
import os
import re
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from scope_ptz.errors import OutputError, PackError

if TYPE_CHECKING:
    from scope_ptz.camera.measurement.calibration import Calibration

VERSION = 1


class _Record(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class MeasuredField(_Record):
    """A field of view: the magnification, its position in the zoom range (0 to 1), and the reported and measured angles."""

    zoom: float = Field(gt=0)
    share: float = Field(ge=0, le=1)
    stated_deg: float = Field(gt=0, lt=180)
    measured_deg: float = Field(gt=0, lt=180)


class CalibrationRecord(_Record):
    """A calibration, with the pan and tilt ranges to which its scales refer.

    ``replaces`` names the values that the measurements replace, because the driver only assumed them.
    """

    measured_at: str
    pan_scale: float
    tilt_scale: float
    tilt_offset_deg: float
    pan_range_deg: tuple[float, float]
    tilt_range_deg: tuple[float, float]
    fields: tuple[MeasuredField, ...]
    snapshot_s: float
    move_s: float
    settling_s: float
    residual_px: float
    replaces: tuple[str, ...] = ()
    contradictions: tuple[str, ...] = ()

    @property
    def pan_deg(self) -> tuple[float, float] | None:
        """Actual pan in degrees at the ends of the assumed range; None if the range was not assumed."""
        return None if "pan range" not in self.replaces else _to_degrees(self.pan_range_deg, self.pan_scale, 0.0)

    @property
    def tilt_deg(self) -> tuple[float, float] | None:
        """Actual tilt in degrees at the ends of the assumed range; None if the range was not assumed."""
        return (
            None if "tilt range" not in self.replaces else _to_degrees(self.tilt_range_deg, self.tilt_scale, self.tilt_offset_deg)
        )


class ProbeRecord(_Record):
    """The values that a camera reports about itself."""

    probed_at: str
    model: str
    driver: str
    pan_range_deg: tuple[float, float]
    tilt_range_deg: tuple[float, float]
    zoom_range: tuple[float, float]
    pan_endless: bool
    zoom_table: tuple[tuple[float, float], ...]
    frame_width: int
    frame_height: int
    presets: tuple[str, ...]
    drives: bool
    edits_presets: bool
    focus: bool
    iris: bool
    assumed: tuple[str, ...]
    snapshot_s: float
    focus_actions: tuple[str, ...] = ()
    iris_actions: tuple[str, ...] = ()
    firmware: str = ""


class CameraProfile(_Record):
    """The stored results for a camera, without user names or passwords.

    Attributes:
        version: Version of the file format.
        camera: The camera's driver and address, such as ``onvif 10.0.0.7:80``.
        probe: The reported values; None if the camera has not been probed.
        calibration: The measurements; None if the camera has not been calibrated.
    """

    version: int = VERSION
    camera: str
    probe: ProbeRecord | None = None
    calibration: CalibrationRecord | None = None


def calibration_record(
    calibration: Calibration, pan_range_deg: tuple[float, float], tilt_range_deg: tuple[float, float], assumed: tuple[str, ...]
) -> CalibrationRecord:
    """Convert a calibration to a record that can be stored."""
    return CalibrationRecord(
        measured_at=now(),
        pan_scale=calibration.pan.scale,
        tilt_scale=calibration.tilt.scale,
        tilt_offset_deg=calibration.tilt_offset_deg,
        pan_range_deg=pan_range_deg,
        tilt_range_deg=tilt_range_deg,
        fields=tuple(
            MeasuredField(
                zoom=field_of_view.zoom,
                share=field_of_view.position,
                stated_deg=field_of_view.stated_deg,
                measured_deg=field_of_view.measured_deg,
            )
            for field_of_view in calibration.fields
        ),
        snapshot_s=calibration.snapshot_s,
        move_s=calibration.move_s,
        settling_s=calibration.settling_s,
        residual_px=calibration.residual_px,
        replaces=assumed,
        contradictions=calibration.contradictions,
    )


def now() -> str:
    """Return the current time in UTC as ISO 8601."""
    return datetime.now(UTC).isoformat(timespec="seconds")


def profile_path(folder: Path, camera: str) -> Path:
    """Return the path of a camera's profile."""
    words = re.sub(r"[^A-Za-z0-9.-]+", "-", camera).strip("-.")[:60]
    return folder / f"{words}-{hashlib.sha256(camera.encode()).hexdigest()[:8]}.json"


def load_profile(folder: Path, camera: str) -> CameraProfile | None:
    """Load a camera's profile; None if there is none.

    Raises:
        PackError: The file cannot be read, is damaged, or has the wrong version or camera.
    """
    path = profile_path(folder, camera)
    try:
        profile = CameraProfile.model_validate_json(path.read_bytes())
    except FileNotFoundError:
        return None
    except (OSError, ValidationError) as error:
        raise PackError(f"The camera profile {path} cannot be read. Delete it and measure the camera again.") from error
    if profile.version != VERSION or profile.camera != camera:
        raise PackError(
            f"The camera profile {path} is from another version or for another camera. Delete it and measure the camera again."
        )
    return profile


def save_profile(folder: Path, profile: CameraProfile) -> Path:
    """Save a camera's profile atomically.

    Raises:
        OutputError: The file cannot be written.
    """
    path = profile_path(folder, profile.camera)
    part = path.with_suffix(f".{os.getpid()}.part")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        part.write_text(profile.model_dump_json(indent=1) + "\n", encoding="utf-8")
        part.replace(path)
    except OSError as error:
        raise OutputError(f"The camera profile {path} cannot be written: {error.strerror or error}.") from error
    return path


def _to_degrees(ends: tuple[float, float], scale: float, offset: float) -> tuple[float, float]:
    return scale * ends[0] + offset, scale * ends[1] + offset
