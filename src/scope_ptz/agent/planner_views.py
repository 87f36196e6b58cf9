"""Frames for planners that see, and the one frame that calls made at the same time look at."""

from __future__ import annotations

import anyio

from scope_ptz.agent.timing import Stopwatch, TimedCamera
from scope_ptz.camera.base import Camera, Frame
from scope_ptz.perception.encoding import picture_of
from scope_ptz.planner.base import Picture
from scope_ptz.tools.context import ImageStore

LONGEST_SIDE = 1280
"""Pixels. Vision models scale larger frames down themselves, after they were sent."""


async def picture(frame: Frame, caption: str) -> Picture:
    """A frame as a planner gets it, no larger than models look at."""
    scale = min(1.0, LONGEST_SIDE / max(frame.width, frame.height))
    coded = await picture_of(frame, (round(frame.width * scale), round(frame.height * scale)))
    return Picture(data_url=coded.data_url, caption=caption)


async def newest_view(frame: Frame) -> Picture:
    """The view of now, with the pose that it was taken at."""
    pose = frame.pose.as_dict()
    return await picture(
        frame, f"The camera's view now, at pan {pose['pan_deg']:g}, tilt {pose['tilt_deg']:g}, zoom {pose['zoom']:g}:"
    )


class PictureStore:
    """An image store that remembers the last picture that a tool kept, so that a planner can be shown it."""

    def __init__(self, images: ImageStore) -> None:
        self._images = images
        self.kept: tuple[str, Frame] | None = None

    def save_look(self, frame: Frame) -> str:
        return self._images.save_look(frame)

    def save_picture(self, frame: Frame) -> str:
        name = self._images.save_picture(frame)
        self.kept = (name, frame)
        return name

    async def shown(self) -> Picture | None:
        if self.kept is None:
            return None
        name, frame = self.kept
        return await picture(frame, f"The picture {name}:")


class OneView(TimedCamera):
    """A camera for calls that are made at the same time: the first that wants a frame takes it, and all look at that one."""

    def __init__(self, camera: Camera, watch: Stopwatch) -> None:
        super().__init__(camera, watch)
        self._lock = anyio.Lock()
        self._taken: Frame | None = None

    async def frame(self) -> Frame:
        async with self._lock:
            if self._taken is None:
                self._taken = await super().frame()
            return self._taken
