"""Live video streams from a device. Only the newest picture is kept, and a stalled or broken stream is reopened."""

from __future__ import annotations

import asyncio
from abc import ABC, abstractmethod
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from time import monotonic
from typing import TYPE_CHECKING

import anyio
from anyio import to_thread

from scope_ptz.camera.network.errors import CameraTimeoutError, CameraUnreachableError, PictureError
from scope_ptz.camera.network.mjpeg import MjpegParser, parse_boundary
from scope_ptz.camera.network.pictures import decode_jpeg

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from scope_ptz.camera.network.http import DeviceHttp

STALLED_S = 5.0
"""Seconds without a picture after which a stream counts as stalled."""

MAX_DAMAGED = 5
"""Maximum number of consecutive damaged pictures to skip."""

GIVE_UP_S = 15.0
"""Seconds without a picture after which a stream counts as lost."""


@dataclass(frozen=True, slots=True)
class LivePicture:
    """A picture from a stream.

    Attributes:
        image: Array of shape ``(H, W, 3)``, uint8, RGB.
        data: Bytes that are identical for identical pictures.
        arrived_s: The ``time.monotonic`` time at which its last byte arrived.
    """

    image: NDArray[np.uint8]
    data: bytes
    arrived_s: float


class LiveStream(ABC):
    """A stream of pictures. Close it when it is no longer needed."""

    @abstractmethod
    async def next(self) -> LivePicture:
        """Wait for a picture that has not been returned yet, and return the newest.

        Raises:
            CameraError: The stream is lost, or its pictures are damaged.
        """

    @abstractmethod
    async def close(self) -> None:
        """Close the stream, and wait until it is closed."""


class MjpegStream(LiveStream):
    """A Motion JPEG stream over HTTP. Only pictures that a consumer is waiting for are decoded.

    Args:
        http: The HTTP connection to the device.
        path: Path of the stream.
        parameters: Query parameters of the stream.
        width: Expected width in pixels.
        height: Expected height in pixels.
        stalled_s: Seconds without a picture after which the stream is reopened.
        give_up_s: Seconds without a picture after which the stream counts as lost.
    """

    def __init__(
        self,
        http: DeviceHttp,
        path: str,
        parameters: dict[str, str],
        *,
        width: int,
        height: int,
        stalled_s: float = STALLED_S,
        give_up_s: float = GIVE_UP_S,
    ) -> None:
        self._http, self._path, self._parameters = http, path, parameters
        self._width, self._height = width, height
        self._stalled_s, self._give_up_s = stalled_s, give_up_s
        self._newest: tuple[bytes, float] | None = None
        self._changed = asyncio.Event()
        self._failure: Exception | None = None
        self.reconnects = 0
        """Number of times that the stream has been reopened."""
        # The task has no task group, because the stream outlives the call that opens it. ``next`` raises the task's error.
        self._task = asyncio.get_running_loop().create_task(self._read())

    async def next(self) -> LivePicture:
        for skips_left in range(MAX_DAMAGED, -1, -1):
            data, arrived_s = await self._wait()
            try:
                image = await to_thread.run_sync(partial(decode_jpeg, data, width=self._width, height=self._height))
            except PictureError as error:
                if error.fault == "size" or not skips_left:
                    raise
            else:
                return LivePicture(image, data, arrived_s)
        raise AssertionError("the last picture is returned or raises")

    async def _wait(self) -> tuple[bytes, float]:
        while self._newest is None:
            if self._failure is not None:
                raise self._failure
            self._changed.clear()
            await self._changed.wait()
        newest, self._newest = self._newest, None
        return newest

    async def close(self) -> None:
        self._task.cancel()
        with suppress(asyncio.CancelledError):
            await self._task

    async def _read(self) -> None:
        last_s, pause_s = monotonic(), 0.1
        try:
            while True:
                previous_s = last_s
                failure: Exception = CameraUnreachableError("The camera closed its MJPEG stream repeatedly. Restart the camera.")
                try:
                    last_s = await self._read_once(last_s)
                except (CameraUnreachableError, CameraTimeoutError, PictureError) as error:
                    failure = error
                    last_s = max(last_s, self._last_s)
                pause_s = 0.1 if last_s > previous_s else min(2 * pause_s, 2.0)
                if monotonic() - last_s > self._give_up_s:
                    self._fail(failure)
                    return
                self.reconnects += 1
                await anyio.sleep(pause_s)
        except Exception as error:  # every failure must reach the consumer
            self._fail(error)

    _last_s = 0.0

    async def _read_once(self, last_s: float) -> float:
        """Read from one connection until it ends. Return the time at which the last picture arrived."""
        async with self._http.stream(self._path, self._parameters) as (content_type, chunks):
            parser = MjpegParser(parse_boundary(content_type))
            iterator = aiter(chunks)
            due_s = monotonic() + self._stalled_s
            while True:
                try:
                    with anyio.fail_after(max(0.001, due_s - monotonic())):
                        chunk = await anext(iterator)
                except StopAsyncIteration:
                    return max(last_s, self._last_s)
                except TimeoutError:
                    raise PictureError(
                        f"The camera's stream has delivered no new picture for {self._stalled_s:g} s. "
                        "Check the network, or restart the camera.",
                        "stalled",
                    ) from None
                if pictures := parser.feed(chunk):
                    self._last_s = monotonic()
                    due_s = self._last_s + self._stalled_s
                    self._newest = pictures[-1], self._last_s
                    self._changed.set()

    def _fail(self, error: Exception) -> None:
        self._failure = error
        self._changed.set()
