"""One of the site's cameras. It is opened on first use and shared by all clients."""

from __future__ import annotations

import asyncio
import logging
from collections import deque
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
from time import monotonic

import anyio
from anyio import to_thread

from scope_ptz.camera.base import Arrival, Camera
from scope_ptz.camera.blender_addon.connection import AddOnSlot
from scope_ptz.camera.guard.wrapper import innermost
from scope_ptz.camera.simulated import SimulatedCamera
from scope_ptz.errors import CameraError, InputError, PackError, ScopeError
from scope_ptz.factory.cameras import OpenCamera, open_camera
from scope_ptz.geometry import Pose
from scope_ptz.serve.site.camera_control import LEASE_S, CameraControl
from scope_ptz.serve.site.clients import Client
from scope_ptz.serve.site.errors import BusyError
from scope_ptz.serve.site.live_picture import LivePicture
from scope_ptz.serve.site.pairs import Models, Pairs
from scope_ptz.serve.site.run_handle import RunHandle
from scope_ptz.simulator.prefetch import Prefetches

MAX_UNDO = 50
"""Maximum number of earlier positions to which ``undo`` can return, one after another."""

PREFETCH_TIMEOUT_S = 20.0
"""Maximum time, in seconds, for which ``close`` waits for a picture that is still being read in the background."""

DRIVE_GROUP_S = 2.0
"""``undo`` treats consecutive drive commands as one if they are at most this many seconds apart."""

logger = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class IdleReturn:
    """The preset to which a camera returns after it has been unused for ``after_s`` seconds. An empty name means home."""

    after_s: float
    preset: str = ""


@dataclass(frozen=True, slots=True)
class CameraPosition:
    """A camera's position: its pose, and its viewpoint if it is simulated."""

    pose: Pose
    viewpoint: str | None


