"""A virtual camera that is served while a test runs commands."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from anyio.from_thread import start_blocking_portal

from scope_ptz.simulator.pack import Scene
from scope_ptz.virtual_camera.accounts import Account, Role
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.http.server import serve
from scope_ptz.virtual_camera.identity import serial_number
from scope_ptz.virtual_camera.onvif.app import OnvifApp

USER, PASSWORD = "operator", "hunter-2-secret"


@dataclass(frozen=True)
class ServedCamera:
    """A device and its port."""

    device: VirtualDevice
    port: int

    @property
    def secrets(self) -> tuple[str, ...]:
        """Values that no report may contain."""
        return USER, PASSWORD, serial_number(self.device)

    def spec(self, scheme: str) -> str:
        """Return the camera spec for a command."""
        size = "&stream=mjpeg&width=320&height=180" if scheme == "axis" else "&stream=snapshot"
        return f"{scheme}://{USER}@127.0.0.1:{self.port}?latency_ms=1{size}"


@contextmanager
def serve_camera(scene: Scene) -> Iterator[ServedCamera]:
    """Serve a fast camera from another thread."""
    device = VirtualDevice(scene, accounts=[Account(USER, PASSWORD, Role.ADMINISTRATOR)], width=320, height=180, time_scale=100)
    with start_blocking_portal() as portal, portal.wrap_async_context_manager(serve([device], onvif=OnvifApp)) as (camera,):
        yield ServedCamera(device, camera.port)
