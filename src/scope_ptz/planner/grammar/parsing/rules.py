"""The rules of ``language.lark`` in the plain form that the chart parser needs, compiled by Lark ahead of time.

Lark needs about half a second to read and expand the grammar, which would delay every ``scope ask``. The expanded rules are
therefore stored in ``language.rules``, with the hash of the grammar in the first line. If the hash does not match, the rules are
compiled again, so that an edited grammar takes effect at once. ``renew()`` rewrites the file.
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
        label: The name of the rule's nodes in the parse tree.
        inline: Whether children replace the node in the tree: always ("_"), if there is only one ("?"), or never ("").
    """

    name: str
    symbols: tuple[str, ...]
    priority: int = 0
    label: str = ""
    inline: str = ""

    def __str__(self) -> str:
        return f"{self.inline or '.'} {self.name} {self.priority} {self.label} {' '.join(self.symbols)}"

    @staticmethod
    def from_line(line: str) -> Rule:
        """Parse a line of ``language.rules``."""
        inline, name, priority, label, *symbols = line.split(" ")
        return Rule(name, tuple(symbols), int(priority), label, inline.strip("."))


def load_rules() -> list[Rule]:
    """Return the rules of the grammar, compiled if the stored ones are out of date."""
    source = _text(_SOURCE)
    head, *lines = _text(_COMPILED).splitlines()
    return [Rule.from_line(line) for line in lines] if head == _heading(source) else compile_rules(source)


def compile_rules(source: str) -> list[Rule]:
    """Compile a grammar with Lark, which expands options, repetitions and groups."""
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
    """Return the content of ``language.rules`` for a grammar."""
    return "\n".join([_heading(source), *map(str, compile_rules(source)), ""])


def renew() -> None:
    """Rewrite ``language.rules``. Needed after every edit of the grammar."""
    Path(__file__).with_name(_COMPILED).write_text(compiled_text(_text(_SOURCE)), encoding="utf-8")


def is_current() -> bool:
    """Return whether ``language.rules`` is up to date with the grammar."""
    return _text(_COMPILED) == compiled_text(_text(_SOURCE))


def _heading(source: str) -> str:
    return f"# Generated from {_SOURCE}; sha256 {hashlib.sha256(source.encode()).hexdigest()}"


def _text(name: str) -> str:
    return files(__package__).joinpath(name).read_text(encoding="utf-8")