class Station:
    """One of the site's cameras, with its control, models and undo history.

    Args:
        name: The name that requests use.
        spec: The camera's spec. It must not come from a request, because a spec can name any device.
        pairs: The pairs of models.
        actor: The server's name in the camera's audit log, and for other programs that use the device.
        idle: The preset to which the camera returns when it is unused; None to leave it where it is.
        lease_s: Seconds without a command after which control expires.
    """

    def __init__(
        self, name: str, spec: str, pairs: Pairs, *, actor: str, idle: IdleReturn | None = None, lease_s: float = LEASE_S
    ) -> None:
        self.name = name
        self.spec, self._pairs, self._actor, self._idle = spec, pairs, actor, idle
        self._opened: OpenCamera | None = None
        self._prefetches = Prefetches()
        self._opening = asyncio.Lock()
        self._models: dict[str, Models] = {}
        self._undo_positions: deque[CameraPosition] = deque(maxlen=MAX_UNDO)
        self.problem: ScopeError | None = None
        """The error from the last attempt to open the camera; None if that attempt succeeded."""
        self.visited: dict[str, CameraPosition] = {}
        """The position of each visited preset, by preset name. Not all cameras report their presets' poses."""
        self._last_drive_s = -DRIVE_GROUP_S
        self._last_command_s = monotonic()
        self._returned = True
        self.current_run: RunHandle | None = None
        self.add_on = AddOnSlot()
        """The connection to the Blender add-on. Only a camera of the kind ``blender-window`` uses it."""
        self.control = CameraControl(name, lambda: self.current_run is not None, lease_s=lease_s)
        self.live = LivePicture(name, self.camera)
        self.preset_changes = 0
        """Number of preset changes so far, which watchers compare to notice changes."""

    async def get_open_camera(self) -> OpenCamera:
        """Return the open camera. The first call opens it.

        Raises:
            CameraError: The camera fails, does not answer, or is controlled by another program.
        """
        async with self._opening:
            if self._opened is None:
                try:
                    self._opened = await open_camera(self.spec, realtime=True, actor=self._actor, add_on=self.add_on)
                except ScopeError as error:
                    self.problem = error
                    raise
                self.problem = None
                if isinstance(camera := innermost(self._opened.camera), SimulatedCamera):
                    await to_thread.run_sync(self._prefetches.start, camera.prefetch)
            return self._opened

    async def camera(self) -> Camera:
        """Return the open camera. Raises the same errors as ``get_open_camera``."""
        return (await self.get_open_camera()).camera

    @property
    def is_open(self) -> bool:
        """Whether the camera has been opened."""
        return self._opened is not None

    @property
    def open_camera(self) -> OpenCamera | None:
        """The camera, if it has been opened."""
        return self._opened

    async def models(self, pair: str) -> Models:
        """Return a pair's planner and perception backend for this camera. The first call for a pair creates them."""
        if pair not in self._models:
            self._models[pair] = await self._pairs.open(pair, await self.get_open_camera())
        return self._models[pair]

    async def require_control(self, client: Client) -> Camera:
        """Return the camera for a client's command. If nobody has control, the client gets it.

        Raises:
            NotInControlError: Another client controls the camera.
            BusyError: A run is in progress.
        """
        camera = await self.camera()
        await self.control.require(client, camera)
        if self.current_run is not None:
            raise BusyError(self.name, self.current_run.id)
        self.touch()
        return camera

    @asynccontextmanager
    async def command(self, client: Client) -> AsyncIterator[Camera]:
        """Return a context in which a client moves the camera. A later ``undo`` returns to the position at entry.

        Raises:
            NotInControlError: Another client controls the camera.
            BusyError: A run is in progress.
        """
        camera = await self.require_control(client)
        await self.remember()
        try:
            yield camera
        finally:
            self.touch()

    def touch(self) -> None:
        """Record that the camera is in use."""
        self._last_command_s, self._returned = monotonic(), False

    async def remember(self) -> None:
        """Record the current position, so that ``undo`` can return to it."""
        position = await self.position()
        if not self._undo_positions or self._undo_positions[-1] != position:
            self._undo_positions.append(position)

    async def drive(self, client: Client, pan_dps: float, tilt_dps: float, zoom_rate: float, timeout_s: float) -> None:
        """Drive the camera at constant velocities until the timeout.

        Args:
            client: The client that sends the command.
            pan_dps: Pan velocity in degrees per second.
            tilt_dps: Tilt velocity in degrees per second.
            zoom_rate: Zoom velocity in octaves of magnification per second.
            timeout_s: Seconds after which the camera stops.
        """
        camera = await self.require_control(client)
        if monotonic() - self._last_drive_s > DRIVE_GROUP_S:
            await self.remember()
        self._last_drive_s = monotonic()
        await camera.drive(pan_dps, tilt_dps, zoom_rate, timeout_s=timeout_s)

    async def stop(self) -> None:
        """Cancel the run in progress, if any, and stop the camera. The caller does not need control."""
        if self.current_run is not None:
            self.current_run.cancel()
        if self._opened is not None:
            await self._opened.camera.stop()

    async def undo(self, client: Client) -> Arrival:
        """Return to the position before the last command.

        Raises:
            InputError: There is nothing to undo.
        """
        camera = await self.require_control(client)
        current = await self.position()
        while self._undo_positions and self._undo_positions[-1] == current:
            self._undo_positions.pop()
        if not self._undo_positions:
            raise InputError("There is no earlier view to return to.")
        return await self.return_to(camera, self._undo_positions.pop())

    async def return_to(self, camera: Camera, position: CameraPosition) -> Arrival:
        """Move the camera to an earlier position."""
        if position.viewpoint is not None and position.viewpoint != await self.viewpoint():
            await camera.go_to_preset(self._preset_at(position.viewpoint))
        return await camera.move(position.pose)

    @property
    def can_undo(self) -> bool:
        """Whether there is an earlier view to return to."""
        return bool(self._undo_positions)

    async def watch_idle(self) -> None:
        """Return the camera to its idle preset whenever it has been unused for long enough, until cancelled."""
        idle = self._idle
        while idle is not None:
            await anyio.sleep(min(1.0, idle.after_s / 2))
            unused_s = monotonic() - self._last_command_s
            if self._returned or self.current_run is not None or not self.is_open or unused_s < idle.after_s:
                continue
            self._returned = True
            try:
                camera = await self.camera()
                await (camera.go_to_preset(idle.preset) if idle.preset else camera.go_home())
            except ScopeError as error:
                logger.warning("%s is not used and cannot return to its preset: %s", self.name, error)

    def cancel_prefetch(self) -> None:
        """Stop reading pictures in the background."""
        self._prefetches.cancel()

    async def close(self) -> None:
        """Stop and close the camera, and close the connections to models."""
        self.add_on.end()  # first, so that nothing waits for a Blender instance that does not read its requests
        opened, self._opened = self._opened, None
        for models in self._models.values():
            await models.close()
        if opened is not None:
            await self.control.clear()
            with suppress(CameraError):
                await opened.camera.stop()
            await opened.aclose()
        # A thread that is still running when the interpreter exits would crash the program.
        self.cancel_prefetch()
        with suppress(PackError, OSError):
            await to_thread.run_sync(self._prefetches.wait, PREFETCH_TIMEOUT_S)

    async def viewpoint(self) -> str | None:
        """Return a simulated camera's viewpoint; None for other cameras."""
        return getattr(innermost(await self.camera()), "viewpoint", None)

    async def position(self) -> CameraPosition:
        """Return the camera's current position."""
        return CameraPosition(await (await self.camera()).pose(), await self.viewpoint())

    def _preset_at(self, viewpoint: str) -> str:
        scene = self._opened.scene if self._opened is not None else None
        for preset in scene.file.presets if scene is not None else ():
            if preset.viewpoint == viewpoint:
                return preset.name
        raise InputError(
            f"The earlier view was taken from the viewpoint '{viewpoint}', which no preset uses, so the camera cannot return there."
        )
