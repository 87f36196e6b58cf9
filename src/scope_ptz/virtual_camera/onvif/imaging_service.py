"""The ONVIF imaging service: focus and iris."""

from __future__ import annotations

import math
from typing import Any

from scope_ptz.virtual_camera.accounts import Role
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.onvif.media_profiles import SOURCE
from scope_ptz.virtual_camera.onvif.operations import Operation, Operations, Reply, Request
from scope_ptz.virtual_camera.onvif.soap import SoapFault, invalid_argument

CLOSED_IRIS_DB = 20.0
"""Attenuation of the closed iris in dB, the unit of ONVIF iris values. The open iris has an attenuation of 0 dB."""

_MODES = ["AUTO", "MANUAL"]
_POSITIONS = {"Min": 0.0, "Max": 1.0}
_DISTANCES = {"Min": -1.0, "Max": 1.0}
_IRIS = {"Min": 0.0, "Max": CLOSED_IRIS_DB}
_TOLERANCE = 1e-4  # clients that calculate in single precision may slightly exceed a range


class ImagingService:
    """The ONVIF imaging service.

    Args:
        device: The camera.
    """

    def __init__(self, device: VirtualDevice) -> None:
        self._device = device

    def operations(self) -> Operations:
        """Return the operations by name."""
        return {
            "GetServiceCapabilities": Operation(lambda _: {"Capabilities": {"ImageStabilization": False}}, None),
            "GetImagingSettings": Operation(self._settings),
            "GetOptions": Operation(self._options),
            "GetMoveOptions": Operation(self._move_options),
            "GetStatus": Operation(self._status),
            "SetImagingSettings": Operation(self._set, Role.OPERATOR),
            "Move": Operation(self._move, Role.OPERATOR),
            "Stop": Operation(self._stop, Role.OPERATOR),
        }

    def _settings(self, request: Request) -> Reply:
        _require_source(request)
        lens = self._device.lens
        exposure = {"Mode": _mode(lens.autoiris), "Iris": (1.0 - lens.iris) * CLOSED_IRIS_DB}
        return {"ImagingSettings": {"Exposure": exposure, "Focus": {"AutoFocusMode": _mode(lens.autofocus)}}}

    def _options(self, request: Request) -> Reply:
        _require_source(request)
        return {"ImagingOptions": {"Exposure": {"Mode": _MODES, "Iris": _IRIS}, "Focus": {"AutoFocusModes": _MODES}}}

    def _move_options(self, request: Request) -> Reply:
        _require_source(request)
        options = {
            "Absolute": {"Position": _POSITIONS},
            "Relative": {"Distance": _DISTANCES},
            "Continuous": {"Speed": {"Min": -1.0, "Max": 1.0}},
        }
        return {"MoveOptions": options}

    def _status(self, request: Request) -> Reply:
        _require_source(request)
        lens = self._device.lens
        focus = {"Position": lens.focus, "MoveStatus": "MOVING" if lens.is_focusing else "IDLE", "Error": ""}
        return {"Status": {"FocusStatus20": focus}}

    def _set(self, request: Request) -> Reply:
        """Apply the settings in a request, after validating all of them."""
        _require_source(request)
        lens, settings = self._device.lens, request.ImagingSettings
        focus, exposure = settings.Focus, settings.Exposure
        iris = None if exposure is None or exposure.Iris is None else _validate_range(exposure.Iris, 0.0, CLOSED_IRIS_DB)
        if focus is not None and (focus.AutoFocusMode == "AUTO") != lens.autofocus:
            lens.set_autofocus(on=focus.AutoFocusMode == "AUTO")
        if exposure is not None:
            lens.set_autoiris(on=exposure.Mode == "AUTO")
            if exposure.Mode == "MANUAL" and iris is not None:
                lens.set_iris(1.0 - iris / CLOSED_IRIS_DB)
        return {}

    def _move(self, request: Request) -> Reply:
        _require_source(request)
        lens, focus_move = self._device.lens, request.Focus
        if focus_move is None:
            raise invalid_argument("A move request must specify a focus move.", "SettingsInvalid")
        if focus_move.Absolute is not None:
            lens.move_focus(_validate_range(focus_move.Absolute.Position, 0.0, 1.0))
        elif focus_move.Relative is not None:
            lens.move_focus(lens.focus + _validate_range(focus_move.Relative.Distance, -1.0, 1.0))
        elif focus_move.Continuous is not None:
            lens.drive_focus(_validate_range(focus_move.Continuous.Speed, -1.0, 1.0))
        else:
            raise invalid_argument("A move request must be absolute, relative or continuous.", "SettingsInvalid")
        return {}

    def _stop(self, request: Request) -> Reply:
        _require_source(request)
        if self._device.lens.is_focusing:
            self._device.lens.stop_focus()
        return {}


def _require_source(request: Request) -> None:
    if request.VideoSourceToken != SOURCE:
        raise SoapFault(f"There is no video source '{str(request.VideoSourceToken)[:64]}'.", "InvalidArgVal", "NoSource")


def _validate_range(value: Any, low: float, high: float) -> float:
    """Validate a number in a request, and return it clamped to its range.

    Raises:
        SoapFault: The number is missing or outside the range.
    """
    if value is None or not math.isfinite(value) or not low - _TOLERANCE <= value <= high + _TOLERANCE:
        raise invalid_argument(f"The value must be from {low:g} to {high:g}; got {value}.", "SettingsInvalid")
    return min(max(float(value), low), high)


def _mode(automatic: bool) -> str:
    return "AUTO" if automatic else "MANUAL"
