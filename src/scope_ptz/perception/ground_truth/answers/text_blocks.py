"""Group the texts on a thing into blocks that are read together, such as the lines of a sign or the rows of a departures board."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from scope_ptz.simulator.models import SceneText
from scope_ptz.simulator.truth import TextSighting

_MAX_LINE_GAP = 3.5
"""Maximum distance between the centres of two lines of a block, in heights of a capital letter."""
_MAX_WORD_GAP = 3.0
"""Maximum gap between two texts in a row of a block, in heights of a capital letter."""
_MIN_TABLE_ROWS = 3
"""Minimum number of rows that columns of texts share, if they form a table although they are far apart."""
_MIN_SAME_FACING = 0.95
"""Minimum cosine of the angle between the lines of two texts on one face of a thing."""
_FIGURE = re.compile(r"\d[.:]\d\d")
"""A price or a time."""

_Group = list[TextSighting]


@dataclass(frozen=True)
class TextBlock:
    """Texts that are read together: rows from top to bottom, each from left to right."""

    rows: tuple[tuple[str, ...], ...]

    @property
    def is_list(self) -> bool:
        """Whether each row is an entry of its own, as on a timetable or a price list."""
        pairs = sum(len(row) > 1 for row in self.rows)
        figures = sum(_FIGURE.search(" ".join(row)) is not None for row in self.rows)
        return pairs >= _MIN_TABLE_ROWS or (len(self.rows) > 2 and figures > 1)

    @property
    def lines(self) -> list[str]:
        """The rows of a list; for other blocks, one line with the whole text."""
        rows = [" ".join(row) for row in self.rows]
        return rows if self.is_list else [" ".join(rows)]


def blocks_of(texts: Sequence[TextSighting]) -> list[TextBlock]:
    """Return the blocks of the texts on one thing, in the order of their first texts. Equal blocks are returned once."""
    blocks = (TextBlock(tuple(tuple(t.text.text for t in row) for row in _rows(group))) for group in groups_of(texts))
    return list(dict.fromkeys(blocks))


def groups_of(texts: Sequence[TextSighting]) -> list[list[TextSighting]]:
    """Return the texts on one thing in groups that are read together, in the order of their first texts."""
    groups = [[text] for text in texts]
    groups = _merged(groups, lambda one, other: any(_are_neighbours(a.text, b.text) for a in one for b in other))
    return _merged(groups, _share_rows)


def _merged(groups: list[_Group], belong_together: Callable[[_Group, _Group], bool]) -> list[_Group]:
    """Merge groups until no two of them belong together."""
    merged: list[_Group] = []
    for group in groups:
        joined = [other for other in merged if belong_together(other, group)]
        if joined:
            joined[0] += [t for other in joined[1:] for t in other] + group
            merged = [other for other in merged if not any(other is extra for extra in joined[1:])]
        else:
            merged.append(list(group))
    return merged


def _are_neighbours(one: SceneText, other: SceneText) -> bool:
    """Return whether two texts are next to each other in a row, or one below the other."""
    if not _face_the_same_way(one, other):
        return False
    cap_m = max(one.cap_height_m, other.cap_height_m)
    along_m, down_m = (abs(x) for x in _offset_m(one, other))
    gap_m = along_m - (one.width_m + other.width_m) / 2
    if down_m < cap_m / 2:
        return gap_m <= _MAX_WORD_GAP * cap_m
    return down_m <= _MAX_LINE_GAP * cap_m and gap_m <= 0


def _share_rows(one: _Group, other: _Group) -> bool:
    """Return whether two groups of texts are columns of a table."""
    return len([a for a in one if any(_are_in_row(a.text, b.text) for b in other)]) >= _MIN_TABLE_ROWS and (
        len([b for b in other if any(_are_in_row(a.text, b.text) for a in one)]) >= _MIN_TABLE_ROWS
    )


def _are_in_row(one: SceneText, other: SceneText) -> bool:
    if not _face_the_same_way(one, other):
        return False
    return abs(_offset_m(one, other)[1]) < max(one.cap_height_m, other.cap_height_m) / 2


def _face_the_same_way(one: SceneText, other: SceneText) -> bool:
    return float(np.dot(one.right, other.right)) > _MIN_SAME_FACING


def _offset_m(one: SceneText, other: SceneText) -> tuple[float, float]:
    """Return the position of the second text relative to the first, in metres to the right and upwards."""
    difference_m = np.subtract(other.centre_m, one.centre_m)
    return float(np.dot(difference_m, one.right)), float(np.dot(difference_m, one.up))


def _rows(group: Sequence[TextSighting]) -> list[list[TextSighting]]:
    """Return the rows of a group from top to bottom, each from left to right."""
    first = group[0].text
    rows: list[list[TextSighting]] = []
    for sighting in sorted(group, key=lambda t: -_offset_m(first, t.text)[1]):
        if rows and _are_in_row(rows[-1][0].text, sighting.text):
            rows[-1].append(sighting)
        else:
            rows.append([sighting])
    return [sorted(row, key=lambda t: _offset_m(first, t.text)[0]) for row in rows]
