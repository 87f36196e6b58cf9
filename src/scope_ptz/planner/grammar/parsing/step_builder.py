"""Build the steps of ``instruction_tree`` from the parse tree, with one method for each rule of ``language.lark``.

The rules about motion are in ``move_builder``, those about presets, objects and questions in ``scene_builder``, and those about
conditions and comparisons in ``condition_builder``.
"""

# ruff: noqa: ARG002 - all rule methods share one signature

from __future__ import annotations

from dataclasses import replace
from typing import Any

from scope_ptz.planner.grammar.instruction_tree import (
    Amount,
    Answered,
    AtIntervals,
    AtPlaces,
    Between,
    Bound,
    Condition,
    Count,
    DoAgain,
    EachTime,
    FirstWith,
    Forbid,
    Further,
    GoToPreset,
    If,
    Linked,
    Loop,
    Move,
    Negated,
    Repeat,
    Report,
    SameAt,
    Seen,
    Snap,
    Step,
    Sweep,
    Turn,
    Unclear,
)
from scope_ptz.planner.grammar.parsing.chart import Branch, Leaf
from scope_ptz.planner.grammar.parsing.compose import compose
from scope_ptz.planner.grammar.parsing.condition_builder import ConditionBuilder
from scope_ptz.planner.grammar.parsing.move_builder import MoveBuilder, StepSize
from scope_ptz.planner.grammar.parsing.tree_nodes import Node

_LINK_OF_TERMINAL = {"AND": "and", "COMMA": ",", "THEN": "then"}


