"""The meaning of nouns: concepts, their synonyms, and the hierarchy of kinds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from importlib.resources import files

from scope_ptz import english

CACHE_SIZE = 8192
"""Number of cached results per function, enough because questions and scenes repeat the same few thousand phrases."""


@dataclass(frozen=True, eq=False)
class Lexicon:
    """All concepts, with their nouns and the kinds that they belong to. The methods cache their results."""

    parents: dict[str, tuple[str, ...]]
    """The kinds to which each concept belongs directly."""
    concepts: dict[str, str]
    """The concept of each noun. All nouns are in the singular."""

    @lru_cache(maxsize=CACHE_SIZE)  # noqa: B019
    def concept(self, phrase: str) -> str | None:
        """Return the concept of a noun, which may be singular or plural; None for an unknown noun."""
        words = phrase.replace("-", " ").split()
        for form in (phrase, singular_phrase(phrase), " ".join(words), singular_phrase(" ".join(words))):
            if form in self.concepts:
                return self.concepts[form]
        return None

    @lru_cache(maxsize=CACHE_SIZE)  # noqa: B019
    def kinds(self, concept: str) -> frozenset[str]:
        """Return the concept and everything that it is a kind of."""
        kinds = {concept}
        for parent in self.parents.get(concept, ()):
            kinds |= self.kinds(parent)
        return frozenset(kinds)

    @lru_cache(maxsize=CACHE_SIZE)  # noqa: B019
    def all_names(self, concept: str) -> frozenset[str]:
        """Return every noun, in the singular, for the concept or for a more specific one."""
        return frozenset(name for name, named_concept in self.concepts.items() if concept in self.kinds(named_concept))


@lru_cache(maxsize=CACHE_SIZE)
def singular_phrase(phrase: str) -> str:
    """Return the phrase with its last word in the singular."""
    if not phrase.strip():
        return phrase
    *first, last = phrase.split()
    return " ".join([*first, english.singular(last)])


@cache
def lexicon() -> Lexicon:
    """Load the lexicon from ``lexicon.txt``."""
    parents: dict[str, tuple[str, ...]] = {}
    concepts: dict[str, str] = {}
    synonyms: list[tuple[str, str]] = []
    for line in files(__package__).joinpath("lexicon.txt").read_text("utf-8").splitlines():
        if not line.strip() or line.startswith("#"):
            continue
        left, _, right = line.partition(":")
        concept, _, parent_names = (part.strip() for part in left.partition("<"))
        parents[concept] = tuple(p.strip() for p in parent_names.split(",") if p.strip())
        concepts[concept] = concept
        synonyms += [(synonym.strip(), concept) for synonym in right.split(",") if synonym.strip()]
    for synonym, concept in synonyms:
        concepts.setdefault(synonym, concept)
        concepts.setdefault(synonym.replace("-", " "), concept)
    return Lexicon(parents, concepts)


def nouns_in(words: Sequence[str], extra_nouns: frozenset[str] = frozenset()) -> list[tuple[int, int]]:
    """Return the spans ``[start, end)`` of words that could be the noun of a phrase, longest first. All end at the last noun.

    Args:
        words: The words of the phrase.
        extra_nouns: Nouns of the scene (categories and names) in addition to those of the lexicon, in the singular.
    """
    return list(_nouns_in(tuple(words), extra_nouns))


@lru_cache(maxsize=CACHE_SIZE)
def _nouns_in(words: tuple[str, ...], extra_nouns: frozenset[str]) -> tuple[tuple[int, int], ...]:
    table = lexicon()
    spans = [
        (i, j)
        for i in range(len(words))
        for j in range(i + 1, min(len(words), i + 5) + 1)
        if table.concept(phrase := " ".join(words[i:j])) or phrase in extra_nouns or singular_phrase(phrase) in extra_nouns
    ]
    if not spans:
        return ()
    end = max(j for _, j in spans)
    return tuple(sorted((s for s in spans if s[1] == end), key=lambda s: s[0]))
