"""The hidden parts of a captured frame: keep-out regions, masks, and black corners."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.camera.capture.session import CaptureSettings, Shot
from scope_ptz.camera.guard.masking import hidden_pixels
from scope_ptz.camera.guard.rules import Region
from scope_ptz.geometry import Perspective, Projection

MARGIN_DEG = 0.3
"""Margin in degrees added to keep-out regions in the pack, because reported poses are inexact."""

DILATION_PX = 5
"""Margin in pixels added to the hidden parts of frames, so that their blurred borders are not used."""

Mask = NDArray[np.bool_]


def hidden_mask(settings: CaptureSettings, shot: Shot, image: NDArray[np.uint8]) -> Mask | None:
    """Return the mask (H, W) of the hidden pixels of a frame; None if no pixel is hidden."""
    view = Perspective(shot.pan_deg, shot.tilt_deg, shot.hfov_deg, settings.frame_width, settings.frame_height)
    hidden = hidden_pixels(view, settings.keep_out, settings.masks)
    if settings.rolled:
        corners = _black_corners(image)
        hidden = corners if hidden is None else hidden | corners
    if hidden is None or not hidden.any():
        return None
    size = 2 * DILATION_PX + 1
    return np.asarray(cv2.dilate(hidden.astype(np.uint8), np.ones((size, size), np.uint8)) > 0)


def keep_out_mask(settings: CaptureSettings, projection: Projection) -> Mask | None:
    """Return the mask (H, W) of the pixels in or near a keep-out region in a pack's picture; None if there are none."""
    return hidden_pixels(projection, tuple(_enlarge(region) for region in settings.keep_out))


def _enlarge(region: Region) -> Region:
    """Return the region enlarged by ``MARGIN_DEG`` on every side."""
    (left, right), (bottom, top) = region.pan_deg, region.tilt_deg
    if region.width_deg < 360.0 - 2 * MARGIN_DEG:
        left, right = (left - MARGIN_DEG + 180.0) % 360.0 - 180.0, (right + MARGIN_DEG + 180.0) % 360.0 - 180.0
    else:
        left, right = -180.0, 180.0
    tilts = max(bottom - MARGIN_DEG, -90.0), min(top + MARGIN_DEG, 90.0)
    return Region(name=region.name, pan_deg=(left, right), tilt_deg=tilts)


def _black_corners(image: NDArray[np.uint8]) -> Mask:
    """Return the mask of the black corners that remain after a frame has been turned upright."""
    height, width = image.shape[:2]
    black = np.zeros((height + 2, width + 2), np.uint8)
    dark = (image.max(axis=2) <= 2).astype(np.uint8)
    for corner in ((0, 0), (width - 1, 0), (0, height - 1), (width - 1, height - 1)):
        if dark[corner[1], corner[0]] == 1 and not black[corner[1] + 1, corner[0] + 1]:
            cv2.floodFill(dark, black, corner, 1, flags=4 | cv2.FLOODFILL_MASK_ONLY | (255 << 8))
    return np.asarray(black[1:-1, 1:-1] > 0)
