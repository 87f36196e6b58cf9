"""Match patterns of word classes against lexemes.

A pattern is a regular expression whose letters are lexemes. A word in capitals is a class of the lexicon, a word in lower case
is that word, and "_" is any lexeme: "(COUNT|tally) DET? (?P<things>_+)". Alternation, groups, repetition and look-ahead are those
of regular expressions. Spaces have no meaning.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cached_property, lru_cache

from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.required_words import Requirement, is_met, requirement_of

_NAME = re.compile(r"\\Z|\?P<\w+>|\?P=\w+|\?[:=!]|\?<[=!]|[A-Z][A-Z-]*|'?[a-z][a-z_']*|_|\s+")


class Match:
    """A pattern that matched, with the lexemes of its named groups."""

    def __init__(self, match: re.Match[str], lexemes: Sequence[Lexeme], offsets: dict[int, int]) -> None:
        self._match, self._lexemes, self._offsets = match, lexemes, offsets

    def __getitem__(self, name: str) -> Sequence[Lexeme]:
        """Return the lexemes of a group; empty if the group took no part in the match."""
        group = self._found.get(name)
        if group is None:
            return ()
        start, end = self._match.span(group)
        return self._lexemes[self._offsets[start] : self._offsets[end]]

    @property
    def _found(self) -> dict[str, str]:
        return {name.partition("__")[0]: name for name, text in self._match.groupdict().items() if text is not None}

    @property
    def size(self) -> int:
        """The number of lexemes that the whole match covers."""
        return self._offsets[self._match.end()] - self._offsets[self._match.start()]

    @property
    def names(self) -> set[str]:
        """The names of the groups that took part in the match."""
        return set(self._found)

    def has(self, name: str) -> bool:
        """Return whether a group took part in the match."""
        return name in self._found


class _Pattern:
    """A pattern that is compiled only when some lexemes might match it."""

    def __init__(self, source: str) -> None:
        self._source, self._is_compiled = source, False

    def may_match(self, names: frozenset[str]) -> bool:
        """Return False if a word or class that the pattern needs is missing."""
        return self._is_compiled or is_met(self._requirement, names)

    @cached_property
    def _requirement(self) -> Requirement:
        return requirement_of(self._source)

    @cached_property
    def at_start(self) -> re.Pattern[str]:
        """The regular expression, to be matched at the first lexeme."""
        self._is_compiled = True
        return re.compile(_regular_expression(self._source))

    @cached_property
    def anywhere(self) -> re.Pattern[str]:
        """The regular expression, to be searched for from any lexeme."""
        self._is_compiled = True
        return re.compile(f"(?:(?<= )|^)(?:{_regular_expression(self._source)})")


_pattern = lru_cache(maxsize=4096)(_Pattern)


def _regular_expression(pattern: str) -> str:
    seen: dict[str, int] = {}

    def element(match: re.Match[str]) -> str:
        name = match[0]
        if name.startswith("?P<"):  # a group may occur several times, in alternatives
            group = name[3:-1]
            seen[group] = seen.get(group, 0) + 1
            return name if seen[group] == 1 else f"?P<{group}__{seen[group]}>"
        if name.startswith(("?", "\\")):
            return name
        if name.isspace():
            return ""
        if name == "_":
            return r"(?:[^ ]+ )"
        if name[0].isupper():
            return rf"(?:[^ |]*\|(?:[^ ]*\|)?{name}\|[^ ]* )"
        return rf"(?:{re.escape(name)}\|[^ ]* )"

    return _NAME.sub(element, pattern)


@lru_cache(maxsize=2048)
def _rendered(lexemes: tuple[Lexeme, ...]) -> tuple[str, dict[int, int], frozenset[str]]:
    """Return the text to match patterns against, the number of lexemes before each offset, and all words and classes."""
    text, offsets = [], {0: 0}
    names: set[str] = set()
    size = 0
    for i, lexeme in enumerate(lexemes, 1):
        word = lexeme.word.replace(" ", "_").replace("|", "_")
        names.update(lexeme.classes)
        names.add(word)
        piece = f"{word}|{'|'.join(sorted(lexeme.classes))}| "
        text.append(piece)
        size += len(piece)
        offsets[size] = i
    return "".join(text), offsets, frozenset(names)


def full_match(pattern: str, lexemes: Sequence[Lexeme]) -> Match | None:
    """Return the match of a pattern with all lexemes; None if it does not match."""
    text, offsets, names = _rendered(tuple(lexemes))
    if not (compiled := _pattern(pattern)).may_match(names):
        return None
    match = compiled.at_start.fullmatch(text)
    return Match(match, lexemes, offsets) if match else None


def match_start(pattern: str, lexemes: Sequence[Lexeme]) -> Match | None:
    """Return the match of a pattern at the first lexeme; None if it does not match."""
    text, offsets, names = _rendered(tuple(lexemes))
    if not (compiled := _pattern(pattern)).may_match(names):
        return None
    match = compiled.at_start.match(text)
    return Match(match, lexemes, offsets) if match else None


def search(pattern: str, lexemes: Sequence[Lexeme]) -> Match | None:
    """Return the first match of a pattern anywhere; None if there is none."""
    text, offsets, names = _rendered(tuple(lexemes))
    if not (compiled := _pattern(pattern)).may_match(names):
        return None
    match = compiled.anywhere.search(text)
    return Match(match, lexemes, offsets) if match else None
