"""Pictures from a device: snapshots, small pictures for detecting whether the camera has settled, and live frames."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import AsyncGenerator, Awaitable, Callable
from contextlib import aclosing
from time import monotonic
from typing import TYPE_CHECKING

import anyio

from scope_ptz.camera.base import CameraInfo, Frame
from scope_ptz.camera.network.errors import PictureError
from scope_ptz.camera.network.live_frames import MAX_PICTURE_LAG_S, LiveFrames, make_frame
from scope_ptz.camera.network.pictures import FrozenCheck, check_not_black, is_black
from scope_ptz.camera.network.pose_track import PoseTrack
from scope_ptz.camera.network.streams import LiveStream
from scope_ptz.geometry import Pose

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from scope_ptz.camera.clocks import Clock

RETRIES = 3
"""Maximum number of retries after a damaged snapshot."""


class DevicePictures(ABC):
    """Pictures from one channel of a device. Drivers implement ``take_snapshot`` and ``open_stream``.

    Args:
        width: Width of a frame in pixels.
        height: Height of a frame in pixels.
        small_size: Width and height of the pictures that are compared to detect whether the camera has settled.
        latency_s: Seconds from the exposure of a streamed frame to its arrival.
    """

    def __init__(self, width: int, height: int, *, small_size: tuple[int, int], latency_s: float) -> None:
        self.width, self.height = width, height
        self._small_size, self._latency_s = small_size, latency_s
        self._frozen_check, self._small_frozen_check = FrozenCheck(), FrozenCheck()
        self._live: list[LiveFrames] = []

    @abstractmethod
    async def take_snapshot(self, width: int, height: int) -> tuple[bytes, NDArray[np.uint8]]:
        """Take a snapshot. Return its bytes, which are identical for identical pictures, and its pixels.

        Raises:
            PictureError: The picture is damaged or has the wrong size.
        """

    @abstractmethod
    def open_stream(self, rate_hz: float) -> LiveStream:
        """Open a stream of frames."""

    async def close(self) -> None:
        """Release resources held between snapshots. The default implementation does nothing."""

    async def frame(self, read_pose: Callable[[], Awaitable[Pose]], info: CameraInfo, clock: Clock) -> Frame:
        """Take a snapshot and return it with the pose at the time of exposure.

        Raises:
            PictureError: The picture is damaged, black or frozen, or has the wrong size.
        """
        deadline_s = monotonic() + MAX_PICTURE_LAG_S
        while True:
            track = PoseTrack()
            track.add(monotonic(), await read_pose())
            requested_s, requested_at = monotonic(), clock.now_s()
            data, image = await self._take(self.width, self.height)
            exposed_s = max(requested_s, monotonic() - self._latency_s)
            track.add(monotonic(), await read_pose())
            pose = track.at(exposed_s)
            check_not_black(image)
            if not self._frozen_check.is_lagging(data, pose, deadline_s):
                return make_frame(image, pose, info, requested_at + exposed_s - requested_s)
            await anyio.sleep(0.1)

    async def settling_picture(self, pose: Pose) -> NDArray[np.uint8]:
        """Take a small picture while the camera reports no motion, and retake it while it lags behind the motors.

        Raises:
            PictureError: The picture is damaged or frozen.
        """
        deadline_s = monotonic() + MAX_PICTURE_LAG_S
        while True:
            data, image = await self._take(*self._small_size)
            # Black pictures are identical and would therefore look frozen. The next snapshot reports them as black.
            if is_black(image) or not self._small_frozen_check.is_lagging(data, pose, deadline_s):
                return image
            await anyio.sleep(0.1)

    async def live(
        self, rate_hz: float, read_pose: Callable[[], Awaitable[Pose]], info: CameraInfo, clock: Clock
    ) -> AsyncGenerator[Frame]:
        """Yield live frames with the pose at the time of exposure. A short device outage interrupts them but does not end them.

        Raises:
            CameraError: The stream is lost, or its pictures are damaged, black or frozen.
        """
        live = LiveFrames(self.open_stream(rate_hz), read_pose, info, clock, self._latency_s)
        self._live.append(live)
        try:
            async with aclosing(live.frames(rate_hz)) as frames:
                async for frame in frames:
                    yield frame
        finally:
            self._live.remove(live)

    @property
    def problem(self) -> str:
        """The reason why live frames are interrupted; empty while they are arriving."""
        return next((live.problem for live in self._live if live.problem), "")

    async def _take(self, width: int, height: int) -> tuple[bytes, NDArray[np.uint8]]:
        """Take a snapshot, and retake it if it is damaged."""
        for retries_left in range(RETRIES, -1, -1):
            try:
                return await self.take_snapshot(width, height)
            except PictureError as error:
                if error.fault == "size" or not retries_left:
                    raise
                await anyio.sleep(0.1)
        raise AssertionError("the last attempt returns or raises")
