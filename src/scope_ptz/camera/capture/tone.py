"""Gain compensation: find a gain per frame and colour channel that makes overlapping frames equally bright.

Automatic exposure and white balance vary from frame to frame. The gains are found by least squares over all overlaps, as in Brown
and Lowe, 2007.
"""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.camera.capture.placed_frames import PlacedFrame

CELL_PX = 24
"""Size in pixels of the cells whose mean colours are compared. Small pose errors hardly affect the means."""

DARK, BRIGHT = 12.0, 243.0
"""Usable range of pixel values, on a scale of 0 to 255. Values outside it may be clipped by the sensor."""

MIN_CELLS = 8  # minimum number of cells in an overlap
PRIOR_WEIGHT = 0.02  # weight of the prior for a gain of 1, relative to one overlap; it determines the overall brightness
MAX_GAIN = 2.0

Floats = NDArray[np.float64]


def cell_means(image: NDArray[np.uint8], hidden: NDArray[np.bool_] | None) -> NDArray[np.float32]:
    """Return the mean colours of a picture's cells (rows, columns, 3); NaN where a cell is hidden or may be clipped."""
    height, width = image.shape[:2]
    size = max(4, width // CELL_PX), max(4, height // CELL_PX)
    means = cv2.resize(image, size, interpolation=cv2.INTER_AREA).astype(np.float32)
    excluded = np.any((means < DARK) | (means > BRIGHT), axis=-1)
    if hidden is not None:
        excluded |= cv2.resize(hidden.astype(np.float32), size, interpolation=cv2.INTER_AREA) > 0
    means[excluded] = np.nan
    return np.asarray(means, np.float32)


def gains(frames: Sequence[PlacedFrame], cells: Sequence[NDArray[np.float32]], pairs: Sequence[tuple[int, int]]) -> Floats:
    """Return the gains (n, 3) that make frames equally bright where they overlap.

    Args:
        frames: The frames at their adjusted poses.
        cells: The cell means of each frame.
        pairs: The pairs of overlapping frames.
    """
    n = len(frames)
    normal, rhs = PRIOR_WEIGHT * np.eye(n), np.zeros((n, 3))
    for i, j in pairs:
        ratio = _log_ratio(frames[i], frames[j], cells[i], cells[j])
        if ratio is None:
            continue
        # gain_i * cell_i = gain_j * cell_j, so log gain_i - log gain_j = -ratio.
        normal[[i, j], [i, j]] += 1.0
        normal[[i, j], [j, i]] -= 1.0
        rhs[i] -= ratio
        rhs[j] += ratio
    return np.asarray(np.clip(np.exp(np.linalg.solve(normal, rhs)), 1 / MAX_GAIN, MAX_GAIN))


def _log_ratio(
    first: PlacedFrame, second: PlacedFrame, cells_1: NDArray[np.float32], cells_2: NDArray[np.float32]
) -> Floats | None:
    """Return the median log ratio (3,) between two frames' cells in the same directions; None if there are too few cells."""
    rows, columns = cells_1.shape[:2]
    points = np.stack(np.meshgrid((np.arange(columns) + 0.5) / columns, (np.arange(rows) + 0.5) / rows), axis=-1)
    points_2 = second.points(first.directions(points))
    inside = np.all((points_2 > 0.02) & (points_2 < 0.98), axis=-1)  # false for NaN
    if inside.sum() < MIN_CELLS:
        return None
    cell_px = (points_2[inside] * cells_2.shape[1::-1] - 0.5).astype(np.float32)
    values_2 = cv2.remap(cells_2, cell_px[:, None], None, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)[:, 0]
    with np.errstate(invalid="ignore"):
        ratios = np.log(cells_1[inside]) - np.log(values_2)
    usable = ratios[~np.isnan(ratios).any(axis=-1)]
    return np.asarray(np.median(usable, axis=0), np.float64) if len(usable) >= MIN_CELLS else None
