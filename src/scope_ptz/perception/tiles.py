"""Wide pictures in parts: models and detectors shrink a panorama until nothing small is left of it."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

from scope_ptz.perception.base import Box
from scope_ptz.perception.memo import Image

WIDEST = 2.4
"""Width over height up to which a picture is looked at whole; ordinary frames are 16:9."""

TILE_ASPECT = 1.6
OVERLAP = 0.15
"""Share of a tile that its neighbour sees too, so that nothing narrower is cut in both."""

SAME_BOX = 0.5
"""Overlap (intersection over the smaller box) from which boxes of two neighbouring tiles are one thing."""


@dataclass(frozen=True, slots=True)
class Tile:
    """A part of a picture over its full height, in pixels."""

    left: int
    right: int

    def crop(self, image: Image) -> Image:
        return image[:, self.left : self.right]

    def place(self, box: Box, width: int) -> Box:
        """A box of the tile as a box of the whole picture of ``width`` pixels."""
        share, start = (self.right - self.left) / width, self.left / width
        return box.model_copy(update={"x_min": start + box.x_min * share, "x_max": min(1.0, start + box.x_max * share)})


def tiles(width: int, height: int) -> tuple[Tile, ...]:
    """Overlapping tiles that cover a picture; one when it is no wider than ordinary frames."""
    if width <= WIDEST * height:
        return (Tile(0, width),)
    wide = TILE_ASPECT * height
    count = math.ceil((width - wide) / (wide * (1 - OVERLAP))) + 1
    step = (width - wide) / (count - 1)
    return tuple(Tile(round(i * step), min(width, round(i * step + wide))) for i in range(count))


def iou(a: Box, b: Box) -> float:
    """Intersection over union."""
    shared = _shared(a, b)
    union = a.width * a.height + b.width * b.height - shared
    return shared / union if union > 0 else 0.0


def suppressed(boxes: Iterable[Box], threshold: float) -> list[Box]:
    """Boxes best first, without those that overlap a better one by more than ``threshold`` (intersection over union)."""
    kept: list[Box] = []
    for box in sorted(boxes, key=lambda b: -(b.score or 0.0)):
        if all(iou(box, other) <= threshold for other in kept):
            kept.append(box)
    return kept


def merged(parts: Iterable[tuple[Tile, Iterable[Box]]], width: int) -> list[Box]:
    """Boxes of all tiles in the whole picture; what two neighbours saw once each is one box around both."""
    kept: list[tuple[Tile, Box]] = []
    for tile, boxes in parts:
        for box in (tile.place(b, width) for b in boxes):
            twin = next((i for i, (other, b) in enumerate(kept) if other != tile and _is_same(b, box)), None)
            if twin is None:
                kept.append((tile, box))
            else:
                kept[twin] = (kept[twin][0], _around(kept[twin][1], box))
    return [box for _, box in kept]


def _shared(a: Box, b: Box) -> float:
    wide, high = min(a.x_max, b.x_max) - max(a.x_min, b.x_min), min(a.y_max, b.y_max) - max(a.y_min, b.y_min)
    return wide * high if wide > 0 and high > 0 else 0.0


def _is_same(a: Box, b: Box) -> bool:
    smaller = min(a.width * a.height, b.width * b.height)
    return smaller > 0 and _shared(a, b) / smaller >= SAME_BOX


def _around(a: Box, b: Box) -> Box:
    better = a if (a.score or 0.0) >= (b.score or 0.0) else b
    corners = {
        "x_min": min(a.x_min, b.x_min),
        "y_min": min(a.y_min, b.y_min),
        "x_max": max(a.x_max, b.x_max),
        "y_max": max(a.y_max, b.y_max),
    }
    return better.model_copy(update=corners)
