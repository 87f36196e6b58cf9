"""Match the tone of frames: compute a gain for each frame and colour channel that makes overlapping frames equally bright.

Automatic exposure and white balance differ between frames. The gains solve all overlaps together, as in Brown and Lowe, 2007.
"""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.camera.capture.placed_frames import PlacedFrame

CELL_PX = 24
"""Size in pixels of the cells whose means are compared. Small pose errors hardly change the means."""

DARK, BRIGHT = 12.0, 243.0
"""Range of usable values, from 0 to 255. Values outside it may be clipped by the sensor."""

MIN_CELLS = 8  # minimum number of cells in an overlap
PRIOR = 0.02  # weight of a gain of 1, relative to one overlap; without it, the overall brightness would be undetermined
MAX_GAIN = 2.0

Floats = NDArray[np.float64]


def cells_of(image: NDArray[np.uint8], hidden: NDArray[np.bool_] | None) -> NDArray[np.float32]:
    """Return the means of a picture's cells (rows, columns, 3); NaN where a cell is hidden or clipped."""
    height, width = image.shape[:2]
    size = max(4, width // CELL_PX), max(4, height // CELL_PX)
    means = cv2.resize(image, size, interpolation=cv2.INTER_AREA).astype(np.float32)
    bad = np.any((means < DARK) | (means > BRIGHT), axis=-1)
    if hidden is not None:
        bad |= cv2.resize(hidden.astype(np.float32), size, interpolation=cv2.INTER_AREA) > 0
    means[bad] = np.nan
    return np.asarray(means, np.float32)


def gains(frames: Sequence[PlacedFrame], cells: Sequence[NDArray[np.float32]], pairs: Sequence[tuple[int, int]]) -> Floats:
    """Return (n, 3) gains that make frames equally bright where they overlap.

    Args:
        frames: The frames at their adjusted poses.
        cells: The means of each frame's cells.
        pairs: The pairs of overlapping frames.
    """
    n = len(frames)
    normal, right = PRIOR * np.eye(n), np.zeros((n, 3))
    for i, j in pairs:
        ratio = _log_ratio(frames[i], frames[j], cells[i], cells[j])
        if ratio is None:
            continue
        # gain_i * cell_i = gain_j * cell_j, so log gain_i - log gain_j = -ratio.
        normal[[i, j], [i, j]] += 1.0
        normal[[i, j], [j, i]] -= 1.0
        right[i] -= ratio
        right[j] += ratio
    return np.asarray(np.clip(np.exp(np.linalg.solve(normal, right)), 1 / MAX_GAIN, MAX_GAIN))


def _log_ratio(one: PlacedFrame, two: PlacedFrame, cells_1: NDArray[np.float32], cells_2: NDArray[np.float32]) -> Floats | None:
    """Return the median log ratio (3,) of the first frame's cells to the second's in the same directions; None if too few."""
    rows, columns = cells_1.shape[:2]
    points = np.stack(np.meshgrid((np.arange(columns) + 0.5) / columns, (np.arange(rows) + 0.5) / rows), axis=-1)
    there = two.points(one.directions(points))
    inside = np.all((there > 0.02) & (there < 0.98), axis=-1)  # false for NaN
    if inside.sum() < MIN_CELLS:
        return None
    spots = (there[inside] * cells_2.shape[1::-1] - 0.5).astype(np.float32)
    seen = cv2.remap(cells_2, spots[:, None], None, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)[:, 0]
    with np.errstate(invalid="ignore"):
        ratios = np.log(cells_1[inside]) - np.log(seen)
    good = ratios[~np.isnan(ratios).any(axis=-1)]
    return np.asarray(np.median(good, axis=0), np.float64) if len(good) >= MIN_CELLS else None
