"""Place the labels of points in a chart so that they overlap neither each other nor the points."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, hypot, pi, sin
from typing import TYPE_CHECKING

from scope_ptz.bench.reports.chart_style import INK, PX

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LABEL_HALF_PT = (7.0, 6.0)
"""Half the width and half the height of a two-digit label, in points."""
DIRECTIONS, DISTANCES_PT = 16, (9.0, 15.0, 22.0, 30.0)
"""Label positions to try around a marker: the number of directions, and the distances from the marker's edge in points."""

Point = tuple[str, tuple[float, float], float]
"""The label of a marker, its position in data coordinates, and its radius in points."""


def place_labels(axes: Axes, points: Sequence[Point]) -> None:
    """Write a label next to each marker. If the label is far away, connect it to the marker with a thin line.

    Args:
        axes: Axes whose layout is final.
        points: The labelled markers.
    """
    scale = 72 / PX
    centres = [tuple(scale * value for value in axes.transData.transform(position)) for _, position, _ in points]
    box = axes.get_window_extent()
    limits = tuple(scale * value for value in (box.x0, box.y0, box.x1, box.y1))
    offsets = label_offsets([((x, y), radius) for (x, y), (_, _, radius) in zip(centres, points, strict=True)], limits)
    for (text, position, radius), offset in zip(points, offsets, strict=True):
        line = (
            {"arrowstyle": "-", "color": INK, "lw": 0.6, "shrinkA": 0, "shrinkB": radius} if hypot(*offset) > radius + 12 else None
        )
        axes.annotate(
            text, position, offset, textcoords="offset points", ha="center", va="center", fontsize=9.5, fontweight="bold", zorder=4,
            arrowprops=line,
        )  # fmt: skip


def label_offsets(
    points: Sequence[tuple[tuple[float, float], float]], limits: Sequence[float]
) -> list[tuple[float, float]]:  # fmt: skip
    """Return the offset of each label from its marker, in points (1/72 inch).

    Labels are placed one by one, each where it overlaps least with markers, earlier labels and the border. Ties go to the position
    nearest to the marker.

    Args:
        points: Centre and radius of each marker.
        limits: Left, bottom, right and top border.
    """
    placed, offsets = list[tuple[float, float]](), list[tuple[float, float]]()
    for (x, y), radius in points:
        best = (float("inf"), 0.0, 0.0)
        for distance in DISTANCES_PT:
            for step in range(DIRECTIONS):
                angle = 2 * pi * step / DIRECTIONS
                dx, dy = (radius + distance) * cos(angle), (radius + distance) * sin(angle)
                cost = _overlap((x + dx, y + dy), points, placed, limits) + 0.01 * distance
                best = min(best, (cost, dx, dy))
        placed.append((x + best[1], y + best[2]))
        offsets.append((best[1], best[2]))
    return offsets


def _overlap(
    label: tuple[float, float],
    points: Sequence[tuple[tuple[float, float], float]],
    placed: Sequence[tuple[float, float]],
    limits: Sequence[float],
) -> float:
    """Return the overlap of a label with markers, other labels and the border, as a weighted sum of lengths in points."""
    (x, y), (half_x, half_y) = label, LABEL_HALF_PT
    total = 0.0
    for (px, py), radius in points:
        total += max(0.0, radius + 1 - hypot(max(0.0, abs(px - x) - half_x), max(0.0, abs(py - y) - half_y)))
    for px, py in placed:
        total += 3 * min(max(0.0, 2 * half_x - abs(px - x)), max(0.0, 2 * half_y - abs(py - y)))
    left, bottom, right, top = limits
    outside = max(0.0, left - (x - half_x), x + half_x - right) + max(0.0, bottom - (y - half_y), y + half_y - top)
    return total + 5 * outside
