"""The state that VAPIX adds to a device: its identity, move speed and control queue."""

from __future__ import annotations

from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.identity import serial_number
from scope_ptz.virtual_camera.vapix.control_queue import ControlQueue

RESOLUTIONS = ((1920, 1080), (1280, 720), (1024, 576), (800, 450), (640, 360), (480, 270), (320, 180), (160, 90))


class VapixCamera:
    """A device together with the state that only VAPIX uses.

    Args:
        device: The camera.

    Attributes:
        speed: The pan and tilt speed for moves, from 1 to 100.
        queue: The control queue.
        serial: The serial number, which depends only on the scene and the viewpoint.
        rtsp_port: The port of its RTSP server; None if there is none.
    """

    def __init__(self, device: VirtualDevice) -> None:
        self.device = device
        self.speed = 100
        self.queue = ControlQueue()
        self.rtsp_port: int | None = None
        self.serial = serial_number(device)

    @property
    def realm(self) -> str:
        """The authentication realm, which clients show to their users."""
        return f"AXIS_{self.serial}"

    def resolutions(self) -> list[str]:
        """Return the resolutions that the camera reports, largest first."""
        full = (self.device.width, self.device.height)
        smaller = [size for size in RESOLUTIONS if size[0] < full[0] and size[1] < full[1]]
        return [f"{width}x{height}" for width, height in (full, *smaller)]
