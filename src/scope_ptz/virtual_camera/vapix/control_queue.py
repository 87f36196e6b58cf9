"""The queue of clients that request control of the camera."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from time import monotonic

from scope_ptz.errors import CameraError
from scope_ptz.virtual_camera.accounts import Role
from scope_ptz.virtual_camera.vapix.replies import Client

CONTROL_TIMEOUT_S = 60.0
"""How long a client keeps control after its last command, in seconds."""

PRIORITIES = {Role.ADMINISTRATOR: 10, Role.OPERATOR: 30, Role.VIEWER: 50}
"""Priority of the clients with each role. Clients with lower numbers come first in the queue."""


@dataclass(slots=True)
class _Place:
    """A client in the queue, with the times of its last poll and, if it has control, of its last activity."""

    client: Client
    polled_s: float
    active_s: float


@dataclass(frozen=True, slots=True)
class QueueStatus:
    """The status of a client in the queue.

    Attributes:
        position: 1 for the client in control, and 0 for a client that is not in the queue.
        seconds: Seconds until the client in control loses it, or the estimated seconds until a waiting client gets it.
        poll_s: Seconds after which a waiting client that does not poll loses its place.
    """

    position: int
    seconds: int
    poll_s: int


class ControlQueue:
    """Gives control to one client at a time, by priority and, among equals, in the order of arrival.

    Args:
        now_s: Returns the current time in seconds, for timeouts.

    Attributes:
        enabled: Whether clients need control to move the camera.
        limit: Maximum number of clients in the queue.
        poll_s: Seconds after which a waiting client that does not poll loses its place.
    """

    def __init__(self, now_s: Callable[[], float] = monotonic) -> None:
        self.enabled, self.limit, self.poll_s = False, 20, 20
        self._now_s = now_s
        self._places: list[_Place] = []

    def request(self, client: Client) -> QueueStatus:
        """Join the queue, or renew control if no other client waits.

        Raises:
            CameraError: The queue is full.
        """
        place = self._place(client)
        now_s = self._now_s()
        if place is None:
            if len(self._places) >= self.limit:
                raise CameraError(f"the control queue is full ({self.limit} clients)")
            self._places.append(_Place(client, now_s, now_s))
            self._places.sort(key=lambda each: PRIORITIES[each.client.role])
            if self._places[0].client == client:
                self._places[0].active_s = now_s
        elif len(self._places) == 1:
            place.active_s = now_s
        return self.status(client)

    def drop(self, client: Client) -> QueueStatus:
        """Give up control, or leave the queue."""
        place = self._place(client)
        if place is not None:
            if place is self._places[0] and len(self._places) > 1:
                self._places[1].active_s = self._now_s()
            self._places.remove(place)
        return self.status(client)

    def status(self, client: Client) -> QueueStatus:
        """Return the status of a client, and record that it polled."""
        place = self._place(client)
        if place is None:
            return QueueStatus(0, 0, self.poll_s)
        place.polled_s = self._now_s()
        left_s = max(0.0, CONTROL_TIMEOUT_S - (self._now_s() - self._places[0].active_s))
        position = self._places.index(place)
        return QueueStatus(position + 1, round(left_s + CONTROL_TIMEOUT_S * max(0, position - 1)), self.poll_s)

    def check(self, client: Client) -> None:
        """Check that a client may move the camera, and renew its control.

        Raises:
            CameraError: Another client has control, or no client has control.
        """
        if not self.enabled:
            return
        place = self._place(client)
        if place is not None and place is self._places[0]:
            place.active_s = place.polled_s = self._now_s()
            return
        holder = f"'{self._places[0].client.name}' has control" if self._places else "nobody has control"
        raise CameraError(f"{holder}; request control with /axis-cgi/com/ptzqueue.cgi?control=request")

    def _place(self, client: Client) -> _Place | None:
        """Remove the clients whose control or place has expired, and return the place of a client; None if it has none."""
        now_s = self._now_s()
        while self._places and now_s - self._places[0].active_s > CONTROL_TIMEOUT_S:
            over_s = self._places.pop(0).active_s + CONTROL_TIMEOUT_S
            if self._places:
                self._places[0].active_s = over_s
        self._places[1:] = [place for place in self._places[1:] if now_s - place.polled_s <= self.poll_s]
        return next((place for place in self._places if place.client == client), None)
