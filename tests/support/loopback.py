"""A loopback HTTP server with scripted behaviours, and addresses without a working server."""

from __future__ import annotations

import asyncio
import json
import socket
import threading
from collections.abc import Awaitable, Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from types import TracebackType
from typing import Any, Self

JSON_TYPE = "application/json"


@dataclass(frozen=True)
class Request:
    """A received request. ``data`` is the JSON body, or ``{}``."""

    method: str
    path: str
    headers: Mapping[str, str]
    data: dict[str, Any]

    @property
    def streaming(self) -> bool:
        return bool(self.data.get("stream"))

    @property
    def chat(self) -> bool:
        return self.path.endswith("/chat/completions")


class Exchange:
    """One request and the means to answer it."""

    def __init__(self, request: Request, writer: asyncio.StreamWriter) -> None:
        self.request, self.writer = request, writer
        self.keep_open = True

    async def send(self, data: bytes) -> None:
        self.writer.write(data)
        await self.writer.drain()

    async def head(
        self, code: int = 200, content_type: str = JSON_TYPE, length: int | None = None, headers: Mapping[str, str] | None = None
    ) -> None:
        """Send the status and the headers. Without a length, the body is sent in chunks."""
        lines = [f"HTTP/1.1 {code} {'OK' if code == 200 else 'Whatever'}"]
        if content_type:
            lines.append(f"Content-Type: {content_type}")
        lines.append("Transfer-Encoding: chunked" if length is None else f"Content-Length: {length}")
        lines += [f"{name}: {value}" for name, value in (headers or {}).items()]
        await self.send(("\r\n".join(lines) + "\r\n\r\n").encode())

    async def whole(
        self, body: bytes, code: int = 200, content_type: str = JSON_TYPE, headers: Mapping[str, str] | None = None
    ) -> None:
        await self.head(code, content_type, len(body), headers)
        await self.send(body)

    async def chunk(self, data: bytes) -> None:
        await self.send(b"%x\r\n%s\r\n" % (len(data), data))

    async def event(self, data: dict[str, Any] | str) -> None:
        await self.chunk(f"data: {data if isinstance(data, str) else json.dumps(data)}\n\n".encode())

    def hang_up(self) -> None:
        """Close the connection immediately, with a TCP reset."""
        self.keep_open = False
        raw = self.writer.get_extra_info("socket")
        with suppress(OSError):
            raw.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, b"\x01\x00\x00\x00\x00\x00\x00\x00")
        self.writer.transport.abort()


Behaviour = Callable[[Exchange], Awaitable[None]]


@dataclass
class Loopback:
    """The server, used as a context manager. It runs in its own thread with its own event loop.

    Attributes:
        requests: All requests in order of arrival.
        connections: Number of accepted connections.
        max_concurrent: Largest number of requests that were answered at the same time.
    """

    script: Iterable[Behaviour]
    then: Behaviour
    requests: list[Request] = field(default_factory=list)
    connections: int = 0
    max_concurrent: int = 0

    def __post_init__(self) -> None:
        self._next = iter(self.script)
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._ready = threading.Event()
        self._open: set[asyncio.Task[None]] = set()
        self._concurrent = 0
        self.port = 0

    @property
    def root(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    @property
    def url(self) -> str:
        return f"{self.root}/v1"

    def __enter__(self) -> Self:
        self._thread.start()
        assert self._ready.wait(10), "the loopback server did not start"
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._loop.call_soon_threadsafe(self._stop.set)
        self._thread.join(10)

    def _serve(self) -> None:
        asyncio.run(self._main())

    async def _main(self) -> None:
        self._loop, self._stop = asyncio.get_running_loop(), asyncio.Event()
        server = await asyncio.start_server(self._accept, "127.0.0.1", self.port, limit=64 * 2**20)
        self.port = server.sockets[0].getsockname()[1]
        self._ready.set()
        await self._stop.wait()
        server.close()
        for task in self._open:
            task.cancel()
        await asyncio.gather(*self._open, return_exceptions=True)

    async def _accept(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        task = asyncio.current_task()
        assert task is not None
        self._open.add(task)
        self.connections += 1
        try:
            with suppress(ConnectionError, asyncio.IncompleteReadError, asyncio.CancelledError):
                while await self._answer(reader, writer):
                    pass
        finally:
            self._open.discard(task)
            writer.close()
            with suppress(OSError, asyncio.CancelledError):
                await writer.wait_closed()

    async def _answer(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> bool:
        request = await _read(reader)
        if request is None:
            return False
        self.requests.append(request)
        exchange = Exchange(request, writer)
        self._concurrent += 1
        self.max_concurrent = max(self.max_concurrent, self._concurrent)
        try:
            await next(self._next, self.then)(exchange)
        finally:
            self._concurrent -= 1
        return exchange.keep_open


async def _read(reader: asyncio.StreamReader) -> Request | None:
    try:
        head = (await reader.readuntil(b"\r\n\r\n")).decode("latin-1")
    except asyncio.IncompleteReadError:
        return None
    first, *rest = head.strip().split("\r\n")
    method, path, _ = first.split(" ", 2)
    headers = {name.lower(): value.strip() for name, _, value in (line.partition(":") for line in rest)}
    if headers.get("transfer-encoding") == "chunked":
        content = b""
        while size := int(await reader.readline(), 16):
            content += await reader.readexactly(size)
            await reader.readline()
        await reader.readline()
    else:
        content = await reader.readexactly(int(headers.get("content-length", 0)))
    return Request(method, path, headers, json.loads(content) if content else {})


@contextmanager
def nobody_listens() -> Iterator[str]:
    """Yield an address that refuses connections: its port is bound, but nothing listens."""
    with socket.socket() as bound:
        bound.bind(("127.0.0.1", 0))
        yield f"http://127.0.0.1:{bound.getsockname()[1]}/v1"


@contextmanager
def speaks_no_tls() -> Iterator[str]:
    """Yield an https address whose server sends a greeting without TLS."""
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        listener.listen()

        def greet() -> None:
            with suppress(OSError):
                while True:
                    caller, _ = listener.accept()
                    with caller:
                        caller.sendall(b"220 ready\r\n")
                        caller.recv(4096)

        thread = threading.Thread(target=greet, daemon=True)
        thread.start()
        yield f"https://127.0.0.1:{listener.getsockname()[1]}/v1"
        listener.shutdown(socket.SHUT_RDWR)
        thread.join(5)


@contextmanager
def never_accepts() -> Iterator[str]:
    """Yield an address that neither accepts nor refuses connections, because the queue of the listener is full."""
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        listener.listen(0)
        address = listener.getsockname()
        fillers = [socket.socket() for _ in range(4)]
        for filler in fillers:
            filler.setblocking(False)
            filler.connect_ex(address)
        try:
            yield f"http://127.0.0.1:{address[1]}/v1"
        finally:
            for filler in fillers:
                filler.close()
