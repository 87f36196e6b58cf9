"""The channel to an agent process passes the conformance suite. The agent is a relay that connects its pipes to the test."""

from __future__ import annotations

import json
import sys
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import anyio
import pytest
from anyio.abc import SocketStream
from anyio.streams.buffered import BufferedByteReceiveStream

from scope_ptz.bench.agents.launch import AgentLaunch
from scope_ptz.bench.agents.pipe import PipeChannel
from tests.bench.agents.conformance import ChannelConformance, Connection

RELAY = """
import os, socket, sys, threading

link = socket.socket(socket.AF_UNIX)
link.connect(sys.argv[1])

def from_test():
    while data := link.recv(65536):
        while data:
            data = data[os.write(1, data):]
    os._exit(0)

threading.Thread(target=from_test, daemon=True).start()
while data := os.read(0, 65536):
    link.sendall(data)
"""
MAX_LINE_BYTES = 10_000_000


class RelayPeer:
    """The test's end of the relay."""

    def __init__(self, stream: SocketStream) -> None:
        self._stream, self._lines = stream, BufferedByteReceiveStream(stream)

    async def send(self, message: bytes) -> None:
        await self._stream.send(message + b"\n")

    async def receive(self) -> dict[str, Any]:
        message: dict[str, Any] = json.loads(await self._lines.receive_until(b"\n", MAX_LINE_BYTES))
        return message

    async def leave(self) -> None:
        await self._stream.aclose()


class TestPipeChannel(ChannelConformance):
    """The suite for the channel to an agent process."""

    @pytest.fixture
    async def connection(self, tmp_path: Path) -> AsyncIterator[Connection]:
        address = tmp_path / "link"
        listener = await anyio.create_unix_listener(address)
        command = (sys.executable, "-I", "-c", RELAY, str(address))
        channel = await PipeChannel.start(AgentLaunch("relay", command, tmp_path, {}))
        async with listener:
            with anyio.fail_after(30):
                stream = await listener.accept()
        try:
            yield Connection(channel, RelayPeer(stream))
        finally:
            await channel.close("The test has ended.")
            await stream.aclose()


pytestmark = pytest.mark.anyio
