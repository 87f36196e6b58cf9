"""Decide whether another clause begins at a position, after a separator or without one."""

from __future__ import annotations

from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.clause import DIRECTIONS, MARKERS, VERBS
from scope_ptz.planner.grammar.parsing.parts.courtesy import is_polite
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start, search
from scope_ptz.planner.grammar.parsing.parts.statements import is_comment, is_statement, without_future_time
from scope_ptz.planner.grammar.parsing.segments.clause_starts import (
    ADJECTIVES,
    BEFORE_NOUN,
    ENDS,
    FRAGMENT,
    FURTHER,
    GERUNDS,
    LOOSE_FRAGMENT,
    NOUN_LIKE,
    NOUNS_TOO,
    PLACE_LEAD,
    QUESTION_FORMS,
    SEPARATORS,
    SET_THERE,
    SKIPPED,
    STARTS,
    STATEMENT,
    WITHOUT_MOVING,
    ZOOM_FRAGMENT,
)
from scope_ptz.planner.grammar.parsing.segments.subordinate_clauses import SubordinateClauseDetector

_SETTING = f"{SET_THERE}|at (DET|LIMIT|full|maximum|max|minimum|min|FREE)* (ZOOM|ZOOMNOUN)|at (TIGHT|WIDE)|at NUM X"
"""The beginning of words that say how the camera is set at a preset: "... zoomed in", "... at full zoom", "... at 3x"."""

_SIZE_TO_REACH = (
    "(so|so_that)* (it|they|PRON|WHOLETHING|DET? PICTURE|DET VIEWNOUN) (BE|looks|look|appears) (FILLER)* "
    "(FRACTION|TWICE|THRICE|NUM X) (as|of? DET size|bigger|larger|ASCLOSE)"
)
"""How large the picture is to be after a zoom: "zoom in so it's twice as close"."""

_ASKS_MORE = "(what|which) FREE{1,2} (BE|HAVEV|DOV|MODAL) DET _|(what|which|who|where|WHQ) (BE|DOV|HAVEV) DET _"
"""The beginning of a question about something other than the previous count: "... and what does the notice say?"."""

_COMMANDS = (
    "(SWITCH|CARRY|TURN|AIM|PAN|SHOW) (BACK|AROUND|over|across|straight|right|back|up|down)* (to|at|on_to|onto|towards)"
    " (DET|PRESETNOUN)* (PRESET|HOME)|(SWITCH|CARRY) (BACK|right|straight)* HOME|"
    "(TAKE|SNAP) (DET|ANOTHER|NUM)* PICTURE|"
    "ENLARGE|WIDEN|ZOOM (IN|OUT)|"
    "(SWITCH|CARRY|TURN|AIM|PAN|TILT) (the)? CAMERA? (LEFT|RIGHT|UP|DOWN) (by|to)? (NUM|LITTLE|LOT|AMOUNTISH)"
)
"""Beginnings of commands that follow a condition without a comma: "if the gate is shut head over to the yard"."""

_NO_TROUBLE = (
    "(it|that|this) (BE|MODAL be) (not)? (too|such|any|a|DET|LITTLE|LOT|much|FILLER|of)* "
    "(bother|trouble|problem|hassle|inconvenience|imposition|much|all_right|ok|okay|possible|convenient|FILLER)"
)
"""Polite words after "if", which a question may follow without a comma."""

_BEFORE_THAT = frozenset({
    "so", "think", "believe", "reckon", "say", "says", "said", "sure", "guess", "hope", "know", "mean", "means", "suppose",
    "see", "like",
})  # fmt: skip
"""Words after which "it is" continues the clause, as in "I think it's open"."""


