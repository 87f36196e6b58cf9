"""Live video from devices that cannot stream at the frame size: scaled video, or a sequence of snapshots."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from time import monotonic
from typing import TYPE_CHECKING

import anyio

from scope_ptz.camera.network.errors import CameraTimeoutError, CameraUnreachableError, PictureError
from scope_ptz.camera.network.streams import GIVE_UP_S, LivePicture, LiveStream

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

RETRY_S = 0.25
"""Seconds between attempts while the device cannot be reached."""


class SnapshotStream(LiveStream):
    """A stream of snapshots.

    Args:
        take: A function that takes a snapshot and returns its bytes, which are identical for identical pictures, and its pixels.
        give_up_s: Seconds without a picture after which the stream counts as lost.
    """

    def __init__(self, take: Callable[[], Awaitable[tuple[bytes, NDArray[np.uint8]]]], *, give_up_s: float = GIVE_UP_S) -> None:
        self._take, self._give_up_s = take, give_up_s

    async def next(self) -> LivePicture:
        requested_s = monotonic()
        while True:
            try:
                data, image = await self._take()
            except (CameraUnreachableError, CameraTimeoutError):
                if monotonic() - requested_s > self._give_up_s:
                    raise
                await anyio.sleep(RETRY_S)
            else:
                return LivePicture(image, data, monotonic())

    async def close(self) -> None:
        """Do nothing, because no connection is held between snapshots."""


class ScaledStream(LiveStream):
    """A stream that scales another stream's pictures to the frame size."""

    def __init__(self, stream: LiveStream, width: int, height: int) -> None:
        self._stream, self._width, self._height = stream, width, height

    async def next(self) -> LivePicture:
        picture = await self._stream.next()
        return LivePicture(scale_picture(picture.image, self._width, self._height), picture.data, picture.arrived_s)

    async def close(self) -> None:
        await self._stream.close()


def scale_picture(image: NDArray[np.uint8], width: int, height: int) -> NDArray[np.uint8]:
    """Return a picture scaled to another size with the same aspect ratio.

    Raises:
        PictureError: The aspect ratios differ.
    """
    import cv2
    import numpy as np

    if image.shape[1::-1] == (width, height):
        return image
    if abs(image.shape[1] * height - image.shape[0] * width) > max(image.shape):
        raise PictureError(
            f"The stream's picture size is {image.shape[1]}x{image.shape[0]}, which does not have the aspect ratio of "
            f"{width}x{height}. Change the size in the camera, or use ?stream=snapshot.",
            "size",
        )
    return np.asarray(cv2.resize(image, (width, height), interpolation=cv2.INTER_AREA), np.uint8)
