"""Maps from a view to the panorama on an atlas's sheet."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import Equirectangular, Perspective, wrap_pan_deg
from scope_ptz.simulator.mapping.grid import Floats, Grid
from scope_ptz.simulator.mapping.tiles import Place
from scope_ptz.simulator.models import Band
from scope_ptz.simulator.sheets.layout import Slot


def panorama_map(band: Band, slot: Slot, grid: Grid, part: Place | None = None) -> NDArray[np.float32]:
    """Return each view pixel's position (x, y) on the sheet, as (H, W, 2).

    Args:
        band: The band of the sphere that the panorama covers.
        slot: The panorama's slot on the sheet.
        grid: The grid over the view.
        part: The rows and columns that are needed; the default is all that the grid covers.
    """
    centre_pan_deg, turn, tilt = _turn_and_tilt_deg(grid)
    x = slot.x - 0.5 + (wrap_pan_deg(centre_pan_deg) + 180.0 + turn) / 360.0 * slot.width
    y = slot.y - 0.5 + (band.top_tilt_deg - tilt) / (band.top_tilt_deg - band.bottom_tilt_deg) * slot.height
    where = grid.to_pixels(np.stack([x, np.clip(y, slot.y - 0.5, slot.y + slot.height - 0.5)], axis=-1), part)
    skipped = (part or grid.place)[1].start - grid.place[1].start
    left, right = slot.x - 0.5, slot.x + slot.width - 0.5
    for beyond, turn_px in ((x < left, slot.width), (x > right, -slot.width)):
        columns = np.flatnonzero(beyond.any(axis=0))
        if columns.size:
            # Only columns between the nodes before and after the seam can be beyond it. They are shifted by the panorama's width.
            first, last = (columns[0] - 2) * grid.step - skipped, (columns[-1] + 1) * grid.step - skipped
            seam = where[:, max(0, first) : max(0, last), 0]
            seam += np.float32(turn_px) * (seam < left if turn_px > 0 else seam > right)
    return where


def _turn_and_tilt_deg(grid: Grid) -> tuple[float, Floats, Floats]:
    """Return the pan of the image's centre and, for each node, its pan relative to the centre and its tilt, in degrees."""
    projection = grid.projection
    if isinstance(projection, Equirectangular):
        tilt_span_deg = projection.bottom_tilt_deg - projection.top_tilt_deg
        turn, tilt = np.meshgrid(
            (grid.x / projection.width - 0.5) * projection.pan_span_deg,
            projection.top_tilt_deg + grid.y / projection.height * tilt_span_deg,
        )
        return projection.left_pan_deg + projection.pan_span_deg / 2, turn, tilt
    if isinstance(projection, Perspective):
        # A ray is (right, up, focal length) in the view. Tilting rotates it in the plane of the last two components.
        sine, cosine = math.sin(math.radians(projection.tilt_deg)), math.cos(math.radians(projection.tilt_deg))
        right, up = grid.x - projection.width / 2, (projection.height / 2 - grid.y)[:, None]
        ahead, rise = projection.focal_px * cosine - up * sine, projection.focal_px * sine + up * cosine
        level = np.sqrt(right**2 + ahead**2)
        return projection.pan_deg, np.degrees(np.arctan2(right, ahead)), np.degrees(np.arctan2(rise, level))
    raise TypeError(f"maps of {type(projection).__name__} are not supported")
