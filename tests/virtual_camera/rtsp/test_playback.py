"""One client's sender: what a slow client misses, and that nothing late is ever sent."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import asynccontextmanager
from time import monotonic

import pytest

from scope_ptz.virtual_camera.rtsp.live_stream import AccessUnit
from scope_ptz.virtual_camera.rtsp.playback import MAX_AGE_S, MAX_QUEUED, Playback, StreamStatistics
from scope_ptz.virtual_camera.rtsp.rtp import RtpPacketizer
from scope_ptz.virtual_camera.rtsp.sinks import BATCH_PACKETS
from tests.support.rtsp_client import RtpPacket
from tests.virtual_camera.rtsp.serving import until

pytestmark = pytest.mark.anyio


class RecordingSink:
    """Keeps what is sent, and can be slow."""

    def __init__(self) -> None:
        self.packets: list[RtpPacket] = []
        self.reports = 0
        self.open = asyncio.Event()
        self.open.set()
        self.accepts = True

    async def send(self, packets: Sequence[bytes]) -> bool:
        if self.accepts:
            self.packets += map(RtpPacket.parse, packets)
        await self.open.wait()
        return self.accepts

    def report(self, packet: bytes) -> None:
        self.reports += 1

    def close(self) -> None:
        """Nothing to release."""

    @property
    def names(self) -> list[str]:
        return [packet.payload.decode() for packet in self.packets]


@asynccontextmanager
async def playing(sink: RecordingSink, latency_s: float = 0.0) -> AsyncIterator[tuple[Playback, StreamStatistics]]:
    statistics = StreamStatistics()
    playback = Playback(
        sink, RtpPacketizer(), latency_s=latency_s, clock_skew_s=lambda: 0.0, statistics=statistics, on_sent=lambda: None
    )
    task = asyncio.create_task(playback.run())
    try:
        yield playback, statistics
    finally:
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)


def unit(name: str, *, keyframe: bool = False, taken_s: float | None = None) -> AccessUnit:
    return AccessUnit(monotonic() if taken_s is None else taken_s, keyframe, (name.encode(),))


def sent(statistics: StreamStatistics, count: int) -> Callable[[], bool]:
    return lambda: statistics.sent == count


async def test_it_starts_with_a_keyframe_that_is_not_older_than_the_start() -> None:
    sink = RecordingSink()
    async with playing(sink) as (playback, statistics):
        for each in (unit("old", keyframe=True, taken_s=playback.start_s - 0.01), unit("p"), unit("k", keyframe=True), unit("q")):
            playback.offer(each)
        await until(sent(statistics, 2))
        assert (sink.names, sink.reports) == (["k", "q"], 1)


async def test_a_slow_client_misses_pictures_up_to_a_keyframe_and_memory_stays_bounded() -> None:
    sink = RecordingSink()
    async with playing(sink) as (playback, statistics):
        sink.open.clear()
        playback.offer(unit("k", keyframe=True))
        await until(lambda: sink.names == ["k"])
        for k in range(MAX_QUEUED + 5):
            playback.offer(unit(f"p{k}"))
        assert statistics.dropped == MAX_QUEUED + 5
        playback.offer(unit("k2", keyframe=True))
        playback.offer(unit("q"))
        sink.open.set()
        await until(sent(statistics, 3))
        assert sink.names == ["k", "k2", "q"]


async def test_a_keyframe_takes_the_place_of_what_waits() -> None:
    sink = RecordingSink()
    async with playing(sink) as (playback, statistics):
        sink.open.clear()
        playback.offer(unit("k", keyframe=True))
        await until(lambda: sink.names == ["k"])
        for k in range(MAX_QUEUED):
            playback.offer(unit(f"p{k}"))
        playback.offer(unit("k2", keyframe=True))
        sink.open.set()
        await until(sent(statistics, 2))
        assert sink.names == ["k", "k2"]


@pytest.mark.parametrize("latency_s", [0.0, 2.0])
async def test_a_late_picture_is_never_sent(latency_s: float) -> None:
    sink = RecordingSink()
    async with playing(sink, latency_s) as (playback, statistics):
        playback.start_s -= 10
        late_s = monotonic() - latency_s - MAX_AGE_S - 0.001
        playback.offer(unit("late", keyframe=True, taken_s=late_s))
        await until(lambda: statistics.dropped == 1)
        playback.offer(unit("p", taken_s=monotonic() - latency_s))
        playback.offer(unit("k", keyframe=True, taken_s=monotonic() - latency_s))
        await until(sent(statistics, 1))
        assert (sink.names, statistics.dropped) == (["k"], 2)
        assert statistics.oldest_s <= MAX_AGE_S


async def test_the_rest_of_a_picture_that_turned_old_is_not_sent() -> None:
    sink = RecordingSink()
    async with playing(sink) as (playback, statistics):
        sink.open.clear()
        contents = tuple(b"k%03d" % k for k in range(3 * BATCH_PACKETS))
        playback.offer(AccessUnit(monotonic(), True, contents))
        await until(lambda: len(sink.packets) == BATCH_PACKETS)
        await asyncio.sleep(MAX_AGE_S)
        sink.open.set()
        await until(lambda: statistics.dropped == 1)
        assert len(sink.packets) == BATCH_PACKETS
        playback.offer(unit("k", keyframe=True))
        await until(sent(statistics, 1))
        # The client notices the loss from the sequence numbers.
        assert (sink.packets[-1].sequence - sink.packets[0].sequence) % 2**16 == len(contents)
        assert statistics.oldest_s <= MAX_AGE_S


async def test_a_network_that_takes_nothing_costs_pictures_up_to_a_keyframe() -> None:
    sink = RecordingSink()
    async with playing(sink) as (playback, statistics):
        sink.accepts = False
        playback.offer(unit("k", keyframe=True))
        await until(lambda: statistics.dropped == 1)
        sink.accepts = True
        playback.offer(unit("p"))
        playback.offer(unit("k2", keyframe=True))
        await until(sent(statistics, 1))
        assert sink.names == ["k2"]
