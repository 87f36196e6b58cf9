"""Encoded live video. Each format is encoded once for all clients that are playing it."""

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
from scope_ptz.virtual_camera.frame_selector import FrameSelector
from scope_ptz.virtual_camera.live_source import LiveSource
from scope_ptz.virtual_camera.rtsp.encoder import H264Encoder
from scope_ptz.virtual_camera.rtsp.messages import RefusedError
from scope_ptz.virtual_camera.rtsp.rtp import payloads
from scope_ptz.virtual_camera.rtsp.stream_url import StreamFormat

KEYFRAME_INTERVAL_S = 1.0  # normal time between keyframes, in seconds
MIN_KEYFRAME_INTERVAL_S = 0.2  # minimum time between keyframes, so that new clients cannot make every picture a keyframe
MAX_FORMATS = 8
"""Maximum number of formats to encode at the same time."""

_SETS = (7, 8)  # NAL unit types of the sequence and picture parameter sets

logger = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class AccessUnit:
    """An encoded picture.

    Attributes:
        taken_s: The ``time.monotonic`` time at which the picture was taken, in seconds.
        keyframe: Whether decoding can start at this picture.
        contents: The payloads of its RTP packets, in order.
    """

    taken_s: float
    keyframe: bool
    contents: tuple[bytes, ...]


class Viewer(Protocol):
    """A client that is playing a stream."""

    def offer(self, unit: AccessUnit) -> None:
        """Receive a picture. This must not block."""

    def end(self) -> None:
        """Called when the stream has ended, for example because the encoder failed."""


class LiveStreams:
    """A camera's streams, one for each format that is being played.

    Args:
        source: The camera's live video.
    """

    def __init__(self, source: LiveSource) -> None:
        self._source = source
        self._streams: dict[StreamFormat, _Stream] = {}

    @property
    def formats(self) -> list[StreamFormat]:
        """The formats that are being encoded."""
        return list(self._streams)

    def join(self, requested_format: StreamFormat, viewer: Viewer, start_s: float) -> None:
        """Add a viewer.

        Args:
            requested_format: The format.
            viewer: The client that receives the pictures.
            start_s: The ``time.monotonic`` time from which the viewer requires pictures. A keyframe follows as soon as
                ``MIN_KEYFRAME_INTERVAL_S`` allows.

        Raises:
            RefusedError: Too many formats are being played.
        """
        if requested_format not in self._streams:
            if len(self._streams) >= MAX_FORMATS:
                raise RefusedError(453)
            self._streams[requested_format] = _Stream(self._source, requested_format)
        stream = self._streams[requested_format]
        stream.viewers.add(viewer)
        stream.keyframe_from_s = start_s

    def leave(self, requested_format: StreamFormat, viewer: Viewer) -> None:
        """Remove a viewer. Encoding stops when a format has no more viewers."""
        stream = self._streams.get(requested_format)
        if stream is not None:
            stream.viewers.discard(viewer)
            if not stream.viewers:
                del self._streams[requested_format]
                stream.task.cancel()

    async def close(self) -> None:
        """End all streams."""
        streams, self._streams = list(self._streams.values()), {}
        for stream in streams:
            stream.task.cancel()
        await asyncio.gather(*(stream.task for stream in streams), return_exceptions=True)


class _Stream:
    """Encodes the live video in one format in a separate task."""

    def __init__(self, source: LiveSource, requested_format: StreamFormat) -> None:
        self._source, self._requested_format = source, requested_format
        self._random = random.Random(0)
        self.viewers: set[Viewer] = set()
        self.keyframe_from_s = inf  # the time from which a viewer is waiting for a keyframe
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
        device, fps = self._source.device, self._requested_format.fps
        encoder: H264Encoder | None = None
        previous: Exposure | None = None
        selector, keyframe_s = FrameSelector(self._source.rate_hz, fps), -inf
        async with self._source.subscribe() as exposures:
            async for exposure in exposures:
                # Time stamps keep increasing when the picture is frozen, as on a camera whose sensor is stuck.
                taken_s = exposure.taken_s if exposure is not previous else monotonic() - self._source.latency_s
                previous = exposure
                if not selector.accepts(taken_s):
                    continue
                width, height = _size(device, self._requested_format)
                if encoder is None or (encoder.width, encoder.height) != (width, height):
                    encoder = await to_thread.run_sync(H264Encoder, width, height, fps)
                    keyframe_s = -inf
                keyframe_requested = taken_s >= self.keyframe_from_s
                keyframe = taken_s - keyframe_s >= (
                    MIN_KEYFRAME_INTERVAL_S if keyframe_requested else KEYFRAME_INTERVAL_S - 0.5 / fps
                )
                if keyframe:
                    keyframe_s = taken_s
                    self.keyframe_from_s = inf if keyframe_requested else self.keyframe_from_s
                nals = await to_thread.run_sync(_encode, encoder, exposure, taken_s, keyframe)
                unit = AccessUnit(taken_s, keyframe, tuple(payloads(self._corrupt(nals))))
                for viewer in list(self.viewers):
                    viewer.offer(unit)

    def _corrupt(self, nals: list[bytes]) -> list[bytes]:
        """Apply the camera's faults to NAL units.

        Parameter sets are left intact, so that decoders still try to decode the rest.
        """
        faults = self._source.device.faults
        if faults.garbage:
            return [nal if nal[0] & 0x1F in _SETS else nal[:1] + self._random.randbytes(len(nal) - 1) for nal in nals]
        if faults.picture == "truncated":
            return [nal if nal[0] & 0x1F in _SETS else nal[: 1 + len(nal) // 2] for nal in nals]
        return nals


def _size(device: VirtualDevice, requested_format: StreamFormat) -> tuple[int, int]:
    """Return the size to encode: the requested size, or half its width and height if the camera has the fault ``size``."""
    if device.faults.picture != "size":
        return requested_format.width, requested_format.height
    return max(2, requested_format.width // 4 * 2), max(2, requested_format.height // 4 * 2)


def _encode(encoder: H264Encoder, exposure: Exposure, taken_s: float, keyframe: bool) -> list[bytes]:
    return encoder.encode(exposure.image, taken_s, keyframe=keyframe)
