"""Pictures from a device: snapshots, small pictures to detect when the camera has settled, and live frames with their poses."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import AsyncGenerator, Awaitable, Callable
from time import monotonic
from typing import TYPE_CHECKING

import anyio

from scope_ptz.camera.base import CameraInfo, Frame
from scope_ptz.camera.network.errors import PictureError
from scope_ptz.camera.network.pictures import FrozenCheck, check_not_black, is_black
from scope_ptz.camera.network.pose_track import PosePoller, PoseTrack
from scope_ptz.camera.network.streams import LiveStream
from scope_ptz.geometry import Perspective, Pose

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from scope_ptz.camera.clocks import Clock

RETRIES = 3
"""Maximum number of times that a damaged snapshot is retaken."""

FROZEN_PATIENCE_S = 2.0
"""Seconds that the picture may lag behind the motors, for example because the encoder freezes it during a move."""


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
                return _frame(image, pose, info, asked_at + exposed_s - asked_s)
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
        """Yield live frames with the pose at exposure.

        Raises:
            CameraError: The stream is lost, or its pictures are damaged, black or frozen.
        """
        offset_s = clock.now_s() - monotonic()
        stream, poses, frozen = self.open_stream(rate_hz), PosePoller(read_pose), FrozenCheck()
        due_s, give_up_s = float("-inf"), monotonic() + FROZEN_PATIENCE_S
        try:
            while True:
                await anyio.sleep(max(0.0, due_s - monotonic()))
                picture = await stream.next()
                exposed_s = picture.arrived_s - self._latency_s
                pose = await poses.at(exposed_s)
                if pose is None:
                    continue  # exposed before the stream was opened
                check_not_black(picture.image)
                if frozen.lags(picture.data, pose, give_up_s):
                    continue
                due_s = max(due_s + 1.0 / rate_hz, monotonic())
                yield _frame(picture.image, pose, info, exposed_s + offset_s)
                give_up_s = monotonic() + FROZEN_PATIENCE_S  # counted from when the consumer asks for the next frame
        finally:
            with anyio.CancelScope(shield=True):
                await poses.close()
                await stream.close()

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


def _frame(image: NDArray[np.uint8], pose: Pose, info: CameraInfo, time_s: float) -> Frame:
    hfov_deg = info.optics.hfov_deg(pose.zoom)
    height, width = image.shape[:2]
    view = Perspective(pose.pan_deg, pose.tilt_deg, hfov_deg, width, height)
    return Frame(image=image, pose=pose, hfov_deg=hfov_deg, time_s=time_s, projection=view)
