"""Pictures of an AXIS camera: snapshots, small pictures for settling, and live frames with the pose at exposure."""

from __future__ import annotations

from collections.abc import AsyncGenerator, Awaitable, Callable
from functools import partial
from time import monotonic
from typing import TYPE_CHECKING, Literal

import anyio
from anyio import to_thread

from scope_ptz.camera.axis import requests
from scope_ptz.camera.base import CameraInfo, Frame
from scope_ptz.camera.network.errors import PictureError
from scope_ptz.camera.network.pictures import FrozenCheck, check_not_black, decode_jpeg, is_black
from scope_ptz.camera.network.pose_track import PoseTrack
from scope_ptz.camera.network.rtsp import RtspStream
from scope_ptz.camera.network.streams import LiveStream, MjpegStream
from scope_ptz.geometry import Perspective, Pose

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from scope_ptz.camera.axis.client import VapixClient
    from scope_ptz.camera.clocks import Clock
    from scope_ptz.camera.network.credentials import Credentials

StreamKind = Literal["mjpeg", "rtsp"]
"""How live frames are transported."""

RETRIES = 3
"""How often a damaged snapshot is taken again."""

MAX_GAP_S = 0.3
"""Readings of the position that are farther apart are not interpolated."""

FROZEN_PATIENCE_S = 2.0
"""How long a picture may lag behind the motors, as with an encoder that freezes it during a move."""

SMALL_WIDTH = 320
"""The least width in pixels of the pictures that are compared for settling."""


class AxisPictures:
    """The pictures of one channel.

    Args:
        client: The connection.
        credentials: The account, for RTSP.
        width: Width of a frame in pixels.
        height: Height of a frame in pixels.
        sizes: Sizes that the device announces.
        stream: How live frames are transported.
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
        self._client, self._credentials = client, credentials
        self.width, self.height = width, height
        self._small = _small_size(width, height, sizes)
        self._stream_kind, self._rtsp_port, self._latency_s = stream, rtsp_port, latency_s
        self._frozen, self._frozen_small = FrozenCheck(), FrozenCheck()

    async def frame(self, read_pose: Callable[[], Awaitable[Pose]], info: CameraInfo, clock: Clock) -> Frame:
        """Take a snapshot, with the pose in the middle of the exposure.

        Raises:
            PictureError: The picture is damaged, black, frozen, or of another size.
        """
        give_up_s = monotonic() + FROZEN_PATIENCE_S
        while True:
            track = PoseTrack()
            track.add(monotonic(), await read_pose())
            asked_s, asked_at = monotonic(), clock.now_s()
            data, image = await self._take(self.width, self.height)
            exposed_s = max(asked_s, monotonic() - self._latency_s)
            track.add(monotonic(), await read_pose())
            pose = track.at(exposed_s)
            check_not_black(image)
            if not self._frozen.lags(data, pose, give_up_s):
                return _frame(image, pose, info, asked_at + exposed_s - asked_s)
            await anyio.sleep(0.1)

    async def small(self, pose: Pose) -> NDArray[np.uint8]:
        """Take a small picture at a standing pose. A picture that lags behind the motors is waited for.

        Raises:
            PictureError: The picture is damaged or frozen.
        """
        give_up_s = monotonic() + FROZEN_PATIENCE_S
        while True:
            data, image = await self._take(*self._small)
            # Black pictures are all the same. Whoever wants to see something is told; the move itself has succeeded.
            if is_black(image) or not self._frozen_small.lags(data, pose, give_up_s):
                return image
            await anyio.sleep(0.1)

    async def live(
        self, rate_hz: float, read_pose: Callable[[], Awaitable[Pose]], info: CameraInfo, clock: Clock
    ) -> AsyncGenerator[Frame]:
        """Yield live frames with the pose at exposure.

        Raises:
            CameraError: The stream is lost, or its pictures are damaged, black or frozen.
        """
        track, offset_s = PoseTrack(), clock.now_s() - monotonic()
        continuous_s = 0.0  # since when the readings are dense enough to interpolate between them
        stream, due_s = self._open(rate_hz), float("-inf")
        frozen, give_up_s = FrozenCheck(), monotonic() + FROZEN_PATIENCE_S
        try:
            while True:
                await anyio.sleep(max(0.0, due_s - monotonic()))
                if track.newest_s < monotonic() - MAX_GAP_S:
                    continuous_s = monotonic()
                    track.add(continuous_s, await read_pose())
                picture = await stream.next()
                exposed_s = picture.arrived_s - self._latency_s
                if exposed_s < continuous_s:
                    continue  # the consumer was away, and nobody knows where the camera was at this exposure
                due_s = max(due_s + 1.0 / rate_hz, monotonic())
                if track.newest_s < exposed_s:
                    track.add(monotonic(), await read_pose())
                pose = track.at(exposed_s)
                check_not_black(picture.image)
                if frozen.lags(picture.data, pose, give_up_s):
                    continue
                give_up_s = monotonic() + FROZEN_PATIENCE_S
                yield _frame(picture.image, pose, info, exposed_s + offset_s)
        finally:
            with anyio.CancelScope(shield=True):
                await stream.close()

    def _open(self, rate_hz: float) -> LiveStream:
        channel = self._client.channel
        if self._stream_kind == "rtsp":
            path = requests.rtsp_path(channel, self.width, self.height, rate_hz)
            url = f"rtsp://{self._client.address.host}:{self._rtsp_port}{path}"
            return RtspStream(url, self._credentials, width=self.width, height=self.height)
        request = requests.mjpeg(channel, self.width, self.height, rate_hz)
        return MjpegStream(self._client.http, request.path, request.query, width=self.width, height=self.height)

    async def _take(self, width: int, height: int) -> tuple[bytes, NDArray[np.uint8]]:
        """Return a snapshot as file and pixels. A damaged one is taken again."""
        request = requests.snapshot(self._client.channel, width, height)
        for left in range(RETRIES, -1, -1):
            reply = await self._client.send(request)
            try:
                return reply.body, await to_thread.run_sync(partial(decode_jpeg, reply.body, width=width, height=height))
            except PictureError as error:
                if error.fault == "size" or not left:
                    raise
                await anyio.sleep(0.1)
        raise AssertionError("the last attempt returns or raises")


def _frame(image: NDArray[np.uint8], pose: Pose, info: CameraInfo, time_s: float) -> Frame:
    hfov_deg = info.optics.hfov_deg(pose.zoom)
    height, width = image.shape[:2]
    view = Perspective(pose.pan_deg, pose.tilt_deg, hfov_deg, width, height)
    return Frame(image=image, pose=pose, hfov_deg=hfov_deg, time_s=time_s, projection=view)


def _small_size(width: int, height: int, sizes: tuple[tuple[int, int], ...]) -> tuple[int, int]:
    """Return the smallest announced size of the frame's shape that is wide enough; the frame's own size if there is none."""
    fitting = [(w, h) for w, h in sizes if w >= SMALL_WIDTH and abs(w * height - h * width) <= max(w, h)]
    return min([*fitting, (width, height)])
