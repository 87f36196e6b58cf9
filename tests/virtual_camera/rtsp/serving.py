"""An RTSP server with its live video, and what tests look at in it."""

from __future__ import annotations

import asyncio
import socket
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass

import anyio

from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.live_source import LiveSource
from scope_ptz.virtual_camera.rtsp.server import RtspServer

PATH = "/axis-media/media.amp"


@dataclass(frozen=True)
class Served:
    """A running server."""

    server: RtspServer
    source: LiveSource
    port: int

    @property
    def device(self) -> VirtualDevice:
        return self.source.device

    def url(self, account: str = "", options: str = "") -> str:
        """Return the address of the stream with an account in it, such as ``root:password``."""
        return f"rtsp://{account and account + '@'}127.0.0.1:{self.port}{PATH}{options and '?' + options}"

    async def until_left(self) -> None:
        """Wait until nobody is left: no connection, no session, no encoder, no look at the scene."""
        server = self.server
        await until(lambda: not (server.connections or server.sessions or server.encoders or self.source.subscribers))


@asynccontextmanager
async def serving(
    device: VirtualDevice, *, rate_hz: float = 50.0, latency_s: float = 0.0, session_timeout_s: float = 60.0
) -> AsyncIterator[Served]:
    source = LiveSource(device, rate_hz=rate_hz, latency_s=latency_s)
    listener = socket.create_server(("127.0.0.1", 0))
    running = asyncio.create_task(source.run())
    try:
        async with RtspServer(source, realm="AXIS_1", session_timeout_s=session_timeout_s).listen(listener) as server:
            yield Served(server, source, listener.getsockname()[1])
    finally:
        running.cancel()
        await asyncio.gather(running, return_exceptions=True)


async def until(condition: Callable[[], bool]) -> None:
    """Wait for something that must come true."""
    with anyio.fail_after(30):
        while not condition():  # noqa: ASYNC110 - conditions have no event
            await anyio.sleep(0.01)
