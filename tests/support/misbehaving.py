"""A real HTTP server on loopback that answers as an OpenAI chat server and as Moondream, or misbehaves as scripted.

    with Misbehaving([status(503), good()]) as server:
        Endpoint(url=server.url)

Each request takes the next behaviour of the script; when it is spent, ``then`` answers the rest (a good reply by default).
"""

from __future__ import annotations

import asyncio
import json
import socket
import threading
from collections.abc import Awaitable, Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from types import TracebackType
from typing import Any

MODEL = "loopback-model"
JSON_TYPE = "application/json"
EVENTS_TYPE = "text/event-stream"


@dataclass(frozen=True)
class Request:
    """What came in. ``data`` is the JSON body, {} when there is none."""

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
        """Status and headers. Without a length the body comes in chunks."""
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
        """Break the connection off at once, with a reset rather than a farewell."""
        self.keep_open = False
        raw = self.writer.get_extra_info("socket")
        with suppress(OSError):
            raw.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, b"\x01\x00\x00\x00\x00\x00\x00\x00")
        self.writer.transport.abort()


Behaviour = Callable[[Exchange], Awaitable[None]]


@dataclass(frozen=True)
class Say:
    """What the model on the server says."""

    text: str = "All done."
    reasoning: str = ""
    tool_calls: tuple[tuple[str, Any], ...] = ()
    finish_reason: str = ""

    def calls(self) -> list[dict[str, Any]]:
        return [
            {
                "id": f"call-{index}",
                "type": "function",
                "function": {"name": name, "arguments": given if isinstance(given, str) else json.dumps(given)},
            }
            for index, (name, given) in enumerate(self.tool_calls)
        ]

    @property
    def ending(self) -> str:
        return self.finish_reason or ("tool_calls" if self.tool_calls else "stop")


Mind = Callable[[Request], Say]


def completion(say: Say) -> dict[str, Any]:
    """A chat completion as vLLM words it."""
    message: dict[str, Any] = {"role": "assistant", "content": say.text or None, "tool_calls": say.calls()}
    if say.reasoning:
        message["reasoning_content"] = say.reasoning
    return {
        "id": "chatcmpl-1",
        "object": "chat.completion",
        "created": 1,
        "model": MODEL,
        "choices": [{"index": 0, "message": message, "finish_reason": say.ending}],
        "usage": {"prompt_tokens": 11, "completion_tokens": 7, "total_tokens": 18, "prompt_tokens_details": {"cached_tokens": 4}},
    }


def pieces(say: Say) -> Iterator[dict[str, Any]]:
    """The same as the chunks of a stream: text and arguments in halves."""

    def chunk(delta: dict[str, Any], ending: str | None = None) -> dict[str, Any]:
        choice = {"index": 0, "delta": delta, "finish_reason": ending}
        return {"id": "chatcmpl-1", "object": "chat.completion.chunk", "created": 1, "model": MODEL, "choices": [choice]}

    yield chunk({"role": "assistant", "content": ""})
    for name, text in (("reasoning_content", say.reasoning), ("content", say.text)):
        half = len(text) // 2
        for part in (text[:half], text[half:]):
            if part:
                yield chunk({name: part})
    for index, call in enumerate(say.calls()):
        arguments = call["function"]["arguments"]
        half = len(arguments) // 2
        first = {"name": call["function"]["name"], "arguments": arguments[:half]}
        yield chunk({"tool_calls": [{"index": index, "id": call["id"], "type": "function", "function": first}]})
        yield chunk({"tool_calls": [{"index": index, "function": {"arguments": arguments[half:]}}]})
    yield chunk({}, say.ending)
    yield {**chunk({}), "choices": [], "usage": completion(say)["usage"]}


MOONDREAM: dict[str, dict[str, Any]] = {
    "query": {"answer": "A white van."},
    "caption": {"caption": "A road with cars."},
    "detect": {"objects": [{"x_min": 0.25, "y_min": 0.25, "x_max": 0.5, "y_max": 0.75}]},
    "point": {"points": [{"x": 0.375, "y": 0.5}]},
}


