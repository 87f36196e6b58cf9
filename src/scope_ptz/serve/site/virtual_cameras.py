"""Turn virtual cameras on and off: network cameras on this machine that show the site's scenes."""

from __future__ import annotations

import asyncio
import logging
import secrets
from dataclasses import dataclass

import anyio
from anyio import to_thread

from scope_ptz.errors import CameraError, InputError
from scope_ptz.factory.cameras.virtual import VirtualCameraOptions, make_devices, serve_virtual_cameras
from scope_ptz.serve.site.camera_kinds import has_rules, scene_of
from scope_ptz.serve.site.errors import NotSimulatedError, RefusedByCameraError
from scope_ptz.serve.site.station import Station
from scope_ptz.virtual_camera.accounts import Account
from scope_ptz.virtual_camera.device import VirtualDevice

HOST = "127.0.0.1"
"""The address that virtual cameras listen on. Only this machine can reach them, regardless of the server's own address."""

ACCOUNT = "root"
"""The account name on virtual cameras. A new password is generated each time a camera is turned on."""

MAX_ON = 4
"""Maximum number of virtual cameras that can be on at a time. Each one keeps a scene's pictures in memory."""

START_TIMEOUT_S = 60.0
"""Maximum time, in seconds, that a virtual camera may take to start."""

logger = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class VirtualCamera:
    """A virtual camera that is on, with its viewpoint in the scene, its addresses and its account name."""

    viewpoint: str
    vapix_url: str
    onvif_url: str
    rtsp_url: str
    account: str


class _RunningCamera:
    """A virtual camera with the task that serves it."""

    def __init__(self, device: VirtualDevice) -> None:
        self.device = device
        self.stop = asyncio.Event()
        self.started: asyncio.Future[VirtualCamera] = asyncio.get_running_loop().create_future()
        self.task: asyncio.Task[None] | None = None

    @property
    def camera(self) -> VirtualCamera | None:
        """The virtual camera; None until it has started."""
        return self.started.result() if self.started.done() and self.started.exception() is None else None


class VirtualCameras:
    """A server's virtual cameras, at most one for each of the site's cameras."""

    def __init__(self) -> None:
        self._running: dict[str, _RunningCamera] = {}
        self._changing = asyncio.Lock()

    def find(self, name: str) -> VirtualCamera | None:
        """Return the virtual camera for the site's camera with this name; None if the virtual camera is off."""
        running = self._running.get(name)
        return None if running is None else running.camera

    async def turn_on(self, station: Station, viewpoint: str | None = None) -> tuple[VirtualCamera, str]:
        """Serve a camera's scene as a network camera, on ports that the operating system chooses.

        Args:
            station: The camera whose scene is shown. Its own pose and scene time are not affected.
            viewpoint: One of the scene's viewpoints; None for that of the home preset.

        Returns:
            The virtual camera and its account's password, which is not stored.

        Raises:
            NotSimulatedError: The camera shows no stored scene.
            RefusedByCameraError: The camera has rules, which a virtual camera would not follow.
            InputError: The virtual camera is already on, too many are on, the viewpoint does not exist, or a package is missing.
            CameraError: The virtual camera did not start in time.
        """
        scene = scene_of(station.spec)
        if scene is None:
            raise NotSimulatedError(
                f"{station.name} is not a simulated scene, so it has no virtual camera. Choose a camera that shows a scene."
            )
        if has_rules(station.spec):
            raise RefusedByCameraError(
                f"{station.name} has rules in scope.yaml, which a virtual camera would not follow. Turn on the "
                "virtual camera of the scene itself."
            )
        async with self._changing:
            if station.name in self._running:
                raise InputError(f"The virtual camera of {station.name} is already on. To get a new password, turn it off and on.")
            if len(self._running) >= MAX_ON:
                raise InputError(f"At most {MAX_ON} virtual cameras can be on at a time. Turn one off first.")
            password = secrets.token_urlsafe(12)
            options = VirtualCameraOptions(
                scenes=(scene,), viewpoints=(viewpoint,) if viewpoint else (), host=HOST, discovery=False, prefetch=False
            )
            (device,) = await to_thread.run_sync(make_devices, options, [Account(ACCOUNT, password)])
            running = self._running[station.name] = _RunningCamera(device)
            running.task = asyncio.create_task(self._serve(station.name, running, options))
            try:
                with anyio.fail_after(START_TIMEOUT_S):
                    return await asyncio.shield(running.started), password
            except BaseException as error:
                running.task.cancel()
                await asyncio.gather(running.task, return_exceptions=True)
                if isinstance(error, TimeoutError):
                    raise CameraError(
                        f"The virtual camera of {station.name} did not start within {START_TIMEOUT_S:g} s."
                    ) from error
                raise

    async def turn_off(self, name: str) -> None:
        """Turn off the virtual camera for the site's camera with this name, if it is on. Its clients are disconnected."""
        async with self._changing:
            running = self._running.get(name)
            if running is not None and running.task is not None:
                running.stop.set()
                await asyncio.gather(running.task, return_exceptions=True)

    async def close(self) -> None:
        """Stop all virtual cameras."""
        for name in list(self._running):
            await self.turn_off(name)

    async def _serve(self, name: str, running: _RunningCamera, options: VirtualCameraOptions) -> None:
        try:
            async with serve_virtual_cameras([running.device], options) as (served,):
                url = served.url
                running.started.set_result(
                    VirtualCamera(running.device.viewpoint, url, f"{url}/onvif/device_service", served.rtsp_url or "", ACCOUNT)
                )
                await running.stop.wait()
        except Exception as error:
            if running.started.done():
                logger.warning("The virtual camera of %s failed unexpectedly: %s", name, type(error).__name__)
            else:
                running.started.set_exception(error)
        finally:
            self._running.pop(name, None)
