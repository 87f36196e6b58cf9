"""Camera reports for the table of tested devices. A report identifies the model, but not the owner or the location."""

from __future__ import annotations

import json
import re
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from scope_ptz.camera.measurement.profile import CalibrationRecord, ProbeRecord

_IDENTIFIERS = re.compile(
    r"(?:\d{1,3}\.){3}\d{1,3}(?::\d+)?"  # IPv4 addresses
    r"|(?:[0-9A-Fa-f]{2}[:-]){5}[0-9A-Fa-f]{2}"  # MAC addresses
    r"|\b(?=[0-9A-Fa-f]*\d)[0-9A-Fa-f]{12}\b"  # MAC addresses without separators, which AXIS uses as serial numbers
    r"|\S+@\S+"
)


def report_text(probe: ProbeRecord, calibration: CalibrationRecord | None = None) -> str:
    """Return a camera report as Markdown: a row for the table of tested devices, and details as JSON.

    The report contains only selected fields, without addresses, accounts or serial numbers. An identifier that a device includes in
    its model name is redacted. Presets are only counted, because their names may reveal the location.

    Args:
        probe: The reported values.
        calibration: The measurements; None if there are none.
    """
    feature_flags = {
        "drive": probe.drives,
        "presets": probe.edits_presets,
        f"focus ({', '.join(probe.focus_actions)})": bool(probe.focus_actions),
        f"iris ({', '.join(probe.iris_actions)})": bool(probe.iris_actions),
    }
    features = ", ".join(name for name, present in feature_flags.items() if present) or "poses and pictures only"
    measured = "no" if calibration is None else "contradictions" if calibration.contradictions else "yes"
    row = (probe.model, probe.firmware or "not reported", probe.driver, features, measured)
    details = {
        "scope_ptz": _version(),
        "model": probe.model,
        "firmware": probe.firmware,
        "driver": probe.driver,
        "pan_range_deg": probe.pan_range_deg,
        "tilt_range_deg": probe.tilt_range_deg,
        "pan_endless": probe.pan_endless,
        "zoom_range": probe.zoom_range,
        "hfov_deg_by_zoom": probe.zoom_table,
        "frame": (probe.frame_width, probe.frame_height),
        "snapshot_s": round(probe.snapshot_s, 3),
        "drives": probe.drives,
        "edits_presets": probe.edits_presets,
        "presets": len(probe.presets),
        "focus": probe.focus_actions,
        "iris": probe.iris_actions,
        "assumed": probe.assumed,
        "calibration": None if calibration is None else _calibration_fields(calibration),
    }
    table = "| Model | Firmware | Driver | Can | Calibrated |\n|---|---|---|---|---|\n"
    cells = " | ".join(text.replace("|", "/").replace("\n", " ") for text in row)
    text = f"# Camera report\n\n{table}| {cells} |\n\n```json\n{json.dumps(details, indent=1)}\n```\n"
    return _IDENTIFIERS.sub("(removed)", text)


def report_name(probe: ProbeRecord) -> str:
    """Return the file name of a report."""
    model_slug = re.sub(r"[^a-z0-9]+", "-", _IDENTIFIERS.sub("", probe.model).lower()).strip("-")[:60]
    return f"camera-report-{model_slug or 'camera'}.md"


def _calibration_fields(record: CalibrationRecord) -> dict[str, object]:
    return {
        "pan_scale": round(record.pan_scale, 4),
        "tilt_scale": round(record.tilt_scale, 4),
        "tilt_offset_deg": round(record.tilt_offset_deg, 2),
        "hfov_deg_by_zoom": [(round(field.zoom, 3), round(field.measured_deg, 2)) for field in record.fields],
        "move_s": round(record.move_s, 2),
        "settling_s": round(record.settling_s, 2),
        "residual_px": round(record.residual_px, 2),
        "contradictions": record.contradictions,
    }


def _version() -> str:
    try:
        return version("scope-ptz")
    except PackageNotFoundError:
        return "unknown"
