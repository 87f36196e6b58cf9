"""Join lists, form sentences, and normalise text for comparison."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence
from functools import lru_cache


def listing(items: Sequence[str], word: str = "and") -> str:
    """Join items as "a, b and c". No items give an empty string."""
    if len(items) < 2:
        return "".join(items)
    return f"{', '.join(items[:-1])} {word} {items[-1]}"


def sentence(text: str) -> str:
    """Return the text with a capital first letter and exactly one full stop at the end."""
    return text[:1].upper() + text[1:].rstrip(".") + "."


@lru_cache(maxsize=8192)
def letters(text: str) -> str:
    """Return only the letters and digits of a text, in lower case, with one space between words."""
    return " ".join(re.findall(r"[a-z0-9]+", unicodedata.normalize("NFKC", text).lower()))
