"""A simulated bad network: a TCP proxy in front of a camera that drops data, delays it and cuts connections."""

from __future__ import annotations

import asyncio
import socket
import struct
import threading
from contextlib import suppress
from types import TracebackType
from typing import Literal, Self

Fate = Literal["forward", "drop", "refuse", "one_way"]
"""Handling of data and connections: ``drop`` is a partition (connections open but stay silent), ``refuse`` resets new
connections, and ``one_way`` forwards requests but drops replies."""


class BadNetwork:
    """Forwards connections to a port on this machine. Use it as a context manager; it runs in its own thread.

    The attributes can be changed at any time, and apply to data that passes afterwards.

    Args:
        port: The port of the camera.

    Attributes:
        fate: Handling of data and of new connections.
        delay_s: Delay of replies, in seconds.
        cut_after: Number of reply bytes after which a connection is reset, or None.
        connections: Number of accepted connections.
        port: The port of the proxy.
    """

    def __init__(self, port: int) -> None:
        self._behind = port
        self.fate: Fate = "forward"
        self.delay_s = 0.0
        self.cut_after: int | None = None
        self.connections = 0
        self.port = 0
        self._ready = threading.Event()
        self._open: set[asyncio.StreamWriter] = set()
        self._tasks: set[asyncio.Task[None]] = set()
        self._thread = threading.Thread(target=lambda: asyncio.run(self._main()), name="bad network", daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        assert self._ready.wait(10), "the proxy did not start"
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._loop.call_soon_threadsafe(self._stop.set)
        self._thread.join(10)

    def cut(self) -> None:
        """Reset all connections that are open now."""
        finished = threading.Event()

        def reset() -> None:
            for writer in list(self._open):
                _reset(writer)
            finished.set()

        self._loop.call_soon_threadsafe(reset)
        assert finished.wait(10)

    async def _main(self) -> None:
        self._loop, self._stop = asyncio.get_running_loop(), asyncio.Event()
        server = await asyncio.start_server(self._accept, "127.0.0.1", 0)
        self.port = server.sockets[0].getsockname()[1]
        self._ready.set()
        await self._stop.wait()
        server.close()
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)

    async def _accept(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        task = asyncio.current_task()
        assert task is not None
        self._tasks.add(task)
        self.connections += 1
        ends = [writer]
        try:
            if self.fate == "refuse":
                _reset(writer)
                return
            behind, to_camera = await asyncio.open_connection("127.0.0.1", self._behind)
            ends.append(to_camera)
            self._open.update(ends)
            async with asyncio.TaskGroup() as group:
                group.create_task(self._requests(reader, to_camera))
                group.create_task(self._replies(behind, writer, to_camera))
        except* (OSError, asyncio.CancelledError):
            pass
        finally:
            self._tasks.discard(task)
            for end in ends:
                self._open.discard(end)
                end.transport.abort()

    async def _requests(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        while data := await reader.read(65_536):
            if self.fate in ("forward", "one_way"):
                writer.write(data)
                await writer.drain()
        raise ConnectionError("the client has disconnected")

    async def _replies(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, camera: asyncio.StreamWriter) -> None:
        passed = 0
        while data := await reader.read(65_536):
            if self.delay_s:
                await asyncio.sleep(self.delay_s)
            if self.fate != "forward":
                continue
            if self.cut_after is not None:
                data = data[: max(0, self.cut_after - passed)]
            writer.write(data)
            await writer.drain()
            passed += len(data)
            if self.cut_after is not None and passed >= self.cut_after:
                await asyncio.sleep(0.01)  # let the data leave before the reset
                _reset(writer)
                _reset(camera)
        if self.fate == "forward":
            raise ConnectionError("the camera has disconnected")
        await asyncio.Event().wait()  # in a partition, the client does not notice that the camera has closed the connection


def _reset(writer: asyncio.StreamWriter) -> None:
    """Close a connection with a TCP reset."""
    raw = writer.get_extra_info("socket")
    with suppress(OSError):
        raw.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    writer.transport.abort()
