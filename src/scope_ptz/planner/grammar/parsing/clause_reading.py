"""Read clauses one after another, and fill in what a clause leaves out because an earlier clause states it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from scope_ptz.planner.grammar.instruction_tree import (
    Aim,
    Ask,
    AtIntervals,
    AtPlaces,
    Back,
    Count,
    EachTime,
    Forbid,
    GoToPreset,
    Linked,
    ListPresets,
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
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.asides import (
    only_gives_reason,
    thing_pointed_out,
)
from scope_ptz.planner.grammar.parsing.calculations import with_calculation
from scope_ptz.planner.grammar.parsing.parts.clause import DIRECTIONS, Clause, NotUnderstoodError, text_of
from scope_ptz.planner.grammar.parsing.parts.courtesy import bare_clause
from scope_ptz.planner.grammar.parsing.parts.noun_phrases import thing_of
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start, search
from scope_ptz.planner.grammar.parsing.parts.preset_refs import places_of
from scope_ptz.planner.grammar.parsing.parts.statements import is_statement
from scope_ptz.planner.grammar.parsing.reader import Reader
from scope_ptz.planner.grammar.parsing.segments.clause_starts import GERUNDS, SET_THERE

NO_END = Unclear("Until when shall I keep doing that?")
_INSPECTING = "checking|inspecting|watching|looking|viewing|verifying"
_NO_COMMAND = Unclear("That tells me something, but not what to do. What shall I look at or look for?")
_SET = ("ZOOM-ED", "PAN-ED", "TILT-ED")
_SLIPS = frozenset({"er", "erm", "uh", "um", "uhm", "oops", "actually", "sorry", "no", "rather", "i_mean", "i_meant"})
"""Words with which speakers correct themselves."""


class ClauseSequenceReader:
    """Reads a sequence of clauses from left to right, one clause at a time."""

    def __init__(self, reader: Reader, clauses: Sequence[Clause]) -> None:
        self.reader, self.clauses = reader, list(clauses)
        self.next_index = 0
        self.last_step: Step | None = None
        self.has_zoomed_in = False
        self.visits_in_row = 0  # number of presets that the last clauses visit in a row
        self.has_pictured_preset = False  # whether the last clause takes a picture of a preset
        self.has_visited = self.has_left = False  # whether this sentence goes to a preset, and then moves on from it

    def _peek(self, offset: int = 0) -> Clause | None:
        position = self.next_index + offset
        return self.clauses[position] if position < len(self.clauses) else None

    def _take(self) -> Clause:
        self.next_index += 1
        return self.clauses[self.next_index - 1]

    def _steps_if_needed(self, clause: Clause, steps: tuple[Step, ...]) -> list[Linked]:
        """Return no steps for "zoom in if you have to", because looking zooms in when necessary; ask about other steps."""
        self._take()
        is_zoom = all(isinstance(s, Move) and all(isinstance(p, Zoom) for p in s.parts) for s in steps)
        if is_zoom and (self.next_index > 2 or self._peek() is not None):
            return []
        return [Linked(clause.link, Unclear("Shall I do that, or not?"))]

    def _read(self, clause: Clause) -> tuple[Step, ...]:
        """Return the steps of a clause, which may omit a verb that the previous clause has: "..., then on the bin"."""
        looks_at_place = isinstance(self.last_step, AtPlaces) and all(isinstance(step, Count | Ask) for step in self.last_step.body)
        preposition = "(at|in|from)?" if looks_at_place and not clause.marker else "(at|in|from)"
        if (
            (match := full_match(f"{preposition} (?P<places>_+)", clause.lexemes))
            and isinstance(self.last_step, Count | Ask | AtPlaces)
            and not clause.is_question
            and (places := places_of(self.reader.source, match["places"]))
        ):
            return (SameAt(places),)  # "count the people at the gate, and then at the yard"
        if isinstance(self.last_step, ZoomTo | Read) and (lacking := full_match("no (?P<part>FREE{1,3})", clause.lexemes)):
            part = text_of(self.reader.source, lacking["part"])  # "zoom in on the man in the vest and no helmet"
            return (
                Unclear(
                    f'I did not understand "no {part}". Please describe the thing in one phrase, such as "... without {part}".'
                ),
            )
        if isinstance(self.last_step, GoToPreset) and not clause.is_question:
            clause = replace(clause, lexemes=_as_command(clause.lexemes))
        try:
            steps = self.reader.read(clause.lexemes, has_question_mark=clause.is_question)
        except NotUnderstoodError:
            if (thing := thing_pointed_out(self.reader.source, clause, self._peek())) is not None:
                return (Mention(thing),)
            if only_gives_reason(clause, len(self.clauses)):
                return ()
            if len(self.clauses) == 1 and not clause.is_question and not clause.marker and is_statement(clause.lexemes):
                return (_NO_COMMAND,)
            if (pictured := self._another_picture(clause)) is not None:
                return self._corrected(clause, pictured)
            if (step := self._without_verb(clause)) is None:
                raise
            steps = (step,)
        steps = self._corrected(clause, steps)
        is_held = all(isinstance(step, Forbid) and step.any_move for step in steps) and not any(
            x.has("NEGATED") or x.word.startswith("do_not") for x in clause.lexemes
        )
        if self.last_step and clause.link and is_held and steps:
            steps = ()  # "bring it up five degrees and hold"
        if isinstance(self.last_step, ZoomTo) and any(
            x.word in {"close_up", "closer_look", "a_closer_look"} for x in clause.lexemes
        ):
            steps = tuple(step for step in steps if not isinstance(step, Move))  # "find the van, get a close-up"
        if len(steps) == 1 and isinstance(self.last_step, ZoomTo) and _is_open_ended(steps[0]):
            steps = (NO_END,)  # "search for a car, panning right 20 at a time"
        if len(steps) == 1 and isinstance(steps[0], Track) and not steps[0].thing.text and isinstance(self.last_step, Track):
            steps = ()  # "stay on the crane, tracking it"
        steps = self._with_clear_return(clause, steps)
        if any(isinstance(step, Move | GoToPreset | ZoomTo) for step in steps):
            self.reader = Reader(replace(self.reader.source, has_moved=True))
        self.last_step = steps[-1] if steps else self.last_step
        self.visits_in_row = self.visits_in_row + len(steps) if all(isinstance(step, GoToPreset) for step in steps) else 0
        return steps

    def _another_picture(self, clause: Clause) -> tuple[Step, ...] | None:
        """Return the steps of "another one 20 degrees further right" or "another one at the gate" after a picture, else None."""
        placed = full_match("(FILLER)* (DET)? (ANOTHER|one) (one|PICTURE)? (of|at|from|in|on) (?P<places>_+)", clause.lexemes)
        is_pictured = self.last_step == Snap() or (isinstance(self.last_step, AtPlaces) and self.last_step.body == (Snap(),))
        if is_pictured and placed is not None and (places := places_of(self.reader.source, placed["places"])):
            return (AtPlaces(places, (Snap(),)),)
        match = full_match("(FILLER)* (DET)? ANOTHER (one|PICTURE)? (at|from)? (?P<turn>(NUM DEG?|LITTLE|LOT) _+)", clause.lexemes)
        if not isinstance(self.last_step, Snap) or match is None or not any(x.has(*DIRECTIONS) for x in match["turn"]):
            return None
        moves = self.reader.read(match["turn"])
        return (*moves, Snap()) if len(moves) == 1 and isinstance(moves[0], Move) else None

    def _with_clear_return(self, clause: Clause, steps: tuple[Step, ...]) -> tuple[Step, ...]:
        """Return the steps of a clause, or ask where to return: "go to the gate, zoom in and return" has two possible places."""
        if clause.link == ".":
            self.has_visited = self.has_left = False
        returns_here = any(isinstance(s, Back) for s in steps) and any(x.word == "here" for x in clause.lexemes)
        if returns_here and (self.visits_in_row > 1 or self.has_left):
            return (Unclear("Shall I go back to the last place, or to where the camera points now?"),)
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

    def _is_aside(self, clause: Clause, steps: tuple[Step, ...]) -> bool:
        """Return whether a clause asks for nothing new: "find the hydrant, centre it", "tilt up 10, checking the wires"."""
        if match_start("(FILLER)* (CENTREWORD|CENTREALL) (it|them|PRON|him|her)", clause.lexemes):
            return isinstance(self.last_step, ZoomTo | Track) and all(isinstance(step, Move) for step in steps)
        is_inspecting = match_start(f"(FILLER)* ({_INSPECTING})", clause.lexemes) and not search(
            "IF|if|whether|for|HOWMANY", clause.lexemes
        )
        is_wish = match_start(
            "(DET|my|our)? FREE{1,2} (wants|needs|wanted) (DET)? (FREE)? (look|view|SEE|to SEE|VIEWNOUN|eyes)", clause.lexemes
        )
        return (
            bool(is_inspecting or is_wish)
            and isinstance(self.last_step, Move | Track)
            and clause.link in {",", ""}
            and self.next_index > 1
        )

    def _is_alternative(self, clause: Clause, steps: tuple[Step, ...]) -> bool:
        """Return whether a clause may replace the one before it: "go to the gate. Let's go to the yard instead"."""
        if not any(x.has("INSTEAD") and x.word == "instead" for x in clause.lexemes) or len(steps) != 1 or self.last_step is None:
            return False
        is_conditional = any(other.marker for other in self.clauses[: self.next_index])
        return type(steps[0]) is type(self.last_step) and not is_conditional

    def _corrected(self, clause: Clause, steps: tuple[Step, ...]) -> tuple[Step, ...]:
        """Return the steps of a clause, corrected for its context."""
        first = clause.lexemes[0] if clause.lexemes else None
        slip = next((x for x in clause.lexemes if not x.has("FILLER", "COMMA") or x.word in _SLIPS), None)
        steps = tuple(with_calculation(clause.lexemes, step) for step in steps)
        same = full_match(
            f"HOWMANY BE (just|only|simply)? (?!LEFT|RIGHT) (?P<state>FREE|ADVERB|{'|'.join(GERUNDS)}) (VISIBLE|FILLER)*",
            clause.lexemes,
        )
        if (
            same
            and isinstance(self.last_step, Count)
            and len(words := self.last_step.things[-1].text.split()) in {1, 2}
            and len(steps) == 1
        ):
            things = [word for word in words if not word.endswith("ing")] or words  # "people" of "people standing"
            return (
                Count((Thing(f"{same['state'][0].word} {things[-1]}"),), self.last_step.view),
            )  # "... and how many are moving?"
        if (
            len(steps) == 1
            and slip is not None
            and slip.word in _SLIPS
            and (clause.link in {",", "and"} or slip.word in {"i_mean", "i_meant"})
            and self.last_step is not None
            and (type(steps[0]) is type(self.last_step) or slip.word in {"i_mean", "i_meant"})
        ):
            return (Unclear("Which of the two do you mean?"),)  # "go to the gate, er, the yard"
        if self.visits_in_row > 1 and len(steps) == 1 and isinstance(steps[0], AtPlaces) and not steps[0].places and steps[0].body:
            if any(x.word.startswith("each") for x in clause.lexemes):
                return (EachTime(steps[0].body),)  # "gate, yard, one photo in each place"
            return (Unclear("Shall I do that at every preset, or only at those that you have named?"),)
        if self._is_alternative(clause, steps):
            return (Unclear("Which of the two do you mean?"),)
        if isinstance(self.last_step, ZoomTo | Count | Mention) and full_match(
            "(FILLER)* CENTREWORD (it|them|him|her) (FILLER)*", clause.lexemes
        ):
            return (ZoomTo(Thing()),)  # "find the hydrant and centre it"
        before = self.clauses[self.next_index - 2].lexemes if self.next_index > 1 else ()
        is_turned = any(x.has("REVERSE", "AROUND") for x in before) and not any(x.has("NUM") for x in (*before, *clause.lexemes))
        if (
            is_turned
            and steps == (self.last_step,)
            and clause.link in {",", "and"}
            and not any(x.has("AGAINWORD") for x in clause.lexemes)
        ):
            return ()  # "turn round and face the other way"
        if self._is_aside(clause, steps):
            return ()
        if len(steps) == 1 and isinstance(steps[0], GoToPreset) and steps[0].how == "bare":
            return self._corrected_visit(clause, steps)
        if isinstance(self.last_step, ListPresets) and full_match(
            "(FILLER)* (LISTING|SHOW|TELL) (me|us)* (em|them|PRON)", clause.lexemes
        ):
            return ()  # "presets? List them."
        self.has_pictured_preset = len(steps) == 1 and isinstance(steps[0], AtPlaces) and steps[0].body == (Snap(),)
        words = [x.word for x in clause.lexemes]
        if words[-2:] == ["take", "one"] and isinstance(self.last_step, Snap):
            return ()  # "my boss wants a photo of the trailer, so take one"
        moves = bool(steps) and all(isinstance(step, Move | Snap) for step in steps)
        zooms = [part for step in steps if isinstance(step, Move) for part in step.parts if isinstance(part, Zoom)] if moves else []
        multiplied = full_match("(FILLER)* (DOUBLE|TRIPLE|QUADRUPLE|HALVE) (?P<what>PRON) (FILLER)*", clause.lexemes)
        if multiplied and (
            (isinstance(self.last_step, Move) and all(isinstance(part, Turn) for part in self.last_step.parts))
            or (self.last_step is None and multiplied["what"][0].word == "that")
        ):
            return (Unclear("Shall I change the zoom, or turn again? Please say by how much."),)
        is_in = bool(match_start("(FILLER|WRAPPER)* ZOOM IN", clause.lexemes))
        if is_in and any(part.kind == "factor" and part.value < 1 for part in zooms):
            return (Unclear("Shall I zoom in or out?"),)  # "zoom in half"
        is_aimed = isinstance(self.last_step, Move) and all(
            isinstance(part, Aim) and part.axis == "zoom" for part in self.last_step.parts
        )
        is_undirected = not any(x.has(*DIRECTIONS, "MORE") for x in clause.lexemes) and clause.link in {",", "and"}
        turns = moves and all(isinstance(part, Turn) for step in steps if isinstance(step, Move) for part in step.parts)
        if turns and is_aimed and is_undirected and isinstance(steps[0], Move):
            return (Unclear("Is that the angle to turn to, or the angle to turn by?"),)  # "set zoom 4x, pan 10 and tilt -5"
        if is_aimed and (again := full_match("(FILLER|to)* (?P<target>NUM) X (FILLER)*", clause.lexemes)):
            return (Move((Aim("zoom", again["target"][0].value),)),)  # "zoom to 2x, then 10x"
        if moves and isinstance(self.last_step, AtIntervals) and any(isinstance(step, Snap) and step.times > 1 for step in steps):
            return (Unclear("How far shall I turn in all?"),)  # "pan right 60, a picture every 15 degrees, four pictures"
        if moves and [x.word for x in clause.lexemes[:2]] == ["make", "that"]:
            return (Unclear("Which way shall I turn, and how far?"),)  # "make that ..." has nothing to correct
        if moves and self.has_zoomed_in and any(x.word == "back_out" for x in clause.lexemes) and not search("NUM", clause.lexemes):
            return (Back(zoom_only=True),)  # "zoom in 4x, take a picture, zoom back out"
        if moves:
            self.has_zoomed_in |= any(isinstance(p, Zoom) and p.value > 1 for s in steps if isinstance(s, Move) for p in s.parts)
        is_search = len(steps) == 1 and isinstance(steps[0], ZoomTo) and first is not None and first.has("FIND")
        if is_search and isinstance(steps[0], ZoomTo) and isinstance(self.last_step, Sweep):
            return (Count((steps[0].thing,), "full"),)  # "sweep round and look for a ladder"
        return steps

    def _corrected_visit(self, clause: Clause, visit: tuple[Step, ...]) -> tuple[Step, ...]:
        """Return the steps of a clause that only names a preset, corrected for its context."""
        words = [x.word for x in clause.lexemes]
        if clause.lexemes[0].has("BE"):
            return (Ask(text_of(self.reader.source, clause.lexemes) + "?"),)  # "is this the gate?"
        if match_start("(FILLER)* (this|that|it|SELF) BE ", clause.lexemes):
            return (Unclear("Shall I go there?"),)  # "this is the gate"
        if words[0].startswith("they_") and not any(x.has("PRESET") for x in clause.lexemes):
            raise NotUnderstoodError(clause.lexemes)  # "count the bicycles, they need a separate ticket"
        if words[0] in {"what_about", "how_about"} and self.last_step is None:
            return (Unclear("What shall I look for there?"),)
        if words[-1] == "last" and self._peek() is not None:
            return (Unclear("In which order shall I visit them?"),)  # "the gate last, the yard first"
        if self.has_pictured_preset and clause.link in {",", "and", "then"}:
            return (*visit, Snap())  # "photograph the gate, then the yard"
        self.has_pictured_preset = False
        if words[0] in {"one", "another", "another_one"}:
            return (*visit, Snap())  # "a shot of the gate and one of the yard"
        return visit

    def _without_verb(self, clause: Clause) -> Step | None:
        """Return the previous clause's step with another thing; None if the clause is not a noun phrase."""
        match = full_match(r"(on|onto|at|to|for|of)? (?P<thing>_+)", bare_clause(clause.lexemes))
        if match is None or full_match("(DET)? PRESET (PRESETNOUN|ORDINAL|FIRSTLY|first)*", match["thing"]):
            return None
        thing = thing_of(self.reader.source, match["thing"])
        if thing is None or not thing.text or clause.lexemes[-1].word in {"away", "off", "back"}:
            return None
        match self.last_step:
            case ZoomTo() | Read():
                return replace(self.last_step, thing=thing)
            case Count():
                return replace(self.last_step, things=(thing,))
        return None

    def _linked_steps(self, clause: Clause, steps: tuple[Step, ...]) -> list[Linked]:
        """Return the linked steps of a clause, or a question if it says "keep panning" but not where to stop."""
        keeps = bool(clause.lexemes) and any(
            x.has("KEEP") and x.word.startswith(("keep", "carry_on", "continue")) for x in clause.lexemes[:2]
        )
        if keeps and any(
            isinstance(step, Move) and all(isinstance(p, Turn) and p.amount is None for p in step.parts) for step in steps
        ):
            return [Linked(clause.link, NO_END)]
        link = clause.link
        return [Linked(link if i == 0 else "and", step) for i, step in enumerate(steps)]

    @staticmethod
    def _is_place(clause: Clause) -> bool:
        """Return whether a clause only names the place of the next one: "at the gate, if there is a van, take a picture"."""
        return bool(clause.lexemes) and clause.lexemes[-1].has("COMMA")

    def _is_trailing(self, clause: Clause) -> bool:
        """Return whether the condition that comes next belongs to a clause before it, and not to the clauses after it."""
        condition, after = self._peek(), self._peek(1)
        if condition is None:
            return False
        if condition.link == "" and not self._is_place(clause):
            return True
        return after is None or after.link == "." or after.marker == "IFNOT"


def _as_command(lexemes: Sequence[Lexeme]) -> tuple[Lexeme, ...]:
    """Return a clause about the camera's setting at the last preset as a command: "the gate, zoomed in", "... at 3x"."""
    if match_start("(FILLER|COMMA)* at NUM X", lexemes):
        start = next(i for i, x in enumerate(lexemes) if x.word == "at")
        return (*lexemes[:start], replace(lexemes[start], word="zoom", classes=frozenset({"ZOOM"})), *lexemes[start:])
    if match_start(SET_THERE, lexemes) is None:
        return tuple(lexemes)
    verb = next(i for i, x in enumerate(lexemes) if x.has(*_SET))
    name = next(kind for kind in _SET if lexemes[verb].has(kind)).removesuffix("-ED")
    command = replace(lexemes[verb], word=name.lower(), classes=frozenset({name}))
    return (*lexemes[:verb], command, *lexemes[verb + 1 :])


def _is_open_ended(step: Step) -> bool:
    """Return whether a move states the size of a step, but not how far to go."""
    return isinstance(step, Move) and any(isinstance(part, Turn) and part.step and not part.amount for part in step.parts)
