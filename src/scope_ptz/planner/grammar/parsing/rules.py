"""The rules of ``language.lark`` in the plain form that the chart parser takes, compiled by Lark ahead of time.

Lark needs about half a second to read and expand the grammar, which would delay every ``scope ask``. So the expanded rules are
stored beside the grammar in ``language.rules``, their symbols in ``language.symbols``, and only those that an instruction can begin
are read. An edited grammar is compiled again. ``renew()`` rewrites the files.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from scope_ptz.planner.grammar.compiled import compiled_lines, heading

GUESSES = frozenset({"far_ref"})
"""Names of rules that take free words after "at" or "in" for a preset."""

_SOURCE = Path(__file__).with_name("language.lark")
_RULES = Path(__file__).with_name("language.rules")
_SYMBOLS = Path(__file__).with_name("language.symbols")


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


class RuleBook:
    """Rules by the first symbol of their right-hand sides, parsed when they are asked for.

    Attributes:
        symbols: All symbols, numbered by their position.

    Args:
        lines: The rules as lines of ``language.rules``.
        symbols: All symbols in the order of ``symbols_of``.
        left_out: Names of rules that do not count.
    """

    def __init__(self, lines: Sequence[str], symbols: Sequence[str], left_out: frozenset[str] = frozenset()) -> None:
        self.symbols = tuple(symbols)
        self._groups: dict[str, list[tuple[int, str]]] = {}
        order = 0
        for line in lines:
            _, name, _, _, first, *_ = line.split(" ", 5)
            if name not in left_out:
                self._groups.setdefault(first, []).append((order, line))
                order += 1

    def starting_with(self, symbol: str) -> list[tuple[int, Rule]]:
        """Return the rules whose right-hand side begins with a symbol, each with its position among all rules."""
        return [(order, Rule.read(line)) for order, line in self._groups.get(symbol, ())]


def load_rules(guesses: bool = True) -> RuleBook:
    """Return the rules of the current grammar.

    Args:
        guesses: Whether the rules in ``GUESSES`` count.
    """
    rules, symbols = compiled_lines(_SOURCE, _RULES), compiled_lines(_SOURCE, _SYMBOLS)
    if rules is None or symbols is None:
        rules, symbols = (text.splitlines()[1:] for text in compiled_texts().values())
    return RuleBook(rules, symbols[0 if guesses else 1].split(" "), frozenset() if guesses else GUESSES)


def symbols_of(rules: Sequence[Rule]) -> list[str]:
    """Return the symbols of rules in the order in which they first occur, right-hand sides first."""
    return list(dict.fromkeys(symbol for rule in rules for symbol in (*rule.symbols, rule.name)))


def compile_rules(source: str) -> list[Rule]:
    """Return a grammar's rules, with options, repetitions and groups expanded by Lark.

    A rule without symbols gets an empty one, which nothing matches.
    """
    from lark import Lark

    compiled = Lark(source, parser="earley", lexer="basic", maybe_placeholders=False).rules
    return [
        Rule(
            name := str(rule.origin.name),
            tuple(symbol.name for symbol in rule.expansion) or ("",),
            rule.options.priority or 0,
            str(rule.alias or name),
            "_" if name.startswith("_") else "?" if rule.options.expand1 and not rule.alias else "",
        )
        for rule in compiled
    ]


def compiled_texts() -> dict[Path, str]:
    """Return the expected content of ``language.rules``, and of ``language.symbols``: all symbols, then those without guesses."""
    rules = compile_rules(_SOURCE.read_text(encoding="utf-8"))
    sure = [rule for rule in rules if rule.name not in GUESSES]
    symbols = (" ".join(symbols_of(some)) for some in (rules, sure))
    return {path: "\n".join([heading(_SOURCE), *lines, ""]) for path, lines in ((_RULES, map(str, rules)), (_SYMBOLS, symbols))}


def renew() -> None:
    """Rewrite both files after the grammar was edited."""
    for path, text in compiled_texts().items():
        path.write_text(text, encoding="utf-8")
