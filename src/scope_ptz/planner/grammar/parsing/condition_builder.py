"""Build conditions and comparisons from the parse tree."""

# ruff: noqa: ARG002 - all rule methods share one signature

from __future__ import annotations

from typing import Any

from scope_ptz.planner.grammar.instruction_tree import (
    BeforeAfter,
    Compare,
    CompareWithBefore,
    Condition,
    Joined,
    Negated,
    Outnumbers,
    PresetOutnumbers,
    Quantity,
    Readable,
    Seen,
    Statement,
    Step,
    Thing,
    Unclear,
    WhichPreset,
)
from scope_ptz.planner.grammar.parsing.scene_builder import SCOPES, SceneBuilder, described
from scope_ptz.planner.grammar.parsing.tree_nodes import Node


class ConditionBuilder(SceneBuilder):
    """Visitor that builds conditions, and steps that compare counts."""

    # Conditions --------------------------------------------------------------------------------------------------------

    def seen(self, node: Node) -> Condition:
        quantity = next(
            (q for b in node.branches() if isinstance(q := self.visit(b) if b.name not in {"np", *SCOPES} else None, Quantity)),
            Quantity(),
        )
        return Seen(self._thing(node), quantity, self._view(node))

    seen_pronoun = seen
    seen_swapped = seen

    def unseen(self, node: Node) -> Condition:
        return Seen(self._thing(node), Quantity("==", 0), self._view(node))

    unseen_pronoun = unseen

    def seen_someone(self, node: Node) -> Condition:
        return Seen(self._people(node), Quantity(), self._view(node))

    def unseen_someone(self, node: Node) -> Condition:
        return Seen(self._people(node), Quantity("==", 0), self._view(node))

    def _people(self, node: Node) -> Thing:
        """Build "people in the lane" for "anyone in the lane"."""
        return Thing(described(" ".join(["people", *(self.text(b.all_leaves()) for b in node.branches("words"))])))

    def unseen_both(self, node: Node) -> Condition:
        return Joined(tuple(Seen(thing, Quantity("==", 0), self._view(node)) for thing in self._things(node)), "all")

    def not_so_many(self, node: Node) -> Condition:
        return Negated(Seen(self._thing(node), self.visit(node.branches("quantity_said")[0].branches()[0]), self._view(node)))

    def readable(self, node: Node) -> Condition:
        return Readable(self._thing(node))

    def holds(self, node: Node) -> Condition:
        return self._statement(node, True)

    def holds_not(self, node: Node) -> Condition:
        return self._statement(node, False)

    def _statement(self, node: Node, expected: bool) -> Condition:
        """Build a question for "the gate is open", but a count for "any worker is not wearing a helmet"."""
        thing, predicate = self._thing(node), self.text(node.branches("words")[0].all_leaves())
        if any(np.has("ANY") for b in node.branches("subject") for np in b.branches("np")):
            return Seen(Thing(f"{thing.text} {'' if expected else 'not '}{predicate}"))
        return Statement(thing, predicate, expected)

    def says(self, node: Node) -> Condition:
        text = self.text(node.branches("words")[0].all_leaves())
        return Statement(self._thing(node), text, question=f"does the {self._thing(node).text} say {text}?")

    def preset_wins(self, node: Node) -> Condition:
        first, second = (self.visit(b) for b in node.branches("named", "numbered", "marked"))
        return PresetOutnumbers(self._thing(node), first, second, self._comparison(node))

    def outnumbers(self, node: Node) -> Condition:
        first, second = self._things(node)[:2]
        return Outnumbers(first, second, self._comparison(node))

    def all_of(self, node: Node) -> Condition:
        return Joined(tuple(self.visit(b) for b in node.branches()), "all")

    def any_of(self, node: Node) -> Condition:
        return Joined(tuple(self.visit(b) for b in node.branches()), "any")

    def _quantity(self, node: Node, operator: Any) -> Quantity:
        return Quantity(operator, self.number(node) if node.has("NUM") else 1)

    def at_least(self, node: Node) -> Quantity:
        return self._quantity(node, ">=")

    def no_more_than(self, node: Node) -> Quantity:
        return self._quantity(node, "<=")

    def more_than(self, node: Node) -> Quantity:
        return self._quantity(node, ">")

    def fewer_than(self, node: Node) -> Quantity:
        return self._quantity(node, "<")

    def exactly(self, node: Node) -> Quantity:
        return self._quantity(node, "==")

    def several(self, node: Node) -> Quantity:
        return Quantity(">=", 2)

    def any_number(self, node: Node) -> Quantity:
        return Quantity()

    # Comparison --------------------------------------------------------------------------------------------------------
    def which_preset(self, node: Node) -> Step:
        return WhichPreset(self._thing(node), self._comparison(node), self._places(node))

    def preset_with(self, node: Node) -> Step:
        return WhichPreset(self._thing(node), "more", self._places(node), any_of=True)

    preset_than = more_at = compare_at = compare_at_last = compare_pair = which_preset

    def busier(self, node: Node) -> Step:
        return Unclear("What shall I count to tell which is busier: vehicles or people?")

    def than_before(self, node: Node) -> Step:
        return CompareWithBefore(self._thing(node), self._comparison(node))

    def compare_things(self, node: Node) -> Step:
        first, second = self._things(node)[:2]
        return Compare(first, second, self._comparison(node), self._view(node))

    def compare_where(self, node: Node) -> Step:
        thing = self.visit(node.branches("np")[0]).text
        first = self.text(node.branches("near_words")[0].all_leaves())
        side = node.branches("side")[0]
        second = self.text(side.all_leaves())
        if not side.branches("near_words"):
            second = f"{first.split(' ')[0]} {second}"
        return Compare(Thing(f"{thing} {first}"), Thing(f"{thing} {second}"), self._comparison(node), self._view(node))

    def before_after(self, node: Node) -> Step:
        moves = self.visit(node.branches("move")[0])
        return moves if isinstance(moves, Unclear) else BeforeAfter(self._thing(node), (moves,), self._comparison(node))

    reveals = before_after