def good(mind: Mind | Say = Say(), moondream: Mapping[str, dict[str, Any]] = MOONDREAM) -> Behaviour:
    """Answers as it should: chat, streaming or not; Moondream's paths; the list of models."""

    async def behave(x: Exchange) -> None:
        request = x.request
        if request.chat:
            say = mind(request) if callable(mind) else mind
            await _stream(x, pieces(say)) if request.streaming else await x.whole(json.dumps(completion(say)).encode())
        elif request.path.endswith("/models"):
            await x.whole(json.dumps({"object": "list", "data": [{"id": MODEL, "object": "model"}]}).encode())
        elif (asked := request.path.rpartition("/")[2]) in moondream:
            await x.whole(json.dumps(moondream[asked]).encode())
        else:
            await x.whole(b'{"error":{"message":"no such path"}}', 404)

    return behave


async def _stream(x: Exchange, events: Iterable[dict[str, Any]], *, pause_s: float = 0.0, done: bool = True) -> None:
    await x.head(content_type=EVENTS_TYPE)
    for data in events:
        await x.event(data)
        await asyncio.sleep(pause_s)
    if done:
        await x.event("[DONE]")
        await x.send(b"0\r\n\r\n")


def say(
    text: str = "",
    *calls: tuple[str, Any],
    reasoning: str = "",
) -> Behaviour:
    """The model says this, or calls these tools."""
    return good(Say(text=text, tool_calls=calls, reasoning=reasoning))


def status(code: int, message: Any = "the server's own words", headers: Mapping[str, str] | None = None) -> Behaviour:
    """An error status with an OpenAI-style error body (or any JSON)."""
    body = {"error": {"message": message, "type": "Whatever", "code": code}} if isinstance(message, str) else message

    async def behave(x: Exchange) -> None:
        await x.whole(json.dumps(body).encode(), code, headers=headers)

    return behave


def body(
    content: bytes | str, content_type: str = JSON_TYPE, code: int = 200, headers: Mapping[str, str] | None = None
) -> Behaviour:
    """Any body, exactly as given."""

    async def behave(x: Exchange) -> None:
        await x.whole(content.encode() if isinstance(content, str) else content, code, content_type, headers)

    return behave


def error_in_success(message: str = "CUDA out of memory") -> Behaviour:
    """HTTP 200 with an error inside; in the midst of a stream where one is wanted."""

    async def behave(x: Exchange) -> None:
        if x.request.streaming:
            await _stream(x, [{"error": {"message": message, "code": 500}}])
        else:
            await x.whole(json.dumps({"error": message}).encode())

    return behave


def reset() -> Behaviour:
    """The connection is broken before anything is said."""

    async def behave(x: Exchange) -> None:
        x.hang_up()

    return behave


def cut_off(mind: Say = Say("The answer is long.")) -> Behaviour:
    """The connection is broken in the midst of the answer."""

    async def behave(x: Exchange) -> None:
        if x.request.streaming:
            await _stream(x, list(pieces(mind))[:2], done=False)
        else:
            await x.head(length=1000)
            await x.send(b'{"choices":[{"message":')
        await asyncio.sleep(0.02)  # what was said shall arrive before the reset
        x.hang_up()

    return behave


