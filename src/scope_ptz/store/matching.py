"""Split text into words as the full-text index does, ignoring case and accents."""

from __future__ import annotations

import re
import unicodedata


def words_of(text: str) -> list[str]:
    """Return the words of the text in lower case, without accents."""
    return re.findall(r"[^\W_]+", _fold_accents(text))


def has_words(instruction: str, answer: str, words: str) -> int:
    """Return 1 if instruction and answer together contain all the given words, otherwise 0. Registered as an SQL function.

    Args:
        instruction: The instruction of a run.
        answer: The answer of the run.
        words: The words, separated by spaces. The last one may be incomplete.
    """
    text = _fold_accents(f"{instruction}\n{answer}")
    *complete, prefix = words.split(" ")
    # A substring search rules out most runs. It is ten times as fast as splitting the text into words.
    if prefix not in text or not all(word in text for word in complete):
        return 0
    found = set(re.findall(r"[^\W_]+", text))
    return int(found.issuperset(complete) and any(word.startswith(prefix) for word in found))


def _fold_accents(text: str) -> str:
    if not text.isascii():
        text = "".join(c for c in unicodedata.normalize("NFKD", text) if not unicodedata.combining(c))
    return text.lower()
