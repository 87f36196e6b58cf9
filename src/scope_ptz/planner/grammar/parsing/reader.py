"""Read one clause: strip courtesy and adjuncts, then find an interpretation that covers all remaining words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from scope_ptz.planner.grammar.instruction_tree import (
    Ask,
    AtIntervals,
    AtPlaces,
    Between,
    Count,
    EachTime,
    Forbid,
    GoToPreset,
    Home,
    Move,
    PresetRef,
    Read,
    Repeat,
    Report,
    Rescope,
    SameAt,
    Snap,
    Step,
    Unclear,
    WhatAbout,
)
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.calculations import without_sum
from scope_ptz.planner.grammar.parsing.controls import control_step
from scope_ptz.planner.grammar.parsing.looks.camera_state import state_step
from scope_ptz.planner.grammar.parsing.looks.comparisons import comparison_step
from scope_ptz.planner.grammar.parsing.looks.counting import check_places_step
from scope_ptz.planner.grammar.parsing.looks.look_clauses import look_step
from scope_ptz.planner.grammar.parsing.looks.sums import sum_step
from scope_ptz.planner.grammar.parsing.moves.motion import turn_step
from scope_ptz.planner.grammar.parsing.moves.places import go_step, listing_step, tour_step, unknown_place
from scope_ptz.planner.grammar.parsing.moves.returns import return_step
from scope_ptz.planner.grammar.parsing.moves.special_turns import CLOCK_POSITION, special_turn
from scope_ptz.planner.grammar.parsing.moves.zooming import ZOOM_TOPICS, zoom_step
from scope_ptz.planner.grammar.parsing.parts.clause import VERBS, NotUnderstoodError, Source, text_of
from scope_ptz.planner.grammar.parsing.parts.courtesy import bare_clause
from scope_ptz.planner.grammar.parsing.parts.noun_phrases import thing_of
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start, search
from scope_ptz.planner.grammar.parsing.parts.preset_refs import (
    occupied_place,
    place_asked_about,
    place_sought,
    places_of,
    stays_in_view,
    without_inner_place,
)
from scope_ptz.planner.grammar.parsing.parts.questions import is_question
from scope_ptz.planner.grammar.parsing.parts.scopes import scope_of, split_leading_place, split_trailing_place, without_repetitions
from scope_ptz.planner.grammar.parsing.parts.statements import is_only_noun

if TYPE_CHECKING:
    from scope_ptz.tools.arguments import View

_EMPTY_CLAUSE = r"(FILLER|LEADFILLER|FIRSTLY|COMMA|WRAPPER|PURPOSE|QUOTE|THEN|AND|SELF|HALT there)*"
_CALL_SIGN = "CAMERA NUM? (from|this is) (LEADFILLER|CAMERA|FREE){1,2} NUM?"
"""The words that open a radio message: "camera one from control"."""


_CAMERA_MOVED = "(FILLER)* (DET)? CAMERA (ADVERB|FILLER)* (PAN-ED|TILT-ED|ZOOM-ED|TURN-ED|CARRY-ED|SWITCH-ED)"
"""A report of a move, which is not a command: "the camera panned left"."""
_THING_MOVES = (
    "(DET|my|our)? (FREE|WHOLETHING){1,3} BE (ADVERB|FILLER)* (CARRY-ING|TURN-ING|SWITCH-ING) (LEFT|RIGHT|UP|DOWN|AROUND)"
)
"""A statement about a thing that moves, which is not a command: "things are moving up here"."""

_ROLL = "(FILLER)* roll (DET|CAMERA|VIEWNOUN|PICTURE|it)* (LEFT|RIGHT|NUM|by) _*"
_ROLLED_PICTURE = "(FILLER)* (TURN|CARRY|roll|SWITCH) (DET|SELF)? (PICTURE|VIEWNOUN|image|screen) (FILLER|AROUND)* (LEFT|RIGHT) _*"
_ROLLS = frozenset({"clockwise", "anticlockwise", "counterclockwise", "cw", "ccw", "acw"})
"""Ways to turn about the line of sight if it is the picture that turns, not the camera: "rotate the picture clockwise"."""

_TO_CLOCK_POSITION = (
    f"(AIM|TURN|PAN|TILT|CARRY|SWITCH|ZOOM|SHOW|FIND|to|at|on|for|in|DET|SELF|GLUE|CAMERA|it|FILLER)* {CLOCK_POSITION} "
    f"(PRESETNOUN|SIDE|direction|FILLER)*"
)
"""A clause that turns to a clock position: "look at 3 o'clock"."""

_SHOULD_HAVE_MOVED = "(WRAPPER|MODAL) have (FILLER|ADVERB)* (PAN-ED|TILT-ED|ZOOM-ED|TURN-ED|CARRY-ED|SWITCH-ED)"
"""A remark about an earlier move: "you should have panned left"."""

_RECORDING = (
    "(FILLER|KEEP)* (record|recording|film|filming) (for (AMOUNTISH|DET)*)? ((NUM|DET|FRACTION)* (SECONDS|MINUTES|HOURS))? "
    "(FILLER)*"
)

_ASKING = frozenset({"did", "does", "has", "had", "is", "are", "was", "were"})
_PAST_FORMS = tuple(f"{verb}-ED" for verb in VERBS)


@dataclass(frozen=True, slots=True)
class Reader:
    """Reads the clauses of an instruction.

    Attributes:
        source: The instruction and the presets.
    """

    source: Source

    def read(self, lexemes: Sequence[Lexeme], *, has_question_mark: bool = False) -> tuple[Step, ...]:
        """Return the steps of a clause.

        Raises:
            NotUnderstoodError: No interpretation covers all words of the clause.
        """
        if not has_question_mark and match_start(_THING_MOVES, lexemes):
            raise NotUnderstoodError(lexemes)
        if match_start(_CAMERA_MOVED, lexemes) or search(_SHOULD_HAVE_MOVED, lexemes):
            raise NotUnderstoodError(lexemes)
        if full_match(_CALL_SIGN, lexemes):
            return ()
        if has_question_mark and (
            more := full_match("(FILLER)* (?P<and>AND|what_about|how_about) (?P<in>at|in|on)? (?P<what>_+)", lexemes)
        ):
            places, thing = places_of(self.source, more["what"]), thing_of(self.source, more["what"])
            if places:
                return (
                    SameAt(places, or_go=more["and"][0].has("AND")),
                )  # "how many cones are there?", and in the next turn "and at the gate?"
            if thing is not None and thing.text and not more.has("in"):
                return (WhatAbout(thing),)  # "and the cars?"
        lexemes = bare_clause(lexemes)
        if has_question_mark and match_start("you (SEE|spot|notice) (ANY|SOMEONE|DET|NUM)", lexemes):
            lexemes = (Lexeme("do", lexemes[0].start, lexemes[0].start, frozenset({"DOV"})), *lexemes)  # "you see a van?"
        if enough := full_match(
            "(?P<body>_+ (LEFT|RIGHT|UP|DOWN|IN|OUT|DEG|NUM|LITTLE|LOT|SECONDS|MINUTES)) ((MODAL|should|ought to|WRAPPER) "
            "(do|DOACT|do_it|suffice|be (enough|ideal|great|perfect|good|fine|nice|lovely|better|grand|plenty|FILLER))|"
            "BE (enough|plenty)) (nicely|fine|FILLER)*",
            lexemes,
        ):
            lexemes = tuple(enough["body"])  # "a quarter turn to the left will do it"
        if not lexemes or full_match(_EMPTY_CLAUSE, lexemes):
            return ()
        steps = (
            control_step(self.source, lexemes)
            or self._with_adjuncts(lexemes, has_question_mark)
            or self._without_adjuncts(lexemes, has_question_mark)
        )
        if steps is None or any(isinstance(inner, Rescope) for step in steps for inner in getattr(step, "body", ())):
            raise NotUnderstoodError(lexemes)  # "everywhere each time": there is nothing to look for
        return steps

    def _with_adjuncts(self, lexemes: Sequence[Lexeme], has_question_mark: bool) -> tuple[Step, ...] | None:
        """Read a clause with words that repeat it or carry it out elsewhere: "... each time", "... at every preset"."""
        if (
            (match := full_match(r"(?P<body>_+?) (COMMA)? (EACHTIME|at ATATIME) (FILLER|INTURN|AGAINWORD)*", lexemes))
            and not has_question_mark
            and not search("(COUNTNOUN|BE|STEPNOUN of NUM DEG?) \\Z", match["body"])
        ):
            body = match["body"]
            if (ahead := full_match(r"with (?P<what>_+)", body)) is not None:
                body = ahead["what"]
            return (EachTime(self.read(body)),)
        if told := full_match(
            r"(?P<tell>TELL (SELF)*) at (EACHTIME|EVERY) (one|PRESETNOUN|of|PRON)* (COMMA)? (?P<what>(whether|IF|WHQ|HOWMANY) _+)",
            lexemes,
        ):
            asked = self.read((*told["tell"], *told["what"]))  # "tell me at each whether it is open"
            is_tour = any(x.has("PRESETNOUN") for x in lexemes[: len(lexemes) - len(told["what"])])
            return (AtPlaces((), asked),) if is_tour else (EachTime(asked),)
        if match := full_match(r"(EACHTIME) (COMMA|FILLER)* (?P<body>_+)", lexemes):
            return (EachTime(self.read(match["body"])),)
        if match := full_match(
            r"(?P<body>_+?) (EVERY (?P<size>NUM) DEG|at (?P<size>NUM) DEG intervals) (INTURN)?|(?P<body>(TAKE-ING|SNAP-ING) _+?) "
            r"EVERY (?P<size>NUM)",
            lexemes,
        ):
            return (AtIntervals(self.read(match["body"]), match["size"][0].value),)
        if match := full_match(r"(?P<body>_+?) BETWEENEACH|BETWEENEACH COMMA? (?P<late>_+)", lexemes):
            return (Between(self.read(match["body"] or match["late"])),)
        step = self._undivided(lexemes)
        if step is not None:
            return step
        if match := full_match("(?P<body>_+) per PRESETNOUN", lexemes):
            return (AtPlaces((), self.read(match["body"])),)
        if match := full_match(
            "(from|starting from|starting at|at) HOME (COMMA|FILLER)* (?P<body>_+)|(?P<body>_+?) (from|starting from|"
            "starting at) HOME",
            lexemes,
        ):
            return (Home(), *self.read(match["body"]))
        if match := full_match(
            "(?P<pictures>(TAKE|SNAP|DET)* NUM PICTURE) COMMA? (at|with|each)* (?P<turn>NUM DEG) (apart|intervals) COMMA? "
            "(CARRY-ING|PAN-ING|TILT-ING|TURN-ING|CARRY|PAN|TILT|to|DET|GLUE)* (?P<way>LEFT|RIGHT|UP|DOWN) (FILLER)*",
            lexemes,
        ):
            between = self.read((*match["way"], *match["turn"]))
            pictures = self.read(match["pictures"])
            if len(pictures) == 1 and isinstance(pictures[0], Snap) and pictures[0].times > 1:
                return (replace(pictures[0], times=1), Repeat((*between, Snap()), pictures[0].times - 1))
        if not search("to NUM X", lexemes) and not any(
            x.has(*ZOOM_TOPICS, *(f"{topic}-ING" for topic in ZOOM_TOPICS), "IN", "OUT") for x in lexemes
        ):
            body, times, group = without_repetitions(lexemes)
            if times > 1 and body:
                inner = self.read(body)
                if len(inner) == 1 and not isinstance(inner[0], Repeat):
                    if isinstance(inner[0], Snap) and not group:
                        return (replace(inner[0], times=times),)
                    return (Repeat(inner, times, group),)
        return self._at_places(lexemes, has_question_mark)

    def _undivided(self, lexemes: Sequence[Lexeme]) -> tuple[Step, ...] | None:
        """Read clauses from which no preset may be split off, such as comparisons and moves."""
        found = (
            listing_step(lexemes)
            or sum_step(self.source, lexemes)
            or comparison_step(self.source, lexemes, self._moves)
            or go_step(self.source, lexemes)
            or return_step(lexemes)
            or state_step(lexemes)
            or tour_step(self.source, lexemes)
        )
        return found if found is None or isinstance(found, tuple) else (found,)

    def _moves(self, lexemes: Sequence[Lexeme]) -> tuple[Step, ...] | None:
        for split in range(len(lexemes)):
            if lexemes[split].has("AND") and split:
                first, second = self._moves(lexemes[:split]), self._moves(lexemes[split + 1 :])
                if first and second and isinstance(first[0], Move) and isinstance(second[0], Move):
                    return (Move((*first[0].parts, *second[0].parts)),)
        try:
            steps = self.read(lexemes)
        except NotUnderstoodError:
            return None
        return steps if steps and all(isinstance(step, Move | Unclear | GoToPreset | Home) for step in steps) else None

    def _at_places(self, lexemes: Sequence[Lexeme], has_question_mark: bool) -> tuple[Step, ...] | None:
        """Read "at the gate, count the cars" and "count the cars at every preset"."""
        rest, places = split_leading_place(self.source, lexemes)
        if places is not None and rest:
            if all(x.has("GLUE", "FILLER", "COMMA") for x in rest):
                return None
            return (AtPlaces(places, self.read(rest, has_question_mark=has_question_mark), is_fronted=True),)
        if search("THAN|than|COMPARE", lexemes):
            return None
        if lexemes[0].has("BE", "WHQ") and (place := occupied_place(self.source, lexemes)) is not None:
            if stays_in_view(self.source):
                return (Ask(f"{text_of(self.source, lexemes)}?"),)
            return (AtPlaces((place,), (Ask(f"{text_of(self.source, lexemes)}?"),)),)
        rest, places = split_trailing_place(self.source, without_sum(lexemes))
        if places is None and (inner := self._place_of_subject(lexemes, has_question_mark)) is not None:
            return inner
        if places is None and (named := self._named_place(lexemes, has_question_mark)) is not None:
            return named
        if places is None or not rest:
            return None
        if len(rest) > 1 and rest[-1].word == "over":
            rest = rest[:-1]  # "is it icy over at the yard?"
        if any(x.has("PRON") for x in rest[-1:]) and match_start("WHQ", rest):
            return None
        if has_question_mark and full_match("(ATLEAST|MORETHAN|FEWERTHAN|ATMOST|EXACTLY) NUM", rest):
            return (AtPlaces(places, (Ask(f"Are there {text_of(self.source, rest).lower()} people there?"),)),)
        if full_match("(BE)? (SOMEONE|NOONE|anything|nothing)", rest):
            question = text_of(self.source, rest)
            return (AtPlaces(places, (Ask(f"{'' if rest[0].has('BE') else 'Is '}{question} there?"),)),)
        if full_match("BE (DET|ANY|SELF)* FREE{1,3} (still|yet|already)", rest) or (
            full_match("BE (DET|ANY|SELF)* FREE{1,3}", rest) and is_only_noun(rest[-1])
        ):
            return (AtPlaces(places, (Ask(f"{text_of(self.source, rest)} there?"),)),)  # "is the van at the gate?"
        if full_match("WHQ FREE{1,3} BE", rest):
            return (AtPlaces(places, (Ask(f"{text_of(self.source, rest)} there?"),)),)  # "which vans are at the gate?"
        try:
            body = self.read(rest, has_question_mark=has_question_mark)
        except NotUnderstoodError:
            return None
        if not body or any(isinstance(step, Forbid | Report) for step in body):
            return None
        return (AtPlaces(places, body),)

    def _place_of_subject(self, lexemes: Sequence[Lexeme], has_question_mark: bool) -> tuple[Step, ...] | None:
        """Read "is the barrier at the crossing up?" as a question at the preset."""
        if not (has_question_mark or is_question(lexemes) or lexemes[0].has("TELL")):
            return None
        if (found := without_inner_place(self.source, lexemes)) is None:
            return None
        source, rest, place = found
        try:
            steps = Reader(source).read(rest, has_question_mark=has_question_mark)
        except NotUnderstoodError:
            return None
        return (AtPlaces((place,), steps),) if steps and all(isinstance(step, Ask | Count | Read) for step in steps) else None

    def _named_place(self, lexemes: Sequence[Lexeme], has_question_mark: bool) -> tuple[Step, ...] | None:
        """Read "has the bus bay got any room left?" as a question at the preset.

        "Where is the bus bay?" is asked in the current view first.
        """
        if (sought := place_sought(self.source, lexemes)) is not None:
            return (Ask(f"{text_of(self.source, lexemes)}?", otherwise_at=sought),)
        if (
            not (has_question_mark or is_question(lexemes) or lexemes[0].has("ANY", "TELL"))
            or (place := place_asked_about(self.source, lexemes)) is None
        ):
            return None
        try:
            steps = self._without_adjuncts(lexemes, has_question_mark)
        except NotUnderstoodError:
            return None
        return (AtPlaces((place,), steps),) if steps and all(isinstance(step, Ask) for step in steps) else None

    def _without_adjuncts(self, lexemes: Sequence[Lexeme], has_question_mark: bool) -> tuple[Step, ...] | None:
        """Read a clause without adjuncts."""
        failed: NotUnderstoodError | None = None
        if full_match(_RECORDING, lexemes):
            return (Unclear("I take single pictures and cannot record. Shall I take a picture?"),)
        rolls = full_match(_ROLLED_PICTURE, lexemes) is not None and any(x.word in _ROLLS for x in lexemes)
        if rolls or full_match(_ROLL, lexemes):
            return (Unclear("I can pan, tilt and zoom, but not roll. Which way shall I turn, and how far?"),)
        if full_match(_TO_CLOCK_POSITION, lexemes) and not has_question_mark:
            return (special_turn(lexemes) or Unclear("Which way shall I turn, and how far?"),)
        if (
            any(x.has("PICTURE", "SNAP", "ANOTHER") for x in lexemes)
            and any(x.has("TAKE", "SNAP", "TAKE-ING", "SNAP-ING") for x in lexemes)
            and not any(x.has("LEFT", "RIGHT", "UP", "DOWN") for x in lexemes)
        ):
            step = look_step(self.source, lexemes, has_question_mark=has_question_mark)
            if isinstance(step, Snap | AtPlaces):
                return (step,)
        for read in (zoom_step, turn_step):
            try:
                if (
                    not is_question(lexemes)
                    and not is_report(lexemes, has_question_mark=has_question_mark)
                    and (step := read(lexemes)) is not None
                ):
                    return (step,)
            except NotUnderstoodError as error:
                failed = failed or error
        if (checked := check_places_step(self.source, lexemes)) is not None:
            return (checked,)
        if (place := unknown_place(self.source, lexemes)) is not None:
            return (place,)
        try:
            found = look_step(self.source, lexemes, has_question_mark=has_question_mark)
        except NotUnderstoodError as error:
            raise failed or error from None
        if found is not None:
            return found if isinstance(found, tuple) else (found,)
        view: View | None = (
            "full" if any(x.has("FULL") for x in lexemes) else "current" if any(x.has("NOW") for x in lexemes) else None
        )
        if (only := scope_of(lexemes)) is not None:
            return (Rescope(only),)  # "count the vents, current view only"
        scoping = ("NOW", "FULL", "FILLER", "PREP", "GLUE", "AND", "NOT", "NEGATED")
        if view and all(x.has(*scoping) or x.word in {"consider", "include", "cover", "mean"} for x in lexemes):
            return (Forbid() if any(x.has("NOT", "NEGATED") for x in lexemes) else Rescope(view),)
        if full_match("(DET)? FREE{1,3}", lexemes) and not has_question_mark:
            name = text_of(self.source, lexemes)
            return (GoToPreset(PresetRef(name, has_article=lexemes[0].has("DET")), "bare"),)
        if failed:
            raise failed
        return None


def is_report(lexemes: Sequence[Lexeme], *, has_question_mark: bool) -> bool:
    """Return whether a clause reports or asks about an earlier move: "I panned left", "did you pan left?"."""
    if has_question_mark and lexemes[0].word in _ASKING:
        return True
    if match_start("(SELF|PRON|(DET)? CAMERA|DET VIEWNOUN|DET PICTURE) (BE|HAVEV|'s) ", lexemes):
        return True
    is_past = any(x.has(*_PAST_FORMS) and not x.has(*VERBS) for x in lexemes)
    return is_past and lexemes[0].has("SELF", "PRON", "CAMERA")
