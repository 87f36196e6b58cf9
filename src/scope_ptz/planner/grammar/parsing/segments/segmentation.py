"""Split the lexemes of an instruction into clauses."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.clause import MOTION_VERBS, Clause
from scope_ptz.planner.grammar.parsing.parts.noun_phrases import is_noun_phrase
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start, search
from scope_ptz.planner.grammar.parsing.segments.clause_boundaries import ClauseBoundaries
from scope_ptz.planner.grammar.parsing.segments.clause_starts import (
    ENDS,
    HEADINGS,
    PLACE_LEAD,
    SEPARATORS,
)


def clauses_of(lexemes: Sequence[Lexeme]) -> list[Clause]:
    """Return the clauses of an instruction."""
    return _Splitter(lexemes).split()


class _Splitter(ClauseBoundaries):
    def split(self) -> list[Clause]:
        i = 0
        while i < len(self.lexemes):
            i = self._step(i)
        self._close()
        return self.out

    def _step(self, i: int) -> int:
        """Handle the lexeme at a position, and return the next position."""
        lexeme = self.lexemes[i]
        ends = [mark for mark in ENDS if lexeme.has(mark)]
        if "COLON" in ends and 0 < len(self.now) < 3 and self.now[-1].has("PRESETNOUN", "CAMERA"):
            return i + 1  # "preset: yard"
        if "COLON" in ends and self._is_heading():
            self.now = []
            return i + 1
        if "COLON" in ends and self._continues_after_colon(i):
            self.now.append(lexeme)
            return i + 1
        if self._is_question() and match_start("OPEN (at|in|from|DET|PRESETNOUN)* PRESET PRESETNOUN? CLOSE", self.lexemes[i:]):
            self._close(True)
            self.link = "."
            return i + 1  # "is the barrier open (gate preset)"
        if ends:
            self._close("QUESTION" in ends)
            self.link = "." if ends[0] != "COLON" else ":"
            return i + 1
        if lexeme.has("THEN") and not (lexeme.word == "next" and match_start("_ (to|FREE COLON)", self.lexemes[i:])):
            self._close()
            self.link = "." if self.link == "." else "then"
            return i + 1
        if (
            self.now
            and lexeme.has("COMMA", "AND")
            and search("(to|at) (PAN|TILT|PANNOUN|TILTNOUN) NUM DEG? \\Z", self.now)
            and match_start("(PAN|TILT|ZOOM|TILTNOUN) NUM", self.lexemes[i + 1 :])
        ):
            return i + 1  # "point at pan 30, tilt -10"
        if (
            lexeme.word == "to"
            and self._is_tour()
            and match_start(
                "(COUNT|READ|TAKE|TELL (whether|if|how|what|HOWMANY)|SEE (whether|if|how|what|HOWMANY)) ", self.lexemes[i + 1 :]
            )
        ):
            self._close()
            self.link = "and"
            return i + 1  # "go to the yard to count the cars"
        if self.now and self._is_meanwhile(i):
            self._close()
            self.link = "and"
            return i + (2 if lexeme.word == "as" else 1)
        if marker := self._marker_at(i):
            self._close()
            self.marker, self.opener = marker, lexeme
            return i + 1
        if lexeme.has("COMMA") and (
            full_match(PLACE_LEAD, self.now) or (self._is_amount() and any(x.has("STEPNOUN") for x in self.now))
        ):
            self.now.append(lexeme)
            return i + 1
        if (
            self.marker in {"IFSO", "IFNOT"}
            and not self.now
            and lexeme.has("COMMA")
            and i + 1 < len(self.lexemes)
            and self.lexemes[i + 1].has("AND")
        ):
            self._close()
            self.link = "and"
            return i + 2  # "... if there is, and to the yard if there is not"
        if (
            lexeme.has("BUT", "COMMA")
            and self._is_motion()
            and self._awaits([x for x in self.lexemes[i + 1 :] if not x.has("BUT")])
        ):
            self.now.append(lexeme)
            return i + 1  # "zoom in, but only a little"
        if lexeme.word == "so" and self.now and i + 1 < len(self.lexemes) and self._is_verb(i + 1):
            self._close()
            self.link = "and"
            return i + 1  # "the picture is too dark, so pan right"
        if lexeme.has(*SEPARATORS):
            after = i + 1
            while after < len(self.lexemes) and self.lexemes[after].has("COMMA", "AND", "DASH", "OPEN", "CLOSE"):
                after += 1
            if after < len(self.lexemes) and self._begins(after):
                words = {x.word for x in self.lexemes[i:after]}
                self._close()
                self.link = self.link or ("," if len(words) > 1 or lexeme.has("COMMA", "DASH", "OPEN", "CLOSE") else "and")
                return after
            if lexeme.has("DASH", "OPEN", "CLOSE") or (lexeme.has("COMMA") and (not self.now or after >= len(self.lexemes))):
                return i + 1
        elif self.now and self._begins_without_separator(i):
            self._close()
            self.link = self.link or "and"
        self.now.append(lexeme)
        return i + 1

    def _is_heading(self) -> bool:
        """Return whether the words before a colon only open the instruction: "Steps:", "steward to camera two:", "queue check:"."""
        if self.out or not self.now:
            return False
        return (len(self.now) == 1 and (self.now[0].word in HEADINGS or self.now[0].has("FREE"))) or bool(
            full_match("(FREE|DET|FILLER)* (to)? CAMERA NUM?|FREE{1,2} (TELL|SHOW|COUNT|time|report|check)", self.now)
        )

    def _continues_after_colon(self, i: int) -> bool:
        """Return whether the words after the colon at a position belong to the same clause as those before it."""
        if not self.now:
            return False
        if self._is_question() and i + 1 < len(self.lexemes) and not self._begins(i + 1):
            return True  # "which of these can be seen: a clock or a bench?"
        if full_match("(PRESET|DET|AND|OR|THAN|COMMA|PRESETNOUN)+", self.now) and any(x.has("AND", "OR", "THAN") for x in self.now):
            return True  # "tills or escalators: which has more shoppers?"
        if is_noun_phrase(self.now) and match_start("_ (FREE|ADVERB|DET|PREP)+ OR _{1,4} QUESTION", self.lexemes[i:]):
            return True  # "display case: open or shut?"
        return self.now[0].has("COMPARE") or bool(search("WHQ _* SUPERLATIVE|WHQ _* LEADMORE", self.now))

    def _is_meanwhile(self, i: int) -> bool:
        """Return whether "while panning" or "as you pan" begins at a position."""
        rest = self.lexemes[i:]
        gerunds = "|".join(f"{verb}-ING" for verb in MOTION_VERBS)
        return (
            bool(match_start(f"(WHILE|AND) ({gerunds})|(WHILE|as) SELF (PAN|TILT|ZOOM|TURN|CARRY)", rest)) and rest[0].has("WHILE")
        ) or bool(match_start("as SELF (PAN|TILT|ZOOM|TURN)", rest))

    def _close(self, is_question: bool = False) -> None:
        if self.out and not self.marker and self.now and all(x.has("FILLER", "COMMA") for x in self.now):
            self.now = []
            return
        if self.now or self.marker in {"IFSO", "IFNOT"}:
            self.out.append(Clause(self.link, self.marker, tuple(self.now), is_question, self.opener))
            self.link = ""
        elif self.out and is_question:
            pass
        self.now, self.marker, self.opener = [], "", None
