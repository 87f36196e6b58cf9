"""Encode frames for models. A frame is encoded once per size, even if several backends use it."""

from __future__ import annotations

import base64
from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np

from scope_ptz.camera.base import Frame
from scope_ptz.errors import PerceptionError
from scope_ptz.perception.models.frame_memo import FrameMemo, Image

JPEG_QUALITY = 90

Size = tuple[int, int]


@dataclass(frozen=True)
class EncodedPicture:
    """A frame in the form in which it is sent to a model: a JPEG of ``width`` x ``height`` pixels."""

    jpeg: bytes
    width: int
    height: int

    @property
    def size(self) -> Size:
        return self.width, self.height

    @cached_property
    def data_url(self) -> str:
        return "data:image/jpeg;base64," + base64.b64encode(self.jpeg).decode("ascii")


def resize(image: Image, size: Size | None) -> Image:
    """Resize an image (H, W, 3) to (width, height). If it already has that size, return the same array."""
    if size is None or size == (image.shape[1], image.shape[0]):
        return image
    return np.asarray(cv2.resize(image, size, interpolation=_interpolation((image.shape[1], image.shape[0]), size)), dtype=np.uint8)


def _interpolation(old: Size, new: Size) -> int:
    """Return the fastest interpolation that gives good results.

    Averaging is needed only when the image becomes much smaller. If the size changes by less than 2%, a few repeated or missing
    rows and columns are invisible.
    """
    if new[0] * new[1] < 0.6 * old[0] * old[1]:
        return cv2.INTER_AREA
    almost_same_size = all(abs(after / before - 1) < 0.02 for before, after in zip(old, new, strict=True))
    return cv2.INTER_NEAREST_EXACT if almost_same_size else cv2.INTER_LINEAR


def encode(image: Image, size: Size | None = None) -> EncodedPicture:
    """Encode an RGB image (H, W, 3) as JPEG, resized to ``size`` (width, height) if given.

    Raises:
        PerceptionError: The image cannot be encoded.
    """
    picture = resize(image, size)
    # A resized copy is converted in place, because allocating another array takes longer.
    target = picture if picture is not image else None
    try:
        bgr = cv2.cvtColor(picture, cv2.COLOR_RGB2BGR, dst=target)
        succeeded, jpeg = cv2.imencode(".jpg", bgr, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])
    except cv2.error:
        succeeded = False
    if not succeeded:
        raise PerceptionError(f"A frame of {picture.shape[1]}x{picture.shape[0]} pixels cannot be written as JPEG.")
    encoded = EncodedPicture(jpeg.tobytes(), int(picture.shape[1]), int(picture.shape[0]))
    _ = encoded.data_url  # computed in advance, in the worker thread
    return encoded


_SHARED_CACHE: FrameMemo[Size | None, EncodedPicture] = FrameMemo(encode)
"""The cache that all backends share, so that each frame is encoded once per size."""


async def encode_frame(
    frame: Frame, size: Size | None = None, memo: FrameMemo[Size | None, EncodedPicture] = _SHARED_CACHE
) -> EncodedPicture:
    """Encode a frame as JPEG at a size (width, height), in a worker thread. Repeated calls return the cached picture."""
    return await memo.get_async(frame.image, None if size == (frame.width, frame.height) else size)
