"""The camera's connection to the server. Threads only transfer requests and replies; the main thread carries out requests."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable
from typing import Any, NamedTuple

from .address import Address
from .errors import AddOnError, ServerRefusedError
from .server_client import ServerClient, quote_part

Description = dict[str, Any]


class Request(NamedTuple):
    """A request from the server."""

    number: int
    operation: str
    arguments: dict[str, Any]


class Picture(NamedTuple):
    """A picture that a thread still has to encode. ``encode`` returns a PNG file; ``version`` identifies the state of the scene."""

    encode: Callable[[], bytes]
    version: str


Reply = dict[str, Any] | Picture | AddOnError


class CameraLink:
    """A connection that makes the open scene a camera of a server.

    The main thread can read ``requests`` and ``problem``, and call ``reply`` and ``update``, without waiting.

    Args:
        address: The server.
        camera: The name of the camera on the server.
        client: The name of this client.
        description: The description of the open scene.
    """

    def __init__(self, address: Address, camera: str, client: str, description: Description) -> None:
        self._address, self._client = address, client
        self._path = f"/cameras/{quote_part(camera)}/add-on"
        self._description = description
        self._stream = ServerClient(address, client)
        self._outbox: queue.SimpleQueue[Callable[[ServerClient], None] | None] = queue.SimpleQueue()
        self._stopping = threading.Event()
        self.requests: queue.SimpleQueue[Request] = queue.SimpleQueue()
        self.sent_updates = 0
        """Number of descriptions that the server has received through ``update``."""
        self.connected = False
        self.ended = False
        self.problem = ""
        """Why the connection failed or was lost; empty while it is open, and after ``stop``."""
        self._threads = [
            threading.Thread(target=self._read, name="scope-camera-requests", daemon=True),
            threading.Thread(target=self._write, name="scope-camera-replies", daemon=True),
        ]

    def start(self) -> None:
        """Connect, in the background."""
        self._threads[0].start()

    def stop(self) -> None:
        """Disconnect, in the background."""
        self._stopping.set()
        self._outbox.put(None)
        self._stream.close()

    def join(self, timeout_s: float) -> None:
        """Wait until the threads have ended."""
        for thread in self._threads:
            if thread.is_alive():
                thread.join(timeout_s)

    def reply(self, request: Request, reply: Reply) -> None:
        """Send the reply to a request, in the background."""
        self._outbox.put(lambda client: self._send(client, request, reply))

    def update(self, description: Description) -> None:
        """Send a new description of the scene, in the background."""

        def send(client: ServerClient) -> None:
            client.request("PUT", f"{self._path}/scene", description)
            self.sent_updates += 1

        self._outbox.put(send)

    def _read(self) -> None:
        try:
            setup = ServerClient(self._address, self._client)
            try:
                connection = setup.request("POST", self._path, self._description)["connection"]
            finally:
                setup.close()
            self._path = f"{self._path}/{quote_part(connection)}"
            self._threads[1].start()
            for event in self._stream.events(f"{self._path}/requests"):
                if self._stopping.is_set():
                    break
                self.connected = True
                if event is not None and event.name == "request":
                    self.requests.put(_parse_request(event.data))
            self._fail("The server ended the connection.")
        except AddOnError as error:
            self._fail(str(error))
        except Exception as error:  # a thread that fails silently would leave the sidebar showing "connecting"
            self._fail(f"The connection failed unexpectedly: {type(error).__name__}.")
        finally:
            self.connected, self.ended = False, True
            self._outbox.put(None)

    def _write(self) -> None:
        client = ServerClient(self._address, self._client)
        while (send := self._outbox.get()) is not None:
            try:
                send(client)
            except ServerRefusedError as error:
                if error.status != 404:  # 404: the server no longer waits for this reply
                    self._fail(str(error))
            except AddOnError as error:
                self._fail(str(error))
                break
        client.close()

    def _send(self, client: ServerClient, request: Request, reply: Reply) -> None:
        if isinstance(reply, Picture):
            try:
                data = reply.encode()
            except (OSError, ValueError) as error:
                self._send(client, request, AddOnError(f"The picture cannot be read: {error}"))
                return
            path = f"{self._path}/pictures/{request.number}?version={quote_part(reply.version)}"
            client.request_bytes("PUT", path, data, "image/png")
            return
        body = {"error": str(reply)[:500] or "unknown"} if isinstance(reply, AddOnError) else {"result": reply}
        client.request("POST", f"{self._path}/replies/{request.number}", body)

    def _fail(self, problem: str) -> None:
        if not self._stopping.is_set() and not self.problem:
            self.problem = problem


def _parse_request(data: Any) -> Request:
    try:
        number, operation, arguments = data["number"], data["operation"], data["arguments"]
    except (KeyError, TypeError):
        raise AddOnError("The server sent a request that this add-on does not understand. Update the add-on.") from None
    if not (isinstance(number, int) and isinstance(operation, str) and isinstance(arguments, dict)):
        raise AddOnError("The server sent a request that this add-on does not understand. Update the add-on.")
    return Request(number, operation, arguments)
