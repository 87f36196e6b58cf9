"""Combine the clauses of a tour of presets and of a repeated list of steps."""

from __future__ import annotations

from scope_ptz.planner.grammar.instruction_tree import (
    Ask,
    Count,
    EachTime,
    GoToPreset,
    Linked,
    Move,
    Read,
    Repeat,
    Snap,
    Step,
    Track,
    Unclear,
    ZoomTo,
)
from scope_ptz.planner.grammar.parsing.compose import compose
from scope_ptz.planner.grammar.parsing.loops import LoopReader
from scope_ptz.planner.grammar.parsing.parts.clause import Clause, Source, trimmed
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start
from scope_ptz.planner.grammar.parsing.parts.preset_refs import places_of

_LOOKS = (Ask, Count, Read, Snap)
"""Steps that are carried out at each of several presets visited one by one."""


class TourReader(LoopReader):
    """Reads tours, such as "the gate and the yard, and count the cars at each", and "three times: pan left, take a picture"."""

    def _tour(self, clause: Clause, steps: tuple[Step, ...]) -> list[Linked] | None:
        """Return the steps of a clause that visits presets one by one, with what to do at each; None for other clauses."""
        if not steps or not all(isinstance(step, GoToPreset) for step in steps):
            return None
        size = 0  # number of further presets in the list that the clause begins
        while (other := self._peek(size)) is not None and _lists_place(self.reader.source, other):
            size += 1
        listed = self.clauses[self.next_index : self.next_index + size]
        act = self._peek(size)
        is_each = any(x.has("EVERY") for x in clause.lexemes)
        is_in_turn = any(x.has("INTURN") for part in (clause, *listed) for x in part.lexemes)
        links = {",", "and", ":", "then"} if is_each else {",", "and", ":"} if is_in_turn else {":"}
        if len(steps) + size < 2 or act is None or act.marker or act.link not in links:
            return None
        if any(x.has("HOWMANYMORE", "LEADMORE", "SUPERLATIVE", "THAN") for x in act.lexemes) and not (is_each or is_in_turn):
            return None  # "gate and yard: how many more cars does the first one show?"
        visits = list(steps)
        for _ in range(size):
            visits += self._read(self._take())
        each = list(self._read(self._take()))  # "look at each of gate and yard and count the people there"
        if any(isinstance(step, Move | ZoomTo | Track) for step in each):
            return [Linked(clause.link, Unclear("Shall I do that at each of them, or only at the last one?"))]
        if not all(isinstance(step, _LOOKS) for step in each):
            return [*self._linked_steps(clause, tuple(visits)), *(Linked(act.link, step) for step in each)]
        rest: list[Step] = []
        while not rest and (more := self._peek()) is not None and more.link == "and" and not more.marker:
            steps = self._read(self._take())
            (each if all(isinstance(step, _LOOKS) for step in steps) else rest).extend(steps)
        return [
            *self._linked_steps(clause, tuple(visits)),
            Linked(",", EachTime(tuple(each))),
            *(Linked("and", step) for step in rest),
        ]

    def _lists_pictures(self, steps: tuple[Step, ...]) -> bool:
        """Return whether the next clauses state the subjects of pictures: "two pictures, one of the barn and one of the silo"."""
        step = steps[0] if len(steps) == 1 else None
        if not isinstance(step, Snap) or step.of is not None or step.times < 2:
            return False
        listed = [self._peek(offset) for offset in range(step.times)]
        return all(
            clause is not None
            and not clause.marker
            and match_start("(one|another|another_one|ANOTHER) (of|at|from) _", clause.lexemes)
            for clause in listed
        )

    def _repeated_list(self, clause: Clause) -> Step | None:
        """Return the repetition for "three times: pan left 20 and count the cars"; None for other clauses."""
        match = full_match(
            (
                r"(FILLER|(do|execute|perform|carry_out|run) (DET following|this|that|it)?|REPEAT|REPEAT SELF)* "
                r"((?P<number>NUM) X|X (?P<number>NUM)|(?P<twice>TWICE)|"
                r"(?P<thrice>THRICE)) "
                r"(COMMA|FILLER|do this|INTURN)*"
            ),
            clause.lexemes,
        )
        after = self._peek()
        if not match or clause.link not in {"", "."} or after is None or after.link not in {":", ","}:
            return None
        times = round(match["number"][0].value) if match["number"] else 2 if match.has("twice") else 3
        body: list[Step] = []
        while self.next_index < len(self.clauses) and (not body or self.clauses[self.next_index].link not in {"."}):
            body = compose(self._linked(), body)
        return Repeat(tuple(body), max(1, min(times, 50)))


def _lists_place(source: Source, clause: Clause) -> bool:
    """Return whether a clause only names another preset of a list: "..., yard and reception"."""
    lexemes = trimmed(clause.lexemes, "INTURN", "FILLER", "COMMA")
    return clause.link in {",", "and"} and not clause.marker and not clause.is_question and bool(places_of(source, lexemes))