def ends_early(mind: Say = Say("The answer is long.")) -> Behaviour:
    """The answer ends politely, and too soon: a stream without its end, or half of a JSON."""

    async def behave(x: Exchange) -> None:
        if x.request.streaming:
            await _stream(x, list(pieces(mind))[:2], done=False)
            await x.send(b"0\r\n\r\n")
        else:
            whole = json.dumps(completion(mind) if x.request.chat else MOONDREAM["detect"]).encode()
            await x.whole(whole[: len(whole) // 2])

    return behave


def slow_first_byte(seconds: float = 30.0) -> Behaviour:
    """Takes the request and is silent."""

    async def behave(x: Exchange) -> None:
        await asyncio.sleep(seconds)

    return behave


def slow_after_head(seconds: float = 30.0) -> Behaviour:
    """Sends the headers of success at once, and is silent then."""

    async def behave(x: Exchange) -> None:
        await x.head(content_type=EVENTS_TYPE if x.request.streaming else JSON_TYPE)
        await asyncio.sleep(seconds)

    return behave


def trickle(pause_s: float = 0.05) -> Behaviour:
    """Never silent for long, and never done."""

    async def behave(x: Exchange) -> None:
        await x.head(content_type=EVENTS_TYPE if x.request.streaming else JSON_TYPE)
        while True:
            await x.chunk(b": still here\n\n" if x.request.streaming else b" ")
            await asyncio.sleep(pause_s)

    return behave


def stalls(seconds: float = 30.0) -> Behaviour:
    """Begins to answer, and is silent then."""

    async def behave(x: Exchange) -> None:
        if x.request.streaming:
            await x.head(content_type=EVENTS_TYPE)
            await x.event(next(iter(pieces(Say()))))
        else:
            await x.head()
            await x.chunk(b'{"choices":')
        await asyncio.sleep(seconds)

    return behave


def empty_choices() -> Behaviour:
    """A reply with nothing in it."""

    async def behave(x: Exchange) -> None:
        if x.request.streaming:
            await _stream(x, [{"object": "chat.completion.chunk", "choices": []}])
        else:
            await x.whole(b'{"object":"chat.completion","choices":[]}' if x.request.chat else b"{}")

    return behave


def wrong_type() -> Behaviour:
    """A web page, with success."""
    return body("<!doctype html><html><body>Welcome to the router</body></html>", "text/html; charset=utf-8")


def malformed() -> Behaviour:
    """JSON that is none, in a stream where one is wanted."""

    async def behave(x: Exchange) -> None:
        if x.request.streaming:
            await x.head(content_type=EVENTS_TYPE)
            await x.event('{"choices": [{"delta": {"content": "half')
            await x.event("[DONE]")
            await x.send(b"0\r\n\r\n")
        else:
            await x.whole(b'{"choices": [{"message": {"content": half}}]}')

    return behave


def huge(size: int = 12 * 2**20, *, stated: bool = False) -> Behaviour:
    """A valid reply of many megabytes; ``stated``: with its length told beforehand."""

    async def behave(x: Exchange) -> None:
        text = "a" * size
        reply = completion(Say(text)) if x.request.chat else {"answer": text, "caption": text}
        with suppress(ConnectionError):
            if x.request.streaming:
                await _stream(x, pieces(Say(text)))
            elif stated:
                await x.whole(json.dumps(reply).encode())
            else:
                data = json.dumps(reply).encode()
                await x.head()
                for start in range(0, len(data), 65536):
                    await x.chunk(data[start : start + 65536])
                await x.send(b"0\r\n\r\n")

    return behave


def echo_key() -> Behaviour:
    """A careless server: its error repeats the credentials that it was given."""

    async def behave(x: Exchange) -> None:
        given = [value for name, value in x.request.headers.items() if "auth" in name]
        await x.whole(json.dumps({"error": {"message": f"Invalid credentials: {given}"}}).encode(), 401)

    return behave


def not_http() -> Behaviour:
    """Another protocol altogether."""

    async def behave(x: Exchange) -> None:
        await x.send(b"SSH-2.0-OpenSSH_9.6\r\n")
        x.keep_open = False

    return behave


def redirect(location: str) -> Behaviour:
    return body("", code=307, headers={"Location": location})


@dataclass
class Misbehaving:
    """The server. It runs in a thread of its own with a loop of its own; a context manager.

    ``requests``: what came in, in order; ``connections``: how many were opened; ``most_at_once``: requests answered together.
    """

    script: Iterable[Behaviour] = ()
    then: Behaviour = field(default_factory=good)
    requests: list[Request] = field(default_factory=list)
    connections: int = 0
    most_at_once: int = 0

    def __post_init__(self) -> None:
        self._next = iter(self.script)
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._ready = threading.Event()
        self._open: set[asyncio.Task[None]] = set()
        self._at_once = 0
        self.port = 0

    @property
    def root(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    @property
    def url(self) -> str:
        return f"{self.root}/v1"

    def __enter__(self) -> Misbehaving:
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
        self._at_once += 1
        self.most_at_once = max(self.most_at_once, self._at_once)
        try:
            await next(self._next, self.then)(exchange)
        finally:
            self._at_once -= 1
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
    """An address at which connections are refused: the port is held, and not listened to."""
    with socket.socket() as held:
        held.bind(("127.0.0.1", 0))
        yield f"http://127.0.0.1:{held.getsockname()[1]}/v1"


@contextmanager
def speaks_no_tls() -> Iterator[str]:
    """An https address behind which something greets first, and not in TLS."""
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
    """An address at which connections are neither taken nor refused: the queue of the listener is full."""
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
