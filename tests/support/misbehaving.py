"""A real HTTP server on loopback that answers as an OpenAI chat server and as Moondream, or misbehaves as scripted.

    with Misbehaving([status(503), good()]) as server:
        Endpoint(url=server.url)

Each request takes the next behaviour of the script; when it is spent, ``then`` answers the rest (a good reply by default).
"""

from __future__ import annotations

import asyncio
import json
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

from tests.support.loopback import (
    JSON_TYPE,
    Behaviour,
    Exchange,
    Loopback,
    Request,
    never_accepts,
    nobody_listens,
    speaks_no_tls,
)
from tests.support.model_wire import MODEL, MOONDREAM, Mind, Say, completion, pieces, response

__all__ = [
    "JSON_TYPE",
    "MODEL",
    "MOONDREAM",
    "Behaviour",
    "Exchange",
    "Mind",
    "Misbehaving",
    "Request",
    "Say",
    "body",
    "completion",
    "cut_off",
    "echo_key",
    "empty_choices",
    "ends_early",
    "error_in_success",
    "good",
    "huge",
    "malformed",
    "never_accepts",
    "nobody_listens",
    "not_http",
    "pieces",
    "redirect",
    "reset",
    "response",
    "say",
    "slow_after_head",
    "slow_first_byte",
    "speaks_no_tls",
    "stalls",
    "status",
    "trickle",
    "wrong_type",
]

EVENTS_TYPE = "text/event-stream"
ALL_DONE = Say()
LONG = Say("The answer is long.")


def good(mind: Mind | Say = ALL_DONE, moondream: Mapping[str, dict[str, Any]] = MOONDREAM) -> Behaviour:
    """Answers as it should: chat, streaming or not; responses, not streaming; Moondream's paths; the list of models."""

    async def behave(x: Exchange) -> None:
        request = x.request
        if request.chat:
            say = mind(request) if callable(mind) else mind
            await _stream(x, pieces(say)) if request.streaming else await x.whole(json.dumps(completion(say)).encode())
        elif request.path.endswith("/responses"):
            await x.whole(json.dumps(response(mind(request) if callable(mind) else mind)).encode())
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


def cut_off(mind: Say = LONG) -> Behaviour:
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


def ends_early(mind: Say = LONG) -> Behaviour:
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
class Misbehaving(Loopback):
    """A server that behaves unless told otherwise."""

    script: Iterable[Behaviour] = ()
    then: Behaviour = field(default_factory=good)
