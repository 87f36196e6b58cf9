"""The state of splitting an instruction into clauses, and tests of the current clause."""

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


class SegmentationState:
    """The words of an instruction, the clauses completed so far, and the words of the current clause."""

    def __init__(self, lexemes: Sequence[Lexeme]) -> None:
        self.lexemes = tuple(lexemes)
        self.completed: list[Clause] = []
        self.words: list[Lexeme] = []
        self.link, self.marker = "", ""
        self.opener: Lexeme | None = None
        self.order_words: tuple[Lexeme, ...] = ()  # "one by one" before a clause, to be appended to its words

    def _is_asking(self) -> bool:
        return bool(self.words) and bool(search(r"(TELL|TELL-ING|WRAPPER|see|check) (me|us|FILLER|SELF)* \Z", self.words))

    def _is_question(self) -> bool:
        place = match_start(f"({PLACE_LEAD}) COMMA", self.words)
        lead = [x for x in self.words[place.size if place else 0 :] if not x.has("FILLER", "FIRSTLY", "COMMA", "NOW")]
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
        return bool(full_match("(FILLER|in|by|with|DET|NUM|X|DEG|PERCENT|STEPNOUN|ATATIME|LITTLE|AMOUNTISH|of|COMMA)*", self.words))

    def _is_free_of_nouns(self) -> bool:
        return not any(x.has("FREE") for x in self.words)

    def _is_reason_for(self, verb: Lexeme) -> bool:
        """Return whether the clause so far only names a thing that explains a turn: "bit of glare (so tilt down)".

        A thing before a zoom may be what to zoom in on, so it is not taken for a reason.
        """
        if self.marker or verb.has("ZOOM", "ENLARGE", "TRACK", "FIND"):
            return False
        words = [x for x in self.words if not x.has("FILLER", "COMMA", "LEADFILLER")]
        known = ("FREE", "DET", "ANY", "PREP", "LITTLE", "LOT", "ADVERB", "NONE")
        is_command = any(x.has(*VERBS, *DIRECTIONS, "NUM", "PRESET", "HOME", "PICTURE") for x in words)
        return any(x.has("FREE") for x in words) and not is_command and all(x.has(*known) for x in words)

    def _is_motion(self) -> bool:
        return (
            self._is_free_of_nouns()
            and not self._is_question()
            and any(x.has(*MOTION_VERBS, *DIRECTIONS, *GERUNDS, "CLOSER", "WIDER", "ENLARGE", "WIDEN", "HOME") for x in self.words)
        )

    def _is_completed_by(self, rest: Sequence[Lexeme]) -> bool:
        """Return whether the words after a separator complete the current move: "left, about ten degrees", "up and left 10"."""
        is_exact = bool(match_start("(AMOUNTISH|COMMA|by)* NUM", rest))
        has_amount = any(x.has("NUM", "FRACTION", "LIMIT") or (not is_exact and x.has("LITTLE", "LOT")) for x in self.words)
        has_direction = any(x.has(*DIRECTIONS) for x in self.words)
        only_amount = match_start(
            (
                r"(but|BUT|only|AMOUNTISH|COMMA|by|DET)* (NUM|FRACTION|LITTLE|LOT|LIMIT) (DEG|AMOUNTISH|of|DET|TURNNOUN|X|"
                r"FILLER|PERCENT|each SIDE)* (COMMA|AND|THEN|STOP|QUESTION|\Z)"
            ),
            rest,
        )
        lacks_direction = (
            not has_direction
            and any(x.has("NUM") for x in self.words)
            and bool(match_start("(to)? (DET)? (LEFT|RIGHT|UP|DOWN) (FILLER)* (COMMA|AND|THEN|STOP|\\Z)", rest))
        )
        if lacks_direction and any(x.has("PAN", "TILT", "TURN", "DEG") for x in self.words):
            return True  # "6 more degrees of tilt, upwards"
        has_two_directions = has_direction and match_start("(LEFT|RIGHT|UP|DOWN)", rest) and self.words[-1].has(*DIRECTIONS)
        return not has_amount and (
            ((has_direction or bool(search("IN|OUT|ENLARGE|WIDEN", self.words))) and bool(only_amount)) or bool(has_two_directions)
        )

    def _compares_presets(self) -> bool:
        """Return whether presets are listed in order to compare them: "put gate and yard in order of ...", "whichever of ..."."""
        ordered = self.words[0].word in {"put", "rank", "order", "sort", "arrange", "list"} and any(
            x.word in {"in_order", "in_order_of", "order", "by"} for x in self.lexemes
        )
        if self.words[0].word == "do" and any(x.has("HAVEV") for x in self.lexemes):
            return True  # "do the gate and the yard have ...?"
        return ordered or any(x.word == "whichever" for x in self.words)

    def _is_tour(self) -> bool:
        """Return whether the clause so far goes to a preset or home, so that further names continue the tour."""
        return (
            self._is_free_of_nouns()
            and any(x.has("PRESET", "HOME", "BACK") for x in self.words)
            and not self._is_question()
            and self.words[0].word not in {"at", "for", "from", "in", "on", "between", "using", "out_of", "of", "among"}
            and not any(x.has("REPEAT", "COUNT", "COUNT-ING", "COMPARE", "PICTURE", "READ", "OR", "TELL") for x in self.words)
            and not self._compares_presets()
        ) or (bool(self.completed) and bool(self.words) and all(x.has("PICTURE", "SNAP") for x in self.words))
