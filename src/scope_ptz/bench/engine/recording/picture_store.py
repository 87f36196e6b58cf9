"""Store the pictures of a run in memory as JPEG data URLs, by their names in the trace."""

from __future__ import annotations

import base64

import anyio
import cv2
from anyio import to_thread

from scope_ptz.agent.planner_views import MAX_SIDE_PX, picture
from scope_ptz.agent.store import PictureNames
from scope_ptz.camera.base import Frame

MAX_PANORAMA_SIDE_PX = 2560
"""Maximum length in pixels of the longer side of a logged panorama. Perception receives panoramas at full size."""
JPEG_QUALITY = 85
"""JPEG quality of logged panoramas."""
_URL_PREFIX = "data:image/jpeg;base64,"


async def data_url(frame: Frame) -> str:
    """Encode a frame as a JPEG data URL in a worker thread. Panoramas are scaled down."""
    if max(frame.width, frame.height) <= MAX_SIDE_PX:
        return (await picture(frame, "")).data_url
    return await to_thread.run_sync(_scaled_data_url, frame)


def _scaled_data_url(frame: Frame) -> str:
    scale = min(1.0, MAX_PANORAMA_SIDE_PX / max(frame.width, frame.height))
    small = cv2.resize(frame.image, (round(frame.width * scale), round(frame.height * scale)), interpolation=cv2.INTER_AREA)
    _, jpeg = cv2.imencode(".jpg", cv2.cvtColor(small, cv2.COLOR_RGB2BGR), [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])
    return _URL_PREFIX + base64.b64encode(jpeg.tobytes()).decode("ascii")


def jpeg_of(url: str) -> bytes:
    """Return the JPEG bytes of a data URL."""
    return base64.b64decode(url.removeprefix(_URL_PREFIX))


class PictureStore:
    """An image store that holds pictures in memory.

    Frames are not encoded until ``encode_pending`` is called, so that the measured times of a run do not include encoding.

    Attributes:
        urls: Data URLs of the encoded pictures by name.
    """

    def __init__(self) -> None:
        self._names, self._pending = PictureNames(), dict[str, Frame]()
        self._lock = anyio.Lock()
        self.urls: dict[str, str] = {}

    async def save_frame(self, frame: Frame) -> str:
        return self._enqueue(self._names.frame(frame), frame)

    async def save_picture(self, frame: Frame) -> str:
        return self._enqueue(self._names.picture().replace(".png", ".jpg"), frame)

    def _enqueue(self, name: str, frame: Frame) -> str:
        self._pending[name] = frame
        return name

    async def encode_pending(self) -> None:
        """Encode the frames saved since the last call."""
        async with self._lock:
            for name in list(self._pending):
                self.urls[name] = await data_url(self._pending[name])
                del self._pending[name]
