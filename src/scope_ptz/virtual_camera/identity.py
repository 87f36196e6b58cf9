"""What a virtual camera says of itself, the same in all protocols."""

from __future__ import annotations

import hashlib
import re
from dataclasses import dataclass
from uuid import NAMESPACE_URL, UUID, uuid5

from scope_ptz.version import __version__
from scope_ptz.virtual_camera.device import VirtualDevice

MANUFACTURER = "SCOPE"
MODEL = "Virtual PTZ Camera"


@dataclass(frozen=True, slots=True)
class Identity:
    """Serial number and names of a device. They follow from its name, so that clients recognise it when it starts again.

    Attributes:
        serial: Twelve hexadecimal digits, as an address of a network card that is marked as locally made.
        hostname: A name with letters, digits and hyphens.
        uuid: The identity in WS-Discovery.
    """

    name: str
    serial: str
    hostname: str
    uuid: UUID
    manufacturer: str = MANUFACTURER
    model: str = MODEL
    firmware: str = __version__

    @property
    def mac(self) -> str:
        """The serial number as an address of a network card."""
        return ":".join(self.serial[k : k + 2] for k in range(0, 12, 2)).lower()


def identify(device: VirtualDevice) -> Identity:
    """Return the identity of a device."""
    key = f"{device.name}/{device.scene.name}/{device.viewpoint}"
    serial = "02" + hashlib.sha256(key.encode()).hexdigest()[:10].upper()
    hostname = re.sub(r"[^a-z0-9]+", "-", device.name.lower()).strip("-")[:63] or "camera"
    return Identity(device.name, serial, hostname, uuid5(NAMESPACE_URL, f"urn:scope-ptz:{serial}"))
