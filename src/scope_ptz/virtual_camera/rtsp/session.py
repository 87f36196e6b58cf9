"""RTSP sessions: the transport that a client has set up, and its playback."""

from __future__ import annotations

import asyncio
import logging
import secrets
from collections.abc import Callable
from time import monotonic

from scope_ptz.virtual_camera.live_source import LiveSource
from scope_ptz.virtual_camera.rtsp.live_stream import LiveStreams
from scope_ptz.virtual_camera.rtsp.playback import Playback, StreamStatistics
from scope_ptz.virtual_camera.rtsp.rtp import RtpPacketizer
from scope_ptz.virtual_camera.rtsp.sinks import InterleavedSink, UdpSink
from scope_ptz.virtual_camera.rtsp.stream_url import StreamFormat

logger = logging.getLogger(__name__)


class Session:
    """A client's session.

    Args:
        requested_format: The format of the stream; None for an event stream, which is always empty.
        owner: The client's address and account. Other clients cannot access the session.
        source: The live video.
        streams: The encoded streams.
        statistics: The counters to update.

    Attributes:
        token: The session identifier, which the client includes in its requests.
        packetizer: Builds the RTP packets. It assigns sequence numbers and time stamps to packets.
        sink: The destination for packets; None until a transport has been set up.
        last_active_s: The ``time.monotonic`` time of the client's last activity.
        connected: Whether the connection that set up the session is still open.
        ended: Whether the session has ended.
        on_lost: Called when the client disconnects during playback or the stream fails.
    """

    def __init__(
        self,
        requested_format: StreamFormat | None,
        owner: tuple[str, str],
        source: LiveSource,
        streams: LiveStreams,
        statistics: StreamStatistics,
    ) -> None:
        self.requested_format, self.owner = requested_format, owner
        self._source, self._streams, self._statistics = source, streams, statistics
        self.token = secrets.token_hex(8)
        self.packetizer = RtpPacketizer()
        self.sink: InterleavedSink | UdpSink | None = None
        self.last_active_s = monotonic()
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
        self.last_active_s = monotonic()

    def handle_loss(self) -> None:
        """Call ``on_lost``, because the client or the stream was lost."""
        self.on_lost()

    def play(self) -> tuple[int, int]:
        """Start sending pictures. This has no effect if pictures are already being sent.

        Returns:
            The sequence number of the next packet, and the RTP time stamp at which the stream starts.

        Raises:
            RefusedError: Too many formats are being played.
        """
        assert self.sink is not None  # noqa: S101 - sessions without a transport are not kept
        if self.requested_format is None:
            return self.packetizer.sequence, self.packetizer.timestamp(monotonic())
        if self._playback is None:
            playback = Playback(
                self.sink,
                self.packetizer,
                latency_s=self._source.latency_s,
                clock_skew_s=lambda: self._source.device.faults.clock_skew_s,
                statistics=self._statistics,
                # Over TCP, a sent picture shows that the client is active; over UDP, its reports do.
                on_sent=self.touch if isinstance(self.sink, InterleavedSink) else lambda: None,
            )
            self._streams.join(self.requested_format, playback, playback.start_s)
            self._playback = playback
            self._task = asyncio.create_task(self._run(playback))
        return self.packetizer.sequence, self.packetizer.timestamp(self._playback.start_s)

    def pause(self) -> None:
        """Stop sending pictures."""
        playback, self._playback = self._playback, None
        if playback is not None and self._task is not None and self.requested_format is not None:
            self._streams.leave(self.requested_format, playback)
            self._task.cancel()

    async def close(self) -> None:
        """End the session. If pictures are being sent, send a BYE packet."""
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
        self.handle_loss()  # the client disconnected, or the stream failed
