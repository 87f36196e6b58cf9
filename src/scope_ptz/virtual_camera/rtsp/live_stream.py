"""Encoded live pictures: each format is encoded once for all clients that play it."""

from __future__ import annotations

import asyncio
import logging
import random
from dataclasses import dataclass
from math import inf
from time import monotonic
from typing import Protocol

from anyio import to_thread

from scope_ptz.errors import ScopeError
from scope_ptz.virtual_camera.device import Exposure, VirtualDevice
from scope_ptz.virtual_camera.live_source import LiveSource
from scope_ptz.virtual_camera.rtsp.encoder import H264Encoder
from scope_ptz.virtual_camera.rtsp.messages import RefusedError
from scope_ptz.virtual_camera.rtsp.rtp import payloads
from scope_ptz.virtual_camera.rtsp.stream_url import StreamFormat

KEYFRAME_INTERVAL_S = 1.0
MIN_KEYFRAME_INTERVAL_S = 0.2  # new clients cannot make every picture a keyframe
MAX_FORMATS = 8
"""Number of formats that are encoded at the same time."""

_SETS = (7, 8)  # types of NAL units

logger = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class AccessUnit:
    """An encoded picture.

    Attributes:
        taken_s: When it was taken, on ``time.monotonic``.
        keyframe: Whether decoding can begin here.
        contents: The payloads of its RTP packets.
    """

    taken_s: float
    keyframe: bool
    contents: tuple[bytes, ...]


class Viewer(Protocol):
    """Somebody who plays a stream."""

    def offer(self, unit: AccessUnit) -> None:
        """Take a picture without waiting."""

    def end(self) -> None:
        """Note that the stream has failed."""


class LiveStreams:
    """The streams of a camera, one for each format that is being played.

    Args:
        source: The live picture of the camera.
    """

    def __init__(self, source: LiveSource) -> None:
        self._source = source
        self._streams: dict[StreamFormat, _Stream] = {}

    @property
    def formats(self) -> list[StreamFormat]:
        """The formats that are being encoded."""
        return list(self._streams)

    def join(self, wanted: StreamFormat, viewer: Viewer, start_s: float) -> None:
        """Let somebody play.

        Args:
            wanted: The format.
            viewer: Who gets its pictures.
            start_s: Time on ``time.monotonic``; the first picture from then on is a keyframe.

        Raises:
            RefusedError: Too many formats are being played.
        """
        if wanted not in self._streams:
            if len(self._streams) >= MAX_FORMATS:
                raise RefusedError(453)
            self._streams[wanted] = _Stream(self._source, wanted)
        stream = self._streams[wanted]
        stream.viewers.add(viewer)
        stream.keyframe_from_s = start_s

    def leave(self, wanted: StreamFormat, viewer: Viewer) -> None:
        """Let somebody stop playing. Without viewers, a format is not encoded."""
        stream = self._streams.get(wanted)
        if stream is not None:
            stream.viewers.discard(viewer)
            if not stream.viewers:
                del self._streams[wanted]
                stream.task.cancel()

    async def close(self) -> None:
        """End all streams."""
        streams, self._streams = list(self._streams.values()), {}
        for stream in streams:
            stream.task.cancel()
        await asyncio.gather(*(stream.task for stream in streams), return_exceptions=True)


class _Stream:
    """Encodes the live picture in one format, in a task of its own."""

    def __init__(self, source: LiveSource, wanted: StreamFormat) -> None:
        self._source, self._wanted = source, wanted
        self._random = random.Random(0)
        self.viewers: set[Viewer] = set()
        self.keyframe_from_s = inf  # a picture from then on is to be a keyframe
        self.task = asyncio.create_task(self._run())

    async def _run(self) -> None:
        try:
            await self._encode()
        except ScopeError as error:
            logger.warning("The stream of %s stopped: %s", self._source.device.name, error)
        finally:
            for viewer in list(self.viewers):
                viewer.end()

    async def _encode(self) -> None:
        device, fps = self._source.device, self._wanted.fps
        encoder: H264Encoder | None = None
        before: Exposure | None = None
        due_s, key_s = 0.0, -inf
        async with self._source.subscribe() as exposures:
            async for exposure in exposures:
                # The time stamps of a frozen picture go on, as from a camera whose sensor hangs.
                taken_s = exposure.taken_s if exposure is not before else monotonic() - self._source.latency_s
                before = exposure
                # Half a frame early is in time: otherwise a rate that does not divide the camera's would become a lower one.
                if taken_s < due_s - 0.5 / self._source.rate_hz:
                    continue
                due_s = max(due_s + 1 / fps, taken_s)
                width, height = _size(device, self._wanted)
                if encoder is None or (encoder.width, encoder.height) != (width, height):
                    encoder = await to_thread.run_sync(H264Encoder, width, height, fps)
                    key_s = -inf
                wanted = taken_s >= self.keyframe_from_s
                keyframe = taken_s - key_s >= (MIN_KEYFRAME_INTERVAL_S if wanted else KEYFRAME_INTERVAL_S - 0.5 / fps)
                if keyframe:
                    key_s = taken_s
                    self.keyframe_from_s = inf if wanted else self.keyframe_from_s
                nals = await to_thread.run_sync(_encode, encoder, exposure, taken_s, keyframe)
                unit = AccessUnit(taken_s, keyframe, tuple(payloads(self._damaged(nals))))
                for viewer in list(self.viewers):
                    viewer.offer(unit)

    def _damaged(self, nals: list[bytes]) -> list[bytes]:
        """Return NAL units as the faults of the camera leave them. Parameter sets stay whole, so that decoders try the rest."""
        faults = self._source.device.faults
        if faults.garbage:
            return [nal if nal[0] & 0x1F in _SETS else nal[:1] + self._random.randbytes(len(nal) - 1) for nal in nals]
        if faults.picture == "truncated":
            return [nal if nal[0] & 0x1F in _SETS else nal[: 1 + len(nal) // 2] for nal in nals]
        return nals


def _size(device: VirtualDevice, wanted: StreamFormat) -> tuple[int, int]:
    """Return the size to encode, which a fault halves."""
    if device.faults.picture != "size":
        return wanted.width, wanted.height
    return max(2, wanted.width // 4 * 2), max(2, wanted.height // 4 * 2)


def _encode(encoder: H264Encoder, exposure: Exposure, taken_s: float, keyframe: bool) -> list[bytes]:
    return encoder.encode(exposure.image, taken_s, keyframe=keyframe)
