"""Lay out an atlas's pictures on its sheet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from scope_ptz.errors import PackError

MAX_SIDE_PX = 32766
"""Maximum side of a sheet in pixels. OpenCV's remap addresses its source with 16-bit integers."""

BORDER_PX = 2
"""Border around every slot in pixels: one pixel for the bilinear neighbour and one for rounding."""

HEIGHT_CLASS_PX = 8
"""Height step in pixels. Before tiles are sorted by direction, their heights are rounded up to a multiple of this.

Tiles with the same rounded height and scale can then lie next to their neighbours in the scene.
"""

Size = tuple[int, int]
"""Width and height in pixels."""


@dataclass(frozen=True, slots=True)
class Slot:
    """The slot for one picture at one scale: its first pixel on the sheet (without the border), its size, and its shelf."""

    x: int
    y: int
    width: int
    height: int
    shelf: int


class Shelf(NamedTuple):
    """A range of whole sheet rows, from ``top`` to ``bottom - 1``, with the pictures that lie side by side in it.

    ``pictures`` are (picture index, scale index) pairs.
    """

    top: int
    bottom: int
    pictures: tuple[tuple[int, int], ...]


class Layout(NamedTuple):
    """Each picture's slots, one per scale; the shelves; and the sheet's width and height."""

    slots: list[tuple[Slot, ...]]
    shelves: list[Shelf]
    size: Size


def lay_out(sizes: Sequence[Size], scales: Sequence[float], pans_deg: Sequence[float] | None = None) -> Layout:
    """Place pictures side by side on shelves, and widen the sheet until its height is within the limit.

    Without ``pans_deg``, pictures are placed in order of decreasing height.

    Args:
        sizes: Width and height of the panorama and of each tile.
        scales: Sizes of each picture on the sheet, relative to its full size.
        pans_deg: Pan angles of the tiles. If given, tiles are sorted by rounded height, scale and pan, so that a shelf holds tiles
            that are seen together, and the panorama has separate shelves.

    Raises:
        PackError: The pictures do not fit.
    """
    scaled_sizes = [[(max(1, round(w * s)), max(1, round(h * s))) for s in scales] for w, h in sizes]
    picture_scales = [(i, k) for i, sized in enumerate(scaled_sizes) for k in range(len(sized))]

    def sort_key(at: tuple[int, int]) -> tuple[float, ...]:
        i, k = at
        height = scaled_sizes[i][k][1]
        if pans_deg is None:
            return (-height,)
        return (0.0, -height) if i == 0 else (1.0, -(-height // HEIGHT_CLASS_PX), k, pans_deg[i - 1])

    picture_scales.sort(key=sort_key)
    sheet_width = max(w for sized in scaled_sizes for w, _ in sized) + 2 * BORDER_PX
    while sheet_width <= MAX_SIDE_PX:
        rows = _fill_rows(picture_scales, scaled_sizes, sheet_width, separate_panorama=pans_deg is not None)
        slots: dict[tuple[int, int], Slot] = {}
        shelves: list[Shelf] = []
        top = 0
        for row in rows:
            x = 0
            for i, k in row:
                width, height = scaled_sizes[i][k]
                slots[i, k] = Slot(x + BORDER_PX, top + BORDER_PX, width, height, len(shelves))
                x += width + 2 * BORDER_PX
            bottom = top + max(scaled_sizes[i][k][1] for i, k in row) + 2 * BORDER_PX
            shelves.append(Shelf(top, bottom, tuple(row)))
            top = bottom
        if top <= MAX_SIDE_PX:
            return Layout([tuple(slots[i, k] for k in range(len(scales))) for i in range(len(sizes))], shelves, (sheet_width, top))
        if sheet_width == MAX_SIDE_PX:
            break
        sheet_width = min(MAX_SIDE_PX, sheet_width * 5 // 4)
    raise PackError(
        "The pictures of this viewpoint do not fit on a sheet of 32766 x 32766 pixels. Bake it with fewer or smaller tiles."
    )


def _fill_rows(
    picture_scales: Sequence[tuple[int, int]], scaled_sizes: Sequence[Sequence[Size]], sheet_width: int, *, separate_panorama: bool
) -> list[list[tuple[int, int]]]:
    """Fill rows from left to right. If ``separate_panorama``, the panorama and the tiles never share a row."""
    rows: list[list[tuple[int, int]]] = []
    x = sheet_width + 1
    for i, k in picture_scales:
        width = scaled_sizes[i][k][0] + 2 * BORDER_PX
        if x + width > sheet_width or (separate_panorama and (rows[-1][0][0] == 0) != (i == 0)):
            rows.append([])
            x = 0
        rows[-1].append((i, k))
        x += width
    return rows
