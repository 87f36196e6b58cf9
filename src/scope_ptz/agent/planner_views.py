"""Pictures for planners that accept images, and the shared frame of concurrent calls."""

from __future__ import annotations

import anyio

from scope_ptz.agent.timing import Stopwatch, TimedCamera
from scope_ptz.camera.base import Camera, Frame
from scope_ptz.perception.models.encoding import Size, encode_frame
from scope_ptz.planner.base import Picture
from scope_ptz.tools.context import ImageStore

MAX_SIDE_PX = 1280  # larger frames are scaled down, as vision models would do anyway


def picture_size(width: int, height: int) -> Size:
    """Return the width and height of a planner's picture of a frame. No side is longer than ``MAX_SIDE_PX`` pixels."""
    scale = min(1.0, MAX_SIDE_PX / max(width, height))
    return round(width * scale), round(height * scale)


async def picture(frame: Frame, caption: str) -> Picture:
    """Return a frame as a captioned JPEG for a planner, at most ``MAX_SIDE_PX`` pixels wide and high."""
    encoded = await encode_frame(frame, picture_size(frame.width, frame.height))
    return Picture(data_url=encoded.data_url, caption=caption)


async def picture_of_view(frame: Frame) -> Picture:
    """Return the current view as a picture with the pose in its caption."""
    pose = frame.pose.as_dict()
    return await picture(
        frame, f"The camera's view now, at pan {pose['pan_deg']:g}, tilt {pose['tilt_deg']:g}, zoom {pose['zoom']:g}:"
    )


class PictureStore:
    """An image store that keeps the last picture from ``take_image``, so that it can be shown to the planner."""

    def __init__(self, images: ImageStore) -> None:
        self._images = images
        self.last: tuple[str, Frame] | None = None

    async def save_frame(self, frame: Frame) -> str:
        return await self._images.save_frame(frame)

    async def save_picture(self, frame: Frame) -> str:
        name = await self._images.save_picture(frame)
        self.last = (name, frame)
        return name

    async def last_picture(self) -> Picture | None:
        """Return the last picture from ``take_image``, prepared for the planner; None if there is none."""
        if self.last is None:
            return None
        name, frame = self.last
        return await picture(frame, f"The picture {name}:")


class SharedFrameCamera(TimedCamera):
    """A camera for concurrent calls. The first request takes a frame, and every later request returns the same frame."""

    def __init__(self, camera: Camera, watch: Stopwatch) -> None:
        super().__init__(camera, watch)
        self._lock = anyio.Lock()
        self._shared_frame: Frame | None = None

    async def frame(self) -> Frame:
        async with self._lock:
            if self._shared_frame is None:
                self._shared_frame = await super().frame()
            return self._shared_frame
