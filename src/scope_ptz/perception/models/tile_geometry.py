"""Split wide images into overlapping tiles. Models would scale a whole panorama down so far that small objects disappear."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

from scope_ptz.perception.base import Box, Point
from scope_ptz.perception.models.frame_memo import Image

MAX_WHOLE_ASPECT = 2.4
"""Images are split only if their ratio of width to height exceeds this; ordinary frames are 16:9."""

TILE_ASPECT = 1.6  # width / height of a tile
OVERLAP = 0.15
"""Fraction of a tile's width that the next tile also covers. A narrower object lies completely in at least one of the two tiles."""

SAME_BOX = 0.5
"""Minimum overlap at which boxes from neighbouring tiles count as the same object.

The overlap is the intersection over the area of the smaller box or, if the borders of their tiles cut both boxes, the shared height
over the height of the taller box.
"""

PANORAMA_SEAM = 0.002
"""A box within this fraction of the width from one end of a 360-degree panorama may continue at the other end."""

TILE_BORDER = 0.01
"""A box within this fraction of the tile's width from the border of its tile may continue beyond it."""


@dataclass(frozen=True, slots=True)
class PanoramaTile:
    """A full-height strip of an image: the pixel columns from ``left`` to ``right`` (exclusive)."""

    left: int
    right: int

    def crop(self, image: Image) -> Image:
        """Return the tile's part of an image."""
        return image[:, self.left : self.right]

    def box_to_image(self, box: Box, width: int) -> Box:
        """Convert a box in the tile to a box in the whole image, which is ``width`` pixels wide."""
        scale, start = (self.right - self.left) / width, self.left / width
        return box.model_copy(update={"x_min": start + box.x_min * scale, "x_max": min(1.0, start + box.x_max * scale)})

    def point_to_image(self, point: Point, width: int) -> Point:
        """Convert a point in the tile to a point in the whole image."""
        return point.model_copy(update={"x": min(1.0, (self.left + point.x * (self.right - self.left)) / width)})


def tiles(width: int, height: int) -> tuple[PanoramaTile, ...]:
    """Return overlapping tiles that cover an image. An image that is not wide has one tile."""
    if width <= MAX_WHOLE_ASPECT * height:
        return (PanoramaTile(0, width),)
    tile_width = TILE_ASPECT * height
    count = math.ceil((width - tile_width) / (tile_width * (1 - OVERLAP))) + 1
    step = (width - tile_width) / (count - 1)
    return tuple(PanoramaTile(round(i * step), min(width, round(i * step + tile_width))) for i in range(count))


def iou(a: Box, b: Box) -> float:
    """Return intersection over union."""
    shared = _intersection(a, b)
    union = a.width * a.height + b.width * b.height - shared
    return shared / union if union > 0 else 0.0


def non_maximum_suppression(boxes: Iterable[Box], threshold: float) -> list[Box]:
    """Return the boxes that non-maximum suppression keeps, best score first. ``threshold`` is the maximum IoU between two boxes."""
    result: list[Box] = []
    for box in sorted(boxes, key=lambda b: -(b.score or 0.0)):
        if all(iou(box, other) <= threshold for other in result):
            result.append(box)
    return result


@dataclass(frozen=True, slots=True)
class _TileBox:
    """A box in whole-image coordinates, its tile, and whether the tile's borders cut the box."""

    tile: PanoramaTile
    box: Box
    cut_left: bool
    cut_right: bool


def merge_boxes(parts: Iterable[tuple[PanoramaTile, Iterable[Box]]], width: int) -> list[Box]:
    """Merge the boxes from all tiles. The boxes of an object that appears in several tiles become one."""
    result: list[_TileBox] = []
    for tile, boxes in parts:
        for box in boxes:
            cut_left, cut_right = tile.left > 0 and box.x_min < TILE_BORDER, tile.right < width and box.x_max > 1 - TILE_BORDER
            tile_box = _TileBox(tile, tile.box_to_image(box, width), cut_left, cut_right)
            duplicate = next((i for i, other in enumerate(result) if other.tile != tile and _is_same(other, tile_box)), None)
            if duplicate is None:
                result.append(tile_box)
            else:
                result[duplicate] = _TileBox(
                    tile, _union_box(result[duplicate].box, tile_box.box), result[duplicate].cut_left, tile_box.cut_right
                )
    return [tile_box.box for tile_box in result]


def merge_points(parts: Iterable[tuple[PanoramaTile, Iterable[Point]]], width: int, max_dx: float) -> list[Point]:
    """Merge the points from all tiles. If points in different tiles mark the same object, only the first one is kept.

    Two points mark the same object if they differ by at most ``max_dx`` in x, a fraction of the width, and by at most
    ``5 * max_dx`` in y, a fraction of the height.
    """
    result: list[tuple[PanoramaTile, Point]] = []
    for tile, points in parts:
        for point in (tile.point_to_image(p, width) for p in points):
            points_in_other_tiles = (p for other, p in result if other != tile)
            if all(abs(p.x - point.x) > max_dx or abs(p.y - point.y) > 5 * max_dx for p in points_in_other_tiles):
                result.append((tile, point))
    return [point for _, point in result]


def remove_seam_duplicates(boxes: list[Box]) -> list[Box]:
    """Drop the narrower half of each object that appears at both ends of a 360-degree panorama."""
    duplicates = {
        (i, j)
        for i, left in enumerate(boxes)
        for j, right in enumerate(boxes)
        if i != j and left.x_min < PANORAMA_SEAM and right.x_max > 1 - PANORAMA_SEAM and _same_heights(left, right)
    }
    dropped = {i if boxes[i].width < boxes[j].width else j for i, j in duplicates}
    return [box for i, box in enumerate(boxes) if i not in dropped]


def _same_heights(a: Box, b: Box) -> bool:
    return min(a.y_max, b.y_max) - max(a.y_min, b.y_min) >= SAME_BOX * max(a.height, b.height)


def _intersection(a: Box, b: Box) -> float:
    width, height = min(a.x_max, b.x_max) - max(a.x_min, b.x_min), min(a.y_max, b.y_max) - max(a.y_min, b.y_min)
    return width * height if width > 0 and height > 0 else 0.0


def _is_same(left: _TileBox, right: _TileBox) -> bool:
    """Return whether ``right``, a box from a tile further to the right, continues or repeats ``left``."""
    a, b = left.box, right.box
    smaller = min(a.width * a.height, b.width * b.height)
    if smaller > 0 and _intersection(a, b) / smaller >= SAME_BOX:
        return True
    if not (left.cut_right and right.cut_left) or a.x_max < b.x_min:
        return False
    return _same_heights(a, b)


def _union_box(a: Box, b: Box) -> Box:
    better = a if (a.score or 0.0) >= (b.score or 0.0) else b
    corners = {
        "x_min": min(a.x_min, b.x_min),
        "y_min": min(a.y_min, b.y_min),
        "x_max": max(a.x_max, b.x_max),
        "y_max": max(a.y_max, b.y_max),
    }
    return better.model_copy(update=corners)
