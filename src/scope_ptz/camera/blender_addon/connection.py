"""The connection between a server and the add-on in a Blender instance: requests to the add-on, and its replies.

The add-on opens the connection and reads requests from a stream. It sends each reply, which may be a picture, in a separate
HTTP request.
"""

from __future__ import annotations

import itertools
from collections import deque
from collections.abc import AsyncGenerator
from dataclasses import dataclass, field
from secrets import token_urlsafe
from typing import Any

import anyio

from scope_ptz.camera.blender_addon.scene import SceneDescription
from scope_ptz.errors import CameraError

HEARTBEAT_S = 5.0
"""Interval in seconds between heartbeats on an idle request stream. They let both ends notice a lost connection."""

MAX_PENDING = 100
"""Maximum number of unanswered requests."""

NOT_CONNECTED = "Blender is not connected. In Blender, open the SCOPE tab of the 3D viewport's sidebar and press Connect."


@dataclass(frozen=True, slots=True)
class Picture:
    """A PNG picture. ``version`` identifies the state of the scene in the picture."""

    png: bytes
    version: str


Reply = dict[str, Any] | Picture | CameraError
"""The reply to a request: a result, a picture, or an error."""


@dataclass(slots=True)
class _PendingRequest:
    """A request whose reply has not arrived."""

    arrived: anyio.Event = field(default_factory=anyio.Event)
    reply: Reply | None = None


class AddOnConnection:
    """A connection to the add-on of one Blender instance.

    Args:
        description: The scene that is open in Blender.
        owner: The name of the client that opened the connection.
    """

    def __init__(self, description: SceneDescription, owner: str) -> None:
        self.id = token_urlsafe(16)
        self.description, self.owner = description, owner
        self.lost = False
        self._numbers = itertools.count(1)
        self._waiting: dict[int, _PendingRequest] = {}
        self._unsent: deque[dict[str, Any]] = deque()
        self._changed = anyio.Event()

    async def request(self, operation: str, arguments: dict[str, Any], *, timeout_s: float) -> dict[str, Any] | Picture:
        """Ask the add-on to carry out an operation, and return the result.

        Args:
            operation: The name of the operation.
            arguments: Its arguments, as JSON data.
            timeout_s: Seconds to wait for the reply.

        Raises:
            CameraError: The operation failed, Blender did not reply in time, or it disconnected.
        """
        if self.lost:
            raise CameraError(NOT_CONNECTED)
        if len(self._waiting) >= MAX_PENDING:
            raise CameraError("Blender has too many unanswered requests. Wait until it responds again.")
        number, waiting = next(self._numbers), _PendingRequest()
        self._waiting[number] = waiting
        self._unsent.append({"number": number, "operation": operation, "arguments": arguments})
        self._wake()
        try:
            with anyio.fail_after(timeout_s):
                await waiting.arrived.wait()
        except TimeoutError:
            raise CameraError(
                f"Blender did not answer within {timeout_s:g} s. It may be rendering, or waiting for input in a dialog."
            ) from None
        finally:
            self._waiting.pop(number, None)
        if isinstance(waiting.reply, CameraError):
            raise waiting.reply
        assert waiting.reply is not None  # noqa: S101 - set before the event
        return waiting.reply

    def answer(self, number: int, reply: Reply) -> bool:
        """Deliver the reply to a request. Return False if the request is no longer waiting for one."""
        waiting = self._waiting.get(number)
        if waiting is None or waiting.arrived.is_set():
            return False
        waiting.reply = reply
        waiting.arrived.set()
        return True

    async def requests(self) -> AsyncGenerator[dict[str, Any] | None]:
        """Yield the requests for the add-on, and None as a heartbeat, until the connection ends.

        When the consumer stops, the connection ends and all pending requests fail.
        """
        try:
            while not self.lost:
                changed = self._changed
                if not self._unsent:
                    with anyio.move_on_after(HEARTBEAT_S):
                        await changed.wait()
                yield self._unsent.popleft() if self._unsent else None
        finally:
            self.end()

    def end(self) -> None:
        """End the connection. Pending requests fail."""
        self.lost = True
        self._unsent.clear()
        self._wake()
        for number in list(self._waiting):
            self.answer(number, CameraError("Blender disconnected before it answered."))

    def _wake(self) -> None:
        changed, self._changed = self._changed, anyio.Event()
        changed.set()


class AddOnSlot:
    """Holds the current connection to a Blender add-on. Only one Blender instance can be connected at a time.

    Attributes:
        changes: Number of times that the connection or its scene has changed.
    """

    def __init__(self) -> None:
        self._current: AddOnConnection | None = None
        self.changes = 0

    @property
    def current(self) -> AddOnConnection | None:
        """The connection; None if no Blender instance is connected."""
        return None if self._current is None or self._current.lost else self._current

    @property
    def connection(self) -> AddOnConnection:
        """The connection, which must exist.

        Raises:
            CameraError: No Blender instance is connected.
        """
        if self.current is None:
            raise CameraError(NOT_CONNECTED)
        return self.current

    def connect(self, description: SceneDescription, owner: str) -> AddOnConnection:
        """Create a connection to a Blender instance, and end any previous one."""
        if self._current is not None:
            self._current.end()
        self._current = AddOnConnection(description, owner)
        self.changes += 1
        return self._current

    def update(self, connection: AddOnConnection, description: SceneDescription) -> None:
        """Replace a connection's scene description, for example after another file has been opened."""
        connection.description = description
        self.changes += 1

    def end(self) -> None:
        """End the connection, if there is one."""
        if self._current is not None:
            self._current.end()
