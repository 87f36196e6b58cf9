"""Compute the Pareto front of a set of points."""

from __future__ import annotations

from collections.abc import Sequence


def undominated(points: Sequence[tuple[float, ...]]) -> list[bool]:
    """Return which points are on the Pareto front, where smaller coordinates are better.

    A point is on the front if no other point is at least as good in every coordinate and better in one.
    """
    return [not any(_dominates(other, point) for other in points) for point in points]


def _dominates(one: tuple[float, ...], other: tuple[float, ...]) -> bool:
    return all(a <= b for a, b in zip(one, other, strict=True)) and one != other
