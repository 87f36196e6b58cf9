"""Decide whether another clause begins at a position, after a separator or without one."""

from __future__ import annotations

from scope_ptz.planner.grammar.parsing.parts.clause import DIRECTIONS, MARKERS, VERBS
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start, search
from scope_ptz.planner.grammar.parsing.segments.clause_starts import (
    ADJECTIVES,
    BEFORE_NOUN,
    FRAGMENT,
    GERUNDS,
    LOOSE_FRAGMENT,
    NOUN_LIKE,
    NOUNS_TOO,
    PLACE_LEAD,
    QUESTION_FORMS,
    SKIPPED,
    STARTS,
    STATEMENT,
)
from scope_ptz.planner.grammar.parsing.segments.subordinate_clauses import SubordinateClauses


class ClauseBoundaries(SubordinateClauses):
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
        if self._is_motion() and match_start("(LEFT|RIGHT|UP|DOWN)", rest) and self._awaits(rest):
            return False
        if self.marker in {"IF", "UNLESS", "WHEN", "UNTIL", "WHILE"} and first.has("NONE"):
            return False  # "if there are cars but no people"
        if first.has("THEN") or self._marker_at(j) or match_start(STARTS, rest) or match_start(FRAGMENT, rest):
            return True
        if j > i and self.lexemes[j - 1].has("WRAPPER"):
            return True
        if match_start(r"(HALT|STAY|HALT-ING|end|pause|SWITCH|CARRY) (at|on|with|up)? (the)? (first|ORDINAL)", rest) and any(
            x.has("PRESET", "PRESETNOUN") for x in self.now
        ):
            return False  # "go through the presets and stop at the first with a van"
        if first.has(*GERUNDS):
            return self._is_free_of_nouns() or first.has(
                "TRACK-ING", "TAKE-ING", "SNAP-ING", "PAN-ING", "TILT-ING", "ZOOM-ING", "COUNT-ING"
            )
        if self._is_verb(j):
            return True
        if match_start(QUESTION_FORMS, rest):
            both_counts = first.has("HOWMANY") and any(x.has("HOWMANY") for x in self.now)
            return not self._is_question() or both_counts
        if self._is_motion() and match_start(LOOSE_FRAGMENT, rest):
            return not self._awaits(rest)
        if (
            self._is_free_of_nouns()
            and (self._is_motion() or self._is_tour())
            and (match_start(STATEMENT, rest) or match_start(STATEMENT, self.lexemes[i:]))
        ):
            return True
        return self._is_tour() and bool(match_start(r"(to|on|over|back|at|DET|PRESETNOUN)* (PRESET|HOME)", rest))

    def _ends_condition(self, i: int) -> bool:
        """Return whether a verb and its object follow a complete condition: "if there is a truck waiting read its plate"."""
        if self.marker not in {"IF", "UNLESS", "WHEN"} or not self._is_verb(i) or not match_start("_ (DET|PRON)", self.lexemes[i:]):
            return False
        is_complete = any(x.has("BE", "HAVEV", "SEE") for x in self.now[:-1])
        return (
            is_complete
            and self.now[-1].has("FREE", "ADVERB", "VISIBLE", "NUM", "PRON", "PRESET")
            and not self.now[-1].has("DET", "NOT", "PREP")
        )

    def _begins_without_separator(self, i: int) -> bool:
        """Return whether a verb begins a clause although no separator precedes it: "pan left 10 tilt up 10"."""
        lexeme, before = self.lexemes[i], self.now[-1]
        if (
            lexeme.word in {"count", "tally", "check"}
            and before.has("FREE")
            and not match_start("_ (DET|FREE|NUM|EVERY|HOWMANY|PRON|how|whether)", self.lexemes[i:])
        ):
            return False  # "a people count at every preset"
        if self._ends_condition(i):
            return True
        if match_start("(with|TAKE-ING|SNAP-ING|COUNT-ING|READ-ING|DESCRIBE-ING) _{1,8}? (EACHTIME|BETWEENEACH)", self.lexemes[i:]):
            return True
        if (
            lexeme.has("ZOOM")
            and before.has("X", "PERCENT")
            and not any(x.has("ZOOM", "PAN", "TILT", "TURN", *DIRECTIONS) for x in self.now)
        ):
            return False  # "can I get 3 times zoom"
        if self.marker and before.has("ADVERB") and any(x.has("BE", "HAVEV") for x in self.now) and self._is_verb(i):
            return lexeme.has("PAN", "TILT", "ZOOM", "TAKE") or lexeme.word in {"go", "turn", "move", "track", "follow"}
        if not before.has(*NOUN_LIKE) and not (before.has("VISIBLE", "NUM", "DEG")):
            return False
        if (
            self.marker in {"IF", "UNLESS", "WHEN", "UNTIL", "WHILE"}
            and before.has("VISIBLE", "NUM")
            and self._is_verb(i)
            and len(self.now) > 1
            and lexeme.has("PAN", "TILT", "ZOOM", "TAKE", "SWITCH", "CARRY", "TRACK", "TURN")
        ):
            return True
        if self._lists_targets(i):
            return False
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
                    or (before.has("FILLER") and any(x.has("DET") for x in self.now[-3:]))
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
                and len(self.now) > 1
                and (not before.has("ADVERB") or before.has("VISIBLE"))
                and lexeme.word not in {"find", "count", "get", "come", "spot", "locate", "have"}
            )
        if self._is_question() or (before.has("FILLER", "LEADFILLER") and all(x.has(*SKIPPED) for x in self.now)):
            return False
        if (
            full_match(PLACE_LEAD, self.now)
            or not before.has(*NOUN_LIKE)
            or (before.has("FREE") and any(x.has("DET") for x in self.now[-2:-1]) and before.word in ADJECTIVES)
        ):
            return False
        return (
            (
                lexeme.word == "go"
                or lexeme.has("PAN", "TILT", "ZOOM", "TAKE", "COUNT", "SNAP", "SWITCH", "TURN", "FIND", "READ", "TRACK")
            )
            and not all(x.has(*SKIPPED, "KEEP") for x in self.now)
            and not before.has(*VERBS, *GERUNDS)
        )

    def _lists_targets(self, i: int) -> bool:
        """Return whether "tilt -10" continues a list of absolute targets: "go to pan 20 tilt -10 zoom 3"."""
        before = search("(to|at) (PAN|TILT) NUM", self.now)
        return bool(before and self.now[-1].has("NUM", "DEG") and match_start("(PAN|TILT|ZOOM) NUM", self.lexemes[i:]))
