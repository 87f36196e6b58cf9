"""Rewrite instructions that pass on what someone else wants: "the boss wants to know how many cars there are"."""

from __future__ import annotations

from scope_ptz.planner.grammar.lexing.lexer import lexemes_of
from scope_ptz.planner.grammar.parsing.asides import may_withdraw
from scope_ptz.planner.grammar.parsing.parts.clause import VERBS
from scope_ptz.planner.grammar.parsing.parts.patterns import match_start, search
from scope_ptz.planner.grammar.parsing.rewording.stated_places import AUXILIARIES, OTHERS, with_place_first

_MAX_LEXEMES = 80  # longer texts are parsed as they are, so that parsing stays fast
_ASKS = (
    f"{OTHERS} {AUXILIARIES} (asking|asks|ask|asked|wondering|wonders|wants_to_know|needs_to_know|would_like_to_know)|"
    "(the_boss_wants|they_want|he_wants|she_wants) to know|"
    "SELF HAVEV (got|had)? DET FREE{1,3} (asking|wondering) (?!SELF? WHQ to)"
)
_QUESTION = f"(FILLER|COMMA)* ({_ASKS}) (me|us|SELF|FILLER)* (?=IF|WHQ|HOWMANY|whether|how|BE there)"
"""Someone asks a question: "dispatch is asking how many trucks are at the gate"."""

_REQUEST = f"(FILLER|COMMA)* {OTHERS} {AUXILIARIES} (asked|told|instructed|wants|needs|like|want|need) (me|us|you) to"
"""Someone asks for something to be done: "Jim asked me to check the crossing"."""

_WANTS_PICTURE = f"(FILLER|COMMA)* {OTHERS} {AUXILIARIES} (asking|asks|asked|calling) for (?=(DET|ANY|NUM|ANOTHER)? PICTURE)"
"""Someone asks for a picture: "the boss is asking for a snapshot"."""


def relayed(text: str, presets: tuple[str, ...]) -> str | None:
    """Return an instruction without the words that relay it, or with its place first; None if it has no such words."""
    if len(lexemes_of(text, presets)) > _MAX_LEXEMES:
        return None
    asked = _without_relay(text, presets)
    placed = with_place_first(asked or text, presets)
    return placed or asked


def _without_relay(text: str, presets: tuple[str, ...]) -> str | None:
    """Return the text with "tell me" for "dispatch is asking", and without "Jim asked me to"; None for other texts."""
    lexemes = lexemes_of(text, presets)
    for i, x in enumerate(lexemes):
        if i and not lexemes[i - 1].has("STOP", "COMMA", "AND", "BUT") and x.word != "so":
            continue
        rest = lexemes[i:]
        for pattern, words in ((_QUESTION, "tell me "), (_REQUEST, "please "), (_WANTS_PICTURE, "take ")):
            match = match_start(pattern, rest)
            if match is None or match.size >= len(rest) or (words == "please " and not rest[match.size].has(*VERBS)):
                continue
            wanted = rest[match.size :]
            is_denied = search("(BUT|COMMA|DASH) _* (NOT|NEGATED)", wanted) is not None or may_withdraw(wanted)
            if is_denied or any(y.has("NOT", "NEGATED", "NONE", "NOONE") for y in rest[: match.size]):
                continue
            return f"{text[: x.start]}{words}{text[rest[match.size].start :]}"
    return None
