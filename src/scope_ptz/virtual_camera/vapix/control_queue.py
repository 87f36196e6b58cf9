"""The queue of clients that are waiting for control of the camera."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from time import monotonic

from scope_ptz.errors import CameraError
from scope_ptz.virtual_camera.accounts import Role
from scope_ptz.virtual_camera.vapix.replies import Client

CONTROL_TIMEOUT_S = 60.0
"""Seconds for which a client keeps control after its last command."""

PRIORITIES = {Role.ADMINISTRATOR: 10, Role.OPERATOR: 30, Role.VIEWER: 50}
"""The priority of clients by role. Clients with lower numbers come first in the queue."""


@dataclass(slots=True)
class _Place:
    """A client's place in the queue, with the times of its last poll and, if it has control, of its last activity."""

    client: Client
    polled_s: float
    active_s: float


@dataclass(frozen=True, slots=True)
class QueueStatus:
    """A client's status in the queue.

    Attributes:
        position: Position in the queue: 1 for the client in control, 0 for a client that is not in the queue.
        seconds: Seconds until the client in control loses control, or the estimated seconds until a waiting client receives it.
        poll_s: Seconds after which a waiting client that does not poll loses its place.
    """

    position: int
    seconds: int
    poll_s: int


class ControlQueue:
    """Gives control to one client at a time, by priority and then by order of arrival.

    Args:
        now_s: A function that returns the current time in seconds, used for timeouts.

    Attributes:
        enabled: Whether clients must have control to move the camera.
        limit: Maximum number of clients in the queue.
        poll_s: Seconds after which a waiting client that does not poll loses its place.
    """

    def __init__(self, now_s: Callable[[], float] = monotonic) -> None:
        self.enabled, self.limit, self.poll_s = False, 20, 20
        self._now_s = now_s
        self._places: list[_Place] = []

    def request(self, client: Client) -> QueueStatus:
        """Join the queue, or renew control if no other client is waiting.

        Raises:
            CameraError: The queue is full.
        """
        place = self._place(client)
        now_s = self._now_s()
        if place is None:
            if len(self._places) >= self.limit:
                raise CameraError(f"the control queue is full ({self.limit} clients)")
            self._places.append(_Place(client, now_s, now_s))
            self._places.sort(key=lambda place: PRIORITIES[place.client.role])
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
        """Return a client's status, and record that it has polled."""
        place = self._place(client)
        if place is None:
            return QueueStatus(0, 0, self.poll_s)
        place.polled_s = self._now_s()
        remaining_s = max(0.0, CONTROL_TIMEOUT_S - (self._now_s() - self._places[0].active_s))
        position = self._places.index(place)
        return QueueStatus(position + 1, round(remaining_s + CONTROL_TIMEOUT_S * max(0, position - 1)), self.poll_s)

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
        holder = f"'{self._places[0].client.name}' has control" if self._places else "no client has control"
        raise CameraError(f"{holder}; request control with /axis-cgi/com/ptzqueue.cgi?control=request")

    def _place(self, client: Client) -> _Place | None:
        """Remove clients whose control or place has expired, and return a client's place; None if it has none."""
        now_s = self._now_s()
        while self._places and now_s - self._places[0].active_s > CONTROL_TIMEOUT_S:
            expired_s = self._places.pop(0).active_s + CONTROL_TIMEOUT_S
            if self._places:
                self._places[0].active_s = expired_s
        self._places[1:] = [place for place in self._places[1:] if now_s - place.polled_s <= self.poll_s]
        return next((place for place in self._places if place.client == client), None)
