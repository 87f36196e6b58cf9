"""Camera control. One client at a time has control of a camera, until it hands control over or control expires."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import AsyncExitStack, contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from time import monotonic

from scope_ptz.camera.base import Camera
from scope_ptz.errors import UnknownNameError
from scope_ptz.serve.site.clients import Client
from scope_ptz.serve.site.errors import NotInControlError

LEASE_S = 120.0
"""Seconds without a command after which control expires."""

ABSENT_S = 5.0
"""Seconds after which control expires if its holder has closed its last live connection. A page reconnects within 2 s."""

MAX_REQUESTS = 20
"""Maximum number of clients that can wait for control."""


@dataclass(frozen=True, slots=True)
class ControlRequest:
    """A client's request for control: the client's key and name, and the time of the request."""

    key: str
    name: str
    since: datetime


class CameraControl:
    """Control of one camera.

    A client that sends a command gets control if nobody has it. If another client has it (the holder), the client can ask for
    control, and the holder hands it over or keeps it. Control expires if the holder sends no commands, or if it closes its live
    connection, so that a closed laptop or a closed browser does not block a camera. Control cannot expire during a run.

    Args:
        camera: The camera's name.
        busy: Returns whether a run is in progress.
        lease_s: Seconds without a command after which control expires.
        absent_s: Seconds without a live connection after which control expires. It applies only to a holder that had one.
    """

    def __init__(self, camera: str, is_busy: Callable[[], bool], *, lease_s: float = LEASE_S, absent_s: float = ABSENT_S) -> None:
        self._camera, self._is_busy, self._lease_s, self._absent_s = camera, is_busy, lease_s, absent_s
        self._holder: Client | None = None
        self._since = datetime.now(UTC)
        self._last_used_s = 0.0
        self._released = False
        self._connections: Counter[str] = Counter()
        self._absent_since_s: float | None = None
        self._requests: dict[str, ControlRequest] = {}
        self._lock = AsyncExitStack()
        self.changes = 0
        """Number of changes so far, which watchers compare to notice changes."""

    @property
    def holder(self) -> Client | None:
        """The client that has control; None if nobody has it."""
        now_s = monotonic()
        absent = self._absent_since_s is not None and now_s - self._absent_since_s > self._absent_s
        expired = not self._is_busy() and (self._released or absent or now_s - self._last_used_s > self._lease_s)
        return None if expired else self._holder

    @property
    def since(self) -> datetime:
        """When the holder got control."""
        return self._since

    @property
    def requests(self) -> tuple[ControlRequest, ...]:
        """The requests for control, oldest first."""
        return tuple(self._requests.values())

    @contextmanager
    def live_connection(self, client: Client) -> Iterator[None]:
        """Return a context in which a client has a live connection. Control expires soon after the holder's last one closes."""
        self._connections[client.key] += 1
        if self._holder is not None and self._holder.key == client.key:
            self._absent_since_s = None
        try:
            yield
        finally:
            self._connections[client.key] -= 1
            if not self._connections[client.key]:
                del self._connections[client.key]
                if self._holder is not None and self._holder.key == client.key:
                    self._absent_since_s = monotonic()

    async def require(self, client: Client, camera: Camera) -> None:
        """Make sure that a client has control. If nobody has control, the client takes it.

        Raises:
            NotInControlError: Another client has control.
            ControlHeldError: Another user of this camera object, outside the server, has control.
        """
        holder = self.holder
        if holder is not None and holder.key != client.key:
            raise NotInControlError(self._camera, holder.name)
        if holder is None:
            await self._hand_to(client, camera)
        self._last_used_s, self._released, self._absent_since_s = monotonic(), False, None

    async def ask(self, client: Client, camera: Camera) -> bool:
        """Take control if nobody has it; otherwise, ask the holder for it. Return whether the client now has control.

        Raises:
            ControlHeldError: Another user of this camera object, outside the server, has control.
        """
        holder = self.holder
        if holder is None or holder.key == client.key:
            await self.require(client, camera)
            return True
        if client.key not in self._requests and len(self._requests) < MAX_REQUESTS:
            self._requests[client.key] = ControlRequest(client.key, client.name, datetime.now(UTC))
            self.changes += 1
        return False

    async def answer(self, holder: Client, key: str, camera: Camera, *, grant: bool, new_holder: Client | None = None) -> None:
        """Answer a request for control: hand control over to the client, or refuse.

        Args:
            holder: The client that answers.
            key: The key of the client that is asking.
            camera: The camera.
            grant: Whether to hand control over.
            new_holder: The client that is asking; by default, an operator with the name and the key in the request.

        Raises:
            NotInControlError: ``holder`` does not have control.
            UnknownNameError: The client has not asked for control.
        """
        if (current := self.holder) is None or current.key != holder.key:
            raise NotInControlError(self._camera, current.name if current else "nobody")
        if key not in self._requests:
            raise UnknownNameError("request for control", key[:80], ())
        request = self._requests.pop(key)
        self.changes += 1
        if grant:
            await self._hand_to(new_holder or Client(request.name, key, "operator"), camera)

    async def release(self, client: Client) -> None:
        """Give up control, or withdraw a request for it. If the client has neither, the call has no effect.

        During a run, control is given up when the run ends, unless the client sends another command first.
        """
        if self._requests.pop(client.key, None) is not None:
            self.changes += 1
        if self._holder is not None and self._holder.key == client.key:
            self._released = True
            await self.clear_if_released()

    async def clear_if_released(self) -> None:
        """Clear control if the holder gave it up and no run is in progress."""
        if self._released and not self._is_busy():
            await self.clear()

    async def clear(self) -> None:
        """Take control away from its holder, if any."""
        self._holder, self._released = None, False
        self.changes += 1
        await self._lock.aclose()

    async def _hand_to(self, client: Client, camera: Camera) -> None:
        await self._lock.aclose()
        self._holder = None
        # The camera's own lock shows other programs that use the same device which client has control.
        await self._lock.enter_async_context(camera.control(client.name))
        self._holder, self._since, self._last_used_s, self._released = client, datetime.now(UTC), monotonic(), False
        self._absent_since_s = None
        self._requests.pop(client.key, None)
        self.changes += 1
