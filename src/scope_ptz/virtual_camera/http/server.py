"""Serve virtual cameras, each on its own port, in the running event loop."""

from __future__ import annotations

import asyncio
import logging
import socket
from collections.abc import AsyncIterator, Callable, Iterator, Sequence
from contextlib import asynccontextmanager, contextmanager
from dataclasses import dataclass
from ipaddress import ip_address

import anyio
import uvicorn
from starlette.types import ASGIApp

from scope_ptz.errors import ConfigError
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.http.application import CameraApplication
from scope_ptz.virtual_camera.http.certificate import Certificate
from scope_ptz.virtual_camera.http.connection import AbortableProtocol
from scope_ptz.virtual_camera.live_source import LiveSource
from scope_ptz.virtual_camera.truth import TruthLog
from scope_ptz.virtual_camera.vapix.vapix_camera import VapixCamera

SHUTDOWN_TIMEOUT_S = 3
"""Maximum time in seconds to wait for open replies when the server shuts down."""

RETRY_S = 1.0  # seconds to wait before restarting live video that failed

logger = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class ServedCamera:
    """A virtual camera on the network.

    Attributes:
        device: The camera.
        vapix: The camera's VAPIX state.
        source: The camera's live video, which its other servers, such as the RTSP server, also use.
        application: The web application that handles requests.
        host: Address on which the camera listens.
        port: Port of the HTTP server, or of the HTTPS server if there is a certificate.
        certificate: The certificate for HTTPS; None for HTTP.
    """

    device: VirtualDevice
    vapix: VapixCamera
    source: LiveSource
    application: CameraApplication
    host: str
    port: int
    certificate: Certificate | None = None

    @property
    def url(self) -> str:
        """The base URL for a client on this machine, such as ``http://127.0.0.1:8080``."""
        return f"{'http' if self.certificate is None else 'https'}://{self._client_host}:{self.port}"

    @property
    def rtsp_url(self) -> str | None:
        """The URL of the H.264 stream for a client on this machine; None if there is no RTSP server."""
        port = self.vapix.rtsp_port
        return None if port is None else f"rtsp://{self._client_host}:{port}/axis-media/media.amp"

    @property
    def _client_host(self) -> str:
        host = {"0.0.0.0": "127.0.0.1", "::": "::1"}.get(self.host, self.host)  # noqa: S104 - compared, not bound to
        return f"[{host}]" if ":" in host else host


@asynccontextmanager
async def serve(
    devices: Sequence[VirtualDevice],
    *,
    host: str = "127.0.0.1",
    ports: Sequence[int] = (),
    truth: bool = False,
    onvif: Callable[[VirtualDevice], ASGIApp] | None = None,
    rate_hz: float = 25.0,
    latency_s: float = 0.0,
    certificates: Sequence[Certificate] = (),
) -> AsyncIterator[tuple[ServedCamera, ...]]:
    """Return a context manager that serves cameras.

    Args:
        devices: The cameras.
        host: Address to listen on. Unless it is a loopback address, all cameras must have accounts.
        ports: A port for each camera; 0 for any free port. If the list is empty, the system chooses all ports.
        truth: Whether clients on this machine receive the ground truth for frames.
        onvif: A function that creates a camera's application for the paths below ``/onvif/``; None for no ONVIF services.
        rate_hz: Frame rate of live video in frames per second.
        latency_s: Simulated delay in seconds from the exposure of a live frame to its delivery.
        certificates: A certificate for each camera, to serve HTTPS instead of HTTP; empty for HTTP.

    Raises:
        ConfigError: A port is in use or not permitted; a camera without accounts would be open to the network; or the number of
            ports or certificates differs from the number of cameras.
    """
    ports = ports or [0] * len(devices)
    if len(ports) != len(devices):
        raise ConfigError(f"There are {len(devices)} cameras but {len(ports)} ports. Specify one port for each camera.")
    if certificates and len(certificates) != len(devices):
        raise ConfigError(f"There are {len(devices)} cameras but {len(certificates)} certificates. Specify one for each camera.")
    if not _is_loopback(host) and any(device.accounts.is_open for device in devices):
        raise ConfigError(f"A camera without accounts would be open to the network at {host}. Add an account to it.")
    logs = [TruthLog(device) if truth else None for device in devices]
    sockets = listen(host, ports)
    camera_certificates: Sequence[Certificate | None] = certificates or [None] * len(devices)
    cameras = tuple(
        _create_camera(device, listener, log, onvif, LiveSource(device, rate_hz=rate_hz, latency_s=latency_s), certificate)
        for device, listener, log, certificate in zip(devices, sockets, logs, camera_certificates, strict=True)
    )
    servers = [_Server(_uvicorn_config(camera)) for camera in cameras]
    running = [asyncio.create_task(server.serve([listener])) for server, listener in zip(servers, sockets, strict=True)]
    sources = [asyncio.create_task(_keep_running(camera.source)) for camera in cameras]
    try:
        for server in servers:
            await server.ready.wait()
        yield cameras
    finally:
        with anyio.CancelScope(shield=True):
            for camera in cameras:
                camera.application.close()
            for server in servers:
                server.should_exit = True
            await asyncio.gather(*running, return_exceptions=True)
            for task in sources:
                task.cancel()
            await asyncio.gather(*sources, return_exceptions=True)
            for log in logs:
                if log is not None:
                    log.close()
            for device in devices:
                device.scene.end_threads()


