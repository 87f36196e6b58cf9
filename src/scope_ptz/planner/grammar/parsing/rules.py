"""The rules of ``language.lark`` in the plain form that the chart parser takes, compiled by Lark ahead of time.

Lark needs about half a second to read and expand the grammar, which would delay every ``scope ask``. So the expanded rules are
stored beside the grammar in ``language.rules``, with the hash of their grammar in the first line. When the hash does not match, the
rules are compiled again, so an edited grammar takes effect at once. ``renew()`` rewrites the file.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

_SOURCE, _COMPILED = "language.lark", "language.rules"


@dataclass(frozen=True, slots=True)
class Rule:
    """A grammar rule.

    Attributes:
        name: The symbol on the left-hand side.
        symbols: The symbols on the right-hand side.
        label: The name of the rule's node in the tree.
        inline: When the node's children go to its parent instead: always ("_"), or when there is only one ("?").
    """

    name: str
    symbols: tuple[str, ...]
    priority: int = 0
    label: str = ""
    inline: str = ""

    def __str__(self) -> str:
        return f"{self.inline or '.'} {self.name} {self.priority} {self.label} {' '.join(self.symbols)}"

    @staticmethod
    def read(line: str) -> Rule:
        """Parse a line of ``language.rules``."""
        inline, name, priority, label, *symbols = line.split(" ")
        return Rule(name, tuple(symbols), int(priority), label, inline.strip("."))


def load_rules() -> list[Rule]:
    """Return the rules of the current grammar."""
    source = _text(_SOURCE)
    head, *lines = _text(_COMPILED).splitlines()
    return [Rule.read(line) for line in lines] if head == _heading(source) else compile_rules(source)


def compile_rules(source: str) -> list[Rule]:
    """Return a grammar's rules, with options, repetitions and groups expanded by Lark."""
    from lark import Lark

    compiled = Lark(source, parser="earley", lexer="basic", maybe_placeholders=False).rules
    return [
        Rule(
            name := str(rule.origin.name),
            tuple(symbol.name for symbol in rule.expansion),
            rule.options.priority or 0,
            str(rule.alias or name),
            "_" if name.startswith("_") else "?" if rule.options.expand1 and not rule.alias else "",
        )
        for rule in compiled
    ]


def compiled_text(source: str) -> str:
    """Return the expected content of ``language.rules``."""
    return "\n".join([_heading(source), *map(str, compile_rules(source)), ""])


def renew() -> None:
    """Rewrite ``language.rules`` after the grammar was edited."""
    Path(__file__).with_name(_COMPILED).write_text(compiled_text(_text(_SOURCE)), encoding="utf-8")


def is_current() -> bool:
    """Return whether the compiled rules belong to the current grammar."""
    return _text(_COMPILED) == compiled_text(_text(_SOURCE))


def _heading(source: str) -> str:
    return f"# Generated from {_SOURCE}; sha256 {hashlib.sha256(source.encode()).hexdigest()}"


def _text(name: str) -> str:
    return files(__package__).joinpath(name).read_text(encoding="utf-8")
