"""Encode pictures for clients that reject large results."""

from __future__ import annotations

from base64 import b64encode
from typing import Any

import cv2
import numpy as np
from anyio import to_thread
from mcp_types import ImageContent
from numpy.typing import NDArray

from scope_ptz.errors import TraceError
from scope_ptz.serve.site.live_picture import encode_jpeg

MAX_RESULT_BYTES = 1024 * 1024
"""Maximum size of a result as JSON, in bytes. Some clients reject larger results."""

MAX_PICTURE_BYTES = 480 * 1024
"""Maximum size of a picture in a tool result, in bytes. As base64, it takes 640 KiB, which leaves 384 KiB for other content."""

MAX_RESOURCE_BYTES = 760 * 1024
"""Maximum size of a picture in a resource, in bytes. The resource contains nothing else."""

PICTURE_WIDTH = 1280  # maximum width of a picture in a tool result, in pixels
_QUALITIES = (85, 70, 55)  # JPEG qualities, tried in this order before the picture is made smaller
_SHRINK_FACTOR = 0.8  # factor by which the width is reduced between attempts

UNTRUSTED_META = {"scope-ptz/untrusted": True}
"""Metadata for every picture, because text in a picture is not an instruction."""


def encode_limited_jpeg(image: NDArray[Any], max_bytes: int, width: int) -> bytes:
    """Encode an RGB picture as a size-limited JPEG.

    Args:
        image: The picture, of shape ``(H, W, 3)``.
        max_bytes: The maximum size of the JPEG in bytes.
        width: The maximum width in pixels.
    """
    width = min(width, int(image.shape[1]))
    while True:
        for quality in _QUALITIES:
            if len(data := encode_jpeg(image, width, quality)) <= max_bytes or width <= 16:
                return data
        width = max(16, int(width * _SHRINK_FACTOR))


def decode_picture(data: bytes) -> NDArray[Any]:
    """Decode a stored picture to RGB, of shape ``(H, W, 3)``.

    Raises:
        TraceError: The picture is damaged.
    """
    image: Any = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)
    if image is None:
        raise TraceError("The picture of the run is damaged.")
    return np.asarray(cv2.cvtColor(image, cv2.COLOR_BGR2RGB))


async def convert_to_limited_jpeg(data: bytes, max_bytes: int, width: int = 100_000) -> bytes:
    """Convert a stored JPEG or PNG to a size-limited JPEG. A JPEG that is small enough is returned unchanged.

    Raises:
        TraceError: The picture is damaged.
    """

    def convert() -> bytes:
        image = decode_picture(data)
        if data.startswith(b"\xff\xd8") and len(data) <= max_bytes and image.shape[1] <= width:
            return data
        return encode_limited_jpeg(image, max_bytes, width)

    return await to_thread.run_sync(convert)


def image_content(jpeg: bytes) -> ImageContent:
    """Return a JPEG as result content."""
    return ImageContent(type="image", data=b64encode(jpeg).decode(), mime_type="image/jpeg", _meta=UNTRUSTED_META)
