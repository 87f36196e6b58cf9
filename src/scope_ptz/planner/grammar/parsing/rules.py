"""The rules of ``language.lark`` in the plain form that the chart parser needs, compiled by Lark ahead of time.

Lark needs about half a second to read and expand the grammar, which would delay every ``scope ask``. The expanded rules are
therefore stored in ``language.rules`` and their symbols in ``language.symbols``. A stored rule is parsed only when a symbol that
it begins with occurs. After the grammar is edited, the rules are compiled at each start until ``write_stored_rules()`` rewrites
the files.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from scope_ptz.planner.grammar.compiled import compiled_lines, heading

RULES_FOR_KNOWN_PRESETS = frozenset({"far_ref"})
"""Rules that are omitted from the grammar if the presets are unknown."""

_SOURCE = Path(__file__).with_name("language.lark")
_RULES = Path(__file__).with_name("language.rules")
_SYMBOLS = Path(__file__).with_name("language.symbols")


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


class RuleBook:
    """Rules by the first symbol on their right-hand side, parsed on request.

    Attributes:
        symbols: All symbols, numbered by their position.

    Args:
        lines: The rules as lines of ``language.rules``.
        symbols: All symbols in the order of ``symbols_of``.
        omitted: Names of rules to omit.
    """

    def __init__(self, lines: Sequence[str], symbols: Sequence[str], omitted: frozenset[str] = frozenset()) -> None:
        self.symbols = tuple(symbols)
        self._groups: dict[str, list[tuple[int, str]]] = {}
        order = 0
        for line in lines:
            _, name, _, _, first, *_ = line.split(" ", 5)
            if name not in omitted:
                self._groups.setdefault(first, []).append((order, line))
                order += 1

    def starting_with(self, symbol: str) -> list[tuple[int, Rule]]:
        """Return the rules whose right-hand side begins with a symbol, each with its position among all rules."""
        return [(order, Rule.from_line(line)) for order, line in self._groups.get(symbol, ())]


def load_rules(*, presets_known: bool = True) -> RuleBook:
    """Return the rules of the grammar, compiled if the stored ones are out of date."""
    rules, symbols = compiled_lines(_SOURCE, _RULES), compiled_lines(_SOURCE, _SYMBOLS)
    if rules is None or symbols is None:
        rules, symbols = (text.splitlines()[1:] for text in compiled_texts().values())
    return RuleBook(rules, symbols[0 if presets_known else 1].split(" "), frozenset() if presets_known else RULES_FOR_KNOWN_PRESETS)


def symbols_of(rules: Sequence[Rule]) -> list[str]:
    """Return the symbols of rules in the order in which they first occur, right-hand sides first."""
    return list(dict.fromkeys(symbol for rule in rules for symbol in (*rule.symbols, rule.name)))


def compile_rules(source: str) -> list[Rule]:
    """Return a grammar's rules, with options, repetitions and groups expanded by Lark.

    A rule without symbols gets an empty symbol, which nothing matches.
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
    """Return the content of ``language.rules`` and ``language.symbols`` by path.

    ``language.symbols`` has two lines: all symbols, and the symbols that remain if the presets are unknown.
    """
    rules = compile_rules(_SOURCE.read_text(encoding="utf-8"))
    without_presets = [rule for rule in rules if rule.name not in RULES_FOR_KNOWN_PRESETS]
    symbols = (" ".join(symbols_of(group)) for group in (rules, without_presets))
    return {path: "\n".join([heading(_SOURCE), *lines, ""]) for path, lines in ((_RULES, map(str, rules)), (_SYMBOLS, symbols))}


def write_stored_rules() -> None:
    """Rewrite ``language.rules`` and ``language.symbols`` after the grammar was edited."""
    for path, text in compiled_texts().items():
        path.write_text(text, encoding="utf-8")
