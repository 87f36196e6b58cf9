"""The rules of ``language.lark`` in the plain form that the chart parser takes, compiled by Lark ahead of time.

Lark needs about half a second to read and expand the grammar, which every ``scope ask`` would wait for. So the expanded rules
are kept beside the grammar in ``language.rules``, headed by the hash of the grammar that they came from. Rules that do not fit
the grammar are compiled anew, so an edited grammar is in force at once; ``renew()`` writes the file again.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

_SOURCE, _COMPILED = "language.lark", "language.rules"


@dataclass(frozen=True, slots=True)
class Rule:
    """``name``: what the symbols make together. ``label``: what its node is called. ``inline``: its parts go to its parent
    instead, always ("_"), or when there is only one ("?")."""

    name: str
    symbols: tuple[str, ...]
    priority: int = 0
    label: str = ""
    inline: str = ""

    def __str__(self) -> str:
        return f"{self.inline or '.'} {self.name} {self.priority} {self.label} {' '.join(self.symbols)}"

    @staticmethod
    def read(line: str) -> Rule:
        inline, name, priority, label, *symbols = line.split(" ")
        return Rule(name, tuple(symbols), int(priority), label, inline.strip("."))


def load_rules() -> list[Rule]:
    """The rules in force."""
    source = _text(_SOURCE)
    head, *lines = _text(_COMPILED).splitlines()
    return [Rule.read(line) for line in lines] if head == _heading(source) else compile_rules(source)


def compile_rules(source: str) -> list[Rule]:
    """A grammar's rules, with options, repetitions and groups expanded by Lark."""
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
    """What ``language.rules`` must hold."""
    return "\n".join([_heading(source), *map(str, compile_rules(source)), ""])


def renew() -> None:
    """Write the compiled rules beside the grammar, after it was edited."""
    Path(__file__).with_name(_COMPILED).write_text(compiled_text(_text(_SOURCE)), encoding="utf-8")


def is_current() -> bool:
    """Whether the compiled rules are those of the grammar."""
    return _text(_COMPILED) == compiled_text(_text(_SOURCE))


def _heading(source: str) -> str:
    return f"# Generated from {_SOURCE}; sha256 {hashlib.sha256(source.encode()).hexdigest()}"


def _text(name: str) -> str:
    return files(__package__).joinpath(name).read_text(encoding="utf-8")