class _Server(uvicorn.Server):
    """A server that sets ``ready`` once it is listening, and leaves signal handling to the surrounding program."""

    def __init__(self, config: uvicorn.Config) -> None:
        super().__init__(config)
        self.ready = asyncio.Event()

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        self.ready.set()

    @contextmanager
    def capture_signals(self) -> Iterator[None]:
        yield


def _create_camera(
    device: VirtualDevice,
    listener: socket.socket,
    log: TruthLog | None,
    onvif: Callable[[VirtualDevice], ASGIApp] | None,
    source: LiveSource,
    certificate: Certificate | None,
) -> ServedCamera:
    vapix = VapixCamera(device)
    application = CameraApplication(vapix, source, log, onvif(device) if onvif is not None else None)
    host, port = listener.getsockname()[:2]
    return ServedCamera(device, vapix, source, application, host, port, certificate)


def _uvicorn_config(camera: ServedCamera) -> uvicorn.Config:
    certificate = camera.certificate
    return uvicorn.Config(
        camera.application.app,
        http=AbortableProtocol,
        ws="none",
        lifespan="off",
        log_config=None,
        access_log=False,
        server_header=False,
        proxy_headers=False,  # address headers from clients are not trusted
        timeout_keep_alive=15,
        timeout_graceful_shutdown=SHUTDOWN_TIMEOUT_S,
        ssl_context_factory=None if certificate is None else lambda _config, _default: certificate.server_context(),
    )


def listen(host: str, ports: Sequence[int]) -> list[socket.socket]:
    """Return a listening socket for each port. If a port cannot be used, the sockets that are already open are closed.

    Raises:
        ConfigError: A port is in use or not permitted.
    """
    sockets: list[socket.socket] = []
    try:
        for port in ports:
            sockets.append(socket.create_server((host, port), family=socket.AF_INET6 if ":" in host else socket.AF_INET))
            # asyncio sets TCP_NODELAY only on sockets with an explicit protocol. Without it, replies wait up to 40 ms for an ACK.
            sockets[-1].setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    except (OSError, OverflowError) as error:
        for opened in sockets:
            opened.close()
        reason = getattr(error, "strerror", None) or str(error)
        raise ConfigError(
            f"Port {port} on {host} cannot be used: {reason}. Choose another port, or 0 for any free port."
        ) from error
    return sockets


def _is_loopback(host: str) -> bool:
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


async def _keep_running(source: LiveSource) -> None:
    """Run a live video source, and restart it after each failure. Clients receive no new frames in the meantime."""
    while True:
        try:
            await source.run()
        except* Exception as group:
            logger.warning("The live video of %s failed and will be restarted: %s", source.device.name, group.exceptions[0])
            await asyncio.sleep(RETRY_S)
