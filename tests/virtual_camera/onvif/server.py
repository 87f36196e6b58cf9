"""A virtual camera's ONVIF services on a loopback port, without the other protocols."""

from __future__ import annotations

import asyncio
import socket
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, nullcontext
from dataclasses import dataclass

import uvicorn

from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.onvif.app import OnvifApp

RTSP_PORT = 8554


@dataclass(frozen=True)
class Serving:
    """A device that is being served."""

    device: VirtualDevice
    port: int

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.port}"


@asynccontextmanager
async def serve(device: VirtualDevice) -> AsyncIterator[Serving]:
    """Serve a device on a port that the system chooses."""
    listener = socket.create_server(("127.0.0.1", 0))
    server = uvicorn.Server(uvicorn.Config(OnvifApp(device, rtsp_port=RTSP_PORT), lifespan="off", log_level="warning"))
    server.capture_signals = nullcontext  # type: ignore[method-assign, assignment] # the test runner keeps its own handlers
    task = asyncio.create_task(server.serve(sockets=[listener]))
    try:
        while not server.started:
            await asyncio.sleep(0.005)
        yield Serving(device, listener.getsockname()[1])
    finally:
        server.should_exit = True
        await task
        listener.close()
