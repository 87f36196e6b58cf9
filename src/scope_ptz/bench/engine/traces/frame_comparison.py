"""Compare a stored frame with a new rendering of the same view.

The same version of the simulator renders the same pixels, and both pictures are compressed in the same way. However, processors and
JPEG libraries round differently, so small differences are accepted. docs/evaluation.md states how the tolerances were measured.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

MAX_MEAN_DIFFERENCE = 4.0
"""Maximum accepted mean absolute difference between two frames, on a scale of 0 to 255."""
MIN_SSIM = 0.96
"""Minimum accepted structural similarity (SSIM) of two frames in greyscale."""
MAX_BLOCK_DIFFERENCE = 18.0
"""Maximum accepted mean absolute difference within a block, on a scale of 0 to 255. It detects things that were painted over."""
BLOCK_PX = 16
"""Width and height of a block in pixels."""
_SIGMA_PX = 1.5  # standard deviation of SSIM's Gaussian window
_C1, _C2 = (0.01 * 255) ** 2, (0.03 * 255) ** 2


@dataclass(frozen=True, slots=True)
class FrameDifference:
    """The difference between two frames.

    Attributes:
        mean: Mean absolute difference, on a scale of 0 to 255.
        ssim: Structural similarity in greyscale; 1 for equal frames.
        worst_block: Largest mean absolute difference within a block, on a scale of 0 to 255.
    """

    mean: float
    ssim: float
    worst_block: float

    @property
    def accepted(self) -> bool:
        """Whether the difference is within all tolerances."""
        return self.mean <= MAX_MEAN_DIFFERENCE and self.ssim >= MIN_SSIM and self.worst_block <= MAX_BLOCK_DIFFERENCE

    def __str__(self) -> str:
        return f"mean difference {self.mean:.2f}, SSIM {self.ssim:.3f}, worst block {self.worst_block:.1f}"


EQUAL = FrameDifference(0.0, 1.0, 0.0)


def compare_frames(stored: bytes, rendered: bytes) -> FrameDifference | None:
    """Return the difference between two frames; None if the stored data is not a picture or the sizes differ.

    Args:
        stored: The stored frame as JPEG.
        rendered: The rendered frame as JPEG.
    """
    if stored == rendered:
        return EQUAL
    first, second = (cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR) if data else None for data in (stored, rendered))
    if first is None or second is None or first.shape != second.shape:
        return None
    difference = cv2.absdiff(first, second).mean(axis=2).astype(np.float32)
    height, width = (side - side % BLOCK_PX for side in difference.shape)
    blocks = difference[:height, :width].reshape(height // BLOCK_PX, BLOCK_PX, width // BLOCK_PX, BLOCK_PX).mean(axis=(1, 3))
    return FrameDifference(
        float(difference.mean()), _ssim(_grey(first), _grey(second)), float(blocks.max(initial=float(difference.mean())))
    )


def _grey(image: NDArray[np.uint8]) -> NDArray[np.float32]:
    return np.asarray(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), np.float32)


def _ssim(first: NDArray[np.float32], second: NDArray[np.float32]) -> float:
    """Return the mean SSIM of two greyscale images, with the Gaussian window of Wang et al. (2004)."""

    def blur(image: NDArray[np.float32]) -> NDArray[np.float32]:
        return np.asarray(cv2.GaussianBlur(image, (11, 11), _SIGMA_PX), np.float32)

    mean_first, mean_second = blur(first), blur(second)
    variance_first, variance_second = blur(first * first) - mean_first**2, blur(second * second) - mean_second**2
    covariance = blur(first * second) - mean_first * mean_second
    top = (2 * mean_first * mean_second + _C1) * (2 * covariance + _C2)
    bottom = (mean_first**2 + mean_second**2 + _C1) * (variance_first + variance_second + _C2)
    return float((top / bottom).mean())
