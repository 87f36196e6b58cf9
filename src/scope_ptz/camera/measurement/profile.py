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
    """A field of view: the magnification, its position in the zoom range (0 to 1), and the stated and measured angles."""

    zoom: float = Field(gt=0)
    share: float = Field(ge=0, le=1)
    stated_deg: float = Field(gt=0, lt=180)
    measured_deg: float = Field(gt=0, lt=180)


class CalibrationRecord(_Record):
    """A calibration, with the ranges of pan and tilt that its scales refer to.

    ``replaces`` names the values that the driver only assumed. The measurements are used instead of them.
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
    """The stored results for a camera, without passwords and user names.

    Attributes:
        version: Version of the format.
        camera: The camera's driver and address, such as ``onvif 10.0.0.7:80``.
        probe: The values that it reports.
        calibration: The measurements.
    """

    version: int = VERSION
    camera: str
    probe: ProbeRecord | None = None
    calibration: CalibrationRecord | None = None


def record_of(
    calibration: Calibration, pan_range_deg: tuple[float, float], tilt_range_deg: tuple[float, float], assumed: tuple[str, ...]
) -> CalibrationRecord:
    """Convert a calibration to the record that is stored."""
    return CalibrationRecord(
        measured_at=now(),
        pan_scale=calibration.pan.scale,
        tilt_scale=calibration.tilt.scale,
        tilt_offset_deg=calibration.tilt_offset_deg,
        pan_range_deg=pan_range_deg,
        tilt_range_deg=tilt_range_deg,
        fields=tuple(
            MeasuredField(zoom=each.zoom, share=each.position, stated_deg=each.stated_deg, measured_deg=each.measured_deg)
            for each in calibration.fields
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
    """Return the file of a camera's profile."""
    words = re.sub(r"[^A-Za-z0-9.-]+", "-", camera).strip("-.")[:60]
    return folder / f"{words}-{hashlib.sha256(camera.encode()).hexdigest()[:8]}.json"


def load_profile(folder: Path, camera: str) -> CameraProfile | None:
    """Return the profile of a camera; None if there is none.

    Raises:
        PackError: The file is damaged.
    """
    path = profile_path(folder, camera)
    try:
        found = CameraProfile.model_validate_json(path.read_bytes())
    except FileNotFoundError:
        return None
    except (OSError, ValidationError) as error:
        raise PackError(f"The camera profile {path} cannot be read. Delete it and measure the camera again.") from error
    if found.version != VERSION or found.camera != camera:
        raise PackError(f"The camera profile {path} belongs to another version or camera. Delete it and measure the camera again.")
    return found


def save_profile(folder: Path, profile: CameraProfile) -> Path:
    """Write the profile of a camera. Readers never see a partial file.

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
