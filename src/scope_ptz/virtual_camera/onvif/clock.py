"""A virtual camera's clock, which may be wrong."""

from __future__ import annotations

from datetime import UTC, datetime
from time import time

from scope_ptz.virtual_camera.device import VirtualDevice


def device_time_s(device: VirtualDevice) -> float:
    """Return the current time of the device's clock in Unix seconds."""
    return time() + device.faults.clock_skew_s


def device_datetime(device: VirtualDevice) -> datetime:
    """Return the current time of the device's clock in UTC."""
    return datetime.fromtimestamp(device_time_s(device), UTC)
