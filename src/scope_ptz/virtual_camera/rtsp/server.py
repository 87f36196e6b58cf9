"""A camera's RTSP server, which runs in the current event loop."""

from __future__ import annotations

import asyncio
import random
import socket
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from math import inf

import anyio
from anyio import to_thread

from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.digest import DigestAuthenticator
from scope_ptz.virtual_camera.live_source import LiveSource
from scope_ptz.virtual_camera.rtsp.connection import RtspConnection
from scope_ptz.virtual_camera.rtsp.encoder import parameter_sets
from scope_ptz.virtual_camera.rtsp.messages import MAX_LINE_BYTES
from scope_ptz.virtual_camera.rtsp.playback import StreamStatistics
from scope_ptz.virtual_camera.rtsp.sessions import Sessions
from scope_ptz.virtual_camera.rtsp.tunnel import Tunnels

SESSION_TIMEOUT_S = 60.0
MAX_CONNECTIONS = 64
WATCH_INTERVAL_S = 0.1  # interval in seconds between checks for faults and session timeouts


class RtspServer:
    """Serves a camera's live video.

    Args:
        source: The live video. The caller runs it.
        realm: The authentication realm, which clients show to their users.
        session_timeout_s: Seconds of client inactivity after which a session ends.
    """

    def __init__(self, source: LiveSource, *, realm: str, session_timeout_s: float = SESSION_TIMEOUT_S) -> None:
        self._source = source
        self._realm = realm
        self._sessions = Sessions(source, timeout_s=session_timeout_s)
        self._tunnels = Tunnels()
        self._rng = random.Random(0)
        self._connections: dict[asyncio.Task[None], RtspConnection] = {}

    @property
    def device(self) -> VirtualDevice:
        """The camera."""
        return self._source.device

    @property
    def statistics(self) -> StreamStatistics:
        """Statistics about the pictures that have been sent."""
        return self._sessions.statistics

    @property
    def sessions(self) -> int:
        """Number of open sessions."""
        return len(self._sessions)

    @property
    def connections(self) -> int:
        """Number of open connections."""
        return len(self._connections)

    @property
    def encoders(self) -> int:
        """Number of formats that are being encoded."""
        return len(self._sessions.streams.formats)

    @asynccontextmanager
    async def listen(self, listener: socket.socket) -> AsyncIterator[RtspServer]:
        """Return a context manager that serves on a listening socket, and closes the socket on exit.

        Raises:
            ConfigError: PyAV is not installed, or lacks libx264.
        """
        device = self.device
        # Load the encoder now, so that a missing encoder is noticed early and the first client does not have to wait.
        await to_thread.run_sync(parameter_sets, device.width, device.height, self._source.rate_hz)
        server = await asyncio.start_server(self._accept, sock=listener, limit=MAX_LINE_BYTES)
        watcher = asyncio.create_task(self._watch())
        try:
            yield self
        finally:
            with anyio.CancelScope(shield=True):
                server.close()
                watcher.cancel()
                await self._sessions.close()
                self._abort()
                await asyncio.gather(watcher, *self._connections, return_exceptions=True)
                await server.wait_closed()

    def _accept(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        if len(self._connections) >= MAX_CONNECTIONS or self.device.down:
            writer.transport.abort()
            return
        # Many RTSP clients do not support qop, and ignore replies to keep-alive requests. Each connection therefore has its own
        # nonce, which does not expire. An intercepted response is useless on other connections.
        digest = DigestAuthenticator(self.device.accounts, self._realm, qop=False, nonce_lifetime_s=inf)
        connection = RtspConnection(self.device, self._source, self._sessions, self._tunnels, digest, self._rng, reader, writer)
        task = asyncio.create_task(connection.run())
        self._connections[task] = connection
        task.add_done_callback(self._connections.pop)

    async def _watch(self) -> None:
        while True:
            if self.device.down:
                self._abort()
                await self._sessions.end_all()
            await self._sessions.end_expired()
            await asyncio.sleep(WATCH_INTERVAL_S)

    def _abort(self) -> None:
        for task, connection in self._connections.items():
            connection.abort()
            task.cancel()
