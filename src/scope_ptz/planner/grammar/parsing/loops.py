"""Read loops: "pan right until you see a van", "while there are no cars, pan right 10"."""

from __future__ import annotations

from scope_ptz.planner.grammar.instruction_tree import (
    AtPlaces,
    Bound,
    FirstWith,
    Forbid,
    Linked,
    Loop,
    Move,
    Report,
    Step,
    Track,
    Turn,
    Unclear,
    ZoomTo,
)
from scope_ptz.planner.grammar.instruction_tree.conditions import Negated, Quantity, Seen
from scope_ptz.planner.grammar.parsing.branches import BranchReader, bound_of
from scope_ptz.planner.grammar.parsing.compose import compose
from scope_ptz.planner.grammar.parsing.parts.clause import Clause, NotUnderstoodError
from scope_ptz.planner.grammar.parsing.parts.noun_phrases import thing_of
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match

FOLLOWS_FOR_A_TIME = "I follow things for a time that you give me. For how many seconds shall I follow it?"
"""The question about "follow him until he stops": what ends it is not looked for while the camera follows."""

_CENTRED = "(?P<thing>_+?) BE (CENTREWORD|in (DET)? (centre|center|middle|CENTREWORD) (of DET (PICTURE|VIEWNOUN|frame))?) (FILLER)*"
"""An "until" condition that a thing is centred: "the van is in the centre of the picture"."""


class LoopReader(BranchReader):
    """Reads loops with their conditions and limits."""

    def _loop(self, clause: Clause, steps: tuple[Step, ...]) -> Step:
        """Return the loop for a clause and the "until ..." that follows it."""
        until = self._take()
        if any(isinstance(step, Track) for step in steps):
            return Unclear(FOLLOWS_FOR_A_TIME)
        is_turn = full_match("(KEEP|FILLER|CAMERA|DET)* (PAN|TURN|PAN-ING|TURN-ING) (AROUND|FILLER|CAMERA|DET)*", clause.lexemes)
        if is_turn and self._peek() is None and (centred := full_match(_CENTRED, until.lexemes)):
            thing = thing_of(self.reader.source, centred["thing"])
            if thing is not None and thing.text:
                return ZoomTo(thing)  # "pan until the excavator is in the middle"
        condition, places = self._condition(until)
        if places or not steps:
            raise NotUnderstoodError(until.lexemes)
        if (
            isinstance(steps[0], AtPlaces)
            and not steps[0].body
            and isinstance(condition, Seen)
            and condition.quantity == Quantity()
        ):
            return FirstWith(condition.thing, steps[0].places)  # "go round the presets, stopping as soon as you see a wheelchair"
        if isinstance(steps[0], Unclear) and full_match(
            "(KEEP|FILLER|CAMERA|it|DET)* (PAN|TURN|SCAN|PAN-ING|TURN-ING|SCAN-ING) (AROUND|FILLER|CAMERA|DET)*", clause.lexemes
        ):
            steps = (Move((Turn("pan", 1),)),)  # "pan until ..." pans right
        if all(isinstance(step, Forbid | Report) for step in steps):
            return Unclear("I cannot wait for something to happen. Shall I look for it now?")
        if until.marker == "WHILE":
            condition = Negated(condition)
        bound: Bound | None = None
        while (after := self._peek()) is not None and (found := bound_of(after)) is not None:
            self._take()
            bound = found
        otherwise: list[Step] = []
        if after is not None and after.marker == "IFNOT":
            self._take()
            if after.lexemes:
                otherwise = compose([Linked("", s) for s in self.reader.read(after.lexemes)], otherwise)
            otherwise = self._block(otherwise)
        return Loop(tuple(steps), condition, bound, tuple(otherwise))

    def _loop_ahead(self, clause: Clause) -> Step:
        """Return the loop for "while there are no cars, pan right 10"."""
        condition, places = self._condition(clause)
        body = self._block([])
        if places or not body:
            raise NotUnderstoodError(clause.lexemes)
        bound = bound_of(after) if (after := self._peek()) is not None else None
        if bound is not None:
            self._take()
        return Loop(tuple(body), Negated(condition) if clause.marker == "WHILE" else condition, bound)
