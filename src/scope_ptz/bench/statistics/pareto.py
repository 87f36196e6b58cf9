"""Compute the Pareto front of a set of points."""

from __future__ import annotations

from collections.abc import Sequence


def pareto_front(points: Sequence[tuple[float, ...]]) -> list[bool]:
    """Return, for each point, whether it is on the Pareto front. Smaller coordinates are better.

    A point is on the front if no other point is at least as good in every coordinate and better in at least one.
    """
    return [not any(_dominates(other, point) for other in points) for point in points]


def _dominates(point: tuple[float, ...], other: tuple[float, ...]) -> bool:
    return all(a <= b for a, b in zip(point, other, strict=True)) and point != other
