"""Black out the masked parts of a frame."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.camera.base import Frame
from scope_ptz.camera.guard.rules import PixelMask, Region
from scope_ptz.geometry import Projection, direction

_STEP_DEG = 0.5  # distance between the points of a region's outline
_GRID = 4
"""Regions are drawn on a grid of every fourth pixel and enlarged by one cell, so that no pixel of a region stays visible."""


def mask_frame(frame: Frame, regions: tuple[Region, ...], masks: tuple[PixelMask, ...]) -> Frame:
    """Return a frame in which the regions and masks are black. A frame that shows none of them is returned unchanged."""
    hidden = hidden_pixels(frame.projection, regions, masks)
    if hidden is None:
        return frame
    image = frame.image.copy()
    image[hidden] = 0
    # The ground truth of hidden parts must be hidden too.
    return replace(frame, image=image, origin=None)


def hidden_pixels(
    projection: Projection, regions: tuple[Region, ...], masks: tuple[PixelMask, ...] = ()
) -> NDArray[np.bool_] | None:
    """Return the mask (H, W) of the pixels that show a region or lie under a pixel mask; None if no pixel does."""
    hidden = _in_regions(projection, regions) if regions else None
    if not masks:
        return hidden
    found = np.zeros((projection.height, projection.width), bool) if hidden is None else hidden
    for mask in masks:
        rows = slice(int(mask.top * projection.height), int(np.ceil(mask.bottom * projection.height)))
        columns = slice(int(mask.left * projection.width), int(np.ceil(mask.right * projection.width)))
        found[rows, columns] = True
    return found


def _in_regions(projection: Projection, regions: tuple[Region, ...]) -> NDArray[np.bool_] | None:
    """Return the mask (H, W) of the pixels that show a region; None if no pixel does."""
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
    grown = cv2.dilate(nodes, np.ones((3, 3), np.uint8))
    large = np.repeat(np.repeat(grown, _GRID, axis=0), _GRID, axis=1)
    return np.asarray(large[:height, :width] > 0)


def _add_outline(nodes: NDArray[np.uint8], projection: Projection, region: Region) -> None:
    """Mark the grid cells under a region's outline, so that a region smaller than a cell is hidden too."""
    left, right = region.pan_deg[0], region.pan_deg[0] + region.width_deg
    bottom, top = region.tilt_deg
    along = np.linspace(left, right, max(2, int((right - left) / _STEP_DEG) + 1))
    up = np.linspace(bottom, top, max(2, int((top - bottom) / _STEP_DEG) + 1))
    edges = [(along, np.full_like(along, bottom)), (along, np.full_like(along, top))]
    edges += [(np.full_like(up, left), up), (np.full_like(up, right), up)]
    for pan, tilt in edges:
        points = projection.points(direction(pan, tilt))
        points = points[~np.isnan(points).any(axis=-1)]
        points = points[((points >= 0) & (points <= 1)).all(axis=-1)]
        columns = np.minimum((points[:, 0] * projection.width / _GRID).astype(int), nodes.shape[1] - 1)
        rows = np.minimum((points[:, 1] * projection.height / _GRID).astype(int), nodes.shape[0] - 1)
        nodes[rows, columns] = 1
