"""An RTSP session: the transport that a client has set up, and its playback."""

from __future__ import annotations

import asyncio
import logging
import secrets
from collections.abc import Callable
from time import monotonic

from scope_ptz.virtual_camera.live_source import LiveSource
from scope_ptz.virtual_camera.rtsp.live_stream import LiveStreams
from scope_ptz.virtual_camera.rtsp.playback import Playback, StreamStatistics
from scope_ptz.virtual_camera.rtsp.rtp import RtpClock
from scope_ptz.virtual_camera.rtsp.sinks import InterleavedSink, UdpSink
from scope_ptz.virtual_camera.rtsp.stream_url import StreamFormat

logger = logging.getLogger(__name__)


class Session:
    """One client's stream.

    Args:
        requested: The format of the stream; None for a stream of events, of which this camera sends none.
        owner: Address and account of the client. Other clients cannot access the session.
        source: The live picture.
        streams: The encoded streams.
        statistics: The counters to update.

    Attributes:
        token: The identifier of the session, which the client sends with its requests.
        clock: Numbers the packets and gives them time stamps.
        sink: The destination of the packets; None until a transport is set up.
        alive_s: Time of the client's last activity, on ``time.monotonic``.
        connected: Whether the connection that set up the session is open.
        ended: Whether the session is over.
        on_lost: Called when the client disconnects during playback, or the stream fails.
    """

    def __init__(
        self,
        requested: StreamFormat | None,
        owner: tuple[str, str],
        source: LiveSource,
        streams: LiveStreams,
        statistics: StreamStatistics,
    ) -> None:
        self.requested, self.owner = requested, owner
        self._source, self._streams, self._statistics = source, streams, statistics
        self.token = secrets.token_hex(8)
        self.clock = RtpClock()
        self.sink: InterleavedSink | UdpSink | None = None
        self.alive_s = monotonic()
        self.connected = True
        self.on_lost: Callable[[], None] = lambda: None
        self._playback: Playback | None = None
        self._task: asyncio.Task[None] | None = None
        self.ended = False

    @property
    def playing(self) -> bool:
        """Whether pictures are being sent."""
        return self._playback is not None

    def touch(self) -> None:
        """Record that the client is active."""
        self.alive_s = monotonic()

    def lost(self) -> None:
        """Handle the loss of the client or of the stream: call ``on_lost``."""
        self.on_lost()

    def play(self) -> tuple[int, int]:
        """Start sending pictures. If pictures are being sent already, they continue.

        Returns:
            The sequence number of the next packet, and the RTP time stamp at which the stream starts.

        Raises:
            RefusedError: Too many formats are being played.
        """
        assert self.sink is not None  # noqa: S101 - a session is kept only with a transport
        if self.requested is None:
            return self.clock.sequence, self.clock.timestamp(monotonic())
        if self._playback is None:
            playback = Playback(
                self.sink,
                self.clock,
                latency_s=self._source.latency_s,
                clock_skew_s=lambda: self._source.device.faults.clock_skew_s,
                statistics=self._statistics,
                # With TCP, a sent picture shows that the client is active; with UDP, its reports do.
                on_sent=self.touch if isinstance(self.sink, InterleavedSink) else lambda: None,
            )
            self._streams.join(self.requested, playback, playback.start_s)
            self._playback = playback
            self._task = asyncio.create_task(self._run(playback))
        return self.clock.sequence, self.clock.timestamp(self._playback.start_s)

    def pause(self) -> None:
        """Stop sending."""
        playback, self._playback = self._playback, None
        if playback is not None and self._task is not None and self.requested is not None:
            self._streams.leave(self.requested, playback)
            self._task.cancel()

    async def close(self) -> None:
        """End the session, and send a BYE packet to a client that is playing."""
        self.ended = True
        playback, task = self._playback, self._task
        self.pause()
        try:
            if task is not None:
                await asyncio.gather(task, return_exceptions=True)
        finally:
            if self.sink is not None:
                if playback is not None:
                    playback.goodbye()
                self.sink.close()

    async def _run(self, playback: Playback) -> None:
        try:
            await playback.run()
        except OSError as error:
            logger.info("A client of %s disconnected: %s", self._source.device.name, error)
        self.lost()  # the client disconnected, or the stream failed
