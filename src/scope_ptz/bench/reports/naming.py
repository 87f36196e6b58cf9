"""What logs call things, made presentable."""

from __future__ import annotations

from pathlib import PurePath


def split_name(split: str) -> str:
    """A split as reports call it: of a file its name, not where it lay."""
    return PurePath(split.replace("\\", "/")).name or split
