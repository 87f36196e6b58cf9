"""A camera's live video. Frames are taken while at least one client is watching, and each client gets the newest frame."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import AsyncGenerator, AsyncIterator, Awaitable, Callable
from contextlib import aclosing, asynccontextmanager
from time import time
from typing import Any

import anyio
import cv2
from anyio import to_thread
from numpy.typing import NDArray

from scope_ptz.camera.base import Camera, Frame
from scope_ptz.errors import CameraError

RATE_HZ = 25.0
JPEG_QUALITY = 80
MAX_AGE_S = 5.0  # maximum age of a frame, which limits the error if a clock is set forward between exposure and arrival
RETRY_S = 1.0  # seconds between a camera failure and the next attempt
CHECK_INTERVAL_S = 0.25  # seconds between checks for interrupted frames

logger = logging.getLogger(__name__)


class LiveFrame:
    """A frame with its JPEG encodings. Clients that request the same width share one encoding.

    Attributes:
        number: Number of the frame, counted since the server started.
        frame: The frame.
        taken: The exposure time, in seconds since 1970.

    Args:
        number: Number of the frame.
        frame: The frame.
        age_s: Seconds since the exposure.
    """

    def __init__(self, number: int, frame: Frame, age_s: float = 0.0) -> None:
        self.number, self.frame, self.taken = number, frame, time() - min(max(age_s, 0.0), MAX_AGE_S)
        self._encodings: dict[int, asyncio.Task[bytes]] = {}

    async def jpeg(self, width: int) -> bytes:
        """Return the frame as a JPEG that is at most ``width`` pixels wide."""
        width = min(width, self.frame.width)
        if width not in self._encodings:
            self._encodings[width] = asyncio.create_task(to_thread.run_sync(encode_jpeg, self.frame.image, width))
        return await asyncio.shield(self._encodings[width])


def encode_jpeg(image: NDArray[Any], width: int, quality: int = JPEG_QUALITY) -> bytes:
    """Encode an RGB picture as a JPEG that is ``width`` pixels wide. The aspect ratio is kept."""
    height = max(1, round(image.shape[0] * width / image.shape[1]))
    if width != image.shape[1]:
        # Above half the width, linear interpolation is as smooth as area averaging and takes a tenth of the time.
        use_area_averaging = 2 * width <= image.shape[1]
        image = cv2.resize(image, (width, height), interpolation=cv2.INTER_AREA if use_area_averaging else cv2.INTER_LINEAR)
    encoded, data = cv2.imencode(".jpg", cv2.cvtColor(image, cv2.COLOR_RGB2BGR), [cv2.IMWRITE_JPEG_QUALITY, quality])
    if not encoded:
        raise CameraError("The picture cannot be encoded.")
    return bytes(data)


class LivePicture:
    """Takes frames from a camera while at least one client is watching, and passes each client the newest one.

    A slow client skips frames and does not delay others. After a camera failure, clients wait until the camera works again.

    Args:
        name: The camera's name.
        camera: Opens the camera if necessary, and returns it.
        rate_hz: Frames per second.
    """

    def __init__(self, name: str, camera: Callable[[], Awaitable[Camera]], *, rate_hz: float = RATE_HZ) -> None:
        self._name, self._camera, self._rate_hz = name, camera, rate_hz
        self._newest: LiveFrame | None = None
        self._changed = anyio.Event()
        self._watched = anyio.Event()
        self.watchers = 0
        self.problem = ""
        """The camera's error message; empty while the camera delivers frames."""

    @property
    def newest(self) -> LiveFrame | None:
        """The newest frame; None while nobody is watching."""
        return self._newest

    async def run(self) -> None:
        """Take frames while at least one client is watching, until cancelled."""
        number = 0
        while True:
            await self._watched.wait()
            try:
                camera = await self._camera()
                async with self._report_interruptions(camera), aclosing(camera.frames(rate_hz=self._rate_hz)) as frames:
                    async for frame in frames:
                        number += 1
                        self.problem = ""
                        if not self.watchers:  # the frame is discarded, because the next watcher must not get an old one
                            break
                        self._publish(LiveFrame(number, frame, camera.clock.now_s() - frame.time_s))
            except Exception as error:  # the live video must continue after any driver failure
                self.problem = str(error)
                logger.warning("The live video of %s failed; retrying: %s", self._name, error)
                self._wake()
                await anyio.sleep(RETRY_S)

    @asynccontextmanager
    async def _report_interruptions(self, camera: Camera) -> AsyncIterator[None]:
        """Return a context that tells clients why frames are missing while the camera's stream continues."""

        async def report() -> None:
            while True:
                await anyio.sleep(CHECK_INTERVAL_S)
                problem = camera.frames_problem
                if problem and not self.problem:
                    self.problem = problem
                    logger.warning("The live video of %s is interrupted: %s", self._name, problem)
                    self._wake()

        task = asyncio.create_task(report())
        try:
            yield
        finally:
            task.cancel()

    @asynccontextmanager
    async def watch(self) -> AsyncIterator[AsyncIterator[LiveFrame | None]]:
        """Return a context that provides an endless iterator over new frames. After a camera failure, the iterator yields None."""
        self.watchers += 1
        self._watched.set()
        frames = self._frames()
        try:
            yield frames
        finally:
            await frames.aclose()
            self.watchers -= 1
            if not self.watchers:
                self._watched = anyio.Event()
                self._newest = None

    async def _frames(self) -> AsyncGenerator[LiveFrame | None]:
        seen = None
        while True:
            while self._newest is None or self._newest is seen:
                changed = self._changed
                await changed.wait()
                if self.problem:
                    yield None
            seen = self._newest
            yield seen

    def _publish(self, frame: LiveFrame) -> None:
        self._newest = frame
        self._wake()

    def _wake(self) -> None:
        changed, self._changed = self._changed, anyio.Event()
        changed.set()
