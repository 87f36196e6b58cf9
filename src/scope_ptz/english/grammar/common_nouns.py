"""Common English nouns for things that people look for, whether or not a scene has them."""

from __future__ import annotations

from functools import cache
from importlib.resources import files

from scope_ptz.english.nouns import singular


def is_common_noun(words: str) -> bool:
    """Return whether the last one or two words are a common noun, in the singular or plural."""
    parts = words.replace("-", " ").split()
    if not parts:
        return False
    parts[-1] = singular(parts[-1])
    return parts[-1] in _common_nouns() or "-".join(parts[-2:]) in _common_nouns()


@cache
def _common_nouns() -> frozenset[str]:
    lines = files(__package__).joinpath("common_nouns.txt").read_text("utf-8").splitlines()
    return frozenset(word for line in lines if not line.startswith("#") for word in line.split())
