"""The meaning of nouns: concepts, their synonyms, and the hierarchy of kinds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from importlib.resources import files

from scope_ptz import english

CACHED = 8192
"""Results of a function that are kept: questions and scenes repeat the same few thousand phrases."""


@dataclass(frozen=True, eq=False)
class Lexicon:
    """All concepts, with their names and the kinds that they belong to. There is only one, so its methods cache their results."""

    parents: dict[str, tuple[str, ...]]
    names: dict[str, str]
    """Every noun, in the singular, with its concept."""

    @lru_cache(maxsize=CACHED)  # noqa: B019
    def concept(self, phrase: str) -> str | None:
        """Return the concept of a noun in the singular or plural."""
        words = phrase.replace("-", " ").split()
        for form in (phrase, singular_phrase(phrase), " ".join(words), singular_phrase(" ".join(words))):
            if form in self.names:
                return self.names[form]
        return None

    @lru_cache(maxsize=CACHED)  # noqa: B019
    def kinds(self, concept: str) -> frozenset[str]:
        """Return the concept and everything that it is a kind of."""
        found = {concept}
        for parent in self.parents.get(concept, ()):
            found |= self.kinds(parent)
        return frozenset(found)

    @lru_cache(maxsize=CACHED)  # noqa: B019
    def all_names(self, concept: str) -> frozenset[str]:
        """Return every noun, in the singular, for the concept or for a more specific one."""
        return frozenset(name for name, meant in self.names.items() if concept in self.kinds(meant))


@lru_cache(maxsize=CACHED)
def singular_phrase(phrase: str) -> str:
    """Return the phrase with its last word in the singular."""
    *first, last = phrase.split()
    return " ".join([*first, english.singular(last)])


@cache
def lexicon() -> Lexicon:
    """Load the lexicon from ``lexicon.txt``."""
    parents: dict[str, tuple[str, ...]] = {}
    names: dict[str, str] = {}
    others: list[tuple[str, str]] = []
    for line in files(__package__).joinpath("lexicon.txt").read_text("utf-8").splitlines():
        if not line.strip() or line.startswith("#"):
            continue
        left, _, right = line.partition(":")
        concept, _, above = (part.strip() for part in left.partition("<"))
        parents[concept] = tuple(p.strip() for p in above.split(",") if p.strip())
        names[concept] = concept
        others += [(other.strip(), concept) for other in right.split(",") if other.strip()]
    for other, concept in others:
        names.setdefault(other, concept)
        names.setdefault(other.replace("-", " "), concept)
    return Lexicon(parents, names)


def nouns_in(words: Sequence[str], known: frozenset[str] = frozenset()) -> list[tuple[int, int]]:
    """Return spans ``[start, end)`` of words that could be the noun of a phrase: those with the last end, longest first.

    Args:
        words: The words of the phrase.
        known: Nouns in addition to the lexicon's (categories and names of the scene), in the singular.
    """
    return list(_nouns_in(tuple(words), known))


@lru_cache(maxsize=CACHED)
def _nouns_in(words: tuple[str, ...], known: frozenset[str]) -> tuple[tuple[int, int], ...]:
    table = lexicon()
    spans = [
        (i, j)
        for i in range(len(words))
        for j in range(i + 1, min(len(words), i + 5) + 1)
        if table.concept(phrase := " ".join(words[i:j])) or phrase in known or singular_phrase(phrase) in known
    ]
    if not spans:
        return ()
    end = max(j for _, j in spans)
    return tuple(sorted((s for s in spans if s[1] == end), key=lambda s: s[0]))
