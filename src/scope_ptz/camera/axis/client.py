"""A VAPIX client, which sends requests, returns replies, and manages its place in the device's control queue."""

from __future__ import annotations

from time import monotonic
from typing import TYPE_CHECKING

from scope_ptz.camera.axis import requests
from scope_ptz.camera.axis.replies import VapixError, check_done, parse_position, parse_presets, parse_queue
from scope_ptz.camera.control import ControlHeldError
from scope_ptz.camera.network.errors import CameraReplyError, CameraSignInError
from scope_ptz.errors import CameraError

if TYPE_CHECKING:
    from scope_ptz.camera.axis.replies import Position, QueuePlace
    from scope_ptz.camera.axis.requests import VapixRequest
    from scope_ptz.camera.network.address import DeviceAddress
    from scope_ptz.camera.network.http import DeviceHttp, DeviceReply

NOT_IMPLEMENTED_STATUSES = (404, 405, 501)
"""HTTP status codes that indicate that the device lacks the requested interface."""


class DeviceControlHeldError(ControlHeldError):
    """Another client has control of the device, according to the device's own control queue."""

    def __init__(self, camera: str, place: QueuePlace) -> None:
        wait = f"about {place.seconds} s" if place.seconds >= 0 else "unknown length"
        # VAPIX reports a position in the queue, but not the names of the clients.
        CameraError.__init__(
            self,
            f"{camera} is controlled by another client in its control queue (this client would be number {place.place} in the "
            f"queue, with a wait of {wait}). Wait, or ask the other client to release control.",
        )
        self.holder = None


class VapixClient:
    """The connection to one channel of a device.

    Args:
        http: The HTTP connection to the device.
        channel: The video channel, from 1.
    """

    def __init__(self, http: DeviceHttp, channel: int = 1) -> None:
        self.http, self.channel = http, channel
        self.control_queue_on = False
        """Whether the device's control queue is enabled. If it is, commands require control."""
        self._control_until_s = 0.0

    @property
    def address(self) -> DeviceAddress:
        return self.http.address

    async def send(self, request: VapixRequest) -> DeviceReply:
        """Send a request.

        Raises:
            CameraError: The device cannot be reached, or lacks the interface.
        """
        reply = await self.http.get(request.path, request.query, retry=request.retryable, accept=NOT_IMPLEMENTED_STATUSES)
        if reply.status in NOT_IMPLEMENTED_STATUSES:
            raise CameraReplyError(f"The camera at {self.address} does not support {request.path}. Check its model and firmware.")
        return reply

    async def command(self, request: VapixRequest) -> None:
        """Take control if the device requires it, and send a command that moves or changes the camera.

        Raises:
            VapixError: The device refuses the command.
            ControlHeldError: Another client has control.
        """
        await self.take_control()
        check_done((await self.send(request)).body)

    async def position(self) -> Position:
        """Read the current position."""
        return parse_position((await self.send(requests.query(self.channel, "position"))).body)

    async def presets(self) -> dict[int, str]:
        """Read the preset names, keyed by preset number."""
        return parse_presets((await self.send(requests.query(self.channel, "presetposcam"))).body)

    async def take_control(self) -> None:
        """Take or renew control if the device's control queue is on.

        Raises:
            ControlHeldError: Another client has control. This client has left the queue.
        """
        if not self.control_queue_on or monotonic() < self._control_until_s:
            return
        try:
            place = parse_queue((await self.send(requests.control_queue(self.channel, "request"))).body)
        except VapixError as error:
            raise CameraError(f"The control queue of the camera at {self.address} did not assign a position. {error}") from None
        if place.place != 1:
            await self.drop_control()
            raise DeviceControlHeldError(f"The camera at {self.address}", place)
        remaining_s = place.poll_s if place.seconds < 0 else min(place.poll_s, place.seconds)
        self._control_until_s = monotonic() + remaining_s / 2

    async def drop_control(self) -> None:
        """Release control, or leave the queue."""
        if not self.control_queue_on:
            return
        self._control_until_s = 0.0
        try:
            await self.send(requests.control_queue(self.channel, "drop"))
        except CameraSignInError:
            raise
        except CameraError:
            return  # the queue drops clients that stop sending requests
