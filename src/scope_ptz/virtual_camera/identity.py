"""A virtual camera's identity, which is the same for all protocols."""

from __future__ import annotations

import hashlib
import re
from uuid import NAMESPACE_URL, UUID, uuid5

from scope_ptz.virtual_camera.device import VirtualDevice

BRAND = "AXIS"
PRODUCT = "M5075-G"
FIRMWARE = "11.11.0"
"""The AXIS OS version that virtual cameras report and whose interfaces they implement."""


def serial_number(device: VirtualDevice) -> str:
    """Return the serial number, twelve hexadecimal digits that depend only on the scene and the viewpoint."""
    place = f"{device.scene.name}/{device.viewpoint}"
    return "ACCC8E" + hashlib.sha256(place.encode()).hexdigest()[:6].upper()


def mac_address(device: VirtualDevice) -> str:
    """Return the MAC address, which AXIS cameras also use as their serial number."""
    serial = serial_number(device)
    return ":".join(serial[k : k + 2] for k in range(0, len(serial), 2))


def hostname(device: VirtualDevice) -> str:
    """Return the host name, which consists of letters, digits and hyphens."""
    return re.sub(r"[^a-z0-9]+", "-", device.name.lower()).strip("-")[:63] or "camera"


def device_uuid(device: VirtualDevice) -> UUID:
    """Return the UUID that identifies the camera in WS-Discovery."""
    return uuid5(NAMESPACE_URL, f"urn:scope-ptz:{serial_number(device)}:{device.name}")
