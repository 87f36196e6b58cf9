"""RTSP over HTTP: two connections with the same cookie."""

from __future__ import annotations

import asyncio
from base64 import b64encode

import anyio
import pytest

from scope_ptz.virtual_camera.device import VirtualDevice
from tests.virtual_camera.rtsp.serving import Served, serving

pytestmark = pytest.mark.anyio

COOKIE = "x-sessioncookie: abc\r\n"
Connection = tuple[asyncio.StreamReader, asyncio.StreamWriter]


async def http(served: Served, method: str, headers: str) -> Connection:
    """Send the head of a request, and return its connection."""
    reader, writer = await asyncio.open_connection("127.0.0.1", served.port)
    writer.write(f"{method} /axis-media/media.amp HTTP/1.1\r\n{headers}\r\n".encode())
    return reader, writer


async def status(connection: Connection) -> int:
    """Return the status of a reply, and read its head to the end."""
    with anyio.fail_after(20):
        head = await connection[0].readuntil(b"\r\n\r\n")
    return int(head.split(b" ")[1])


def request(served: Served, method: str, number: int, headers: str = "") -> bytes:
    return f"{method} {served.url()} RTSP/1.0\r\nCSeq: {number}\r\n{headers}\r\n".encode()


async def ended(connection: Connection) -> None:
    """Wait until the server has closed a connection."""
    with anyio.fail_after(20):
        while await connection[0].read(65536):
            pass
    connection[1].close()


async def test_a_stream_through_a_tunnel(open_device: VirtualDevice) -> None:
    async with serving(open_device) as served:
        get = await http(served, "GET", COOKIE)
        assert await status(get) == 200
        post = await http(served, "POST", COOKIE + "Content-Length: 32767\r\n")
        setup = request(served, "SETUP", 1, "Transport: RTP/AVP/TCP;unicast;interleaved=0-1\r\n")
        encoded = b64encode(setup)
        for part in (encoded[:5], encoded[5:40] + b"\r\n" + encoded[40:]):
            post[1].write(part)
            await post[1].drain()
        with anyio.fail_after(20):
            reply = (await get[0].readuntil(b"\r\n\r\n")).decode()
            assert reply.startswith("RTSP/1.0 200")
            session = reply.partition("Session: ")[2].partition(";")[0]
            play, options = request(served, "PLAY", 2, f"Session: {session}\r\n"), request(served, "OPTIONS", 3)
            post[1].write(b64encode(play) + b64encode(options))
            received = b""
            while not (b"CSeq: 2\r\n" in received and b"CSeq: 3\r\n" in received and b"$\x00" in received):
                received += await get[0].read(65536)
        other = await http(served, "POST", COOKIE)
        assert await status(other) == 404  # the tunnel has a POST connection already
        other[1].close()
        post[1].close()
        await ended(get)
        await served.until_left()


@pytest.mark.parametrize(("method", "headers", "expected"), [("GET", "", 400), ("POST", "", 400), ("POST", COOKIE, 404)])
async def test_half_a_tunnel_is_refused(open_device: VirtualDevice, method: str, headers: str, expected: int) -> None:
    async with serving(open_device) as served:
        connection = await http(served, method, headers)
        assert await status(connection) == expected
        await ended(connection)
        await served.until_left()


async def test_a_cookie_is_used_once_at_a_time(open_device: VirtualDevice) -> None:
    async with serving(open_device) as served:
        first, second = await http(served, "GET", COOKIE), None
        assert await status(first) == 200
        second = await http(served, "GET", COOKIE)
        assert await status(second) == 400
        await ended(second)
        first[1].close()


@pytest.mark.parametrize("content", [b"A===", b64encode(b"no request\r\n\r\n")])
async def test_what_is_no_request_ends_the_tunnel(open_device: VirtualDevice, content: bytes) -> None:
    async with serving(open_device) as served:
        get = await http(served, "GET", COOKIE)
        assert await status(get) == 200
        post = await http(served, "POST", COOKIE)
        post[1].write(content)
        await ended(get)
        post[1].close()
        await served.until_left()
