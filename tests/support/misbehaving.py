"""A real HTTP server on loopback that answers as an OpenAI chat server and as Moondream, or misbehaves as scripted.

    with Misbehaving([status(503), good()]) as server:
        Endpoint(url=server.url)

Each request takes the next behaviour of the script. After the script, ``then`` answers (by default, with a valid reply).
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
from tests.support.model_wire import MODEL, MOONDREAM, Responder, Say, completion, pieces, response

__all__ = [
    "JSON_TYPE",
    "MODEL",
    "MOONDREAM",
    "Behaviour",
    "Exchange",
    "Misbehaving",
    "Request",
    "Responder",
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
LONG_REPLY = Say("The answer is long.")


def good(reply: Responder | Say = ALL_DONE, moondream: Mapping[str, dict[str, Any]] = MOONDREAM) -> Behaviour:
    """Answer correctly: chat (also streamed), responses (not streamed), Moondream's paths, and the list of models."""

    async def behave(x: Exchange) -> None:
        request = x.request
        if request.chat:
            say = reply(request) if callable(reply) else reply
            await _stream(x, pieces(say)) if request.streaming else await x.whole(json.dumps(completion(say)).encode())
        elif request.path.endswith("/responses"):
            await x.whole(json.dumps(response(reply(request) if callable(reply) else reply)).encode())
        elif request.path.endswith("/models"):
            await x.whole(json.dumps({"object": "list", "data": [{"id": MODEL, "object": "model"}]}).encode())
        elif (skill := request.path.rpartition("/")[2]) in moondream:
            await x.whole(json.dumps(moondream[skill]).encode())
        else:
            await x.whole(b'{"error":{"message":"no such path"}}', 404)

    return behave


async def _stream(x: Exchange, events: Iterable[dict[str, Any]], *, pause_s: float = 0.0, send_done: bool = True) -> None:
    await x.head(content_type=EVENTS_TYPE)
    for data in events:
        await x.event(data)
        await asyncio.sleep(pause_s)
    if send_done:
        await x.event("[DONE]")
        await x.send(b"0\r\n\r\n")


def say(
    text: str = "",
    *calls: tuple[str, Any],
    reasoning: str = "",
) -> Behaviour:
    """Answer with a text, tool calls or reasoning."""
    return good(Say(text=text, tool_calls=calls, reasoning=reasoning))


def status(code: int, message: Any = "the server's own words", headers: Mapping[str, str] | None = None) -> Behaviour:
    """Answer with an error status and an OpenAI-style error body (or any JSON)."""
    body = {"error": {"message": message, "type": "Whatever", "code": code}} if isinstance(message, str) else message

    async def behave(x: Exchange) -> None:
        await x.whole(json.dumps(body).encode(), code, headers=headers)

    return behave


def body(
    content: bytes | str, content_type: str = JSON_TYPE, code: int = 200, headers: Mapping[str, str] | None = None
) -> Behaviour:
    """Answer with exactly this body."""

    async def behave(x: Exchange) -> None:
        await x.whole(content.encode() if isinstance(content, str) else content, code, content_type, headers)

    return behave


def error_in_success(message: str = "CUDA out of memory") -> Behaviour:
    """Answer with HTTP 200 and an error in the body or in the stream."""

    async def behave(x: Exchange) -> None:
        if x.request.streaming:
            await _stream(x, [{"error": {"message": message, "code": 500}}])
        else:
            await x.whole(json.dumps({"error": message}).encode())

    return behave


def reset() -> Behaviour:
    """Reset the connection before the reply."""

    async def behave(x: Exchange) -> None:
        x.hang_up()

    return behave


def cut_off(reply: Say = LONG_REPLY) -> Behaviour:
    """Reset the connection in the middle of the reply."""

    async def behave(x: Exchange) -> None:
        if x.request.streaming:
            await _stream(x, list(pieces(reply))[:2], send_done=False)
        else:
            await x.head(length=1000)
            await x.send(b'{"choices":[{"message":')
        await asyncio.sleep(0.02)  # let the data arrive before the reset
        x.hang_up()

    return behave


def ends_early(reply: Say = LONG_REPLY) -> Behaviour:
    """End the reply cleanly but too early: a stream without its end, or half of the JSON."""

    async def behave(x: Exchange) -> None:
        if x.request.streaming:
            await _stream(x, list(pieces(reply))[:2], send_done=False)
            await x.send(b"0\r\n\r\n")
        else:
            data = json.dumps(completion(reply) if x.request.chat else MOONDREAM["detect"]).encode()
            await x.whole(data[: len(data) // 2])

    return behave


def slow_first_byte(seconds: float = 30.0) -> Behaviour:
    """Accept the request, and send nothing."""

    async def behave(x: Exchange) -> None:
        await asyncio.sleep(seconds)

    return behave


def slow_after_head(seconds: float = 30.0) -> Behaviour:
    """Send the headers of a success, and then nothing."""

    async def behave(x: Exchange) -> None:
        await x.head(content_type=EVENTS_TYPE if x.request.streaming else JSON_TYPE)
        await asyncio.sleep(seconds)

    return behave


def trickle(pause_s: float = 0.05) -> Behaviour:
    """Send small pieces without end."""

    async def behave(x: Exchange) -> None:
        await x.head(content_type=EVENTS_TYPE if x.request.streaming else JSON_TYPE)
        while True:
            await x.chunk(b": still here\n\n" if x.request.streaming else b" ")
            await asyncio.sleep(pause_s)

    return behave


def stalls(seconds: float = 30.0) -> Behaviour:
    """Begin the reply, and then send nothing."""

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
    """Answer with a reply without choices."""

    async def behave(x: Exchange) -> None:
        if x.request.streaming:
            await _stream(x, [{"object": "chat.completion.chunk", "choices": []}])
        else:
            await x.whole(b'{"object":"chat.completion","choices":[]}' if x.request.chat else b"{}")

    return behave


def wrong_type() -> Behaviour:
    """Answer with a web page and status 200."""
    return body("<!doctype html><html><body>Welcome to the router</body></html>", "text/html; charset=utf-8")


def malformed() -> Behaviour:
    """Answer with invalid JSON, also in a stream."""

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
    """Answer with a valid reply of many megabytes. With ``stated``, the headers contain its length."""

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
    """Answer with an error that repeats the credentials of the request."""

    async def behave(x: Exchange) -> None:
        credentials = [value for name, value in x.request.headers.items() if "auth" in name]
        await x.whole(json.dumps({"error": {"message": f"Invalid credentials: {credentials}"}}).encode(), 401)

    return behave


def not_http() -> Behaviour:
    """Answer in another protocol."""

    async def behave(x: Exchange) -> None:
        await x.send(b"SSH-2.0-OpenSSH_9.6\r\n")
        x.keep_open = False

    return behave


def redirect(location: str) -> Behaviour:
    """Answer with a redirect."""
    return body("", code=307, headers={"Location": location})


@dataclass
class Misbehaving(Loopback):
    """A server that answers correctly, except for the behaviours of its script."""

    script: Iterable[Behaviour] = ()
    then: Behaviour = field(default_factory=good)
