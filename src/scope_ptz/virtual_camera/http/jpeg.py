"""Encode exposures as JPEGs. Clients that request the same size and compression share one encoding."""

from __future__ import annotations

import asyncio
from collections import OrderedDict
from dataclasses import dataclass

import cv2
import numpy as np
from anyio import to_thread
from numpy.typing import NDArray

from scope_ptz.errors import CameraError, InputError
from scope_ptz.virtual_camera.device import Exposure, VirtualDevice
from scope_ptz.virtual_camera.picture_size import crop_and_scale, parse_resolution

DEFAULT_COMPRESSION = 30
"""The default compression on AXIS cameras, on a scale from 0 (best quality) to 100."""

MAX_SHARED = 8  # maximum number of formats whose newest encoding is cached


@dataclass(frozen=True, slots=True)
class PictureFormat:
    """The size in pixels and the compression (0 to 100) of a JPEG."""

    width: int
    height: int
    compression: int = DEFAULT_COMPRESSION


def picture_format(device: VirtualDevice, resolution: str, compression: str) -> PictureFormat:
    """Parse the format that a client requests. Empty strings mean the defaults.

    Raises:
        InputError: The resolution does not have the form WIDTHxHEIGHT or is out of range, or the compression is not an integer
            from 0 to 100.
    """
    width, height = parse_resolution(device, resolution)
    if compression and not (compression.isdecimal() and int(compression[:6]) <= 100):
        raise InputError(f"compression: expected 0 to 100, got {compression[:60]!r}")
    return PictureFormat(width, height, int(compression) if compression else DEFAULT_COMPRESSION)


def encode(image: NDArray[np.uint8], requested_format: PictureFormat) -> bytes:
    """Encode an RGB image as a JPEG. If the aspect ratio differs, the image is cropped rather than stretched."""
    image = crop_and_scale(image, requested_format.width, requested_format.height)
    quality = round(98 - 0.85 * requested_format.compression)
    encoded, content = cv2.imencode(".jpg", cv2.cvtColor(image, cv2.COLOR_RGB2BGR), [cv2.IMWRITE_JPEG_QUALITY, quality])
    if not encoded:
        raise CameraError("The picture cannot be encoded.")
    return bytes(content)


def with_comment(jpeg: bytes, text: str) -> bytes:
    """Return the JPEG with a comment segment inserted after its start marker."""
    content = text.encode()[:65_000]
    return jpeg[:2] + b"\xff\xfe" + (len(content) + 2).to_bytes(2, "big") + content + jpeg[2:]


class SharedJpegs:
    """Encodes each exposure at most once per format.

    Args:
        device: The camera, whose faults are applied to the pictures.
    """

    def __init__(self, device: VirtualDevice) -> None:
        self._device = device
        self._newest: OrderedDict[PictureFormat, tuple[Exposure, asyncio.Task[bytes]]] = OrderedDict()
        self.encodings = 0
        """Number of encodings so far."""

    async def snapshot(self, requested_format: PictureFormat) -> tuple[Exposure, bytes]:
        """Capture an image, and return the exposure and its JPEG."""
        exposure = await to_thread.run_sync(self._device.expose)
        return exposure, await self.jpeg(exposure, requested_format)

    async def jpeg(self, exposure: Exposure, requested_format: PictureFormat) -> bytes:
        """Return an exposure as a JPEG, reusing the last encoding if possible."""
        cached = self._newest.get(requested_format)
        if cached is None or cached[0] is not exposure:
            cached = exposure, asyncio.create_task(self._encode(exposure, requested_format))
            self._newest[requested_format] = cached
            self._newest.move_to_end(requested_format)
            if len(self._newest) > MAX_SHARED:
                self._newest.popitem(last=False)
        content = await asyncio.shield(cached[1])
        return content[: len(content) // 2] if self._device.faults.picture == "truncated" else content

    async def _encode(self, exposure: Exposure, requested_format: PictureFormat) -> bytes:
        self.encodings += 1
        if self._device.faults.picture == "size":
            height, width = exposure.image.shape[:2]
            requested_format = PictureFormat(
                min(width, requested_format.width // 2), min(height, requested_format.height // 2), requested_format.compression
            )
        return await to_thread.run_sync(encode, exposure.image, requested_format)
