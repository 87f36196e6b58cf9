"""A thread that sends short requests to the server. The main thread collects the results."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable
from typing import Any

from .address import Address
from .errors import AddOnError
from .server_client import ServerClient

Callback = Callable[[Any, str], None]
"""A function that the main thread calls with the result and the error message, which is empty on success."""


class RequestThread:
    """A thread that runs tasks one after another. A task is a function that sends requests.

    Args:
        address: The server.
        client: The name of this client.
    """

    def __init__(self, address: Address, client: str) -> None:
        self._address, self._client = address, client
        self._queue: queue.SimpleQueue[tuple[Callable[[ServerClient], Any], Callback] | None] = queue.SimpleQueue()
        self._finished: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self._thread = threading.Thread(target=self._work, name="scope-tasks", daemon=True)
        self._thread.start()

    def add(self, task: Callable[[ServerClient], Any], done: Callback) -> None:
        """Run a task in the background. After it has finished, ``collect`` calls ``done``."""
        self._queue.put((task, done))

    def collect(self) -> None:
        """Call the callbacks of finished tasks. Only the main thread may call this."""
        while not self._finished.empty():
            self._finished.get()()

    def stop(self) -> None:
        """End the thread after all queued tasks."""
        self._queue.put(None)

    def join(self, timeout_s: float) -> None:
        """Wait until the thread has ended."""
        self._thread.join(timeout_s)

    def _work(self) -> None:
        client = ServerClient(self._address, self._client)
        while (entry := self._queue.get()) is not None:
            task, done = entry
            result, problem = None, ""
            try:
                result = task(client)
            except AddOnError as error:
                problem = str(error)
            except (KeyError, TypeError, ValueError):
                problem = "The server's reply has an unknown format. Update the add-on."
            self._finished.put(lambda done=done, result=result, problem=problem: done(result, problem))  # type: ignore[misc]
        client.close()
