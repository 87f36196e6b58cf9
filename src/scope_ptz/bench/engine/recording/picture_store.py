"""Store the pictures of a run as JPEG, under their names in the trace."""

from __future__ import annotations

import base64

import anyio
import cv2
from anyio import to_thread

from scope_ptz.agent.planner_views import MAX_SIDE_PX, picture
from scope_ptz.agent.store import Numbering
from scope_ptz.camera.base import Frame

WIDEST = 2560
"""Longest side of a logged panorama in pixels. Perception receives the panorama in full size."""
QUALITY = 85
"""JPEG quality of a logged panorama."""
_HEAD = "data:image/jpeg;base64,"


async def data_url(frame: Frame) -> str:
    """Return a frame as a JPEG data URL, encoded in a worker thread. Panoramas are reduced."""
    if max(frame.width, frame.height) <= MAX_SIDE_PX:
        return (await picture(frame, "")).data_url
    return await to_thread.run_sync(_reduced_data_url, frame)


def _reduced_data_url(frame: Frame) -> str:
    scale = min(1.0, WIDEST / max(frame.width, frame.height))
    small = cv2.resize(frame.image, (round(frame.width * scale), round(frame.height * scale)), interpolation=cv2.INTER_AREA)
    _, jpeg = cv2.imencode(".jpg", cv2.cvtColor(small, cv2.COLOR_RGB2BGR), [cv2.IMWRITE_JPEG_QUALITY, QUALITY])
    return _HEAD + base64.b64encode(jpeg.tobytes()).decode("ascii")


def jpeg_of(url: str) -> bytes:
    """Return the JPEG bytes of a data URL."""
    return base64.b64decode(url.removeprefix(_HEAD))


class PictureStore:
    """An image store that keeps pictures in memory. Frames are encoded in ``settle``, outside the timed parts of a run."""

    def __init__(self) -> None:
        self._names, self._waiting = Numbering(), dict[str, Frame]()
        self._lock = anyio.Lock()
        self.kept: dict[str, str] = {}
        """Data URLs by name."""

    def save_look(self, frame: Frame) -> str:
        return self._enqueue(self._names.look(frame), frame)

    def save_picture(self, frame: Frame) -> str:
        return self._enqueue(self._names.picture().replace(".png", ".jpg"), frame)

    def _enqueue(self, name: str, frame: Frame) -> str:
        self._waiting[name] = frame
        return name

    async def settle(self) -> None:
        """Encode the frames that were saved since the last call."""
        async with self._lock:
            for name in list(self._waiting):
                self.kept[name] = await data_url(self._waiting[name])
                del self._waiting[name]
