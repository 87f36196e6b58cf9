"""A parser for context-free grammars that finds every reading of ambiguous text.

Grammars use a subset of Lark's notation. A rule is ``name: alternative | alternative``. Names in capitals are token types, which
``%declare`` lists, and other names are rules. ``?``, ``*``, ``+`` and parentheses have their usual meaning. ``->`` names an
alternative. A rule whose name begins with "_" is inlined: its parts become parts of the rule that uses it. Left recursion is not
supported.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from scope_ptz.english.grammar.questions.expressions import (
    Build,
    Choice,
    Expression,
    Nothing,
    Repetition,
    Rule,
    Series,
    Terminal,
    TokenSequence,
)
from scope_ptz.english.grammar.questions.typed_tokens import Token

_RULE = re.compile(r"^(\w+):((?:.*\n?(?!\w+:|%))*)", re.MULTILINE)
_SYMBOL = re.compile(r"\w+|[()|?*+]|->|\S")


class ChartParser:
    """A parser for a grammar.

    Args:
        grammar: The text of the grammar.

    Raises:
        ValueError: The grammar has a syntax error, or uses an undefined name.
    """

    def __init__(self, grammar: str) -> None:
        lines = [line.partition("//")[0] for line in grammar.splitlines()]
        types = frozenset(word for line in lines if line.startswith("%declare") for word in line.split()[1:])
        bodies = dict(_RULE.findall("\n".join(lines)))
        self._rules = {name: Rule(name) for name in bodies}
        for name, body in bodies.items():
            self._rules[name].alternatives += _RuleParser(name, body, self._rules, types).alternatives()

    def readings(self, tokens: Sequence[Token], start: str, build: Build) -> list[Any]:
        """Return every reading of the complete token list; an empty list if it does not match the rule.

        Args:
            tokens: The tokens to parse.
            start: The name of the rule to match.
            build: A function that returns the meaning of a match. Meanings that readings share are built once.
        """
        text, rule = TokenSequence(tokens, build), self._rules[start]
        if len(tokens) not in rule.ends(text, 0):
            return []
        return [reading for (reading,) in rule.parts(text, 0, len(tokens))]

    def matches(self, tokens: Sequence[Token], start: str) -> bool:
        """Return whether the complete token list matches a rule."""
        return len(tokens) in self._rules[start].ends(TokenSequence(tokens), 0)


class _RuleParser:
    """A parser for the body of a rule."""

    def __init__(self, name: str, body: str, rules: Mapping[str, Rule], types: frozenset[str]) -> None:
        self._name, self._rules, self._types = name, rules, types
        self._symbols: list[str] = [*_SYMBOL.findall(body), ""]
        self._position = 0

    def alternatives(self) -> Iterator[tuple[str, Expression]]:
        """Yield the alternatives of the rule with their names."""
        symbol = "|"
        while symbol == "|":
            body, name = self._series(), "" if self._name.startswith("_") else self._name
            if (symbol := self._next_symbol()) == "->":
                name, symbol = self._next_symbol(), self._next_symbol()
            yield name, body
        if symbol:
            raise self._error(symbol)

    def _next_symbol(self) -> str:
        self._position += 1
        return self._symbols[self._position - 1]

    def _series(self) -> Expression:
        parts: list[Expression] = []
        while (symbol := self._symbols[self._position]) not in {"", "|", ")", "->"}:
            self._position += 1
            part = self._group() if symbol == "(" else self._named_expression(symbol)
            if self._symbols[self._position] in {"?", "*", "+"}:
                part = _quantify(part, self._next_symbol())
            parts.append(part)
        series = parts.pop() if parts else Nothing()
        while parts:
            series = Series(parts.pop(), series)
        return series

    def _group(self) -> Expression:
        options = [self._series()]
        while (symbol := self._next_symbol()) == "|":
            options.append(self._series())
        if symbol != ")":
            raise self._error(symbol)
        return Choice(options)

    def _named_expression(self, name: str) -> Expression:
        if name in self._types:
            return Terminal(name)
        if name not in self._rules:
            raise self._error(name)
        return self._rules[name]

    def _error(self, symbol: str) -> ValueError:
        return ValueError(f"the rule '{self._name}' of the grammar has an unexpected '{symbol}'")


def _quantify(part: Expression, quantifier: str) -> Expression:
    """Return the expression that matches ``part`` as often as "?", "*" or "+" allows."""
    repeated = part if quantifier == "?" else Repetition(part)
    return repeated if quantifier == "+" else Choice([repeated, Nothing()])
