"""Split the lexemes of an instruction into clauses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from scope_ptz.english.grammar.parts_of_speech import verb_form
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.clause import DIRECTIONS, MOTION_VERBS, Clause
from scope_ptz.planner.grammar.parsing.parts.courtesy import is_polite
from scope_ptz.planner.grammar.parsing.parts.noun_phrases import is_noun_phrase
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start, search
from scope_ptz.planner.grammar.parsing.parts.scopes import scope_of
from scope_ptz.planner.grammar.parsing.segments.clause_boundaries import ClauseBoundaryDetector
from scope_ptz.planner.grammar.parsing.segments.clause_starts import (
    ENDS,
    HEADINGS,
    PLACE_LEAD,
    SEPARATORS,
    TASK_NOUNS,
)

_MAX_HEADING_WORDS = 4
_STATION = "(CAMERA NUM?|LEADFILLER NUM?|(DET)? (control|base|ops|dispatch|hq|security) FREE?)"
_OPENER = (
    f"(FILLER)* {_STATION} (from|to|this is) {_STATION}|(FREE|STEPNOUN|TURNNOUN)* (test|check|drill|exercise|routine)|"
    "(FILLER|WRAPPER)* do DET rounds (for us|FILLER)*"
)
"""Words before a comma that only open an instruction: "control to camera two, ...", "step test, ...", "do the rounds, ..."."""

_COURTESY_FIRST = (
    "(FILLER|LEADFILLER|COMMA)* (WRAPPER|MODAL SELF) (FILLER|LEADFILLER|COMMA|WRAPPER)*"
    " (?=IF (?!SELF MODAL)|UNLESS|for NUM SECONDS|NUM X COLON|(TWICE|THRICE) COLON)"
)
"""Courtesy before a condition, a duration or a number of times."""


def clauses_of(lexemes: Sequence[Lexeme]) -> list[Clause]:
    """Return the clauses of an instruction."""
    times = "(?P<times>X NUM|NUM X|TWICE|THRICE)"
    group = full_match(
        f"(?P<group>OPEN _+ CLOSE) {times} (STOP|FILLER)*|{times} COLON? (?P<group>OPEN _+ CLOSE) (STOP|FILLER)*", lexemes
    )
    if group is not None and not any(x.has("OPEN", "CLOSE") for x in group["group"][1:-1]):
        inner = [replace(x, word=",", classes=frozenset({"COMMA"})) if x.has("STOP") else x for x in group["group"][1:-1]]
        colon = replace(inner[0], word=":", end=inner[0].start, classes=frozenset({"COLON"}))
        lexemes = (*group["times"], colon, *inner)  # "(pan left 20; photo) x3"
    return _Splitter(_without_courtesy_before_condition(lexemes)).split()


def _without_courtesy_before_condition(lexemes: Sequence[Lexeme]) -> tuple[Lexeme, ...]:
    """Return lexemes without "could you" before a condition, a duration or a number: "could you, if there is a van, zoom in"."""
    kept: list[Lexeme] = []
    i = 0
    while i < len(lexemes):
        if (not kept or kept[-1].has(*ENDS)) and (match := match_start(_COURTESY_FIRST, lexemes[i:])):
            i += match.size
            continue
        kept.append(lexemes[i])
        i += 1
    return tuple(kept)


class _Splitter(ClauseBoundaryDetector):
    def split(self) -> list[Clause]:
        i = 0
        while i < len(self.lexemes):
            i = self._step(i)
        self._close()
        return self.completed

    def _step(self, i: int) -> int:
        """Handle the lexeme at a position, and return the next position."""
        lexeme = self.lexemes[i]
        ends = [mark for mark in ENDS if lexeme.has(mark)]
        if (after := self._after_topic(i)) is not None:
            return after
        if "COLON" in ends and self._continues_after_colon(i):
            self.words.append(lexeme)
            return i + 1
        if self._is_question() and match_start("OPEN (at|in|from|DET|PRESETNOUN)* PRESET PRESETNOUN? CLOSE", self.lexemes[i:]):
            self._close(True)
            self.link = "."
            return i + 1  # "is the barrier open (gate preset)"
        if ends:
            self._close("QUESTION" in ends)
            self.link = "." if ends[0] != "COLON" else ":"
            return i + 1
        if lexeme.has("THEN") and not (
            lexeme.word == "next"
            and (
                match_start("_ (to|FREE COLON)", self.lexemes[i:])
                or (self.words and self.words[-1].has("DET") and match_start("_ FREE", self.lexemes[i:]))
            )
        ):
            self._close()
            self.link, self.opener = "." if self.link == "." else "then", lexeme
            return i + 1
        if (
            self.words
            and lexeme.has("COMMA", "AND")
            and search("(to|at) (DET|ABSOLUTE)* (PAN|TILT|PANNOUN|TILTNOUN) (of|at)? NUM DEG? \\Z", self.words)
            and match_start("(DET|ABSOLUTE)* (PAN|TILT|ZOOM|TILTNOUN|PANNOUN) (of|at)? NUM", self.lexemes[i + 1 :])
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
        if (after := self._after_order_word(i)) is not None:
            return after
        if self.words and self._is_meanwhile(i):
            self._close()
            self.link = "and"
            return i + (2 if lexeme.word == "as" else 1)
        if marker := self._marker_at(i):
            self._close()
            self.marker, self.opener = marker, lexeme
            return i + 1
        if lexeme.has("COMMA") and (
            (self.marker not in {"AFTER", "WHEN"} and full_match(PLACE_LEAD, self.words))
            or (self._is_amount() and any(x.has("STEPNOUN") for x in self.words))
        ):
            self.words.append(lexeme)
            return i + 1
        if lexeme.has("COMMA") and len(self.words) == 1 and (self.words[0].word == "close_up" or self.words[0].has("EACHTIME")):
            return i + 1  # "close-up, conveyor belt", "at each, count the people"
        if lexeme.has("COMMA") and self.words and all(x.has("INTURN") for x in self.words):
            self.order_words, self.words = tuple(self.words), []
            return i + 1  # "one by one, go through the presets"
        if lexeme.has("COMMA", "DASH", "AND") and self._is_choice_of_presets(i):
            self.words.append(lexeme)
            return i + 1
        if (
            self.marker in {"IFSO", "IFNOT"}
            and not self.words
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
            and self._is_completed_by([x for x in self.lexemes[i + 1 :] if not x.has("BUT")])
        ):
            self.words.append(lexeme)
            return i + 1  # "zoom in, but only a little"
        if lexeme.word == "so" and self.words and i + 1 < len(self.lexemes) and self._is_verb(i + 1):
            self.marker = "REASON" if self._is_reason_for(self.lexemes[i + 1]) else self.marker  # "bit of glare so tilt down"
            self._close()
            self.link, self.opener = "and", lexeme
            return i + 1  # "the picture is too dark, so pan right"
        if not self.completed and lexeme.has("COMMA", "DASH") and full_match(_OPENER, self.words):
            self.words = []
            return i + 1
        if lexeme.has(*SEPARATORS):
            if not self.completed and not self.marker and is_polite(self.words):
                self.words = []
                return i + 1  # "do forgive me, could you zoom out?"
            after = i + 1
            while after < len(self.lexemes) and self.lexemes[after].has("COMMA", "AND", "DASH", "OPEN", "CLOSE"):
                after += 1
            if after < len(self.lexemes) and self._begins(after):
                words = {x.word for x in self.lexemes[i:after]}
                together = [x for x in self.lexemes[i:after] if x.has("ATSAMETIME")]
                self._close()
                self.words = together
                self.link = self.link or (
                    "and" if together else "," if len(words) > 1 or lexeme.has("COMMA", "DASH", "OPEN", "CLOSE") else "and"
                )
                return after
            if lexeme.has("DASH", "OPEN", "CLOSE") or (lexeme.has("COMMA") and (not self.words or after >= len(self.lexemes))):
                return i + 1
        elif self.words and self._begins_without_separator(i):
            self._close()
            self.link = self.link or "and"
        self.words.append(lexeme)
        return i + 1

    def _after_topic(self, i: int) -> int | None:
        """Handle a separator after a label or heading. Return the next position, or None for other separators."""
        lexeme = self.lexemes[i]
        is_colon = lexeme.has("COLON")
        if is_colon and self._is_label(i):
            return i + 1
        if is_colon and full_match("ABSOLUTE (FREE|PRESETNOUN|angles|pose)?", self.words):
            self.words = self.words[:1]
            return i + 1  # "absolute: pan 72 and tilt -9"
        if is_colon and not self.completed and full_match("(FILLER|DET)* FULL", self.words):
            self.words.append(replace(lexeme, word=",", classes=frozenset({"COMMA"})))
            return i + 1  # "entire area: are there more vans than bikes?"
        in_order = r"COMMA INTURN FILLER* (STOP|COMMA|\Z)"
        if lexeme.has("COMMA") and self.words and self._is_tour() and match_start(in_order, self.lexemes[i:]):
            return i + 1  # "gate, yard, in that order"
        if lexeme.word == "reason" and match_start("_ COLON", self.lexemes[i:]) and (self.completed or self.words):
            self._close()
            self.marker, self.opener = "REASON", lexeme
            return i + 2  # "pan left 38, reason: alarm on the door"
        if is_colon and self._is_heading(i):
            self.words = []
            return i + 1
        return None

    def _is_heading(self, i: int) -> bool:
        """Return whether the words before a colon only open the instruction: "Steps:", "steward to camera two:", "Step test:"."""
        if self.completed or not self.words:
            return False
        if full_match(
            "(FILLER|WRAPPER)* ((do|make|run|start|begin|take) DET)? (FREE|quick|short|full)? (tour|patrol|round|rounds|circuit) "
            "(for us|FILLER)*",
            self.words,
        ):
            return True  # "do the rounds: ..."
        if len(self.words) == 1 and (self.words[0].word in HEADINGS or self.words[0].has("FREE")):
            return True
        if full_match("(FREE|DET|FILLER)* (to)? CAMERA NUM?|FREE{1,2} (TELL|SHOW|COUNT|time|report|check)", self.words):
            return True
        names_task = self.words[-1].word in TASK_NOUNS and len(self.words) <= _MAX_HEADING_WORDS
        return names_task and not any(x.has("PRESET", "NUM", *DIRECTIONS) for x in self.words) and self._begins(i + 1)

    def _is_choice_of_presets(self, i: int) -> bool:
        """Return whether a separator follows presets to choose from: "gate or yard, which has more cars?"."""
        leads = "(SWITCH|CARRY|SHOW|COMPARE|WRAPPER|to|me|us|FILLER)*"
        presets = "(DET)? PRESET (DET|COMMA|PRESET|AND|OR|THAN|with|to)* (AND|OR|THAN|with|to) DET? PRESET FILLER*"
        asked = "(AND|COMMA|TELL|me|us|FILLER|see)*"
        return bool(
            full_match(f"{leads} {presets}", self.words)
            and match_start(f"_ {asked} (whichever|(WHQ|where) _{{0,4}} (SUPERLATIVE|LEADMORE))", self.lexemes[i:])
        )

    def _continues_after_colon(self, i: int) -> bool:
        """Return whether the words after the colon at a position belong to the same clause as those before it."""
        if not self.words or (i + 1 < len(self.lexemes) and self._is_verb(i + 1)):
            return False
        if self._is_question() and i + 1 < len(self.lexemes) and not self._begins(i + 1):
            return True  # "which of these can be seen: a clock or a bench?"
        if full_match("(PRESET|DET|AND|OR|THAN|COMMA|PRESETNOUN)+", self.words) and any(
            x.has("AND", "OR", "THAN") for x in self.words
        ):
            return True  # "tills or escalators: which has more shoppers?"
        if is_noun_phrase(self.words) and match_start("_ (FREE|ADVERB|DET|PREP)+ OR _{1,4} QUESTION", self.lexemes[i:]):
            return True  # "display case: open or shut?"
        return self.words[0].has("COMPARE") or bool(
            search("WHQ _* SUPERLATIVE|WHQ _* LEADMORE|(busier|quieter|fuller|emptier) with|(more|fewer) FREE \\Z", self.words)
        )

    def _is_afterwards(self, i: int) -> bool:
        """Return whether "after" means "afterwards", because it stands between "and" and the last command."""
        rest = self.lexemes[i + 1 :]
        is_last = not any(x.has("COMMA", "AND", "THEN", "COLON", "DASH") for x in rest)
        follows_and = self.lexemes[i - 1].has("AND") and not self._is_question()
        return follows_and and is_last and bool(rest) and self._is_verb(i + 1) and verb_form(rest[0].word) == "base"

    def _after_order_word(self, i: int) -> int | None:
        """Handle a word that states the order of commands, and return the next position; None for other words."""
        lexeme = self.lexemes[i]
        if lexeme.word == "after" and self.completed and not self.words and self._is_afterwards(i):
            self.link = "then"
            return i + 1  # "take a picture and after go home"
        if lexeme.word == "after" and self.words and match_start("_ (COMMA|STOP|AND|THEN|\\Z)", self.lexemes[i:]):
            return i + 1  # "..., and zoom out after"
        if self._is_ordinal_of_list(i):
            self._close()
            self.link = "then"
            return i + 1
        first = match_start("(COMMA|AND)* (BUT (FIRSTLY|BEFORE that)|but_before that) COMMA?", self.lexemes[i:])
        if first is not None and self._begins(i + first.size):
            self._close()
            self.marker = "FIRST"
            return i + first.size  # "pan left 20, but first take a picture"
        return None

    def _is_label(self, i: int) -> bool:
        """Return whether the words before the colon at a position name what follows it: "preset: yard", "tilt: -5"."""
        if 0 < len(self.words) < 3 and self.words[-1].has("PRESETNOUN", "CAMERA") and scope_of(self.words) is None:
            return True
        if full_match("(close_up|COUNT|READ|TRACK|FIND|headcount|presence check|COUNTNOUN|LISTING)", self.words):
            return True  # "close-up: padlock"
        return bool(self.words) and self.words[-1].has("PAN", "TILT", "ZOOM") and bool(match_start("_ NUM", self.lexemes[i:]))

    def _is_ordinal_of_list(self, i: int) -> bool:
        """Return whether "second" or "third" at a position begins the next command of a list that begins with "first"."""
        words = [x.word for x in self.lexemes]
        return (
            self.lexemes[i].word in {"second", "third", "fourth", "fifth", "sixth"}
            and words[0] in {"first", "firstly"}
            and self.lexemes[i - 1].has(*SEPARATORS, "STOP")
            and i + 1 < len(self.lexemes)
            and not self.lexemes[i + 1].has("PRESETNOUN", "PRESET", "FREE")
            and self._begins(i + 1)
        )

    def _is_meanwhile(self, i: int) -> bool:
        """Return whether "while panning" or "as you pan" begins at a position."""
        rest = self.lexemes[i:]
        gerunds = "|".join(f"{verb}-ING" for verb in MOTION_VERBS)
        return (
            bool(match_start(f"(WHILE|AND) ({gerunds})|(WHILE|as) SELF (PAN|TILT|ZOOM|TURN|CARRY)", rest)) and rest[0].has("WHILE")
        ) or bool(match_start("as SELF (PAN|TILT|ZOOM|TURN)", rest))

    def _close(self, is_question: bool = False) -> None:
        if self.completed and not self.marker and self.words and all(x.has("FILLER", "COMMA") for x in self.words):
            self.words = []
            return
        if self.words and self.order_words:
            self.words, self.order_words = [*self.words, *self.order_words], ()
        if self.words or self.marker in {"IFSO", "IFNOT"}:
            self.completed.append(Clause(self.link, self.marker, tuple(self.words), is_question, self.opener))
            self.link = ""
        elif self.completed and is_question:
            pass
        self.words, self.marker, self.opener = [], "", None
