"""Send a live stream to a client. Slow clients miss pictures, so that they always receive recent ones."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from time import monotonic, time

from scope_ptz.virtual_camera.rtsp import rtcp
from scope_ptz.virtual_camera.rtsp.live_stream import AccessUnit
from scope_ptz.virtual_camera.rtsp.rtp import RtpPacketizer
from scope_ptz.virtual_camera.rtsp.sinks import BATCH_PACKETS, Sink

MAX_AGE_S = 0.5
"""Maximum age of a picture in seconds, beyond the configured stream latency. Older pictures are not sent."""

MAX_QUEUED = 6  # maximum number of queued pictures per client


@dataclass(slots=True)
class StreamStatistics:
    """Statistics about the pictures that a server has sent.

    Attributes:
        sessions: Number of sessions opened.
        sent: Number of pictures sent completely.
        dropped: Number of pictures that slow clients missed.
        oldest_s: Maximum age in seconds of a picture when one of its packets was sent, minus the configured latency.
    """

    sessions: int = 0
    sent: int = 0
    dropped: int = 0
    oldest_s: float = 0.0


class Playback:
    """Sends queued pictures to a client while ``run`` is running.

    Args:
        sink: The destination for packets.
        packetizer: Builds the RTP packets. It assigns sequence numbers and time stamps to packets.
        latency_s: The configured stream latency in seconds.
        clock_skew_s: A function that returns the number of seconds by which the camera's clock is fast.
        statistics: The counters to update.
        on_sent: Called each time a picture has been sent completely.
    """

    def __init__(
        self,
        sink: Sink,
        packetizer: RtpPacketizer,
        *,
        latency_s: float,
        clock_skew_s: Callable[[], float],
        statistics: StreamStatistics,
        on_sent: Callable[[], None],
    ) -> None:
        self._sink, self._packetizer, self._statistics = sink, packetizer, statistics
        self._latency_s, self._clock_skew_s, self._on_sent = latency_s, clock_skew_s, on_sent
        self.start_s = monotonic() - latency_s
        """Pictures taken before this time are not sent, so that no time stamp precedes the one in the reply to PLAY."""
        self._queue: deque[AccessUnit] = deque()
        self._changed = asyncio.Event()
        self._needs_keyframe, self._ended = True, False
        self._packets = self._octets = 0
        self._reported_s = -rtcp.REPORT_INTERVAL_S

    def offer(self, unit: AccessUnit) -> None:
        """Queue a picture for sending. This does not block."""
        if unit.taken_s < self.start_s:
            return
        if len(self._queue) >= MAX_QUEUED:
            self._drop_queue()
        if self._needs_keyframe and not unit.keyframe:
            self._statistics.dropped += 1
            return
        self._needs_keyframe = False
        self._queue.append(unit)
        self._changed.set()

    def end(self) -> None:
        """Record that the stream has ended."""
        self._ended = True
        self._changed.set()

    async def run(self) -> None:
        """Send pictures until the stream ends.

        Raises:
            OSError: The client has disconnected.
        """
        while not self._ended:
            if not self._queue:
                self._changed.clear()
                await self._changed.wait()
                continue
            unit = self._queue.popleft()
            self._report_if_due()
            if await self._send(unit):
                self._statistics.sent += 1
                self._on_sent()
            else:
                self._statistics.dropped += 1
                self._drop_queue()

    def goodbye(self) -> None:
        """Notify the client that the stream has ended."""
        self._sink.report(rtcp.goodbye(self._packetizer.ssrc))

    async def _send(self, unit: AccessUnit) -> bool:
        packets = self._packetizer.packets(unit.contents, unit.taken_s)
        for start in range(0, len(packets), BATCH_PACKETS):
            age_s = monotonic() - unit.taken_s - self._latency_s
            batch = packets[start : start + BATCH_PACKETS]
            if age_s > MAX_AGE_S or not await self._sink.send(batch):
                return False
            self._statistics.oldest_s = max(self._statistics.oldest_s, age_s)
            self._packets += len(batch)
            self._octets += sum(map(len, unit.contents[start : start + BATCH_PACKETS]))
        return True

    def _drop_queue(self) -> None:
        """Drop the queued pictures and all later ones before the next keyframe, because they could not be decoded."""
        self._statistics.dropped += len(self._queue)
        self._queue.clear()
        self._needs_keyframe = True

    def _report_if_due(self) -> None:
        now_s = monotonic()
        if now_s - self._reported_s >= rtcp.REPORT_INTERVAL_S:
            self._reported_s = now_s
            unix_s, timestamp = time() + self._clock_skew_s(), self._packetizer.timestamp(now_s)
            self._sink.report(rtcp.sender_report(self._packetizer.ssrc, unix_s, timestamp, self._packets, self._octets))
