"""Colour words."""

from __future__ import annotations

COLOURS = frozenset({
    "red", "orange", "yellow", "green", "blue", "purple", "violet", "pink", "brown", "black", "white", "grey", "gray", "silver",
    "gold", "golden", "beige", "cream", "tan", "amber", "turquoise", "teal", "cyan", "magenta", "maroon", "navy", "lime", "olive",
})  # fmt: skip
