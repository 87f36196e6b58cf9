"""Pictures from a device: snapshots, small pictures to detect when the camera has settled, and live frames with their poses."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import AsyncGenerator, Awaitable, Callable
from contextlib import aclosing
from time import monotonic
from typing import TYPE_CHECKING

import anyio

from scope_ptz.camera.base import CameraInfo, Frame
from scope_ptz.camera.network.errors import PictureError
from scope_ptz.camera.network.live_frames import FROZEN_PATIENCE_S, LiveFrames, frame_of
from scope_ptz.camera.network.pictures import FrozenCheck, check_not_black, is_black
from scope_ptz.camera.network.pose_track import PoseTrack
from scope_ptz.camera.network.streams import LiveStream
from scope_ptz.geometry import Pose

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from scope_ptz.camera.clocks import Clock

RETRIES = 3
"""Maximum number of times that a damaged snapshot is retaken."""


class DevicePictures(ABC):
    """Pictures from one channel of a device. Drivers implement taking a snapshot and opening a stream.

    Args:
        width: Width of a frame in pixels.
        height: Height of a frame in pixels.
        small: Width and height of the pictures that are compared to detect when the camera has settled.
        latency_s: Seconds from the exposure of a streamed frame to its arrival.
    """

    def __init__(self, width: int, height: int, *, small: tuple[int, int], latency_s: float) -> None:
        self.width, self.height = width, height
        self._small, self._latency_s = small, latency_s
        self._frozen, self._frozen_small = FrozenCheck(), FrozenCheck()
        self._live: list[LiveFrames] = []

    @abstractmethod
    async def take_once(self, width: int, height: int) -> tuple[bytes, NDArray[np.uint8]]:
        """Take a snapshot. Return bytes that are identical for identical pictures, and the pixels.

        Raises:
            PictureError: The picture is damaged or has the wrong size.
        """

    @abstractmethod
    def open_stream(self, rate_hz: float) -> LiveStream:
        """Open a stream of frames."""

    async def close(self) -> None:
        """Release resources that are kept between snapshots. By default, there are none."""

    async def frame(self, read_pose: Callable[[], Awaitable[Pose]], info: CameraInfo, clock: Clock) -> Frame:
        """Take a snapshot, with the pose at the time of exposure.

        Raises:
            PictureError: The picture is damaged, black or frozen, or has the wrong size.
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
                return frame_of(image, pose, info, asked_at + exposed_s - asked_s)
            await anyio.sleep(0.1)

    async def settling_picture(self, pose: Pose) -> NDArray[np.uint8]:
        """Take a small picture while the camera reports no motion. Wait if the picture lags behind the motors.

        Raises:
            PictureError: The picture is damaged or frozen.
        """
        give_up_s = monotonic() + FROZEN_PATIENCE_S
        while True:
            data, image = await self._take(*self._small)
            # Black pictures are all identical, so they would look frozen. The next snapshot reports the fault.
            if is_black(image) or not self._frozen_small.lags(data, pose, give_up_s):
                return image
            await anyio.sleep(0.1)

    async def live(
        self, rate_hz: float, read_pose: Callable[[], Awaitable[Pose]], info: CameraInfo, clock: Clock
    ) -> AsyncGenerator[Frame]:
        """Yield live frames with the pose at exposure. A short outage of the device interrupts them, but does not end them.

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
        """Why the live frames are interrupted; empty while they arrive."""
        return next((live.problem for live in self._live if live.problem), "")

    async def _take(self, width: int, height: int) -> tuple[bytes, NDArray[np.uint8]]:
        """Take a snapshot. A damaged snapshot is retaken."""
        for left in range(RETRIES, -1, -1):
            try:
                return await self.take_once(width, height)
            except PictureError as error:
                if error.fault == "size" or not left:
                    raise
                await anyio.sleep(0.1)
        raise AssertionError("the last attempt returns or raises")
