"""Create sprite sheets for actors."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from scope_ptz.blender.keyframes import Keyframe
from scope_ptz.blender.quality import DEPTH_STEP, FAR_M, NEAR_M
from scope_ptz.simulator.layers import encode_depth, read_colour
from scope_ptz.simulator.models import Sprite

MAX_SHEET_WIDTH = 4096
SHADOW_GAMMA = 0.5
"""Gamma applied to shadows, because they are rendered in linear light but drawn over display values."""

MIN_SHADOW_OPACITY = 0.04
"""Minimum opacity of a shadow. Fainter shadows are removed.

Without this limit, the faint shade around a body would extend to the border of its picture.
"""

FEATHER_SHARE = 0.06
"""Fraction of a sprite's size over which the shadow fades towards the border of its picture."""


@dataclass(frozen=True, slots=True)
class Sheet:
    """A sprite sheet: a picture ``(H, W, 4)`` with straight alpha, distance codes ``(H, W)``, and each sprite's position."""

    colour: NDArray[np.uint8]
    depth: NDArray[np.uint16]
    sprites: list[Sprite]


def make_sheet(frames: list[Keyframe], folder: Path) -> Sheet:
    """Create a sheet from the pictures that the worker wrote to ``folder``."""
    pictures, depths = [], []
    for k in range(len(frames)):
        with np.load(folder / f"{k:03d}.npz") as file:
            metres = file["depth"]
        picture = read_colour(folder / f"{k:03d}.png")
        pictures.append(_display_shadow(picture, metres > 0))
        depths.append(encode_depth(metres, NEAR_M, FAR_M, 2 * DEPTH_STEP))
    places, (width, height) = _lay_out([(f.view.width, f.view.height) for f in frames])
    colour = np.zeros((height, width, 4), dtype=np.uint8)
    depth = np.zeros((height, width), dtype=np.uint16)
    sprites = []
    for frame, picture, codes, (left, top) in zip(frames, pictures, depths, places, strict=True):
        rows, columns = slice(top, top + frame.view.height), slice(left, left + frame.view.width)
        colour[rows, columns], depth[rows, columns] = picture, codes
        sprites += [
            Sprite(
                path_s=time_s,
                phase=frame.phase,
                position_m=frame.position_m,
                pan_deg=frame.view.pan_deg,
                tilt_deg=frame.view.tilt_deg,
                hfov_deg=frame.view.hfov_deg,
                left=left,
                top=top,
                width=frame.view.width,
                height=frame.view.height,
            )
            for time_s in sorted({frame.time_s, *frame.extra_times_s})
        ]
    return Sheet(colour, depth, sorted(sprites, key=lambda s: (s.path_s, s.phase)))


def _display_shadow(picture: NDArray[np.uint8], body: NDArray[np.bool_]) -> NDArray[np.uint8]:
    alpha = picture[..., 3].astype(np.float32) / 255
    darkness = 1 - picture[..., :3].max(axis=2).astype(np.float32) / 255
    shadow = np.where(body, 0.0, darkness)
    shadow_alpha = np.maximum(1 - (1 - alpha) ** SHADOW_GAMMA - MIN_SHADOW_OPACITY, 0) / (1 - MIN_SHADOW_OPACITY)
    shadow_alpha = shadow_alpha * _feather(body.shape)
    result = picture.copy()
    result[..., 3] = np.rint(255 * (shadow * shadow_alpha + (1 - shadow) * alpha)).astype(np.uint8)
    result[result[..., 3] < 3] = 0
    return result


def _feather(shape: tuple[int, ...]) -> NDArray[np.float32]:
    """Return weights of shape ``(H, W)`` that rise from 0 at the border to 1 inside."""
    rows, columns = (np.minimum(np.arange(n) + 0.5, n - np.arange(n) - 0.5) / (FEATHER_SHARE * n) for n in shape)
    return np.asarray(np.clip(np.minimum(rows[:, None], columns[None, :]), 0, 1), dtype=np.float32)


def _lay_out(sizes: list[tuple[int, int]]) -> tuple[list[tuple[int, int]], tuple[int, int]]:
    """Arrange rectangles in rows, in the given order. Return each rectangle's left and top, and the sheet's size."""
    places: list[tuple[int, int]] = []
    x = y = row_height = right = 0
    for width, height in sizes:
        if x + width > MAX_SHEET_WIDTH:
            x, y, row_height = 0, y + row_height, 0
        places.append((x, y))
        x, row_height, right = x + width, max(row_height, height), max(right, x + width)
    return places, (right, y + row_height)
