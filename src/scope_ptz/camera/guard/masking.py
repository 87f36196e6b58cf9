"""Black out the keep-out regions and masks in a frame."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.camera.base import Frame
from scope_ptz.camera.guard.rules import PixelMask, Region
from scope_ptz.geometry import Projection, direction

_STEP_DEG = 0.5  # distance in degrees between the points of a region's outline
_GRID = 4
"""Size of a grid cell in pixels. Regions are drawn on this grid and enlarged by one cell, so that they are hidden completely."""


def mask_frame(frame: Frame, regions: tuple[Region, ...], masks: tuple[PixelMask, ...]) -> Frame:
    """Return the frame with the regions and masks blacked out, or the frame itself if it shows none of them."""
    hidden = hidden_pixels(frame.projection, regions, masks)
    if hidden is None:
        return frame
    image = frame.image.copy()
    image[hidden] = 0
    # Without an origin, the frame gives no access to the ground truth of the hidden parts.
    return replace(frame, image=image, origin=None)


def hidden_pixels(
    projection: Projection, regions: tuple[Region, ...], masks: tuple[PixelMask, ...] = ()
) -> NDArray[np.bool_] | None:
    """Return the mask (H, W) of the pixels in a region or under a pixel mask; None if there are none."""
    hidden = _region_pixels(projection, regions) if regions else None
    if not masks:
        return hidden
    combined = np.zeros((projection.height, projection.width), bool) if hidden is None else hidden
    for mask in masks:
        rows = slice(int(mask.top * projection.height), int(np.ceil(mask.bottom * projection.height)))
        columns = slice(int(mask.left * projection.width), int(np.ceil(mask.right * projection.width)))
        combined[rows, columns] = True
    return combined


def _region_pixels(projection: Projection, regions: tuple[Region, ...]) -> NDArray[np.bool_] | None:
    """Return the mask (H, W) of the pixels in a region; None if there are none."""
    width, height = projection.width, projection.height
    xs = np.append(np.arange(0, width, _GRID), width) / width
    ys = np.append(np.arange(0, height, _GRID), height) / height
    rays = projection.directions(np.stack(np.meshgrid(xs, ys), axis=-1))
    pan = np.degrees(np.arctan2(rays[..., 0], rays[..., 1]))
    tilt = np.degrees(np.arcsin(np.clip(rays[..., 2], -1.0, 1.0)))
    nodes = np.zeros(pan.shape, np.uint8)
    for region in regions:
        turn = (pan - region.pan_deg[0]) % 360.0
        inside = (tilt >= region.tilt_deg[0]) & (tilt <= region.tilt_deg[1]) & (turn <= region.width_deg)
        nodes |= inside.astype(np.uint8)
        _add_outline(nodes, projection, region)
    if not nodes.any():
        return None
    enlarged = cv2.dilate(nodes, np.ones((3, 3), np.uint8))
    large = np.repeat(np.repeat(enlarged, _GRID, axis=0), _GRID, axis=1)
    return np.asarray(large[:height, :width] > 0)


def _add_outline(nodes: NDArray[np.uint8], projection: Projection, region: Region) -> None:
    """Mark the grid cells under a region's outline, so that regions smaller than a cell are hidden too."""
    left, right = region.pan_deg[0], region.pan_deg[0] + region.width_deg
    bottom, top = region.tilt_deg
    pans = np.linspace(left, right, max(2, int((right - left) / _STEP_DEG) + 1))
    tilts = np.linspace(bottom, top, max(2, int((top - bottom) / _STEP_DEG) + 1))
    edges = [(pans, np.full_like(pans, bottom)), (pans, np.full_like(pans, top))]
    edges += [(np.full_like(tilts, left), tilts), (np.full_like(tilts, right), tilts)]
    for pan, tilt in edges:
        points = projection.points(direction(pan, tilt))
        points = points[~np.isnan(points).any(axis=-1)]
        points = points[((points >= 0) & (points <= 1)).all(axis=-1)]
        columns = np.minimum((points[:, 0] * projection.width / _GRID).astype(int), nodes.shape[1] - 1)
        rows = np.minimum((points[:, 1] * projection.height / _GRID).astype(int), nodes.shape[0] - 1)
        nodes[rows, columns] = 1
