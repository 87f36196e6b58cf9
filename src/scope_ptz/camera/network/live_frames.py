"""Live frames from a picture stream, each with the pose at its time of exposure."""

from __future__ import annotations

from collections.abc import AsyncGenerator, Awaitable, Callable
from time import monotonic
from typing import TYPE_CHECKING

import anyio

from scope_ptz.camera.base import CameraInfo, Frame
from scope_ptz.camera.network.pictures import FrozenCheck, check_not_black
from scope_ptz.camera.network.pose_track import PosePoller
from scope_ptz.geometry import Perspective, Pose

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from scope_ptz.camera.clocks import Clock
    from scope_ptz.camera.network.streams import LiveStream

MAX_PICTURE_LAG_S = 2.0
"""Maximum time in seconds that the picture may lag behind the motors, for example because the encoder freezes during a move."""

INTERRUPTED_AFTER_S = 1.5
"""Seconds without a frame after which a stream counts as interrupted."""


class LiveFrames:
    """Yields the frames from a stream. A short device outage interrupts the frames but does not end them.

    Args:
        stream: The picture stream, which is closed when ``frames`` ends.
        read_pose: A function that reads the pose.
        info: The camera's properties.
        clock: The camera's clock.
        latency_s: Seconds from the exposure of a picture to its arrival.
    """

    def __init__(
        self,
        stream: LiveStream,
        read_pose: Callable[[], Awaitable[Pose]],
        info: CameraInfo,
        clock: Clock,
        latency_s: float,
    ) -> None:
        self._stream, self._poses, self._info, self._latency_s = stream, PosePoller(read_pose), info, latency_s
        self._offset_s = clock.now_s() - monotonic()
        self._waiting_since_s: float | None = None

    @property
    def problem(self) -> str:
        """The reason why no frames are arriving; empty while they are."""
        if self._poses.problem:
            return self._poses.problem
        if self._waiting_since_s is not None and monotonic() - self._waiting_since_s > INTERRUPTED_AFTER_S:
            return f"{self._info.name} is not sending frames. Reconnecting. Check the network and the camera."
        return ""

    async def frames(self, rate_hz: float) -> AsyncGenerator[Frame]:
        """Yield frames, and close the stream at the end.

        Raises:
            CameraError: The stream is lost, the pose cannot be read, or the pictures are damaged, black or frozen.
        """
        frozen, due_s, deadline_s = FrozenCheck(), float("-inf"), monotonic() + MAX_PICTURE_LAG_S
        try:
            while True:
                await anyio.sleep(max(0.0, due_s - monotonic()))
                requested_s = monotonic()
                self._waiting_since_s = self._waiting_since_s or requested_s
                picture = await self._stream.next()
                exposed_s = picture.arrived_s - self._latency_s
                pose = await self._poses.at(exposed_s)
                if monotonic() - requested_s > INTERRUPTED_AFTER_S:  # an outage does not count as lag
                    deadline_s = monotonic() + MAX_PICTURE_LAG_S
                if pose is None:
                    continue  # exposed before the first pose reading
                check_not_black(picture.image)
                if frozen.is_lagging(picture.data, pose, deadline_s):
                    continue
                due_s = max(due_s + 1.0 / rate_hz, monotonic())
                self._waiting_since_s = None
                yield make_frame(picture.image, pose, self._info, exposed_s + self._offset_s)
                deadline_s = monotonic() + MAX_PICTURE_LAG_S  # restarted when the consumer asks for the next frame
        finally:
            with anyio.CancelScope(shield=True):
                await self._poses.close()
                await self._stream.close()


def make_frame(image: NDArray[np.uint8], pose: Pose, info: CameraInfo, time_s: float) -> Frame:
    """Return a frame with the perspective view at a pose as its projection."""
    hfov_deg = info.optics.hfov_deg(pose.zoom)
    height, width = image.shape[:2]
    view = Perspective(pose.pan_deg, pose.tilt_deg, hfov_deg, width, height)
    return Frame(image=image, pose=pose, hfov_deg=hfov_deg, time_s=time_s, projection=view)
