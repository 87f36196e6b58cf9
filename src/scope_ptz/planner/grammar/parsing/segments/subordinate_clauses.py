"""Recognise the words that begin a subordinate clause: "if", "until", "so that", "to check the fence"."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.english.grammar.parts_of_speech import verb_form
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.clause import DIRECTIONS, UNTIL_LIMIT, VERBS
from scope_ptz.planner.grammar.parsing.parts.courtesy import GLAD
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start, search
from scope_ptz.planner.grammar.parsing.parts.statements import is_event
from scope_ptz.planner.grammar.parsing.segments.clause_starts import GERUNDS
from scope_ptz.planner.grammar.parsing.segments.open_clause import SegmentationState

_GOES = (
    "(FILLER|FIRSTLY|WRAPPER|SWITCH|CARRY|LEAVE|KEEP|HOMEWARD|BACK|TURN|CAMERA|SELF|PRON|it|DET|PRESETNOUN|PREP|GLUE)* "
    "(PRESET|HOME) (PRESETNOUN|FILLER)*"
)
"""A clause that only goes to a preset or home."""

_OCCASION = "DET? (?P<noun>FREE{1,3}) (shift|watch|run|patrol|break|check|round)? (COMMA|STOP|AND|THEN|\\Z)"

PAST_VERBS = "|".join(f"{verb}-ED" for verb in VERBS)


def _is_occasion(words: Sequence[Lexeme]) -> bool:
    """Return whether the words after "before" name an occasion: "lunch", "the next test case", "I go to lunch"."""
    named = full_match("(DET|ORDINAL|PRON|THEN)* FREE{1,3} (FILLER)*", words) or full_match("SELF (go|leave|head|SWITCH) _+", words)
    return named is not None and not any(x.has("PRESET", "NUM", *DIRECTIONS) for x in words)


class SubordinateClauseDetector(SegmentationState):
    """Recognises the beginnings of subordinate clauses."""

    def _marker_at(self, i: int) -> str:
        """Return the class of a word that begins a subordinate clause; "" for other words."""
        lexeme = self.lexemes[i]
        marker = next(
            (
                name
                for name in ("IFSO", "IFNOT", "UNTIL", "UNLESS", "AFTER", "BEFORE", "WHEN", "WHILE", "IF", "REASON")
                if lexeme.has(name)
            ),
            "",
        )
        rest = self.lexemes[i + 1 :]
        if lexeme.word == "in_case" and self.words and not self._is_question():
            return "REASON"  # "pan left in case there is someone"
        if lexeme.word == "on" and not self.words and match_start("(SEE-ING|FIND-ING) (ANY|SOMEONE|NUM)", rest):
            return "WHEN"  # "on seeing a fox, take a picture"
        if (lexeme.word == "to" and self._has_purpose(rest)) or (lexeme.word == "for" and self._is_for_purpose(i)):
            return "REASON"
        if (
            lexeme.word == "with"
            and not self.words
            and match_start("(ATLEAST|ATMOST|MORETHAN|FEWERTHAN|EXACTLY|NONE|no|NUM ORMORE|fewer|more)", rest)
        ):
            return "IF"
        if (
            lexeme.word in {"so_that", "so"}
            and self.words
            and match_start("(DET|SELF|PRON|FREE) _", rest)
            and (self._only_explains(rest) or (match_start("(it|they|PRON)", rest) and self._zooms_in_on_thing()))
        ):
            return "REASON"
        if (
            not marker
            or (lexeme.word == "should" and self.words)
            or (lexeme.word == "as_the" and search("(as|close) _?? \\Z", self.words))
        ):
            return ""  # "the zoom should be increased"
        if (
            marker in {"IF", "WHEN", "AFTER"}
            and match_start("(SELF|HAVEV)* (ZOOM|ZOOM-ING|ZOOM-ED) IN? (on|onto) (it|them)", rest)
            and (self._is_question() or any(x.has("READ", "TELL", "TELL-S", "WHQ") for x in self.words))
        ):
            return ""  # "what does it say when you zoom in on it?"
        if (
            marker == "IF"
            and search(
                f"(WRAPPER|would) (be|FREE|appreciate)+ \\Z|"
                f"({GLAD}|great|good|nice|appreciated|kind|appreciate it|helpful|lovely) \\Z",
                self.words,
            )
            and match_start(f"SELF (MODAL|{PAST_VERBS})", rest)
        ):
            return ""  # "I would be grateful if you would ..."
        if marker in {"IF", "WHEN"} and self._is_asking() and not lexeme.has("IFSO"):
            return ""  # "tell me if it is open"
        if (
            any(x.has("LEADMORE", "COMPARE") for x in self.words)
            and (self._is_question() or self.words[0].has("COMPARE"))
            and marker in {"BEFORE", "AFTER", "IF", "WHEN"}
        ):
            return ""  # "are there more cars after panning left?"
        if (
            marker in {"BEFORE", "AFTER"}
            and rest
            and (
                match_start("(and|or|AND|OR) (BEFORE|AFTER)", rest)
                or (i and self.lexemes[i - 1].has("AND", "OR") and i > 1 and self.lexemes[i - 2].has("BEFORE", "AFTER"))
            )
        ):
            return ""
        if marker in {"BEFORE", "AFTER"}:
            verbal = match_start(
                r"(SELF|FILLER|HAVEV|FIRSTLY)* (" + "|".join([*GERUNDS, *(f"{v}-ED" for v in VERBS), *VERBS]) + ")", rest
            )
            if marker == "AFTER" and match_start("(SELF|HAVEV)* (SEE|SEE-ED|SEE-ING|FIND-ED|FIND-ING) (ANY|SOMEONE|NUM)", rest):
                return "WHEN"
            if marker == "AFTER" and match_start("(BE)? (at|on|in) DET? PRESET", rest):
                return marker  # "once you are at the gate"
            if (
                marker == "AFTER"
                and lexeme.word.endswith("you_have")
                and match_start("(found|got)? (PRON|it|one) (COMMA|THEN)", rest)
            ):
                return marker  # "until you see a van. When you have it, ..."
            shot = match_start(r"(DET|NUM)? (PICTURE|CLOSER|look)", rest)
            end = next((j for j, x in enumerate(rest) if x.has("COMMA", "STOP", "QUESTION", "THEN")), len(rest))
            if marker == "BEFORE" and (is_event(rest[:end]) or (full_match(_GOES, self.words) and _is_occasion(rest[:end]))):
                return marker
            return marker if shot or (verbal and not match_start("DET|EVERY", rest)) else ""
        if marker == "IFNOT" and lexeme.word == "else" and self.words and self.words[-1].has("SOMEONE", "WHQ", "NOONE"):
            return ""
        if marker == "WHEN" and lexeme.word == "once" and not match_start("SELF|there|DET|PRON|it|FREE|SOMEONE|NUM", rest):
            return ""
        if marker == "UNTIL" and match_start("_{1,5}? (fills|takes) ", rest):
            return ""  # "zoom in until the truck fills the frame"
        if marker == "UNTIL" and self._is_motion() and match_start(UNTIL_LIMIT, self.lexemes[i:]):
            return ""  # "zoom in until you hit the limit"
        if marker == "WHEN" and lexeme.word == "when" and not self.words and match_start("(DOV|BE|MODAL) ", rest):
            return ""  # "when does the shop close?"
        if marker == "REASON" and not self.words and not rest:
            return ""
        if marker == "REASON" and lexeme.word.startswith("as") and search("(SAMEAMOUNT|same|many|much) _{0,6} \\Z", self.words):
            return ""  # "is the number of cars the same as the number of vans?"
        return marker

    def _is_for_purpose(self, i: int) -> bool:
        """Return whether "for" at a position says what a command is for: "zoom in for a better look", "go home for lunch"."""
        rest = self.lexemes[i + 1 :]
        if self._is_motion() and match_start("DET (FREE|CLOSER|LITTLE|WIDER|good)+ (look|view|VIEWNOUN|PICTURE)", rest):
            return True
        is_sized = any(x.has(*DIRECTIONS, "ZOOM") for x in self.words) and any(x.has("NUM", "LITTLE", "LOT") for x in self.words)
        if self._is_motion() and is_sized and match_start("DET FREE{1,3} (COMMA|STOP|AND|THEN|\\Z)", rest):
            return True  # "tilt up 15 for the owl box"
        if not full_match(_GOES, self.words):
            return False
        looks = not self.words[-1].has("HOME") and any(x.has("TELL", "FIND", "SCAN", "COUNT", "AIM") for x in self.lexemes[:i])
        occasion = match_start(_OCCASION, rest)  # "put it on the gate for the night shift", unlike "check the gate for vans"
        return not looks and occasion is not None and (rest[0].has("DET") or not occasion["noun"][-1].word.endswith("s"))

    def _has_purpose(self, rest: Sequence[Lexeme]) -> bool:
        """Return whether the words after "to" say what a move or picture is for: "pan left to check the fence"."""
        verbs = (
            r"(SEE|TELL|READ|SHOW|COUNT|cover|catch|inspect|watch|view|avoid|keep|make|get|give|have|include|follow|"
            r"take_in|stay) (?!(to|LEFT|RIGHT|UP|DOWN))"
        )
        is_named = bool(match_start(verbs, rest))
        if not (is_named or self._aims_at_goal(rest)) or self._is_question():
            return False
        moves = any(x.has("PAN", "TILT", "TURN", "RAISE", "LOWER", *DIRECTIONS) for x in self.words)
        sized_zoom = any(x.has("ZOOM", "ENLARGE", "WIDEN", "OUT", "WIDER") for x in self.words) and any(
            x.has("NUM", "LITTLE", "LOT", "LIMIT", "PERCENT", "OUT", "WIDEN", "WIDER", "TWICE") for x in self.words
        )
        pictures = any(x.has("PICTURE") for x in self.words) and any(x.has("TAKE", "SNAP") for x in self.words)
        return not any(x.has("FREE") for x in self.words) and (moves or sized_zoom or pictures)

    def _aims_at_goal(self, rest: Sequence[Lexeme]) -> bool:
        """Return whether the words after "to" say what a move with an amount is for: "zoom out 30% to match the other view"."""
        is_sized = any(x.has("NUM", "LITTLE", "LOT", "LIMIT", "PERCENT", "FRACTION", "TWICE") for x in self.words)
        is_verb = bool(rest) and rest[0].has("FREE") and verb_form(rest[0].word) == "base"
        return is_sized and is_verb and match_start("_ (DET|SELF|PRON)", rest) is not None

    def _zooms_in_on_thing(self) -> bool:
        """Return whether the clause so far names a thing to zoom in on: "frame the tanker so that it fills the picture"."""
        return any(x.has("FREE") for x in self.words) and any(x.has("SHOW", "ZOOM", "ENLARGE", "FIND", "AIM") for x in self.words)

    def _only_explains(self, rest: Sequence[Lexeme]) -> bool:
        """Return whether the words after "so that" only state a purpose, without an angle or a thing to zoom in on."""
        end = next((i for i, x in enumerate(rest) if x.has("COMMA", "STOP", "QUESTION", "AND", "THEN")), len(rest))
        words = rest[:end]
        zooms = any(x.has("ZOOM", "ZOOM-ING", "ENLARGE", "CLOSER") for x in self.words) and not (words and words[0].has("SELF"))
        zooms = zooms and not any(x.has("NUM", "LIMIT", "LITTLE", "LOT", "PERCENT") for x in self.words)
        return (
            not zooms
            and bool(search("BE|MODAL|HAVEV|SHOW|SHOW-S", words))
            and not any(
                x.has(
                    "NUM",
                    "FRACTION",
                    "TWICE",
                    "THRICE",
                    *DIRECTIONS,
                    "REVERSE",
                    "LEVEL",
                    "HORIZON",
                    "WHOLETHING",
                    "AIM-ING",
                    "SOMEONE",
                )
                for x in words
            )
        )
