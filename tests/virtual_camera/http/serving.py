"""Clients of a served virtual camera, and helpers that read its replies."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from typing import Any

import anyio
import cv2
import httpx2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.http.server import ServedCamera, serve

PTZ, IMAGE, VIDEO = "/axis-cgi/com/ptz.cgi", "/axis-cgi/jpg/image.cgi", "/axis-cgi/mjpg/video.cgi"


def client(camera: ServedCamera, user: str = "root", password: str = "pass word", **options: Any) -> httpx2.AsyncClient:  # noqa: S107
    auth = httpx2.DigestAuth(user, password) if user else None
    return httpx2.AsyncClient(base_url=camera.url, auth=auth, trust_env=False, timeout=20, **options)


@asynccontextmanager
async def camera_and_client(device: VirtualDevice, **options: Any) -> AsyncIterator[tuple[ServedCamera, httpx2.AsyncClient]]:
    async with serve([device], **options) as (camera,), client(camera) as session:
        yield camera, session


def decoded(jpeg: bytes) -> NDArray[np.uint8]:
    image = cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR)
    assert image is not None
    return np.asarray(image, np.uint8)


class Parts:
    """Reads the parts of a multipart stream as a browser does: by boundary and Content-Length."""

    def __init__(self, response: httpx2.Response) -> None:
        self._boundary = response.headers["content-type"].partition("boundary=")[2].encode()
        self._chunks = response.aiter_bytes()
        self._buffer = b""

    async def take(self, count: int) -> list[tuple[dict[str, str], bytes]]:
        """Return the headers and the body of the next parts."""
        return [await self._next() for _ in range(count)]

    async def _next(self) -> tuple[dict[str, str], bytes]:
        head = await self._until(b"\r\n\r\n")
        first, *lines = head.split(b"\r\n")
        assert first == b"--" + self._boundary
        headers = {name.lower(): value.strip() for name, _, value in (line.decode().partition(":") for line in lines)}
        length = int(headers["content-length"])
        while len(self._buffer) < length + 2:
            self._buffer += await anext(self._chunks)
        body, end, self._buffer = self._buffer[:length], self._buffer[length : length + 2], self._buffer[length + 2 :]
        assert end == b"\r\n"
        return headers, body

    async def _until(self, mark: bytes) -> bytes:
        while mark not in self._buffer:
            self._buffer += await anext(self._chunks)
        found, _, self._buffer = self._buffer.partition(mark)
        return found


async def until(condition: Callable[[], bool]) -> None:
    with anyio.fail_after(20):
        while not condition():  # noqa: ASYNC110 - what is waited for has no event
            await anyio.sleep(0.01)
