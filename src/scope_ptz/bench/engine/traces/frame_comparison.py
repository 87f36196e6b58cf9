"""Compare a stored frame with the frame that the simulator renders now.

The same version renders the same pixels, and both pictures are compressed in the same way. Other processors and JPEG libraries
round differently, so a small difference is accepted. docs/evaluation.md states the measurements behind the tolerances.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

MAX_MEAN_DIFFERENCE = 4.0
"""Largest accepted mean absolute difference of two frames, in levels of 256."""
MIN_SSIM = 0.96
"""Smallest accepted structural similarity (SSIM) of two frames in grey."""
MAX_BLOCK_DIFFERENCE = 18.0
"""Largest accepted mean absolute difference within a block, in levels of 256. It finds things that were painted over."""
BLOCK_PX = 16
"""Width and height of a block in pixels."""
_SIGMA_PX = 1.5  # of the Gaussian window of SSIM
_C1, _C2 = (0.01 * 255) ** 2, (0.03 * 255) ** 2


@dataclass(frozen=True, slots=True)
class FrameDifference:
    """The difference of two frames.

    Attributes:
        mean: Mean absolute difference, in levels of 256.
        ssim: Structural similarity in grey; 1 for equal frames.
        worst_block: Largest mean absolute difference of a block, in levels of 256.
    """

    mean: float
    ssim: float
    worst_block: float

    @property
    def accepted(self) -> bool:
        """Whether the frames show the same within the tolerances."""
        return self.mean <= MAX_MEAN_DIFFERENCE and self.ssim >= MIN_SSIM and self.worst_block <= MAX_BLOCK_DIFFERENCE

    def __str__(self) -> str:
        return f"mean difference {self.mean:.2f}, SSIM {self.ssim:.3f}, worst block {self.worst_block:.1f}"


EQUAL = FrameDifference(0.0, 1.0, 0.0)


def compare_frames(stored: bytes, rendered: bytes) -> FrameDifference | None:
    """Return the difference of two frames; None if the stored one is no picture or has another size.

    Args:
        stored: The stored frame as JPEG.
        rendered: The rendered frame as JPEG.
    """
    if stored == rendered:
        return EQUAL
    one, other = (cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR) if data else None for data in (stored, rendered))
    if one is None or other is None or one.shape != other.shape:
        return None
    difference = cv2.absdiff(one, other).mean(axis=2).astype(np.float32)
    height, width = (side - side % BLOCK_PX for side in difference.shape)
    blocks = difference[:height, :width].reshape(height // BLOCK_PX, BLOCK_PX, width // BLOCK_PX, BLOCK_PX).mean(axis=(1, 3))
    return FrameDifference(
        float(difference.mean()), _ssim(_grey(one), _grey(other)), float(blocks.max(initial=float(difference.mean())))
    )


def _grey(image: NDArray[np.uint8]) -> NDArray[np.float32]:
    return np.asarray(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), np.float32)


def _ssim(one: NDArray[np.float32], other: NDArray[np.float32]) -> float:
    """Return the mean SSIM of two grey images, with the Gaussian window of Wang et al. (2004)."""

    def blur(image: NDArray[np.float32]) -> NDArray[np.float32]:
        return np.asarray(cv2.GaussianBlur(image, (11, 11), _SIGMA_PX), np.float32)

    mean_one, mean_other = blur(one), blur(other)
    variance_one, variance_other = blur(one * one) - mean_one**2, blur(other * other) - mean_other**2
    covariance = blur(one * other) - mean_one * mean_other
    top = (2 * mean_one * mean_other + _C1) * (2 * covariance + _C2)
    bottom = (mean_one**2 + mean_other**2 + _C1) * (variance_one + variance_other + _C2)
    return float((top / bottom).mean())
