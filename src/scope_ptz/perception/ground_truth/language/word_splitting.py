"""Split a description or question into words."""

from __future__ import annotations

import re
import unicodedata

_CONTRACTIONS = {
    "what's": "what is", "where's": "where is", "who's": "who is", "there's": "there is", "that's": "that is", "how's": "how is",
    "it's": "it is", "isn't": "is not", "aren't": "are not", "doesn't": "does not", "don't": "do not", "can't": "can not",
    "cannot": "can not", "wasn't": "was not", "hasn't": "has not", "haven't": "have not", "i'm": "i am", "they're": "they are",
    "nobody": "no person", "no-one": "no person", "noone": "no person",
    "which's": "which is", "what're": "what are", "there're": "there are",
}  # fmt: skip
_SPLIT = re.compile(r'"[^"]*"|(?<![a-z0-9])\'[^\']+\'(?![a-z0-9])|[a-z0-9]+(?:[-.\'/][a-z0-9]+)*|,|;')


def split(text: str) -> list[str]:
    """Return lower-case words, numbers, commas and quoted strings with their quotes.

    Contractions are expanded, and possessives are split into the word and ``'s``.
    """
    plain = unicodedata.normalize("NFKC", text).lower()
    for curly, straight in (("\u2019", "'"), ("\u2018", "'"), ("\u201c", '"'), ("\u201d", '"')):
        plain = plain.replace(curly, straight)
    words: list[str] = []
    for word in _SPLIT.findall(plain):
        if word in _CONTRACTIONS:
            words += _CONTRACTIONS[word].split()
        elif word.endswith("'s") and len(word) > 2:
            words += [word[:-2], "'s"]
        else:
            words.append(word)
    return words
