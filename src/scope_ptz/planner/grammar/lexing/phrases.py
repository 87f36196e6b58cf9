"""Load the phrases of ``vocabulary.txt``, which are expanded ahead of time.

Expanding the patterns takes a tenth of a second, so the phrases are stored in ``vocabulary.phrases``: a line with the sets of
terminals that occur, then a line for each first word with the remaining words of its phrases. If the vocabulary was edited, the
stored phrases are ignored until ``write_stored_phrases()`` rewrites the file.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from pathlib import Path

from scope_ptz.planner.grammar.compiled import compiled_lines, heading
from scope_ptz.planner.grammar.lexing.vocabulary import expand, vocabulary

_SOURCE = Path(__file__).with_name("vocabulary.txt")
_COMPILED = Path(__file__).with_name("vocabulary.phrases")

Words = tuple[str, ...]
Kinds = frozenset[str]
_NO_PHRASES: dict[Words, Kinds] = {}


class PhraseTable:
    """The possible terminals of each phrase, parsed on request by first word. ``FILLER`` marks words without meaning.

    Args:
        lines: The lines of ``vocabulary.phrases`` after its heading.
    """

    def __init__(self, lines: Iterable[str]) -> None:
        sets, *groups = lines
        self._sets = [frozenset(kinds.split(" ")) for kinds in sets.split("\t")]
        self._groups = dict(line.split("\t", 1) for line in groups)
        self._parsed_groups: dict[str, dict[Words, Kinds]] = {}

    def __contains__(self, words: Words) -> bool:
        return words in self.starting_with(words[0])

    def __getitem__(self, words: Words) -> Kinds:
        return self.starting_with(words[0])[words]

    def get(self, words: Words) -> Kinds:
        """Return the terminals of a phrase; an empty set if the phrase is unknown."""
        return self.starting_with(words[0]).get(words, frozenset())

    def phrases(self) -> dict[Words, Kinds]:
        """Return all phrases with their terminals."""
        return {words: kinds for first in self._groups for words, kinds in self.starting_with(first).items()}

    def starting_with(self, first: str) -> dict[Words, Kinds]:
        """Return the phrases that begin with a word."""
        if first not in self._groups:
            return _NO_PHRASES
        if first not in self._parsed_groups:
            entries = (entry.split(" ") for entry in self._groups[first].split("\t"))
            self._parsed_groups[first] = {(first, *rest): self._sets[int(number)] for number, *rest in entries}
        return self._parsed_groups[first]


@cache
def phrase_table() -> PhraseTable:
    """Return the phrases of the current vocabulary."""
    return PhraseTable(compiled_lines(_SOURCE, _COMPILED) or compiled_text().splitlines()[1:])


def expanded() -> dict[Words, Kinds]:
    """Return all phrases with their terminals, expanded from their patterns."""
    table: dict[Words, set[str]] = {}
    for terminal, patterns in vocabulary().items():
        for pattern in patterns:
            for words in expand(pattern):
                table.setdefault(words, set()).add(terminal)
    return {words: frozenset(kinds) for words, kinds in table.items()}


def compiled_text() -> str:
    """Return the expected content of ``vocabulary.phrases``."""
    phrases = {words: " ".join(sorted(kinds)) for words, kinds in sorted(expanded().items())}
    sets = sorted(set(phrases.values()))
    numbers = {kinds: str(number) for number, kinds in enumerate(sets)}
    groups: dict[str, list[str]] = {}
    for (first, *rest), kinds in phrases.items():
        groups.setdefault(first, []).append(" ".join([numbers[kinds], *rest]))
    return "\n".join([heading(_SOURCE), "\t".join(sets), *("\t".join([first, *entries]) for first, entries in groups.items()), ""])


def write_stored_phrases() -> None:
    """Rewrite ``vocabulary.phrases`` after the vocabulary was edited."""
    _COMPILED.write_text(compiled_text(), encoding="utf-8")


def is_current() -> bool:
    """Return whether the compiled phrases belong to the current vocabulary."""
    return _COMPILED.read_text(encoding="utf-8") == compiled_text()
