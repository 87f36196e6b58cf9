"""Recognise the words that begin a subordinate clause: "if", "until", "so that", "to check the fence"."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.clause import DIRECTIONS, VERBS
from scope_ptz.planner.grammar.parsing.parts.patterns import match_start, search
from scope_ptz.planner.grammar.parsing.segments.clause_starts import (
    GERUNDS,
)
from scope_ptz.planner.grammar.parsing.segments.open_clause import OpenClause


class SubordinateClauses(OpenClause):
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
        if lexeme.word == "in_case" and self.now and not self._is_question():
            return "REASON"  # "pan left in case there is someone"
        if lexeme.word == "to" and self._has_purpose(rest):
            return "REASON"
        if (
            lexeme.word == "for"
            and self._is_motion()
            and match_start("DET (FREE|CLOSER|LITTLE|WIDER|good)+ (look|view|VIEWNOUN|PICTURE)", rest)
        ):
            return "REASON"  # "zoom in for a better look"
        if (
            lexeme.word == "with"
            and not self.now
            and match_start("(ATLEAST|ATMOST|MORETHAN|FEWERTHAN|EXACTLY|NONE|no|NUM ORMORE|fewer|more)", rest)
        ):
            return "IF"
        if (
            lexeme.word in {"so_that", "so"}
            and self.now
            and match_start("(DET|SELF|PRON|FREE) _", rest)
            and self._only_explains(rest)
        ):
            return "REASON"
        if not marker:
            return ""
        if (
            marker in {"IF", "WHEN", "AFTER"}
            and match_start("(SELF|HAVEV)* (ZOOM|ZOOM-ING|ZOOM-ED) IN? (on|onto) (it|them)", rest)
            and (self._is_question() or any(x.has("READ", "TELL") for x in self.now))
        ):
            return ""  # "what does it say when you zoom in on it?"
        if (
            marker == "IF"
            and search(
                "(WRAPPER|would) (be|FREE|appreciate)+ \\Z|(grateful|great|good|nice|appreciated|kind|appreciate it) \\Z", self.now
            )
            and match_start("SELF MODAL", rest)
        ):
            return ""  # "I would be grateful if you would ..."
        if marker in {"IF", "WHEN"} and self._is_asking() and not lexeme.has("IFSO"):
            return ""  # "tell me if it is open"
        if (
            any(x.has("LEADMORE", "COMPARE") for x in self.now)
            and (self._is_question() or self.now[0].has("COMPARE"))
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
            verbal = match_start(r"(SELF|FILLER|HAVEV)* (" + "|".join([*GERUNDS, *(f"{v}-ED" for v in VERBS), *VERBS]) + ")", rest)
            if marker == "AFTER" and match_start("(SELF|HAVEV)* (SEE|SEE-ED|SEE-ING|FIND-ED|FIND-ING) (ANY|SOMEONE|NUM)", rest):
                return "WHEN"
            shot = match_start(r"(DET|NUM)? (PICTURE|CLOSER|look)", rest)
            return marker if shot or (verbal and not match_start("DET|EVERY", rest)) else ""
        if marker == "IFNOT" and lexeme.word == "else" and self.now and self.now[-1].has("SOMEONE", "WHQ", "NOONE"):
            return ""
        if marker == "WHEN" and lexeme.word == "once" and not match_start("SELF|there|DET|PRON|it|FREE|SOMEONE|NUM", rest):
            return ""
        if marker == "UNTIL" and match_start("_{1,5}? (fills|takes) ", rest):
            return ""  # "zoom in until the truck fills the frame"
        if marker == "WHEN" and lexeme.word == "when" and not self.now and match_start("(DOV|BE|MODAL) ", rest):
            return ""  # "when does the shop close?"
        if marker == "REASON" and not self.now and not rest:
            return ""
        return marker

    def _has_purpose(self, rest: Sequence[Lexeme]) -> bool:
        """Return whether the words after "to" say what a move or picture is for: "pan left to check the fence"."""
        verbs = (
            r"(SEE|TELL|READ|SHOW|COUNT|cover|catch|inspect|watch|view|avoid|keep|make|get|give|have|include|follow|"
            r"take_in|stay) (?!(to|LEFT|RIGHT|UP|DOWN))"
        )
        if not match_start(verbs, rest) or self._is_question():
            return False
        moves = any(x.has("PAN", "TILT", "TURN", "RAISE", "LOWER", *DIRECTIONS) for x in self.now)
        sized_zoom = any(x.has("ZOOM", "ENLARGE", "WIDEN", "OUT", "WIDER") for x in self.now) and any(
            x.has("NUM", "LITTLE", "LOT", "LIMIT", "PERCENT", "OUT", "WIDEN", "WIDER", "TWICE") for x in self.now
        )
        pictures = any(x.has("PICTURE") for x in self.now) and any(x.has("TAKE", "SNAP") for x in self.now)
        return not any(x.has("FREE") for x in self.now) and (moves or sized_zoom or pictures)

    def _only_explains(self, rest: Sequence[Lexeme]) -> bool:
        """Return whether the words after "so that" name a purpose, and neither an angle nor a thing to zoom in on."""
        end = next((i for i, x in enumerate(rest) if x.has("COMMA", "STOP", "QUESTION", "AND", "THEN")), len(rest))
        words = rest[:end]
        zooms = any(x.has("ZOOM", "ZOOM-ING", "ENLARGE", "CLOSER") for x in self.now) and not (words and words[0].has("SELF"))
        return (
            not zooms
            and bool(search("BE|MODAL|HAVEV|SHOW|SHOW-S", words))
            and not any(x.has("NUM", *DIRECTIONS, "REVERSE", "LEVEL", "HORIZON", "WHOLETHING", "AIM-ING", "SOMEONE") for x in words)
        )
