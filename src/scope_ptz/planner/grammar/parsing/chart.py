"""A weighted chart parser for a grammar that Lark has compiled.

Lark's own parsers are not suitable. Camera instructions are ambiguous ("left" is a direction, a side or a verb, and any word may be
part of a description), which rules out a deterministic LALR parser. Lark's Earley parser takes 100 to 900 ms for an instruction,
because it predicts every alternative of every optional word at every position.

Lark is therefore used only to read, check and expand the grammar. In this parser, right-hand sides share a prefix tree, and only
constituents that can begin with the given lexemes are tried, bottom-up, which takes a few milliseconds. The parser returns the
reading with the highest sum of rule priorities; ties go to the reading with the fewest rules.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field

from scope_ptz.planner.grammar.parsing.rules import Rule, RuleBook

_RULE_COST = 1e-3  # prefers readings with fewer rules
_ORDER_COST = 1e-8  # prefers rules that come earlier in the grammar


@dataclass(slots=True)
class _Node:
    """A node of the prefix tree: its child for each next symbol, and the rules whose right-hand side ends here."""

    children: dict[int, _Node] = field(default_factory=dict)
    complete: list[tuple[int, float, Rule]] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class Leaf:
    """A terminal in a parse tree. ``index`` is the position of its lexeme."""

    kind: str
    index: int


@dataclass(frozen=True, slots=True)
class Branch:
    """An applied rule in a parse tree. ``name`` is the alias of the rule, or its name if it has none."""

    name: str
    children: tuple[Leaf | Branch, ...]


_Link = tuple["_Link | None", int, int, int]  # previous link, symbol, start, end
_Best = tuple[float, _Link | None, Rule | None]  # score, last link, rule


class ChartParser:
    """A parser of sequences of lexemes. Each lexeme is given as the set of terminals that it may match."""

    def __init__(self, rules: RuleBook) -> None:
        self._rules = rules
        self._names = rules.symbols
        self._ids = {name: number for number, name in enumerate(rules.symbols)}
        self._first: dict[int, _Node] = {}

    def _read_first(self, symbol: int) -> _Node:
        """Read the rules that begin with a symbol, and return their first node."""
        first = _Node()
        for order, rule in self._rules.starting_with(self._names[symbol]):
            node = first
            for following in rule.symbols[1:]:
                node = node.children.setdefault(self._ids[following], _Node())
            gain = rule.priority - _RULE_COST - _ORDER_COST * order
            node.complete.append((self._ids[rule.name], gain, rule))
        self._first[symbol] = first
        return first

    def parse(self, lexemes: Sequence[Collection[str]], start: str) -> Branch | None:
        """Return the best parse tree of the lexemes, whose root is the rule ``start``; None if there is none."""
        n = len(lexemes)
        chart: list[dict[int, dict[int, _Best]]] = [{} for _ in range(n + 1)]
        for i in range(n - 1, -1, -1):
            self._fill(chart, i, [self._ids[kind] for kind in sorted(lexemes[i]) if kind in self._ids])
        if n not in chart[0].get(self._ids[start], {}):
            return None
        tree = self._tree(chart, self._ids[start], 0, n)
        return tree[0] if isinstance(tree[0], Branch) else None

    def _fill(self, chart: list[dict[int, dict[int, _Best]]], i: int, terminals: list[int]) -> None:
        """Find all constituents that start at ``i``, given all that start later."""
        here = chart[i]
        reached: dict[tuple[int, int], float] = {}
        agenda: list[tuple[int, int]] = []
        for terminal in terminals:
            here.setdefault(terminal, {})[i + 1] = (0.0, None, None)
            agenda.append((terminal, i + 1))
        while agenda:
            symbol, end = agenda.pop()
            node = self._first.get(symbol) or self._read_first(symbol)
            edges: list[tuple[_Node, int, float, _Link]] = [(node, end, here[symbol][end][0], (None, symbol, i, end))]
            while edges:
                node, end, score, link = edges.pop()
                key = (id(node), end)
                if reached.get(key, float("-inf")) >= score:
                    continue
                reached[key] = score
                for parent, gain, rule in node.complete:
                    ends = here.setdefault(parent, {})
                    if end not in ends or ends[end][0] < score + gain:
                        ends[end] = (score + gain, link, rule)
                        agenda.append((parent, end))
                later = chart[end]
                for following in node.children.keys() & later.keys():
                    child = node.children[following]
                    for next_end, best in later[following].items():
                        edges.append((child, next_end, score + best[0], (link, following, end, next_end)))

    def _tree(self, chart: list[dict[int, dict[int, _Best]]], symbol: int, start: int, end: int) -> list[Leaf | Branch]:
        """Return the nodes that a constituent contributes to its parent: one node, or its children (see ``Rule.inline``)."""
        _, link, rule = chart[start][symbol][end]
        if rule is None:
            return [Leaf(self._names[symbol], start)]
        parts: list[list[Leaf | Branch]] = []
        while link is not None:
            link, child, child_start, child_end = link
            parts.append(self._tree(chart, child, child_start, child_end))
        children = [node for part in reversed(parts) for node in part]
        if rule.inline == "_" or (rule.inline == "?" and len(children) == 1):
            return children
        return [Branch(rule.label, tuple(children))]
