"""A camera's RTSP sessions, which have owners and timeouts and are limited in number."""

from __future__ import annotations

import asyncio
from time import monotonic

from scope_ptz.virtual_camera.live_source import LiveSource
from scope_ptz.virtual_camera.rtsp.live_stream import LiveStreams
from scope_ptz.virtual_camera.rtsp.messages import RefusedError
from scope_ptz.virtual_camera.rtsp.playback import StreamStatistics
from scope_ptz.virtual_camera.rtsp.session import Session
from scope_ptz.virtual_camera.rtsp.stream_url import StreamFormat

MAX_SESSIONS = 32
ORPHAN_TIMEOUT_S = 15.0
"""Seconds of inactivity after which a session without a connection ends. UDP clients may reconnect until then."""


class Sessions:
    """A camera's sessions.

    Args:
        source: The live video.
        timeout_s: Seconds of client inactivity after which a session ends.

    Attributes:
        statistics: Statistics about the pictures that have been sent.
        streams: The encoded streams.
    """

    def __init__(self, source: LiveSource, *, timeout_s: float) -> None:
        self.timeout_s = timeout_s
        self.statistics = StreamStatistics()
        self.streams = LiveStreams(source)
        self._source = source
        self._sessions: dict[str, Session] = {}
        self._ending_tasks: set[asyncio.Task[None]] = set()

    def __len__(self) -> int:
        return len(self._sessions)

    def open(self, requested_format: StreamFormat | None, owner: tuple[str, str]) -> Session:
        """Open a session. The arguments are those of ``Session``.

        Raises:
            RefusedError: There are too many sessions.
        """
        if len(self._sessions) >= MAX_SESSIONS:
            raise RefusedError(453)
        session = Session(requested_format, owner, self._source, self.streams, self.statistics)
        self._sessions[session.token] = session
        self.statistics.sessions += 1
        return session

    def find(self, token: str, owner: tuple[str, str]) -> Session:
        """Return a client's session, and record that the client is active.

        Raises:
            RefusedError: The client has no such session.
        """
        session = self._sessions.get(token)
        if session is None or session.owner != owner:
            raise RefusedError(454)
        session.touch()
        return session

    async def end(self, session: Session) -> None:
        """End a session."""
        if self._sessions.pop(session.token, None) is not None:
            await session.close()

    def end_soon(self, session: Session) -> None:
        """End a session in a background task, for callbacks that cannot wait."""
        task = asyncio.create_task(self.end(session))
        self._ending_tasks.add(task)
        task.add_done_callback(self._ending_tasks.discard)

    async def end_all(self) -> None:
        """End all sessions."""
        await asyncio.gather(*(self.end(session) for session in list(self._sessions.values())))

    async def end_expired(self) -> None:
        """End the sessions whose clients have been inactive for too long."""
        now_s = monotonic()
        for session in list(self._sessions.values()):
            limit_s = self.timeout_s if session.connected else min(ORPHAN_TIMEOUT_S, self.timeout_s)
            if now_s - session.last_active_s > limit_s:
                await self.end(session)

    async def close(self) -> None:
        """End all sessions and streams."""
        await self.end_all()
        await asyncio.gather(*self._ending_tasks, return_exceptions=True)
        await self.streams.close()