class ClauseBoundaryDetector(SubordinateClauseDetector):
    """Recognises the beginnings of main clauses."""

    def _begins(self, i: int) -> bool:
        """Return whether a clause can begin at a position after a separator."""
        j = i
        while j < len(self.lexemes) and self.lexemes[j].has(*SKIPPED) and not self._marker_at(j):
            j += 1
        if j >= len(self.lexemes):
            return False
        rest = self.lexemes[j:]
        first = rest[0]
        if self._is_motion() and match_start("(LEFT|RIGHT|UP|DOWN)", rest) and self._is_completed_by(rest):
            return False
        if self.marker in {"IF", "UNLESS", "WHEN", "UNTIL", "WHILE"} and first.has("NONE"):
            return False  # "if there are cars but no people"
        if self._is_motion() and match_start("(in|by)? NUM DEG? (ATATIME|STEPNOUN)", rest):
            return False  # "pan right 30, 10 at a time"
        if match_start("(at|with)? NUM DEG (apart|intervals)", rest) or search("NUM DEG apart \\Z", self.words):
            return False  # "three photos, 10 degrees apart, moving left"
        if first.has("THEN") or self._marker_at(j) or match_start(STARTS, rest) or match_start(FRAGMENT, rest):
            return True
        if full_match(f"(FILLER)* {FURTHER}", self.words) and match_start(FURTHER, rest):
            return True
        if match_start(ZOOM_FRAGMENT, rest) and not self._is_question() and not self.marker:
            return True
        if j > i and self.lexemes[j - 1].has("WRAPPER"):
            return True
        if match_start(r"(HALT|STAY|HALT-ING|end|pause|SWITCH|CARRY) (at|on|with|up)? (the)? (first|ORDINAL)", rest) and any(
            x.has("PRESET", "PRESETNOUN") for x in self.words
        ):
            return False  # "go through the presets and stop at the first with a van"
        if first.has(*GERUNDS):
            return self._is_free_of_nouns() or first.has(
                "TRACK-ING", "TAKE-ING", "SNAP-ING", "PAN-ING", "TILT-ING", "ZOOM-ING", "COUNT-ING"
            )
        if self._is_verb(j) or match_start(f"MODAL you (FILLER|ADVERB)* ({'|'.join(VERBS)})", rest):
            return True
        if match_start(QUESTION_FORMS, rest):
            both_counts = first.has("HOWMANY") and any(x.has("HOWMANY") for x in self.words)
            asks_more = (
                self.lexemes[j - 1].has("AND")
                and bool(search("HOWMANY", self.words))
                and bool(match_start(_ASKS_MORE, rest))
                and not any(x.has("PRON") or x.word in {"they", "there"} for x in self._until_separator(j))
            )
            return not self._is_question() or both_counts or asks_more
        if self._is_motion() and match_start(LOOSE_FRAGMENT, rest):
            return not self._is_completed_by(rest)
        if not self._is_question() and match_start("(HOWMANY|number|numbers|COUNTNOUN) QUESTION", rest):
            return True  # "persons in frame, number?"
        if self._is_tour() and match_start(
            f"{_SETTING}|(AMOUNTISH|BACK|to|over|DET|MORE)* (IN|OUT) (to|by|NUM|LITTLE|LOT|LIMIT)", rest
        ):
            return True  # "go to the gate and out to the widest"
        if (
            self._is_free_of_nouns()
            and (self._is_motion() or self._is_tour())
            and (match_start(STATEMENT, rest) or match_start(STATEMENT, self.lexemes[i:]))
        ):
            return True
        if not self.marker and (self._is_remark(i) if not self._is_question() else is_polite(self._until_separator(i))):
            return True
        until = self._until_separator(i)
        if not self.marker and self.lexemes[i - 1].has("COMMA") and len(without_future_time(until)) < len(until):
            return self._is_remark(i)  # "how many vans are there, we start in ten minutes"
        return self._is_tour() and bool(match_start(r"(to|on|over|back|at|DET|PRESETNOUN)* (PRESET|HOME)", rest))

    def _is_tour_or_motion(self) -> bool:
        """Return whether the clause so far is a command that moves the camera."""
        return not self.marker and not self._is_question() and (self._is_tour() or self._is_motion())

    def _until_separator(self, i: int) -> tuple[Lexeme, ...]:
        """Return the lexemes from a position to the next separator or the end of the sentence."""
        later = range(i + 1, len(self.lexemes))
        end = next((j for j in later if self.lexemes[j].has(*ENDS, *SEPARATORS, "THEN")), len(self.lexemes))
        return self.lexemes[i:end]

    def _is_remark(self, i: int) -> bool:
        """Return whether a statement, a comment or a polite phrase stands between a position and the next separator."""
        words = without_future_time(self._until_separator(i))
        if any(x.has("NUM", "DEG", *DIRECTIONS) for x in words):
            return False
        return is_statement(words) or is_comment(words) or is_polite(words)

    def _ends_condition(self, i: int) -> bool:
        """Return whether a verb and its object follow a complete condition: "if there is a truck waiting read its plate"."""
        if self.marker not in {"IF", "UNLESS", "WHEN"} or not self._is_verb(i):
            return False
        if match_start(_COMMANDS, self.lexemes[i:]) and self.words[-1].has(*NOUN_LIKE, "ADVERB"):
            states = any(x.has("BE", "HAVEV", "SEE", "NOONE", "NONE", "ANY") for x in self.words)
            return states or (self.words[0].word == "of" and len(self.words) > 1)  # "in case of smoke go home"
        if not match_start("_ (DET|PRON)", self.lexemes[i:]):
            return False
        is_complete = any(x.has("BE", "HAVEV", "SEE") for x in self.words[:-1])
        if full_match("there BE (not_any|NONE|none|no)", self.words):
            return True  # "if there aren't any check the bus bay"
        return (
            is_complete
            and self.words[-1].has("FREE", "ADVERB", "VISIBLE", "NUM", "PRON", "PRESET")
            and not self.words[-1].has("DET", "NOT", "PREP")
        )

    def _begins_without_separator(self, i: int) -> bool:
        """Return whether a verb begins a clause although no separator precedes it: "pan left 10 tilt up 10"."""
        lexeme, before = self.lexemes[i], self.words[-1]
        if self._begins_run_on_remark(i):
            return True
        is_told = bool(match_start("(FILLER|DET)* CAMERA", self.words))  # "the camera at the gate panned left"
        if before.has("PRESET") and not is_told and self._is_tour() and match_start(_SETTING, self.lexemes[i:]):
            return True  # "the gate at full zoom"
        if (
            lexeme.word in {"count", "tally", "check"}
            and before.has("FREE")
            and not match_start("_ (DET|FREE|NUM|EVERY|HOWMANY|PRON|how|whether)", self.lexemes[i:])
        ):
            return False  # "a people count at every preset"
        if self._ends_condition(i) or self._begins_remark(i):
            return True
        if self.marker == "IF" and full_match(_NO_TROUBLE, self.words) and match_start("(MODAL|DOV) SELF", self.lexemes[i:]):
            return True  # "if it is not too much bother could you ..."
        states = self.marker in {"IF", "UNLESS", "WHEN"} and search("BE|HAVEV|SEE", self.words[:-1])
        if states and match_start(f"MODAL you (FILLER|ADVERB)* ({'|'.join(VERBS)})", self.lexemes[i:]):
            return True  # "if the gate is open could you take a picture"
        if self.marker in {"IF", "UNLESS"} and search("BE|HAVEV|SEE", self.words[:-1]):
            takes = "get (me|us) DET? (PICTURE|CLOSER|FREE)"
            allows = "SELF (can|may|should|must) (PAN|TILT|ZOOM|TURN|CARRY|SWITCH|TAKE|TRACK|COUNT)"
            if match_start(f"{takes}|{allows}", self.lexemes[i:]):
                return True  # "if there is no queue you can go home"
        if (
            before.has("PRESET", "HOME", "NUM", "DEG")
            and self._is_tour_or_motion()
            and match_start("(do|MODAL) not _", self.lexemes[i:])
        ):
            return True  # "go to the gate don't take a picture"
        if lexeme.word == "without" and match_start(WITHOUT_MOVING, self.lexemes[i:]):
            is_request = match_start(f"(FILLER|COMMA)* MODAL SELF (FILLER|ADVERB)* ({'|'.join(VERBS)})", self.words)
            return is_request is not None or not self._is_question()  # "pan left 20 without zooming"
        if match_start(
            "(with|TAKE-ING|SNAP-ING|COUNT-ING|READ-ING|DESCRIBE-ING) _{1,8}? (EACHTIME|BETWEENEACH|EVERY NUM)", self.lexemes[i:]
        ):
            return True
        if (
            lexeme.has("ZOOM")
            and before.has("X", "PERCENT")
            and not any(x.has("ZOOM", "PAN", "TILT", "TURN", *DIRECTIONS) for x in self.words)
        ):
            return False  # "can I get 3 times zoom"
        if self.marker and before.has("ADVERB") and any(x.has("BE", "HAVEV") for x in self.words) and self._is_verb(i):
            return lexeme.has("PAN", "TILT", "ZOOM", "TAKE") or lexeme.word in {"go", "turn", "move", "track", "follow"}
        if not before.has(*NOUN_LIKE) and not (before.has("VISIBLE", "NUM", "DEG")):
            return False
        if (
            self.marker in {"IF", "UNLESS", "WHEN", "UNTIL", "WHILE"}
            and before.has("VISIBLE", "NUM")
            and self._is_verb(i)
            and len(self.words) > 1
            and lexeme.has("PAN", "TILT", "ZOOM", "TAKE", "SWITCH", "CARRY", "TRACK", "TURN")
        ):
            return True
        if match_start("(PAN|TILT) FILLER* (STOP|COMMA|AND|THEN|QUESTION|\\Z)", self.lexemes[i:]) and search(
            "NUM DEG? of? (LEFT|RIGHT|UP|DOWN) \\Z", self.words
        ):
            return False  # "ten degrees of right pan"
        if self._lists_targets(i) or (lexeme.has("TURNNOUN", "ZOOMNOUN") and search(r"DET NUM (DEG|X)? \Z", self.words)):
            return False  # "give me a 4 degree pan"
        if (
            before.has("NUM", "DEG")
            and self._is_motion()
            and match_start(
                "(TAKE|SNAP) (DET|NUM|ANOTHER) PICTURE|(TAKE|SNAP) ANOTHER \\Z|COUNT (DET|EVERY|FREE)|READ DET", self.lexemes[i:]
            )
        ):
            return True  # "pan right 60 take a picture"
        if (
            self.marker == "WHILE"
            and len(self.words) > 2
            and match_start("KEEP (PAN-ING|TILT-ING|ZOOM-ING|TURN-ING)", self.lexemes[i:])
        ):
            return True  # "as long as there is no van keep panning"
        if (
            not self._is_verb(i)
            or (
                lexeme.word in NOUNS_TOO
                and (
                    before.has("DET", "FRACTION", "LIMIT", "LITTLE", "TURNNOUN", "AMOUNTISH", "NUM")
                    or before.word in {"full", "complete", "whole", "half", "quarter"}
                    or not match_start("_ (LEFT|RIGHT|UP|DOWN|AROUND)", self.lexemes[i:])
                )
            )
            or (
                (
                    before.has(*BEFORE_NOUN, "FIRSTLY", "COMMA", "AND", "OR", "BE")
                    or (before.has("FILLER") and any(x.has("DET") for x in self.words[-3:]))
                )
                and not before.has("DEG", *DIRECTIONS, "IN", "OUT")
            )
        ):
            return (
                before.has("NUM", "DEG", *DIRECTIONS)
                and lexeme.has("PAN", "TILT", "ZOOM")
                and not self._is_question()
                and not self._is_amount()
            )
        if self._is_amount():
            return False
        if self.marker in {"IF", "UNLESS", "WHEN", "UNTIL", "WHILE"}:
            return (
                lexeme.has("PAN", "TILT", "ZOOM", "TAKE", "SWITCH", "CARRY", "FIND", "TRACK", "COUNT", "TURN")
                and not before.has("SELF", "MODAL", "TO", "NOT", *MARKERS)
                and len(self.words) > 1
                and (not before.has("ADVERB") or before.has("VISIBLE"))
                and lexeme.word not in {"find", "count", "get", "come", "spot", "locate", "have"}
            )
        if self._is_question() or (before.has("FILLER", "LEADFILLER") and all(x.has(*SKIPPED) for x in self.words)):
            return False
        if (
            full_match(PLACE_LEAD, self.words)
            or not before.has(*NOUN_LIKE)
            or (before.has("FREE") and any(x.has("DET") for x in self.words[-2:-1]) and before.word in ADJECTIVES)
        ):
            return False
        return (
            (
                lexeme.word == "go"
                or lexeme.has("PAN", "TILT", "ZOOM", "TAKE", "COUNT", "SNAP", "SWITCH", "TURN", "FIND", "READ", "TRACK")
            )
            and not all(x.has(*SKIPPED, "KEEP") for x in self.words)
            and not before.has(*VERBS, *GERUNDS)
        )

    def _begins_remark(self, i: int) -> bool:
        """Return whether "it's" or "there's" begins a remark after a complete clause: "count the cars it's busy today"."""
        if i + 2 >= len(self.lexemes) or len(self.words) < 2 or self.marker:
            return False
        lexeme, verb, before = self.lexemes[i], self.lexemes[i + 1], self.words[-1]
        is_contraction = lexeme.end == verb.start and verb.has("BE", "HAVEV", "MODAL")
        return (
            is_contraction
            and lexeme.word in {"it", "there", "he", "she", "they", "i", "we", "someone", "somebody", "something"}
            and before.has(
                "FREE", "PRESET", "VISIBLE", "NUM", "DEG", "LITTLE", "LOT", "LIMIT", "FILLER", "HOME", "PICTURE", *DIRECTIONS
            )
            and before.word
            not in {"what", "where", "how", "that", "which", "whether", "colour", "color", "time", "kind", "way", *_BEFORE_THAT}
            and not before.has("REL", "WHQ", "PREP", "COMMA")
        )

    def _begins_run_on_remark(self, i: int) -> bool:
        """Return whether a statement follows a complete command without a separator: "tilt up a lot there is too much sky"."""
        if self.marker or self._is_question() or not self._is_motion() or len(self.words) < 2:
            return False
        ends = self.words[-1].has(
            "NUM", "DEG", "X", "PERCENT", "LITTLE", "LOT", "LIMIT", "MORE", "IN", "OUT", "AROUND", "REVERSE", "HOME", *DIRECTIONS
        )  # fmt: skip
        is_completed = self._is_completed_by(self.lexemes[i:]) or match_start(_SIZE_TO_REACH, self.lexemes[i:]) is not None
        return ends and not is_completed and self._is_remark(i)

    def _lists_targets(self, i: int) -> bool:
        """Return whether "tilt -10" continues a list of absolute targets: "go to pan 20 tilt -10 zoom 3"."""
        before = search("(to|at) (PAN|TILT) NUM", self.words)
        return bool(before and self.words[-1].has("NUM", "DEG") and match_start("(PAN|TILT|ZOOM) NUM", self.lexemes[i:]))
