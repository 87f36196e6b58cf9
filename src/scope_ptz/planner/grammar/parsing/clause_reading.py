"""Read one clause after another, each with what the clauses before it leave out in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from scope_ptz.planner.grammar.instruction_tree import (
    Aim,
    Ask,
    AtPlaces,
    Back,
    Count,
    Forbid,
    GoToPreset,
    Linked,
    Mention,
    Move,
    Read,
    SameAt,
    Snap,
    Step,
    Sweep,
    Thing,
    Track,
    Turn,
    Unclear,
    Zoom,
    ZoomTo,
)
from scope_ptz.planner.grammar.parsing.asides import (
    explains,
    pointed_out,
)
from scope_ptz.planner.grammar.parsing.calculations import calculated
from scope_ptz.planner.grammar.parsing.parts.clause import DIRECTIONS, Clause, NotUnderstoodError, text_of
from scope_ptz.planner.grammar.parsing.parts.noun_phrases import thing_of
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start, search
from scope_ptz.planner.grammar.parsing.parts.preset_refs import places_of
from scope_ptz.planner.grammar.parsing.reader import Reader, bare_clause
from scope_ptz.planner.grammar.parsing.segments.clause_starts import GERUNDS

NO_END = Unclear("Until when shall I keep doing that?")
_SLIPS = frozenset({"er", "erm", "uh", "um", "uhm", "oops", "actually", "sorry", "no", "rather", "i_mean", "i_meant"})
"""Words with which someone corrects what they have just said."""


class ClauseReading:
    """Reads single clauses from left to right."""

    def __init__(self, reader: Reader, clauses: Sequence[Clause]) -> None:
        self.reader, self.clauses = reader, list(clauses)
        self.next = 0
        self.last: Step | None = None
        self.has_zoomed_in = False
        self.has_visited = self.has_left = False  # in this sentence: whether the camera went to a preset, and moved on from there

    def _peek(self, offset: int = 0) -> Clause | None:
        position = self.next + offset
        return self.clauses[position] if position < len(self.clauses) else None

    def _take(self) -> Clause:
        self.next += 1
        return self.clauses[self.next - 1]

    def _as_needed(self, clause: Clause, steps: tuple[Step, ...]) -> list[Linked]:
        """Return the steps of "zoom in if you have to": none, because a look that needs a closer view takes it by itself."""
        self._take()
        is_zoom = all(isinstance(s, Move) and all(isinstance(p, Zoom) for p in s.parts) for s in steps)
        if is_zoom and (self.next > 2 or self._peek() is not None):
            return []
        return [Linked(clause.link, Unclear("Shall I do that, or not?"))]

    def _read(self, clause: Clause) -> tuple[Step, ...]:
        """Return the steps of a clause, which may leave out the verb of the clause before: "..., then on the bin"."""
        if (
            (match := full_match("(at|in|from) (?P<places>_+)", clause.lexemes))
            and isinstance(self.last, Count | Ask | AtPlaces)
            and not clause.is_question
            and (places := places_of(self.reader.source, match["places"]))
        ):
            return (SameAt(places),)  # "count the people at the gate, and then at the yard"
        try:
            steps = self.reader.read(clause.lexemes, asked=clause.is_question)
        except NotUnderstoodError:
            if (thing := pointed_out(self.reader.source, clause, self._peek())) is not None:
                return (Mention(thing),)
            if explains(clause, len(self.clauses)):
                return ()
            if (step := self._without_verb(clause)) is None:
                raise
            steps = (step,)
        steps = self._checked(clause, steps)
        if self.last and clause.link and all(isinstance(step, Forbid) and step.any_move for step in steps) and steps:
            steps = ()  # "bring it up five degrees and hold"
        if isinstance(self.last, ZoomTo) and any(x.word in {"close_up", "closer_look", "a_closer_look"} for x in clause.lexemes):
            steps = tuple(step for step in steps if not isinstance(step, Move))  # "find the van, get a close-up"
        if len(steps) == 1 and isinstance(self.last, ZoomTo) and _is_open_ended(steps[0]):
            steps = (NO_END,)  # "search for a car, panning right 20 at a time"
        if len(steps) == 1 and isinstance(steps[0], Track) and not steps[0].thing.text and isinstance(self.last, Track):
            steps = ()  # "stay on the crane, tracking it"
        steps = self._with_clear_return(clause, steps)
        self.last = steps[-1] if steps else self.last
        return steps

    def _with_clear_return(self, clause: Clause, steps: tuple[Step, ...]) -> tuple[Step, ...]:
        """Return the steps of a clause. "Go to the gate, zoom in and return" is asked about: there are two places to return to."""
        if clause.link == ".":
            self.has_visited = self.has_left = False
        is_undo = any(x.has("UNDO", "ZOOM", "ZOOMNOUN") for x in clause.lexemes)
        if (
            self.has_left
            and clause.link != "then"
            and not is_undo
            and any(isinstance(s, Back) and not s.zoom_only and s.amount is None for s in steps)
        ):
            return (Unclear("Shall I take back only the last move, or go back to where I was before the preset?"),)
        for step in steps:
            is_tour = isinstance(step, AtPlaces) and not step.body
            self.has_left |= is_tour or (self.has_visited and isinstance(step, Move | ZoomTo | Track | GoToPreset))
            self.has_visited |= isinstance(step, GoToPreset)
        return steps

    def _checked(self, clause: Clause, steps: tuple[Step, ...]) -> tuple[Step, ...]:
        """Return the steps of a clause, or what else its words ask for in this place."""
        first = clause.lexemes[0] if clause.lexemes else None
        steps = tuple(calculated(clause.lexemes, step) for step in steps)
        same = full_match(f"HOWMANY BE (?!LEFT|RIGHT) (?P<state>FREE|ADVERB|{'|'.join(GERUNDS)})", clause.lexemes)
        if same and isinstance(self.last, Count) and len(words := self.last.things[-1].text.split()) in {1, 2} and len(steps) == 1:
            return (Count((Thing(f"{same['state'][0].word} {words[-1]}"),), self.last.view),)  # "... and how many are moving?"
        if (
            len(steps) == 1
            and first is not None
            and first.word in _SLIPS
            and clause.link in {",", "and"}
            and self.last is not None
            and (type(steps[0]) is type(self.last) or first.word in {"i_mean", "i_meant"})
        ):
            return (Unclear("Which of the two do you mean?"),)  # "go to the gate, er, the yard"
        is_visit = len(steps) == 1 and isinstance(steps[0], GoToPreset) and steps[0].how == "bare"
        if is_visit and first is not None and first.has("BE"):
            return (Ask(text_of(self.reader.source, clause.lexemes) + "?"),)  # "is this the gate?"
        if is_visit and match_start("(FILLER)* (this|that|it|SELF) BE ", clause.lexemes):
            return (Unclear("Shall I go there?"),)  # "this is the gate"
        if is_visit and first is not None and first.word in {"what_about", "how_about"} and self.last is None:
            return (Unclear("What shall I look for there?"),)
        words = [x.word for x in clause.lexemes]
        if is_visit and words[:1] == ["one"]:
            return (*steps, Snap())  # "a shot of the gate and one of the yard"
        if words[-2:] == ["take", "one"] and isinstance(self.last, Snap):
            return ()  # "my boss wants a photo of the trailer, so take one"
        moves = bool(steps) and all(isinstance(step, Move | Snap) for step in steps)
        zooms = [part for step in steps if isinstance(step, Move) for part in step.parts if isinstance(part, Zoom)] if moves else []
        is_in = bool(match_start("(FILLER|WRAPPER)* ZOOM IN", clause.lexemes))
        if is_in and any(part.kind == "factor" and part.value < 1 for part in zooms):
            return (Unclear("Shall I zoom in or out?"),)  # "zoom in half"
        is_aimed = isinstance(self.last, Move) and all(isinstance(part, Aim) and part.axis == "zoom" for part in self.last.parts)
        is_undirected = not any(x.has(*DIRECTIONS, "MORE") for x in clause.lexemes) and clause.link in {",", "and"}
        turns = moves and all(isinstance(part, Turn) for step in steps if isinstance(step, Move) for part in step.parts)
        if turns and is_aimed and is_undirected and isinstance(steps[0], Move):
            return (Unclear("Is that the angle to turn to, or the angle to turn by?"),)  # "set zoom 4x, pan 10 and tilt -5"
        if moves and [x.word for x in clause.lexemes[:2]] == ["make", "that"]:
            return (Unclear("Which way shall I turn, and how far?"),)  # a correction of something that was not said
        if moves and self.has_zoomed_in and any(x.word == "back_out" for x in clause.lexemes) and not search("NUM", clause.lexemes):
            return (Back(zoom_only=True),)  # "zoom in 4x, take a picture, zoom back out"
        if moves:
            self.has_zoomed_in |= any(isinstance(p, Zoom) and p.value > 1 for s in steps if isinstance(s, Move) for p in s.parts)
        is_search = len(steps) == 1 and isinstance(steps[0], ZoomTo) and first is not None and first.has("FIND")
        if is_search and isinstance(steps[0], ZoomTo) and isinstance(self.last, Sweep):
            return (Count((steps[0].thing,), "full"),)  # "sweep round and look for a ladder"
        return steps

    def _without_verb(self, clause: Clause) -> Step | None:
        """Return the step of the clause before with another thing; None if the clause is not a noun phrase."""
        match = full_match(r"(on|onto|at|to|for|of)? (?P<thing>_+)", bare_clause(clause.lexemes))
        thing = thing_of(self.reader.source, match["thing"]) if match else None
        if thing is None or not thing.text or clause.lexemes[-1].word in {"away", "off", "back"}:
            return None
        match self.last:
            case ZoomTo() | Read():
                return replace(self.last, thing=thing)
            case Count():
                return replace(self.last, things=(thing,))
        return None

    def _ended(self, clause: Clause, steps: tuple[Step, ...]) -> list[Linked]:
        """Return the linked steps of a clause. "Keep panning" without an end is asked about."""
        keeps = bool(clause.lexemes) and any(
            x.has("KEEP") and x.word.startswith(("keep", "carry_on", "continue")) for x in clause.lexemes[:2]
        )
        if keeps and any(
            isinstance(step, Move) and all(isinstance(p, Turn) and p.amount is None for p in step.parts) for step in steps
        ):
            return [Linked(clause.link, NO_END)]
        link = clause.link
        return [Linked(link if i == 0 else "and", step) for i, step in enumerate(steps)]

    def _is_trailing(self) -> bool:
        """Return whether the condition that comes next belongs to the clause before it, and not to the clauses after it."""
        condition, after = self._peek(), self._peek(1)
        if condition is None:
            return False
        if condition.link == "":
            return True
        return after is None or after.link == "." or after.marker == "IFNOT"


def _is_open_ended(step: Step) -> bool:
    """Return whether a move states the size of a step, but not how far to go."""
    return isinstance(step, Move) and any(isinstance(part, Turn) and part.step and not part.amount for part in step.parts)
