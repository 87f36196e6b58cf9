"""The pictures of a run, as JPEG, by the names that its trace gives them."""

from __future__ import annotations

import base64

import anyio
import cv2
from anyio import to_thread

from scope_ptz.agent.planner_views import MAX_SIDE_PX, picture
from scope_ptz.agent.store import Numbering
from scope_ptz.camera.base import Frame

WIDEST = 2560
"""Longest side of a logged panorama in pixels. Perception received it in full size."""
QUALITY = 85
_HEAD = "data:image/jpeg;base64,"


async def data_url(frame: Frame) -> str:
    """Return a frame as a JPEG data URL, encoded in a worker thread. A model that was shown it got the same bytes."""
    if max(frame.width, frame.height) <= MAX_SIDE_PX:
        return (await picture(frame, "")).data_url
    return await to_thread.run_sync(_coded, frame)


def _coded(frame: Frame) -> str:
    scale = min(1.0, WIDEST / max(frame.width, frame.height))
    small = cv2.resize(frame.image, (round(frame.width * scale), round(frame.height * scale)), interpolation=cv2.INTER_AREA)
    _, jpeg = cv2.imencode(".jpg", cv2.cvtColor(small, cv2.COLOR_RGB2BGR), [cv2.IMWRITE_JPEG_QUALITY, QUALITY])
    return _HEAD + base64.b64encode(jpeg.tobytes()).decode("ascii")


def jpeg_of(url: str) -> bytes:
    """Return the bytes of a picture."""
    return base64.b64decode(url.removeprefix(_HEAD))


class PictureStore:
    """An image store that keeps pictures in memory. Frames are encoded in ``settle``, outside the timed parts of a run."""

    def __init__(self) -> None:
        self._names, self._waiting = Numbering(), dict[str, Frame]()
        self._lock = anyio.Lock()
        self.kept: dict[str, str] = {}
        """Data URLs by name."""

    def save_look(self, frame: Frame) -> str:
        return self._take(self._names.look(frame), frame)

    def save_picture(self, frame: Frame) -> str:
        return self._take(self._names.picture().replace(".png", ".jpg"), frame)

    def _take(self, name: str, frame: Frame) -> str:
        self._waiting[name] = frame
        return name

    async def settle(self) -> None:
        """Encode the frames that wait."""
        async with self._lock:
            for name in list(self._waiting):
                self.kept[name] = await data_url(self._waiting[name])
                del self._waiting[name]
