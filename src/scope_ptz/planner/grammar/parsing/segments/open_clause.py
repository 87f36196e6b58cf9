"""The clause that is being read: its words so far, and their properties."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.clause import DIRECTIONS, MOTION_VERBS, VERBS, Clause
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start, search
from scope_ptz.planner.grammar.parsing.segments.clause_starts import (
    AFTER_VERB,
    GERUNDS,
    NOUNS_TOO,
    PLACE_LEAD,
    QUESTION_FORMS,
)


class OpenClause:
    """The words of an instruction, the clauses completed so far, and the words of the clause being read."""

    def __init__(self, lexemes: Sequence[Lexeme]) -> None:
        self.lexemes = tuple(lexemes)
        self.out: list[Clause] = []
        self.now: list[Lexeme] = []
        self.link, self.marker = "", ""
        self.opener: Lexeme | None = None
        self.order: tuple[Lexeme, ...] = ()  # "one by one" before a clause, to be appended to its words

    def _is_asking(self) -> bool:
        return bool(self.now) and bool(search(r"(TELL|TELL-ING|WRAPPER|see|check) (me|us|FILLER|SELF)* \Z", self.now))

    def _is_question(self) -> bool:
        place = match_start(f"({PLACE_LEAD}) COMMA", self.now)
        lead = [x for x in self.now[place.size if place else 0 :] if not x.has("FILLER", "FIRSTLY", "COMMA", "NOW")]
        return bool(match_start(QUESTION_FORMS, lead)) or bool(
            match_start(
                (
                    r"(WRAPPER|FILLER)* (TELL|DESCRIBE|LISTING) (me|us|FILLER|SELF)* (if|whether|what|which|who|where|how|"
                    r"HOWMANY|WHQ|PREP WHQ|IF|that)"
                ),
                lead,
            )
        )

    def _is_verb(self, i: int) -> bool:
        """Return whether the lexeme at a position is a verb in the imperative."""
        lexeme = self.lexemes[i] if i < len(self.lexemes) else None
        if lexeme is None or not lexeme.has(*VERBS):
            return False
        after = self.lexemes[i + 1] if i + 1 < len(self.lexemes) else None
        return lexeme.word not in NOUNS_TOO or (
            after is None
            or after.has(*AFTER_VERB)
            or (lexeme.word == "set" and after.has("PAN", "TILT", "ZOOM", "PANNOUN", "TILTNOUN", "ZOOMNOUN"))
            or after.word in {"to", "at", "on", "for", "towards", "whether", "if", "that", "what"}
        )

    def _is_amount(self) -> bool:
        """Return whether the clause so far is only an amount, as in "4x zoom" or "in 10 degree steps, pan right"."""
        return bool(full_match("(FILLER|in|by|with|DET|NUM|X|DEG|PERCENT|STEPNOUN|ATATIME|LITTLE|AMOUNTISH|of|COMMA)*", self.now))

    def _is_free_of_nouns(self) -> bool:
        return not any(x.has("FREE") for x in self.now)

    def _is_reason_for(self, verb: Lexeme) -> bool:
        """Return whether the clause so far only names a thing that explains a turn: "bit of glare (so tilt down)".

        A thing before a zoom may be what to zoom in on, so it is not taken for a reason.
        """
        if self.marker or verb.has("ZOOM", "ENLARGE", "TRACK", "FIND"):
            return False
        words = [x for x in self.now if not x.has("FILLER", "COMMA", "LEADFILLER")]
        known = ("FREE", "DET", "ANY", "PREP", "LITTLE", "LOT", "ADVERB", "NONE")
        is_command = any(x.has(*VERBS, *DIRECTIONS, "NUM", "PRESET", "HOME", "PICTURE") for x in words)
        return any(x.has("FREE") for x in words) and not is_command and all(x.has(*known) for x in words)

    def _is_motion(self) -> bool:
        return (
            self._is_free_of_nouns()
            and not self._is_question()
            and any(x.has(*MOTION_VERBS, *DIRECTIONS, *GERUNDS, "CLOSER", "WIDER", "ENLARGE", "WIDEN", "HOME") for x in self.now)
        )

    def _awaits(self, rest: Sequence[Lexeme]) -> bool:
        """Return whether the words after a separator complete the previous move: "left, about ten degrees", "up and left 10"."""
        is_exact = bool(match_start("(AMOUNTISH|COMMA|by)* NUM", rest))
        has_amount = any(x.has("NUM", "FRACTION", "LIMIT") or (not is_exact and x.has("LITTLE", "LOT")) for x in self.now)
        has_way = any(x.has(*DIRECTIONS) for x in self.now)
        only_amount = match_start(
            (
                r"(but|BUT|only|AMOUNTISH|COMMA|by|DET)* (NUM|FRACTION|LITTLE|LOT|LIMIT) (DEG|AMOUNTISH|of|DET|TURNNOUN|X|"
                r"FILLER|PERCENT|each SIDE)* (COMMA|AND|THEN|STOP|QUESTION|\Z)"
            ),
            rest,
        )
        no_way = (
            not has_way
            and any(x.has("NUM") for x in self.now)
            and bool(match_start("(to)? (DET)? (LEFT|RIGHT|UP|DOWN) (FILLER)* (COMMA|AND|THEN|STOP|\\Z)", rest))
        )
        if no_way and any(x.has("PAN", "TILT", "TURN", "DEG") for x in self.now):
            return True  # "6 more degrees of tilt, upwards"
        two_ways = has_way and match_start("(LEFT|RIGHT|UP|DOWN)", rest) and self.now[-1].has(*DIRECTIONS)
        return not has_amount and (
            ((has_way or bool(search("IN|OUT|ENLARGE|WIDEN", self.now))) and bool(only_amount)) or bool(two_ways)
        )

    def _is_order(self) -> bool:
        """Return whether presets are listed in order to compare them: "put gate and yard in order of ...", "whichever of ..."."""
        ordered = self.now[0].word in {"put", "rank", "order", "sort", "arrange", "list"} and any(
            x.word in {"in_order", "in_order_of", "order", "by"} for x in self.lexemes
        )
        if self.now[0].word == "do" and any(x.has("HAVEV") for x in self.lexemes):
            return True  # "do the gate and the yard have ...?"
        return ordered or any(x.word == "whichever" for x in self.now)

    def _is_tour(self) -> bool:
        """Return whether the clause so far goes to a preset or home, so that further names continue the tour."""
        return (
            self._is_free_of_nouns()
            and any(x.has("PRESET", "HOME", "BACK") for x in self.now)
            and not self._is_question()
            and self.now[0].word not in {"at", "for", "from", "in", "on", "between", "using", "out_of", "of", "among"}
            and not any(x.has("REPEAT", "COUNT", "COUNT-ING", "COMPARE", "PICTURE", "READ", "OR", "TELL") for x in self.now)
            and not self._is_order()
        ) or (bool(self.out) and bool(self.now) and all(x.has("PICTURE", "SNAP") for x in self.now))
