"""Counts of visible things, of which there may be more that are too small or hidden."""

from __future__ import annotations

from collections.abc import Iterable


class VisibleCount(int):
    """The number of things that a picture shows.

    Attributes:
        complete: Whether there can be no others in view; if not, the number is only a minimum.
    """

    complete: bool

    def __new__(cls, number: int, *, complete: bool = True) -> VisibleCount:
        count = super().__new__(cls, number)
        count.complete = complete
        return count


def is_complete(count: int) -> bool:
    """Return whether a count is exact. Plain numbers are."""
    return not isinstance(count, VisibleCount) or count.complete


def are_complete(counts: Iterable[int]) -> bool:
    """Return whether all counts are exact."""
    return all(map(is_complete, counts))


def number_text(count: int) -> str:
    """Return a count without its noun: "3", "at least 3", "none", or "none clearly" when there may be some."""
    if not count:
        return "none" if is_complete(count) else "none clearly"
    return str(int(count)) if is_complete(count) else f"at least {int(count)}"
