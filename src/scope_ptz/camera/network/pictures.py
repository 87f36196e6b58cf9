"""Decode JPEG pictures from a device, and detect damaged, black and frozen ones."""

from __future__ import annotations

import hashlib
from io import BytesIO
from time import monotonic
from typing import TYPE_CHECKING

import numpy as np

from scope_ptz.camera.network.errors import PictureError, PictureFault

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from scope_ptz.geometry import Pose

BLACK_LEVEL = 6
"""Maximum pixel value in a black picture, on a scale of 0 to 255. Sensor noise in the dark exceeds it."""

FROZEN_TURN_DEG = 1.0
"""Turn in degrees after which a bit-identical picture counts as frozen."""

STATIONARY_DEG = 0.05
"""Difference in degrees between the poses of successive pictures below which the camera counts as stationary."""

_JPEG_START, _JPEG_END = b"\xff\xd8", b"\xff\xd9"


def decode_jpeg(data: bytes, *, width: int | None = None, height: int | None = None) -> NDArray[np.uint8]:
    """Decode a JPEG picture.

    Args:
        data: The content of the JPEG file.
        width: The expected width in pixels; None to accept any size.
        height: The expected height in pixels; None to accept any size.

    Returns:
        Array of shape ``(H, W, 3)``, uint8, RGB.

    Raises:
        PictureError: The picture is truncated or damaged, or has the wrong size.
    """
    from PIL import Image, UnidentifiedImageError

    if not data.startswith(_JPEG_START):
        raise PictureError("The camera sent data that is not a JPEG picture. Check its model and firmware.", "damaged")
    if _JPEG_END not in data[-64:]:
        raise PictureError("The camera sent an incomplete picture. Check the network, then try again.", "truncated")
    try:
        with Image.open(BytesIO(data), formats=("JPEG",)) as picture:
            size = picture.size
            if (width, height) != (None, None) and size != (width, height):
                raise PictureError(
                    f"The camera sent a picture of {size[0]}x{size[1]} pixels instead of {width}x{height}. "
                    "Request a supported size with ?width=...&height=...",
                    "size",
                )
            return np.array(picture.convert("RGB"))
    except (OSError, UnidentifiedImageError, ValueError, SyntaxError, Image.DecompressionBombError) as error:
        fault: PictureFault = "truncated" if "truncated" in str(error) else "damaged"
        description = "that is incomplete" if fault == "truncated" else "that is damaged"
        raise PictureError(f"The camera sent a picture {description}. Check the network, then try again.", fault) from None


def is_black(image: NDArray[np.uint8]) -> bool:
    """Return whether a picture is entirely black."""
    return bool(image.max() <= BLACK_LEVEL) if image[::8, ::8].max() <= BLACK_LEVEL else False


def check_not_black(image: NDArray[np.uint8]) -> None:
    """Raise ``PictureError`` if a picture is entirely black."""
    if is_black(image):
        raise PictureError("The camera's picture is black. Check the lens cover, the iris and the lighting.", "black")


class FrozenCheck:
    """Detects pictures that do not change although the camera turns.

    Pictures of a static scene may be identical, so only pictures taken at different poses are compared. Only poses of a stationary
    camera count, because during a move a picture and its pose may be from slightly different times.
    """

    def __init__(self) -> None:
        self._digest = b""
        self._stationary_at: Pose | None = None
        self._last: Pose | None = None

    def is_frozen(self, data: bytes, pose: Pose) -> bool:
        """Return whether an identical picture was taken earlier, while the camera was stationary at a clearly different pose.

        Args:
            data: The picture's bytes: a JPEG file, or pixels.
            pose: The pose at which it was taken.
        """
        digest = hashlib.blake2b(data, digest_size=16).digest()
        is_stationary = self._last is not None and _turn_deg(self._last, pose) < STATIONARY_DEG
        self._last = pose
        if digest != self._digest:
            self._digest, self._stationary_at = digest, None
        elif is_stationary and self._stationary_at is None:
            self._stationary_at = pose
        elif is_stationary and self._stationary_at is not None:
            return _turn_deg(self._stationary_at, pose) > FROZEN_TURN_DEG
        return False

    def is_lagging(self, data: bytes, pose: Pose, deadline_s: float) -> bool:
        """Return whether a picture still shows an earlier pose, for example because the encoder freezes during a move.

        Args:
            data: The picture's bytes.
            pose: The pose at which it was taken.
            deadline_s: The ``time.monotonic`` time after which to raise an error instead.

        Raises:
            PictureError: The picture is still frozen after ``deadline_s``.
        """
        if not self.is_frozen(data, pose):
            return False
        if monotonic() > deadline_s:
            raise PictureError("The picture is frozen: it does not change while the camera turns. Restart the camera.", "frozen")
        return True


def _turn_deg(first: Pose, second: Pose) -> float:
    """Return the largest change on any axis in degrees. A zoom change of 10% counts as one degree."""
    pan = abs((second.pan_deg - first.pan_deg + 180) % 360 - 180)
    return max(pan, abs(second.tilt_deg - first.tilt_deg), 10 * abs(second.zoom / first.zoom - 1))
