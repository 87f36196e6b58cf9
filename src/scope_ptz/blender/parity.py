"""Measure the similarity between two pictures of the same view, and between their instance boxes."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

WINDOW_PX = 7
K1, K2 = 0.01, 0.03  # SSIM constants

Picture = NDArray[np.uint8]
Mask = NDArray[np.bool_]


def ssim(a: Picture, b: Picture, mask: Mask | None = None) -> float:
    """Return the mean structural similarity between the greyscale versions of two ``(H, W, 3)`` RGB pictures.

    If ``mask`` is given, only its pixels count.

    The method is that of Wang et al., "Image quality assessment: from error visibility to structural similarity", 2004, with a
    uniform 7x7 window and sample covariance. The border, where the window does not fit, is excluded.
    """
    x, y = _to_grey(a), _to_grey(b)
    size = (WINDOW_PX, WINDOW_PX)
    unbiased = WINDOW_PX**2 / (WINDOW_PX**2 - 1)
    mx, my = cv2.blur(x, size), cv2.blur(y, size)
    vx = unbiased * (cv2.blur(x * x, size) - mx * mx)
    vy = unbiased * (cv2.blur(y * y, size) - my * my)
    cov = unbiased * (cv2.blur(x * y, size) - mx * my)
    c1, c2 = (K1 * 255) ** 2, (K2 * 255) ** 2
    index = (2 * mx * my + c1) * (2 * cov + c2) / ((mx * mx + my * my + c1) * (vx + vy + c2))
    return float(_inner_values(np.asarray(index), mask).mean())


def sharpness(picture: Picture, mask: Mask | None = None) -> float:
    """Return the variance of the Laplacian of the greyscale picture. If ``mask`` is given, only its pixels count."""
    return float(_inner_values(np.asarray(cv2.Laplacian(_to_grey(picture), cv2.CV_64F)), mask).var())


def _inner_values(values: NDArray[np.float64], mask: Mask | None) -> NDArray[np.float64]:
    """Return the values inside the mask that are more than half a window from the border."""
    border = WINDOW_PX // 2
    inner = (slice(border, -border), slice(border, -border))
    return values[inner] if mask is None else values[inner][mask[inner]]


def box_ious(a: NDArray[np.uint16], b: NDArray[np.uint16], min_pixels: int) -> dict[int, float]:
    """Return the box IoU by instance ID, for instances with more than ``min_pixels`` pixels in the reference ``b``."""
    numbers, counts = np.unique(b[b > 0], return_counts=True)
    return {int(n): _iou(_box(a == n), _box(b == n)) for n, count in zip(numbers, counts, strict=True) if count > min_pixels}


def _box(mask: Mask) -> tuple[int, int, int, int] | None:
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    if not len(rows):
        return None
    return int(columns[0]), int(rows[0]), int(columns[-1]) + 1, int(rows[-1]) + 1


def _iou(a: tuple[int, int, int, int] | None, b: tuple[int, int, int, int] | None) -> float:
    if a is None or b is None:
        return 0.0
    overlap_width, overlap_height = min(a[2], b[2]) - max(a[0], b[0]), min(a[3], b[3]) - max(a[1], b[1])
    intersection = max(overlap_width, 0) * max(overlap_height, 0)
    return intersection / ((a[2] - a[0]) * (a[3] - a[1]) + (b[2] - b[0]) * (b[3] - b[1]) - intersection)


def _to_grey(picture: Picture) -> NDArray[np.float64]:
    return np.asarray(cv2.cvtColor(picture, cv2.COLOR_RGB2GRAY), dtype=np.float64)
