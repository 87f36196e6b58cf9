"""Create virtual cameras in scenes, and serve them over their protocols."""

from __future__ import annotations

import logging
import secrets
from collections.abc import AsyncIterator, Mapping, Sequence
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

from anyio import to_thread

from scope_ptz.errors import ConfigError, InputError, UnknownNameError
from scope_ptz.factory.scenes import open_scene
from scope_ptz.settings import ScopeSettings

if TYPE_CHECKING:
    from scope_ptz.virtual_camera.accounts import Account
    from scope_ptz.virtual_camera.device import VirtualDevice
    from scope_ptz.virtual_camera.http.server import ServedCamera

logger = logging.getLogger(__name__)

MAX_TIME_SCALE = 1000.0


@dataclass(frozen=True, kw_only=True)
class VirtualCameraOptions:
    """Options for serving virtual cameras.

    Attributes:
        scenes: The scene of each camera, by name.
        viewpoints: The viewpoint of each camera; empty for the scenes' home viewpoints.
        host: Address to listen on.
        port: Port of the first camera; further cameras use the following ports. 0 lets the system choose all ports.
        rtsp_port: RTSP port of the first camera, assigned in the same way as ``port``.
        time_scale: Motor speed as a multiple of the real speed.
        freeze_time: Whether scene time is paused, so that actors do not move.
        latency_s: Simulated delay in seconds from the exposure of a frame to its delivery.
        faults: The faults that the cameras simulate, by name.
        truth: Whether clients on this machine receive the ground truth for frames.
        https: Whether the cameras serve HTTPS instead of HTTP, each with a new self-signed certificate.
        discovery: Whether the cameras respond to WS-Discovery on the interface with the address ``host``.
        prefetch: Whether viewpoints are read in the background when the cameras start.
    """

    scenes: tuple[str, ...]
    viewpoints: tuple[str, ...] = ()
    host: str = "127.0.0.1"
    port: int = 0
    rtsp_port: int = 0
    time_scale: float = 1.0
    freeze_time: bool = False
    latency_s: float = 0.0
    faults: Mapping[str, object] | None = None
    truth: bool = False
    https: bool = False
    discovery: bool = True
    prefetch: bool = True


def make_accounts(users: Sequence[str], settings: ScopeSettings) -> list[Account]:
    """Create accounts with the configured password or, if there is none, with random passwords.

    Args:
        users: ``NAME`` or ``NAME:ROLE``, where ROLE is viewer, operator or administrator (the default).
        settings: The settings, which may contain the password.

    Raises:
        InputError: A name is empty or repeated, or contains characters that HTTP cannot transmit, or a role is unknown.
        ConfigError: The configured password is empty.
    """
    from scope_ptz.virtual_camera.accounts import Account, Role

    configured = settings.virtual_camera_password
    if configured is not None and not configured.get_secret_value():
        raise ConfigError("SCOPE_VIRTUAL_CAMERA_PASSWORD is empty. Set a password, or unset the variable.")
    accounts: dict[str, Account] = {}
    for user in users:
        name, _, role = user.partition(":")
        roles = {member.name.lower(): member for member in Role}
        if (role or "administrator") not in roles:
            raise UnknownNameError("role", role, roles)
        if not name or name in accounts or not (name.isascii() and name.isprintable() and '"' not in name):
            raise InputError(
                f"Each account must have a unique name of printable ASCII characters without quotes; got '{name[:60]}'."
            )
        password = configured.get_secret_value() if configured is not None else secrets.token_urlsafe(12)
        accounts[name] = Account(name, password, roles[role or "administrator"])
    return list(accounts.values())


