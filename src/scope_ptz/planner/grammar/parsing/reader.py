"""Read one clause: courtesy and adjuncts are taken off, and what remains must be covered by one of the readings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from scope_ptz.planner.grammar.instruction_tree import (
    AtIntervals,
    AtPlaces,
    Between,
    DoAgain,
    EachTime,
    Forbid,
    GoToPreset,
    Home,
    Move,
    PresetRef,
    Repeat,
    Report,
    Rescope,
    SameAt,
    Snap,
    Step,
    Unclear,
)
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.looks.camera_state import state_step
from scope_ptz.planner.grammar.parsing.looks.comparisons import comparison_step, sum_step
from scope_ptz.planner.grammar.parsing.looks.counting import check_places_step
from scope_ptz.planner.grammar.parsing.looks.look_clauses import look_step
from scope_ptz.planner.grammar.parsing.moves.motion import turn_step
from scope_ptz.planner.grammar.parsing.moves.places import go_step, tour_step, unknown_place
from scope_ptz.planner.grammar.parsing.moves.zooming import ZOOM_TOPICS, zoom_step
from scope_ptz.planner.grammar.parsing.parts.clause import VERBS, NotUnderstoodError, Source, text_of
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start, search
from scope_ptz.planner.grammar.parsing.parts.preset_refs import places_of
from scope_ptz.planner.grammar.parsing.parts.questions import is_question
from scope_ptz.planner.grammar.parsing.parts.scopes import place_after, place_before, without_times

if TYPE_CHECKING:
    from scope_ptz.tools.arguments import View

_EDGE = ("FILLER", "COMMA", "LEADFILLER", "FIRSTLY", "QUOTE", "INSTEAD", "DASH", "OPEN", "CLOSE", "AND", "BUT", "ATSAMETIME")
_WRAPPERS = (
    (
        r"(MODAL SELF (FILLER|be able to|kindly|maybe|perhaps|possibly|be so kind as to|help|mind|not)* "
        r"(?!(ADVERB)* (SEE|be |have|READ))|WRAPPER (?!DET? HOME)|only (?=TAKE|SNAP|PAN|TILT|ZOOM|SWITCH|CARRY)|"
        r"CAMERA NUM COMMA|make it (?=AIM|TURN|PAN|TILT|ZOOM|FACE)|SELF (BE|am|was|were) (hoping|wondering|asking|"
        r"FREE) (if|that|whether)? SELF (MODAL)|(DET)? CAMERA (should|must|needs to|has to|ought to)|(DET)? "
        r"FREE{1,2} (wants|needs|WRAPPER|TAKE-S) (SELF to|to (?=SEE|SHOW|have)|to SEE)?(?=DET|PRESET|NUM|it|"
        r"PICTURE|LITTLE|COUNTNOUN|CARRY|PAN|TILT|ZOOM)|SELF (will|would)? (need|want|love|like) (SELF to|"
        r"to)?(?=DET|NUM|PICTURE|PAN|TILT|ZOOM|TURN|CARRY|SWITCH|SNAP|COUNT)|SELF would (be FREE|appreciate it) "
        r"(if SELF MODAL|WRAPPER)|"
        r"SELF would be (grateful|thankful|glad) for (?=DET|NUM|PICTURE)|"
        r"(FILLER|LEADFILLER(?! NUM)|FIRSTLY|COMMA|QUOTE|AND|BUT|INSTEAD|PURPOSE))"
    ),
)
_NEGATION = "(NEGATED|(SELF)? (do|MODAL|need) not|DOV not)"
_SILENT_CLAUSE = r"(FILLER|LEADFILLER|FIRSTLY|COMMA|WRAPPER|PURPOSE|QUOTE|THEN|AND|SELF|HALT there)*"


_ASKING = frozenset({"did", "does", "has", "had", "is", "are", "was", "were"})
_PAST_FORMS = tuple(f"{verb}-ED" for verb in VERBS)


@dataclass(frozen=True, slots=True)
class Reader:
    """Reads the clauses of an instruction.

    Attributes:
        source: The instruction and the presets.
    """

    source: Source

    def read(self, lexemes: Sequence[Lexeme], *, asked: bool = False) -> tuple[Step, ...]:
        """Return the steps of a clause.

        Raises:
            NotUnderstoodError: No reading covers all words of the clause.
        """
        lexemes = bare_clause(lexemes)
        if not lexemes or full_match(_SILENT_CLAUSE, lexemes):
            return ()
        steps = self._as_control(lexemes) or self._with_adjuncts(lexemes, asked) or self._plain(lexemes, asked)
        if steps is None:
            raise NotUnderstoodError(lexemes)
        return steps

    def _as_control(self, lexemes: Sequence[Lexeme]) -> tuple[Step, ...] | None:
        """Read clauses that say what not to do, what to do again, or how the result is to be reported."""
        if match_start(_NEGATION, lexemes) and not match_start("NEGATED (more)? (FREE|PRESETNOUN) BE", lexemes):
            return self._forbidden(lexemes)
        if full_match(
            "(FILLER)* (STAY|STAY-ING) (FILLER|there|here|where|SELF|BE|CAMERA|still|DET|VIEWNOUN|this|put|as)*", lexemes
        ):
            return (Forbid(any_move=True),)
        if match := full_match(
            (
                "(REPEAT|AGAINWORD|TURN)? (REPEAT|AGAINWORD) (FILLER|AGAINWORD|INTURN|COMMA|THEN)* ((?P<number>NUM) (X|"
                "MORE X|MORE) (INTURN|MORE|FILLER)*|(?P<twice>twice)|(?P<thrice>thrice)|X (?P<x>NUM))? (INTURN|MORE|"
                "FILLER|AGAINWORD)*"
            ),
            lexemes,
        ):
            number = match["number"] or match["x"]
            times = round(number[0].value) if number else 2 if match.has("twice") else 3 if match.has("thrice") else None
            more = any(x.has("MORE") and x.word in {"more", "another"} for x in lexemes)
            return (DoAgain(times, more=more),)
        if full_match("(FILLER)* NUM (x|PERCENT) (FILLER)*", lexemes):
            return (Unclear("Shall I zoom, or do that several times?"),)
        if match := full_match(
            (
                "(FILLER|AGAINWORD)* ((?P<number>NUM) X|(?P<twice>twice)|(?P<thrice>thrice)|X (?P<x>NUM)) (INTURN|FILLER|"
                "MORE|over|AGAINWORD)*"
            ),
            lexemes,
        ):
            number = match["number"] or match["x"]
            return (
                DoAgain(
                    round(number[0].value) if number else 2 if match.has("twice") else 3,
                    more=any(x.word == "more" for x in lexemes),
                ),
            )
        if match := full_match("(REPEAT|REPEAT SELF) (FILLER)* (at|for|in|on|from) (?P<places>_+)", lexemes):
            places = places_of(self.source, match["places"])
            return (SameAt(places),) if places is not None else None
        if full_match(
            (
                r"(FILLER)* (LEAVE|keep) (DET|SELF|CAMERA)* (pan|tilt|zoom|CAMERA|ZOOMNOUN|height|angle|focus|PANNOUN|"
                r"TILTNOUN) (level|setting)? (alone|as it is|where it is|the same|SAMEAMOUNT|unchanged|as is|fixed|put) "
                r"(FILLER)*"
            ),
            lexemes,
        ) and any(x.has("PAN", "TILT", "ZOOM", "ZOOMNOUN", "TILTNOUN", "PANNOUN") or x.word in {"lens", "focus"} for x in lexemes):
            return (Forbid(),)
        if full_match("(look|TELL|AIM|have_a_look|take_a_look) (FILLER|there|here|now|please)*", lexemes) and any(
            x.word in {"look", "have_a_look", "take_a_look", "see", "check"} for x in lexemes
        ):
            return (Report(),)
        if full_match(
            (
                "(TELL|READ) (me|us)* (whether|if|IF|that|so) (SELF|it|there)* (can|BE|HAVEV)* (FIND-ED|SEE-ED|found|"
                "find|SEE|FIND|so)? (one|it|any|them|so)*"
            ),
            lexemes,
        ) and any(x.word in {"whether", "if", "so"} for x in lexemes):
            return (Report(),)
        if full_match("(which|that|those|they|these) (BE) (not)? (DET)? (different|same|other|distinct) _*", lexemes):
            return (Report(),)
        if full_match(
            (
                "(add|sum|total|COUNT) (DET|PRON|NUM|both|EVERY|up|together|of|FREE)* (up|together|total|UP)|(TELL|CARRY|"
                "TAKE|SHOW|what is) (me|us)* (the|DET) (sum|total|difference|result|count|answer)"
            ),
            lexemes,
        ) and not any(x.has("FREE") and x.word not in {"sum", "difference", "result", "together", "total"} for x in lexemes):
            return (Report(),)
        if full_match(
            "(SNAP|TAKE|SNAP-ING|TAKE-ING) (DET)? (PICTURE)? (of)? (both|EVERY|all|each) (of them|one|PRON|of)*", lexemes
        ) and any(x.has("SNAP", "PICTURE", "SNAP-ING") for x in lexemes):
            return (EachTime((Snap(),)),)
        if full_match("(HALT|HALT-ING|hold|wait|pause) (there|here|FILLER|moving|CAMERA|it)*", lexemes):
            return (Forbid(any_move=True),)
        if full_match(
            (
                "(TELL|report|SAY|let me know|REPORT) (me|us|SELF|back|FILLER|DET|result|results|so|that|it|answer|"
                "number|what SELF FIND|what SELF SEE|to|findings|count|how SELF get on|about|PRON|TELL|DET COUNTNOUN|how "
                "it went|total|both)*"
            ),
            lexemes,
        ) and not search("what SELF SEE", lexemes):
            return (Report(),)
        return None

    def _forbidden(self, lexemes: Sequence[Lexeme]) -> tuple[Step, ...] | None:
        """Read "don't zoom", "without moving the camera" and "no zooming"."""
        match = match_start(f"{_NEGATION} (FILLER|need to|have to|ever|bother)*", lexemes)
        rest = lexemes[match.size :] if match else lexemes
        if not rest:
            return None
        forms = "|".join(f"{verb}|{verb}-ING" for verb in VERBS)
        if not match_start(f"(FILLER|DET|any)* ({forms}|ZOOMNOUN|LEFT|RIGHT|UP|DOWN|NUM|movement|LITTLE|LOT)", rest):
            return None
        parts = [x for x in rest if not x.has("FILLER", "CAMERA", "DET", "PRON", "SELF", "COMMA", "AROUND")]
        is_any = all(
            x.word in {"move", "moving", "movement", "turn", "turning", "anything", "at_all", "all", "at"} or x.has("OR", "CAMERA")
            for x in parts
        )
        allowed = all(
            x.has(
                "FREE",
                "DET",
                "FILLER",
                "CAMERA",
                "PREP",
                "PRON",
                "SELF",
                "COMMA",
                "OR",
                "AND",
                *VERBS,
                "ZOOMNOUN",
                "NUM",
                "DEG",
                "LEFT",
                "RIGHT",
                "UP",
                "DOWN",
                "IN",
                "OUT",
                "LITTLE",
                "LOT",
                "LIMIT",
                "X",
                "MORE",
                "AMOUNTISH",
                "PRESET",
                "HOME",
                "PICTURE",
                "VIEWNOUN",
                "NOW",
                "ANY",
                *(f"{v}-ING" for v in VERBS),
                "GLUE",
                "PERCENT",
                "HOWEVER",
            )
            for x in rest
        )
        return (Forbid(any_move=is_any),) if allowed else None

    def _with_adjuncts(self, lexemes: Sequence[Lexeme], asked: bool) -> tuple[Step, ...] | None:
        """Read a clause with words that repeat it, or do it elsewhere: "... each time", "... at every preset", "twice, ..."."""
        if (
            (match := full_match(r"(?P<body>_+?) (COMMA)? (EACHTIME|at ATATIME) (FILLER|INTURN|AGAINWORD)*", lexemes))
            and not asked
            and not search("COUNTNOUN \\Z", match["body"])
        ):
            body = match["body"]
            if (ahead := full_match(r"with (?P<what>_+)", body)) is not None:
                body = ahead["what"]
            return (EachTime(self.read(body)),)
        if match := full_match(r"(EACHTIME) (COMMA|FILLER)* (?P<body>_+)", lexemes):
            return (EachTime(self.read(match["body"])),)
        if match := full_match(r"(?P<body>_+?) (EVERY (?P<size>NUM) DEG|at (?P<size>NUM) DEG intervals) (INTURN)?", lexemes):
            return (AtIntervals(self.read(match["body"]), match["size"][0].value),)
        if match := full_match(r"(?P<body>_+?) BETWEENEACH|BETWEENEACH COMMA? (?P<late>_+)", lexemes):
            return (Between(self.read(match["body"] or match["late"])),)
        step = self._whole(lexemes)
        if step is not None:
            return step
        if not search("to NUM X", lexemes) and not any(
            x.has(*ZOOM_TOPICS, *(f"{topic}-ING" for topic in ZOOM_TOPICS), "IN", "OUT") for x in lexemes
        ):
            body, times, group = without_times(lexemes)
            if times > 1 and body:
                inner = self.read(body)
                if len(inner) == 1 and not isinstance(inner[0], Repeat):
                    if isinstance(inner[0], Snap) and not group:
                        return (replace(inner[0], times=times),)
                    return (Repeat(inner, times, group),)
        return self._at_places(lexemes, asked)

    def _whole(self, lexemes: Sequence[Lexeme]) -> tuple[Step, ...] | None:
        """Read clauses whose preset is not an adjunct."""
        found = (
            comparison_step(self.source, lexemes, self._moves)
            or sum_step(self.source, lexemes)
            or go_step(self.source, lexemes)
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

    def _at_places(self, lexemes: Sequence[Lexeme], asked: bool) -> tuple[Step, ...] | None:
        """Read "at the gate, count the cars" and "count the cars at every preset"."""
        rest, places = place_before(self.source, lexemes)
        if places is not None and rest:
            if all(x.has("GLUE", "FILLER", "COMMA") for x in rest):
                return None
            return (AtPlaces(places, self.read(rest, asked=asked)),)
        if search("THAN|than|COMPARE", lexemes):
            return None
        rest, places = place_after(self.source, lexemes)
        if places is None or not rest:
            return None
        if any(x.has("PRON") for x in rest[-1:]) and match_start("WHQ", rest):
            return None
        try:
            body = self.read(rest, asked=asked)
        except NotUnderstoodError:
            return None
        if not body or any(isinstance(step, Forbid | Report) for step in body):
            return None
        return (AtPlaces(places, body),)

    def _plain(self, lexemes: Sequence[Lexeme], asked: bool) -> tuple[Step, ...] | None:
        """Read a clause without adjuncts."""
        failed: NotUnderstoodError | None = None
        if (
            any(x.has("PICTURE", "SNAP", "ANOTHER") for x in lexemes)
            and any(x.has("TAKE", "SNAP", "TAKE-ING", "SNAP-ING") for x in lexemes)
            and not any(x.has("LEFT", "RIGHT", "UP", "DOWN") for x in lexemes)
        ):
            step = look_step(self.source, lexemes, asked=asked)
            if isinstance(step, Snap | AtPlaces):
                return (step,)
        for read in (zoom_step, turn_step):
            try:
                if not is_question(lexemes) and not is_report(lexemes, asked=asked) and (step := read(lexemes)) is not None:
                    return (step,)
            except NotUnderstoodError as error:
                failed = failed or error
        if (checked := check_places_step(self.source, lexemes)) is not None:
            return (checked,)
        if (place := unknown_place(self.source, lexemes)) is not None:
            return (place,)
        try:
            found = look_step(self.source, lexemes, asked=asked)
        except NotUnderstoodError as error:
            raise failed or error from None
        if found is not None:
            return found if isinstance(found, tuple) else (found,)
        view: View | None = (
            "full" if any(x.has("FULL") for x in lexemes) else "current" if any(x.has("NOW") for x in lexemes) else None
        )
        if view and all(x.has("NOW", "FULL", "FILLER", "PREP", "GLUE", "AND", "not", "only", "NOT", "NEGATED") for x in lexemes):
            return (Forbid() if any(x.has("NOT", "NEGATED") for x in lexemes) else Rescope(view),)
        if full_match("(DET)? FREE{1,3}", lexemes) and not asked:
            name = text_of(self.source, lexemes)
            return (GoToPreset(PresetRef(name, has_article=lexemes[0].has("DET")), "bare"),)
        if failed:
            raise failed
        return None


def is_report(lexemes: Sequence[Lexeme], *, asked: bool) -> bool:
    """Return whether a clause tells or asks about a move, instead of commanding it: "I panned left", "did you pan left?"."""
    if asked and lexemes[0].word in _ASKING:
        return True
    if match_start("(SELF|PRON|(DET)? CAMERA|DET VIEWNOUN|DET PICTURE) (BE|HAVEV|'s) ", lexemes):
        return True
    is_past = any(x.has(*_PAST_FORMS) and not x.has(*VERBS) for x in lexemes)
    return is_past and lexemes[0].has("SELF", "PRON", "CAMERA")


def bare_clause(lexemes: Sequence[Lexeme]) -> tuple[Lexeme, ...]:
    """Return a clause without courtesy at either end."""
    lexemes = tuple(lexemes)
    while lexemes:
        match = match_start(_WRAPPERS[0], lexemes)
        if not match or not match.size or match.size >= len(lexemes):
            break
        lexemes = lexemes[match.size :]
    if (match := full_match("(?P<body>_+?) with DET CAMERA", lexemes)) is not None:
        lexemes = tuple(match["body"])
    while (
        len(lexemes) > 1
        and (
            lexemes[-1].has("FILLER", "COMMA", "QUOTE", "AND", "DASH", "OPEN", "CLOSE", "PURPOSE", "INSTEAD")
            or (lexemes[-1].has("LEADFILLER") and lexemes[-2].has("COMMA", "DASH"))
        )
        and not lexemes[-1].has("NOW", "VISIBLE", "FULL", "AGAINWORD", "INTURN")
    ):
        lexemes = lexemes[:-1]
    return lexemes
