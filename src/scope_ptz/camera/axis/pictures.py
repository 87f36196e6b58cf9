"""Pictures from an AXIS camera over VAPIX and RTSP."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Literal

from anyio import to_thread

from scope_ptz.camera.axis import requests
from scope_ptz.camera.network.device_pictures import DevicePictures
from scope_ptz.camera.network.pictures import decode_jpeg
from scope_ptz.camera.network.rtsp import RtspStream
from scope_ptz.camera.network.streams import LiveStream, MjpegStream

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from scope_ptz.camera.axis.client import VapixClient
    from scope_ptz.camera.network.credentials import Credentials

StreamKind = Literal["mjpeg", "rtsp"]
"""The transport of live frames."""

SMALL_WIDTH = 320
"""Minimum width in pixels of the pictures that are compared to detect whether the camera has settled."""


class AxisPictures(DevicePictures):
    """Pictures from one channel.

    Args:
        client: The connection.
        credentials: The credentials for the RTSP stream.
        width: Width of a frame in pixels.
        height: Height of a frame in pixels.
        sizes: Picture sizes that the device reports.
        stream: The transport of live frames.
        rtsp_port: Port of the RTSP server.
        latency_s: Seconds from the exposure of a streamed frame to its arrival.
    """

    def __init__(
        self,
        client: VapixClient,
        credentials: Credentials,
        width: int,
        height: int,
        *,
        sizes: tuple[tuple[int, int], ...] = (),
        stream: StreamKind = "mjpeg",
        rtsp_port: int = 554,
        latency_s: float = 0.1,
    ) -> None:
        super().__init__(width, height, small_size=_small_size(width, height, sizes), latency_s=latency_s)
        self._client, self._credentials = client, credentials
        self._stream_kind, self._rtsp_port = stream, rtsp_port

    def open_stream(self, rate_hz: float) -> LiveStream:
        channel = self._client.channel
        if self._stream_kind == "rtsp":
            path = requests.rtsp_path(channel, self.width, self.height, rate_hz)
            url = f"rtsp://{self._client.address.host}:{self._rtsp_port}{path}"
            return RtspStream(url, self._credentials, width=self.width, height=self.height)
        request = requests.mjpeg(channel, self.width, self.height, rate_hz)
        return MjpegStream(self._client.http, request.path, request.query, width=self.width, height=self.height)

    async def take_snapshot(self, width: int, height: int) -> tuple[bytes, NDArray[np.uint8]]:
        reply = await self._client.send(requests.snapshot(self._client.channel, width, height))
        return reply.body, await to_thread.run_sync(partial(decode_jpeg, reply.body, width=width, height=height))


def _small_size(width: int, height: int, sizes: tuple[tuple[int, int], ...]) -> tuple[int, int]:
    """Return the smallest reported size that has the frame's aspect ratio and is at least ``SMALL_WIDTH`` wide.

    If there is none, return the frame's own size.
    """
    candidates = [(w, h) for w, h in sizes if w >= SMALL_WIDTH and abs(w * height - h * width) <= max(w, h)]
    return min([*candidates, (width, height)])