def make_devices(options: VirtualCameraOptions, accounts: Sequence[Account]) -> list[VirtualDevice]:
    """Open the scenes, and create a virtual camera in each.

    Raises:
        InputError: A scene, viewpoint, fault or number is invalid.
        PackError: A scene's files are damaged.
    """
    from scope_ptz.simulator.clock import SceneClock
    from scope_ptz.virtual_camera.device import VirtualDevice
    from scope_ptz.virtual_camera.faults import validate_faults

    if not options.scenes:
        raise InputError("Name at least one scene, for example --scene highway-works; `scope scene list` lists them.")
    if options.viewpoints and len(options.viewpoints) != len(options.scenes):
        raise InputError(
            f"There are {len(options.scenes)} scenes but {len(options.viewpoints)} viewpoints. Specify one viewpoint per scene."
        )
    if not 0 < options.time_scale <= MAX_TIME_SCALE:
        raise InputError(f"The time scale must be above 0 and at most {MAX_TIME_SCALE:g}; got {options.time_scale}.")
    faults = validate_faults(options.faults or {})
    devices = []
    for scene_name, viewpoint in zip(options.scenes, options.viewpoints or (None,) * len(options.scenes), strict=True):
        scene = open_scene(scene_name)
        # A clock that does not follow the wall clock is frozen, because nothing else advances it: the motors have a separate clock.
        clock = SceneClock(scene.file.start_s, realtime=not options.freeze_time)
        device = VirtualDevice(scene, viewpoint=viewpoint, accounts=accounts, clock=clock, time_scale=options.time_scale)
        device.faults = faults
        devices.append(device)
    return devices


@asynccontextmanager
async def serve_virtual_cameras(
    devices: Sequence[VirtualDevice], options: VirtualCameraOptions
) -> AsyncIterator[tuple[ServedCamera, ...]]:
    """Return a context manager that serves cameras over all their protocols.

    Raises:
        ConfigError: A package is not installed, a port is in use, or a camera without accounts would be open to the network.
    """
    from scope_ptz.simulator.prefetch import Prefetches

    try:
        from scope_ptz.virtual_camera.http.certificate import create_certificate
        from scope_ptz.virtual_camera.http.server import listen, serve
        from scope_ptz.virtual_camera.onvif.app import OnvifApp
        from scope_ptz.virtual_camera.onvif.discovery import DiscoverableCamera, serve_discovery
        from scope_ptz.virtual_camera.rtsp.server import RtspServer
    except ModuleNotFoundError as error:
        raise ConfigError(f"The package {error.name} is not installed. Install it with: pip install 'scope-ptz[serve]'") from error
    ports, rtsp_ports = ([first + k if first else 0 for k in range(len(devices))] for first in (options.port, options.rtsp_port))
    hosts = tuple(dict.fromkeys(("localhost", "127.0.0.1", "::1", options.host)))
    certificates = [create_certificate(device.name, hosts) for device in devices] if options.https else []
    async with AsyncExitStack() as stack:
        listeners = [stack.enter_context(listener) for listener in listen(options.host, rtsp_ports)]
        rtsp_port_of = {device: listener.getsockname()[1] for device, listener in zip(devices, listeners, strict=True)}
        cameras = await stack.enter_async_context(
            serve(
                devices,
                host=options.host,
                ports=ports,
                truth=options.truth,
                latency_s=options.latency_s,
                onvif=lambda device: OnvifApp(device, rtsp_port=rtsp_port_of[device]),
                certificates=certificates,
            )
        )
        for camera, listener in zip(cameras, listeners, strict=True):
            await stack.enter_async_context(RtspServer(camera.source, realm=camera.vapix.realm).listen(listener))
            camera.vapix.rtsp_port = rtsp_port_of[camera.device]
        if options.discovery:
            discoverable_cameras = [DiscoverableCamera(camera.device, camera.port, tls=options.https) for camera in cameras]
            try:
                await stack.enter_async_context(serve_discovery(discoverable_cameras, host=options.host))
            except ConfigError as error:  # the cameras can be used without discovery
                logger.warning("%s", error)
        prefetches = Prefetches()
        stack.callback(prefetches.cancel)
        for device in devices if options.prefetch else ():
            await to_thread.run_sync(prefetches.start, device.prefetch)
        yield cameras
