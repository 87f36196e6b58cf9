"""Recognise questions by their form: a question word, or a verb before its subject."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.patterns import match_start, search

_LEAD = (
    r"((in|on|at|behind|between|near|under|beside|among) (DET|NUM)* (FREE|PREP|DET|NUM)+ COMMA|from (LEFT|"
    r"RIGHT|PREP|FREE|UP|DOWN) to? (LEFT|RIGHT|UP|DOWN|FREE) COMMA|FILLER|COMMA|so|and|FIRSTLY|NOW|FULL|"
    r"LEADFILLER|QUOTE)*"
)
_FORMS = (
    r"(in|at|on|from|to|of|by|with|for|under|behind)? (WHQ|what|which|who|where|how|HOWMANYMORE|HOWMANY)",
    r"have (SELF|they|any|the FREE+ (been|got|gone|left|arrived))",
    r"do the (?!(rounds|round|usual|(other|same) (thing|one|ones|way)|tour|lot|following|trick|thing|job|FULL|PRESET)) _ _ _*|"
    r"do (SELF|these|those|all|any|PRON|SOMEONE|both|EVERY)",
    (
r"(BE|does|did|has|had) (not)? (there|DET|PRON|SOMEONE|NOONE|FREE|SELF|PRESET|ANY|NUM|CAMERA|PICTURE|"
r"EVERY|VISIBLE|LEADMORE|MORE|NONE|it|NOW|everyone|everybody|everything|ATLEAST|MORETHAN|FEWERTHAN|PREP)"
),
    (
r"(can|could|did|does|would|will|might|MODAL) (SELF|DET|PRON|SOMEONE|FREE|EVERY|ANY) (ADVERB|FILLER)* "
r"(SEE|READ|TELL|FREE|count|spot|be|find|have|BE|HAVEV|look|fit|get|make_out|identify|LOOKSLIKE)"
),
    r"(anyone|anybody|anything|NOONE|nothing) (?!(HAVEV|MODAL|BUT|EXCEPT)) (_)+ \Z",
    r"from (LEFT|RIGHT|nearest|UP|DOWN|top|bottom) to _+? (WHQ|in which|which|what)",
    r"any (?!(chance|luck|news|idea|ideas|way|reason|time|moment|joy|day|minute|good|problem|problems|questions))"
    r" (FREE|SOMEONE) (?!(SELF|MODAL))",
    r"(put|rank|arrange|sort) _+? in_order (of|by|from) _+",
    r"(out_of|of|among|between) _+ (COMMA) (which|what|who)",
)  # fmt: skip
_COMMANDS = (
    r"(then|and|COMMA|but) (FILLER|FIRSTLY)* (PAN|TILT|ZOOM) (IN|OUT|LEFT|RIGHT|UP|DOWN|NUM|it|CAMERA)|NUM "
    r"DEG (LEFT|RIGHT|UP|DOWN)|(PAN|TILT) (LEFT|RIGHT|UP|DOWN)|THEN|WRAPPER"
)


def is_question(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether lexemes have the form of a question and contain no command."""
    return any(match_start(f"{_LEAD} {form}", lexemes) for form in _FORMS) and not search(_COMMANDS, lexemes) and len(lexemes) > 1
