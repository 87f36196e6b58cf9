"""Distances to the static world in a view, sharpened along the outlines of instances. They determine occlusion."""

from __future__ import annotations

import math
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import Projection
from scope_ptz.simulator.mapping.tiles import Place
from scope_ptz.simulator.reproject import view_map
from scope_ptz.simulator.viewpoint import Viewpoint

SEARCH_RADII_TEXELS = (1.0, 2.0)
"""Radii around a pixel, in texels of the depth layer, at which to search for a distance measured on the correct instance."""

_NEIGHBOURS = ((0, 1), (0, -1), (1, 0), (-1, 0), (1, 1), (-1, 1), (1, -1), (-1, -1))
"""The eight neighbouring pixels, in the order in which they are tried."""

Ids = NDArray[np.uint8] | NDArray[np.uint16]
Positions = NDArray[Any]


def outlined_depth_view(
    viewpoint: Viewpoint, projection: Projection, ids: NDArray[np.uint16], part: Place | None = None
) -> NDArray[np.float32]:
    """Return the distances from ``depth_view``, with edges moved to the outlines of the instances.

    If a pixel's distance was measured on a different instance, it is replaced with the distance of a nearby pixel that was measured
    on the correct instance.

    Args:
        viewpoint: The viewpoint.
        projection: The view.
        ids: The view's (H, W) instance IDs.
        part: The rows and columns that are needed; the default is the whole view.
    """
    whole = (slice(0, projection.height), slice(0, projection.width))
    around, inner = _add_margin(viewpoint, projection, part or whole)
    where, metres = _stored_depth(viewpoint, projection, around)
    return _sharpen_edges(metres, viewpoint.owner_atlas.sample(where), ids[around], None, _texel_px(viewpoint, projection))[inner]


def outlined_depth_part(
    viewpoint: Viewpoint, projection: Projection, part: Place, needed: NDArray[np.uint8], stride: int = 1
) -> NDArray[np.float32]:
    """Return the distances from ``outlined_depth_view`` for a part of a view. Only pixels in and near the part are read.

    Args:
        viewpoint: The viewpoint.
        projection: The view.
        part: The rows and columns that are needed.
        needed: (rows, columns) mask of the part. Edges are sharpened only where it is not 0.
        stride: Return only every ``stride``-th row and column of the part. Edges are then accurate to this many pixels.
    """
    around, inner = _add_margin(viewpoint, projection, part, stride)
    every = slice(None, None, stride)
    where, metres = _stored_depth(viewpoint, projection, around, stride)
    id_atlas = viewpoint.id_atlas
    # Reading codes is faster than reading IDs. Only small instances share a code.
    codes = id_atlas.sample_codes(view_map(viewpoint, id_atlas, projection, around)[every, every])
    mask = np.zeros(metres.shape, bool)
    mask[inner] = needed[every, every]
    texel_px = _texel_px(viewpoint, projection) / stride
    return _sharpen_edges(metres, viewpoint.owner_atlas.sample_codes(where), codes, mask, texel_px)[inner]


def sharpening_reach_px(viewpoint: Viewpoint, projection: Projection) -> int:
    """Return the radius around a pixel of a view in which edge sharpening reads distances."""
    return math.ceil(max(SEARCH_RADII_TEXELS) * _texel_px(viewpoint, projection)) + 1


def _add_margin(viewpoint: Viewpoint, projection: Projection, part: Place, stride: int = 1) -> tuple[Place, Place]:
    """Return a part of a view enlarged by the margin that edge sharpening reads, and the position of the part inside it.

    The position counts only every ``stride``-th row and column.
    """
    steps = -(-sharpening_reach_px(viewpoint, projection) // stride)
    before = [min(steps, span.start // stride) for span in part]
    rows, columns = (
        slice(span.start - stride * skipped, min(size, span.stop + stride * steps))
        for span, skipped, size in zip(part, before, (projection.height, projection.width), strict=True)
    )
    inner_rows, inner_columns = (
        slice(skipped, skipped - (span.start - span.stop) // stride) for span, skipped in zip(part, before, strict=True)
    )
    return (rows, columns), (inner_rows, inner_columns)


def _stored_depth(
    viewpoint: Viewpoint, projection: Projection, part: Place, stride: int = 1
) -> tuple[Positions, NDArray[np.float32]]:
    """Return positions on the depth layer's sheet, rounded to whole pixels, and the distances there."""
    where = view_map(viewpoint, viewpoint.depth_atlas, projection, part)[::stride, ::stride]
    # The owners of the distances are read at the same positions, so positions are rounded only once.
    where, _ = cv2.convertMaps(where, None, cv2.CV_16SC2, nninterpolation=True)
    viewpoint.owner_atlas.ensure(0)
    return where, np.take(viewpoint.depth_metres, cv2.remap(viewpoint.depth_atlas.sheet, where, None, cv2.INTER_NEAREST))


def _sharpen_edges(
    metres: NDArray[np.float32], owners: Ids, ids: Ids, needed: NDArray[np.bool_] | None, texel_px: float
) -> NDArray[np.float32]:
    """Return distances with edges moved to the outlines in ``ids``. All arrays have the same shape.

    Args:
        metres: Distances.
        owners: The IDs (or their codes) of the instances on which the distances were measured.
        ids: The IDs (or their codes) of the instances that the pixels show.
        needed: Mask of the pixels to correct; by default, all pixels.
        texel_px: Size of a depth-layer texel in pixels.
    """
    same = owners == ids
    wrong = ~same if needed is None else needed & ~same
    pixels = np.flatnonzero(wrong)
    if not len(pixels):
        return metres
    # Flat indices, because NumPy reads and writes them faster than pairs.
    height, width = metres.shape
    refined, found, owner = metres.copy().ravel(), same.ravel(), owners.ravel()
    expected, sources = ids[wrong], metres.ravel()
    ys, xs = np.divmod(pixels, width)
    for reach in SEARCH_RADII_TEXELS:
        near = np.empty((len(_NEIGHBOURS), len(pixels)), pixels.dtype)
        for k, (dx, dy) in enumerate(_NEIGHBOURS):
            y = np.minimum(np.maximum(ys + round(dy * reach * texel_px), 0), height - 1)
            x = np.minimum(np.maximum(xs + round(dx * reach * texel_px), 0), width - 1)
            np.add(y * width, x, out=near[k])
        matches = found[near] & (owner[near] == expected)
        first = matches.argmax(axis=0)
        columns = np.arange(len(pixels))
        any_match = matches[first, columns]
        refined[pixels[any_match]] = sources[near[first, columns][any_match]]
        others = np.flatnonzero(~any_match)
        if not len(others):
            break
        pixels, ys, xs, expected = pixels[others], ys[others], xs[others], expected[others]
    return refined.reshape(height, width)


def _texel_px(viewpoint: Viewpoint, projection: Projection) -> float:
    """Return the size of a depth-layer texel in view pixels, at least 1."""
    return max(1.0, projection.pixels_per_radian / (viewpoint.manifest.depth.width / (2 * math.pi)))
