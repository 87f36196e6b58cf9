"""Expressions of a context-free grammar, which match lists of tokens.

Matching has two phases. The first finds the ends of all matches of an expression from a given start. The second builds meanings,
but only for matches that are part of a match of the whole text. Both cache the results of rules, so the first phase takes
polynomial time even for texts with many readings, and parts that readings share are built once.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from itertools import product
from typing import Any

from scope_ptz.english.grammar.questions.typed_tokens import Token

EMPTY = ""
"""A pseudo token type in ``Expression.first``. It means that the expression can match no tokens."""

Parts = tuple[Any, ...]
"""The meanings of the parts of a match: tokens, and the results of ``Build``."""

Build = Callable[[str, list[Any]], Any]
"""A function that returns the meaning of a match from the name of the rule's alternative and the meanings of its parts."""


class TokenSequence:
    """A list of tokens with cached parsing results.

    Args:
        tokens: The tokens to parse.
        build: A function that returns the meaning of a match.
    """

    def __init__(self, tokens: Sequence[Token], build: Build = lambda _name, parts: parts) -> None:
        self.tokens, self.build = tokens, build
        self.kinds = [*(token.type for token in tokens), EMPTY]
        self.ends: dict[tuple[Rule, int], frozenset[int]] = {}
        self.readings: dict[tuple[Rule, int, int], list[Parts]] = {}


class Expression:
    """A part of a grammar."""

    @cached_property
    def first(self) -> frozenset[str]:
        """The token types with which a match can begin, and ``EMPTY`` if a match can have no tokens."""
        raise NotImplementedError

    def may_begin(self, kind: str) -> bool:
        """Return whether a match can begin where the next token has this type."""
        return kind in self.first or EMPTY in self.first

    def ends(self, text: TokenSequence, start: int) -> frozenset[int]:
        """Return the ends of all matches that begin at ``start``."""
        raise NotImplementedError

    def parts(self, text: TokenSequence, start: int, end: int) -> Iterator[Parts]:
        """Yield the parts of each match from ``start`` to ``end``."""
        raise NotImplementedError


class Nothing(Expression):
    """An expression that matches no tokens."""

    first = frozenset({EMPTY})

    def ends(self, text: TokenSequence, start: int) -> frozenset[int]:  # noqa: ARG002
        return frozenset({start})

    def parts(self, text: TokenSequence, start: int, end: int) -> Iterator[Parts]:  # noqa: ARG002
        if start == end:
            yield ()


class Terminal(Expression):
    """An expression that matches one token of a type."""

    def __init__(self, kind: str) -> None:
        self.kind = kind

    @cached_property
    def first(self) -> frozenset[str]:
        return frozenset({self.kind})

    def ends(self, text: TokenSequence, start: int) -> frozenset[int]:
        return frozenset({start + 1}) if text.kinds[start] == self.kind else frozenset()

    def parts(self, text: TokenSequence, start: int, end: int) -> Iterator[Parts]:
        if end == start + 1 and text.kinds[start] == self.kind:
            yield (text.tokens[start],)


class Series(Expression):
    """Two expressions in sequence."""

    def __init__(self, head: Expression, tail: Expression) -> None:
        self.head, self.tail = head, tail

    @cached_property
    def first(self) -> frozenset[str]:
        first = self.head.first
        return (first - {EMPTY}) | self.tail.first if EMPTY in first else first

    def ends(self, text: TokenSequence, start: int) -> frozenset[int]:
        middles = self.head.ends(text, start)
        return frozenset(
            end for middle in middles if self.tail.may_begin(text.kinds[middle]) for end in self.tail.ends(text, middle)
        )

    def parts(self, text: TokenSequence, start: int, end: int) -> Iterator[Parts]:
        for middle in self.head.ends(text, start):
            if middle <= end and self.tail.may_begin(text.kinds[middle]) and end in self.tail.ends(text, middle):
                tails = list(self.tail.parts(text, middle, end))
                for head, tail in product(self.head.parts(text, start, middle), tails):
                    yield head + tail


class Choice(Expression):
    """Alternatives, any of which may match."""

    def __init__(self, options: Sequence[Expression]) -> None:
        self.options = options

    @cached_property
    def first(self) -> frozenset[str]:
        return frozenset[str]().union(*(option.first for option in self.options))

    def ends(self, text: TokenSequence, start: int) -> frozenset[int]:
        kind = text.kinds[start]
        return frozenset[int]().union(*(option.ends(text, start) for option in self.options if option.may_begin(kind)))

    def parts(self, text: TokenSequence, start: int, end: int) -> Iterator[Parts]:
        for option in self.options:
            if option.may_begin(text.kinds[start]):
                yield from option.parts(text, start, end)


class Repetition(Expression):
    """One or more matches of an expression that cannot be empty."""

    def __init__(self, body: Expression) -> None:
        self.body = body

    @cached_property
    def first(self) -> frozenset[str]:
        return self.body.first

    def ends(self, text: TokenSequence, start: int) -> frozenset[int]:
        found: set[int] = set()
        open_ends = {start}
        while open_ends:
            position = open_ends.pop()
            new = self.body.ends(text, position) - found if self.body.may_begin(text.kinds[position]) else frozenset[int]()
            found |= new
            open_ends |= new
        return frozenset(found)

    def parts(self, text: TokenSequence, start: int, end: int) -> Iterator[Parts]:
        if not self.body.may_begin(text.kinds[start]):
            return
        for middle in self.body.ends(text, start):
            if middle == end:
                yield from self.body.parts(text, start, end)
            elif middle < end and end in self.ends(text, middle):
                tails = list(self.parts(text, middle, end))
                for body, rest in product(self.body.parts(text, start, middle), tails):
                    yield body + rest


class Rule(Expression):
    """A named expression.

    Attributes:
        alternatives: Pairs of a name and an expression. The name is passed to ``Build``; "" marks an inlined rule.
    """

    def __init__(self, name: str) -> None:
        self.name = name
        self.alternatives: list[tuple[str, Expression]] = []

    @cached_property
    def first(self) -> frozenset[str]:
        return frozenset[str]().union(*(body.first for _, body in self.alternatives))

    def ends(self, text: TokenSequence, start: int) -> frozenset[int]:
        key = (self, start)
        if key not in text.ends:
            kind = text.kinds[start]
            text.ends[key] = frozenset[int]().union(
                *(body.ends(text, start) for _, body in self.alternatives if body.may_begin(kind))
            )
        return text.ends[key]

    def parts(self, text: TokenSequence, start: int, end: int) -> Iterator[Parts]:
        key = (self, start, end)
        if key not in text.readings:
            text.readings[key] = [
                (text.build(name, list(parts)),) if name else parts
                for name, body in self.alternatives
                if body.may_begin(text.kinds[start])
                for parts in body.parts(text, start, end)
            ]
        return iter(text.readings[key])