class StepBuilder(MoveBuilder, ConditionBuilder):
    """Visitor that builds all steps of one instruction."""

    def extend(self, tree: Branch, before: list[Step]) -> list[Step]:
        """Return the steps of a sentence combined with the steps before it."""
        return compose(self._linked(Node(tree)), before)

    def _linked(self, node: Node) -> list[Linked]:
        """Return the steps of a sentence with the links between them."""
        out: list[Linked] = []
        link = "." if node.name == "sentence" else ""
        for part in node.branch.children:
            child = Node(part) if isinstance(part, Branch) else None
            if child is not None and child.name == "reason_words":
                continue
            if child is None or child.name == "sep":
                kind = part.kind if isinstance(part, Leaf) else Node(part).leaf_kinds()[0]
                link = _LINK_OF_TERMINAL.get(kind, "")
                continue
            for step in self._as_steps(self.visit(child)):
                out.append(Linked(link, step))
                link = "then"
        return out

    @staticmethod
    def _as_steps(result: Any) -> tuple[Step, ...]:
        return result if isinstance(result, tuple) else (result,)

    def _body(self, node: Node, index: int) -> tuple[Step, ...]:
        """Return the steps of the child branch at ``index``."""
        return self._as_steps(self.visit(node.branches()[index]))

    # Steps -------------------------------------------------------------------------------------------------------------
    def plain(self, node: Node) -> Any:
        return self.visit(node.branches()[0])

    def block(self, node: Node) -> tuple[Step, ...]:
        return tuple(compose(self._linked(node), []))

    def repeated(self, node: Node) -> Step:
        parts = [self.visit(b) for b in node.branches()]
        times = next(p for p in parts if isinstance(p, int) and not isinstance(p, bool))
        body = self._as_steps(next(p for p in parts if not isinstance(p, int | Amount | StepSize)))
        if sizes := [p for p in parts if isinstance(p, Amount | StepSize)]:
            return self._repeated_by(body, times, sizes[0])
        return Repeat(body, times, group=node.has("COMMA"))

    def repeated_each(self, node: Node) -> tuple[Step, ...]:
        """Build "pan left 20 three times taking a picture after each"."""
        return (*self._body(node, 0), EachTime(self._body(node, 1)))

    @staticmethod
    def _repeated_by(body: tuple[Step, ...], times: int, size: Amount | StepSize) -> Step:
        """Build "turn left twice by 30"."""
        amount = size if isinstance(size, Amount) else size.size
        move = body[0]
        if len(body) > 1 or not isinstance(move, Move) or not all(isinstance(p, Turn) and p.amount is None for p in move.parts):
            return Unclear("How far shall I move each time?")
        return Repeat((Move(tuple(replace(p, amount=amount) for p in move.parts if isinstance(p, Turn))),), times)

    def _loop(self, node: Node, negate: bool = False) -> Step:
        condition: Condition | None = None
        bound: Bound | None = None
        otherwise: tuple[Step, ...] = ()
        body: tuple[Step, ...] = ()
        for branch in node.branches():
            result = self.visit(branch)
            if branch.name == "block":
                otherwise = result
            elif isinstance(result, Bound):
                bound = result
            elif isinstance(result, Condition):
                condition = result
            else:
                body = self._as_steps(result)
        if condition is None:
            raise TypeError("a loop must have a condition")
        return Loop(body, Negated(condition) if negate else condition, bound, otherwise)

    def loop(self, node: Node) -> Step:
        return self._loop(node)

    loop_bound = loop_first = loop

    def loop_while(self, node: Node) -> Step:
        return self._loop(node, negate=True)

    loop_while_first = loop_while

    def each_time(self, node: Node) -> Step:
        return EachTime(self._body(node, 0))

    def with_picture(self, node: Node) -> tuple[Step, ...]:
        return (*self._body(node, 0), EachTime((Snap(),)))

    def before_first(self, node: Node) -> tuple[Step, ...]:
        return (*self._body(node, 1), *self._body(node, 0))

    def before(self, node: Node) -> tuple[Step, ...]:
        return (*self._body(node, 0), *self._body(node, 1))

    after_first = before
    after = before_first

    def if_then(self, node: Node) -> Step:
        condition, *blocks = (self.visit(b) for b in node.branches())
        return If(condition, blocks[0], blocks[1] if len(blocks) > 1 else ())

    def if_at(self, node: Node) -> Step:
        """Build "if there are no cars at gate, ...": the condition is tested at that place."""
        condition, places, *blocks = (self.visit(b) for b in node.branches())
        return AtPlaces(places, (If(condition, blocks[0], blocks[1] if len(blocks) > 1 else ()),))

    def unless_at(self, node: Node) -> Step:
        """Build "unless there are cars at gate, ...": the condition is tested at that place."""
        condition, places, block = (self.visit(b) for b in node.branches())
        return AtPlaces(places, (If(Negated(condition), block),))

    def first_with(self, node: Node) -> Step:
        """Build "go through the presets and stop at the first with a crane"."""
        places = next(self.visit(b) for b in node.branches("every_place", "place_list"))
        return FirstWith(self._thing(node), places)

    def snap_each(self, node: Node) -> Step:
        return EachTime((Snap(),))

    def if_so(self, node: Node) -> Step:
        blocks = [self.visit(b) for b in node.branches()]
        return If(Answered(), blocks[0], blocks[1] if len(blocks) > 1 else ())

    def correction(self, node: Node) -> Step:
        return Unclear("You changed your mind half way. Which of the two do you want?")

    def if_not(self, node: Node) -> Step:
        return If(Negated(Answered()), self.visit(node.branches()[-1]))

    def in_between(self, node: Node) -> tuple[Step, ...]:
        return (*self._body(node, 0), Between(self._body(node, 1)))

    def between_alone(self, node: Node) -> Step:
        return Between(self._body(node, 0))

    def at_intervals(self, node: Node) -> Step:
        """Build "take a photo every 30 degrees while panning right 90"."""
        if any(not self.words_of(leaf).startswith(("every", "each")) for b in node.branches("every") for leaf in b.leaves()):
            return Unclear("How far apart shall that be?")
        branches = [b for b in node.branches() if b.name != "every"]
        size = next(i for i, b in enumerate(branches) if b.name.startswith("angle"))
        body = self._as_steps(self.visit(branches[0]))
        moves = self._as_steps(self.visit(branches[size + 1])) if len(branches) > size + 1 else ()
        move = next((m for m in moves if isinstance(m, Move)), None)
        if any(isinstance(s, Move) for s in body) or (moves and move is None):
            return Unclear("What shall I do at each of these steps, and which way shall I turn?")
        return AtIntervals(body, abs(self.visit(branches[size])), move)

    def stepped_first(self, node: Node) -> Step:
        """Build "in 10 degree steps, pan right 40"."""
        size, move = (self.visit(b) for b in node.branches())
        if not isinstance(move, Move):
            return move  # type: ignore[no-any-return]
        return Move(
            tuple(replace(p, step=size.size, steps=size.count) if isinstance(p, Turn) else p for p in move.parts), move.has_verb
        )

    def do_each(self, node: Node) -> Step:
        *places, act = node.branches()
        return AtPlaces(tuple(self.visit(place) for place in places), self._as_steps(self.visit(act)))

    def each_time_that(self, node: Node) -> tuple[Step, ...]:
        """Build "take a picture every time you pan right": a picture after each move."""
        return (*self._body(node, 1), EachTime(self._body(node, 0)))

    def find_by(self, node: Node) -> Step:
        thing, move = (self.visit(b) for b in node.branches())
        return Loop((move,), Seen(thing))

    def unless_then(self, node: Node) -> Step:
        condition, *blocks = (self.visit(b) for b in node.branches())
        return If(Negated(condition), blocks[0], blocks[1] if len(blocks) > 1 else ())

    def if_last(self, node: Node) -> Step:
        act, condition, *block = (self.visit(b) for b in node.branches())
        return If(condition, self._as_steps(act), block[0] if block else ())

    def unless_last(self, node: Node) -> Step:
        act, condition, *block = (self.visit(b) for b in node.branches())
        return If(Negated(condition), self._as_steps(act), block[0] if block else ())

    def do_at(self, node: Node) -> Step:
        """Build "at gate, count the cars", in either order."""
        parts = [b for b in node.branches() if b.name != "visit"]
        places, act = sorted(parts, key=lambda b: b.name not in {"every_place", "place_list"})
        return AtPlaces(self.visit(places), self._as_steps(self.visit(act)))

    def same_at(self, node: Node) -> Step:
        return SameAt(self.visit(node.branches()[0]))

    def count_at(self, node: Node) -> tuple[Step, ...]:
        """Build "count cars at gate and trucks at highway"."""
        result = [self.visit(b) for b in node.branches("np", "named", "numbered", "marked", "unmarked", "known_ref")]
        return tuple(AtPlaces((place,), (Count((thing,)),)) for thing, place in zip(result[::2], result[1::2], strict=True))

    def visit_places(self, node: Node) -> Any:
        places = self.visit(node.branches()[-1])
        if len(places) == 1:
            return GoToPreset(places[0])
        return AtPlaces(places, ())

    def roam(self, node: Node) -> Step:
        """Build "pan until ..." without a direction, which pans right."""
        return Move((Turn("pan", 1),))

    def report(self, node: Node) -> Step:
        return Report()

    def further(self, node: Node) -> Step:
        """Build "then another 15", which continues in the same direction."""
        return Further(Amount("degrees", self.number(node)))

    def further_little(self, node: Node) -> Step:
        return Further(Amount("little"))

    def forbidden(self, node: Node) -> Step:
        return Forbid()

    def stay(self, node: Node) -> Step:
        return Forbid(any_move=True)

    def done_again(self, node: Node) -> Step:
        return DoAgain(self.visit(node.branches()[0]), more=node.has("MORE"))

    def do_again(self, node: Node) -> Step:
        return DoAgain()

    def sweep(self, node: Node) -> Step:
        words = " ".join(self.words_of(leaf) for leaf in node.leaves("SWEEP"))
        return Sweep(turn="360" in words)

    # Quantities --------------------------------------------------------------------------------------------------------
    def n_times(self, node: Node) -> int:
        return max(1, min(round(self.number(node)), 50))

    def twice(self, node: Node) -> int:
        return self.repeat_count(node)

    def once(self, node: Node) -> int:
        return 1

    def at_most(self, node: Node) -> Bound:
        if node.has("NUM"):
            return Bound(moves=max(1, round(self.number(node))))
        return Bound(moves=1 if node.has("ONCE") else self.repeat_count(node))

    def at_most_degrees(self, node: Node) -> Bound:
        return Bound(degrees=abs(self.number(node)))

    def no_bound(self, node: Node) -> Bound:
        return Bound()
