"""Look up the parts of speech of English words in LemmInflect's dictionary.

The first look-up loads the dictionary, which takes about 0.2 s.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Literal

VerbForm = Literal["base", "third person", "past", "participle"]


@lru_cache(maxsize=8192)
def parts_of_speech(word: str) -> frozenset[str]:
    """Return the parts of speech that a lower-case word can have, such as {"NOUN", "VERB"}; an empty set for an unknown word."""
    from lemminflect import getAllLemmas

    return frozenset(getAllLemmas(word))


@lru_cache(maxsize=8192)
def lemmas_of(word: str) -> frozenset[str]:
    """Return the base forms that a lower-case word can have ("left": "left", "leave"); the word itself if it is unknown."""
    from lemminflect import getAllLemmas

    return frozenset(lemma for lemmas in getAllLemmas(word).values() for lemma in lemmas) or frozenset({word})


@lru_cache(maxsize=8192)
def verb_form(word: str) -> VerbForm | None:
    """Return the form of a lower-case verb; None for other words.

    A past form may also be a past participle. "participle" is the form that ends in "ing".
    """
    from lemminflect import getAllLemmas

    lemmas = getAllLemmas(word).get("VERB", ())
    if not lemmas:
        return None
    if word in lemmas:
        return "base"
    if word.endswith("ing"):
        return "participle"
    return "third person" if word.endswith("s") else "past"
