"""Distances of the static world in a view, with edges as sharp as those of the instance numbers. They determine occlusion."""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import Projection
from scope_ptz.simulator.mapping.tiles import Place
from scope_ptz.simulator.reproject import id_view, view_map
from scope_ptz.simulator.viewpoint import Viewpoint

SEARCH_RADII_TEXELS = (1.0, 2.0)
"""Radii around a pixel, in texels of the depth layer, at which a distance measured on the correct instance is searched for."""

_NEIGHBOURS = ((0, 1), (0, -1), (1, 0), (-1, 0), (1, 1), (-1, 1), (1, -1), (-1, -1))
"""The eight neighbouring pixels, in the order in which they are tried."""


def outlined_depth_view(
    viewpoint: Viewpoint, projection: Projection, numbers: NDArray[np.uint16], part: Place | None = None
) -> NDArray[np.float32]:
    """Return the distances of ``depth_view`` with edges as sharp as in ``numbers``, the view's (H, W) instance numbers.

    If the distance of a pixel was measured on a different instance, it is replaced with the distance of a nearby pixel that was
    measured on the correct instance.

    Args:
        viewpoint: The viewpoint.
        projection: The view.
        numbers: The view's instance numbers.
        part: The rows and columns that are needed; the default is the whole view.
    """
    whole = (slice(0, projection.height), slice(0, projection.width))
    around, inner = _with_margin(viewpoint, projection, part or whole)
    return _sharpened_depth(viewpoint, projection, around, numbers[around], None)[inner]


def outlined_depth_part(
    viewpoint: Viewpoint, projection: Projection, part: Place, needed: NDArray[np.uint8]
) -> NDArray[np.float32]:
    """Return the distances of ``outlined_depth_view`` for a part of a view. Only pixels in and near the part are read.

    Args:
        viewpoint: The viewpoint.
        projection: The view.
        part: The rows and columns that are needed.
        needed: (rows, columns) mask of the part. Edges are sharpened only where it is not 0.
    """
    around, inner = _with_margin(viewpoint, projection, part)
    mask = np.zeros([a.stop - a.start for a in around], bool)
    mask[inner] = needed
    return _sharpened_depth(viewpoint, projection, around, id_view(viewpoint, projection, around), mask)[inner]


def _with_margin(viewpoint: Viewpoint, projection: Projection, part: Place) -> tuple[Place, Place]:
    """Return a part of a view enlarged by the margin that edge sharpening reads, and the position of the part inside it."""
    margin = math.ceil(max(SEARCH_RADII_TEXELS) * _texel_px(viewpoint, projection)) + 1
    rows, columns = (
        slice(max(0, span.start - margin), min(size, span.stop + margin))
        for span, size in zip(part, (projection.height, projection.width), strict=True)
    )
    inner_rows, inner_columns = (slice(p.start - a.start, p.stop - a.start) for p, a in zip(part, (rows, columns), strict=True))
    return (rows, columns), (inner_rows, inner_columns)


def _sharpened_depth(
    viewpoint: Viewpoint, projection: Projection, part: Place, numbers: NDArray[np.uint16], needed: NDArray[np.bool_] | None
) -> NDArray[np.float32]:
    where = view_map(viewpoint, viewpoint.depth_atlas, projection, part)
    # Both layers are read at the same positions, which are rounded to whole pixels once.
    where, _ = cv2.convertMaps(where, None, cv2.CV_16SC2, nninterpolation=True)
    metres: NDArray[np.float32] = np.take(
        viewpoint.depth_metres, cv2.remap(viewpoint.depth_atlas.sheet, where, None, cv2.INTER_NEAREST)
    )
    viewpoint.owner_atlas.ensure(0)
    owners = viewpoint.owner_atlas.sample(where)
    same = owners == numbers
    wrong = ~same if needed is None else needed & ~same
    pixels = np.flatnonzero(wrong)
    if not len(pixels):
        return metres
    # Flat indices, because NumPy reads and writes them faster than pairs.
    height, width = metres.shape
    texel_px = _texel_px(viewpoint, projection)
    refined, found, owner = metres.copy().ravel(), same.ravel(), owners.ravel()
    expected, sources = numbers[wrong], metres.ravel()
    ys, xs = np.divmod(pixels, width)
    for reach in SEARCH_RADII_TEXELS:
        for dx, dy in _NEIGHBOURS:
            y = np.minimum(np.maximum(ys + round(dy * reach * texel_px), 0), height - 1)
            x = np.minimum(np.maximum(xs + round(dx * reach * texel_px), 0), width - 1)
            near = y * width + x
            matches = found[near] & (owner[near] == expected)
            refined[pixels[matches]] = sources[near[matches]]
            others = np.flatnonzero(~matches)
            if not len(others):
                return refined.reshape(height, width)
            pixels, ys, xs, expected = pixels[others], ys[others], xs[others], expected[others]
    return refined.reshape(height, width)


def _texel_px(viewpoint: Viewpoint, projection: Projection) -> float:
    """Return the size of a texel of the depth layer in pixels of a view, at least 1."""
    return max(1.0, projection.pixels_per_radian / (viewpoint.manifest.depth.width / (2 * math.pi)))
