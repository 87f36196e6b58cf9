"""Find last words of an instruction that stop, limit or choose something without saying what is meant.

"Pan left 20 degrees. Less", "follow the truck, stop" and "go to the yard. The last one" are no instructions that the camera can
carry out in part: what comes last changes what comes first. The planner asks.
"""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.planner.grammar.lexing.lexer import Lexeme, lexemes_of
from scope_ptz.planner.grammar.parsing.parts.clause import DIRECTIONS, MARKERS, MOTION_VERBS, VERBS
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, search

_PAUSES = ("STOP", "COMMA", "DASH", "COLON")
_OPENERS = "(FILLER|BUT|AND|COMMA|DASH|no|well|just|INSTEAD)*"
_CLOSERS = "(FILLER|INSTEAD|NOW|there|COMMA|though|then)*"
_UNIT = "(DEG|X|PERCENT)"

_NOTHING = "(do|DOV) nothing|stay_put|(do|DOV) not (touch|LITTLE|do|move|change) (anything|a thing|it)"
_STOPPING = f"(HALT|pause|freeze|{_NOTHING}) (it|right)*"
"""Words that stop the camera. After several commands, "stop" and "over" are signals of radio operators."""

_LEAVING = (
    "leave_it_where_it_is|leave_it as it is|leave_it as_it_is|LEAVE (it|that|WHOLETHING) (alone|as it is|as_it_is|where it is)"
)
"""Words that leave the camera alone: "pan left 30. Actually leave it where it is"."""

_AMOUNT = (
    f"(NUM {_UNIT}?)? (less|more|fewer)|NUM {_UNIT}? (ATMOST|maximum|max|tops|ORFEWER)|ATMOST NUM {_UNIT}?|"
    "(CARRY|TAKE|it|that)* ((?!twice|thrice) (DOUBLE|TRIPLE|QUADRUPLE|HALVE)) (it|that)?|half (of)? (it|that)|"
    "(it|that|this) (BE|'s) (not_enough|not enough|insufficient|too much|too little)|not_enough"
)
"""An amount that changes the one that was said."""

_WAS_TOO_MUCH = "(that|it|this) (was|were) (LITTLE|LOT|way|far)* too (much|far|close|near|tight|LOT|CLOSER|TIGHT)"
"""Too much of an earlier move. Before it, "zoom out" and "go back" are the remedy: "zoom out, that was too much"."""

_REMEDY = ("OUT", "WIDEN", "DECREASE", "BACK", "UNDO")

_NOT_SO = "not (so|that) (ADVERB|LOT|FREE|CLOSER|WIDER|WIDE|TIGHT)"
_TOO = "(FILLER|LITTLE|LOT)* too (?P<much>far|LOT|FREE|UP|DOWN|IN|OUT|CLOSER|WIDER|WIDE|TIGHT)"
_TOO_CLOSE, _TOO_WIDE = frozenset({"close", "tight", "near", "narrow", "big"}), frozenset({"wide", "small"})
_TOO_HIGH, _TOO_LOW = frozenset({"high"}), frozenset({"low"})
_REASONS = {
    **dict.fromkeys(("OUT", "WIDEN", "DECREASE"), _TOO_CLOSE),
    **dict.fromkeys(("IN", "ENLARGE", "INCREASE"), _TOO_WIDE),
    **dict.fromkeys(("UP", "RAISE"), _TOO_LOW),
    **dict.fromkeys(("DOWN", "LOWER"), _TOO_HIGH),
}
"""What is too much before a move, by its direction: "zoom out. Too close" gives the reason for the move."""

_WAY = f"(my|your|his|her|our|their) ({'|'.join(DIRECTIONS)}) (COMMA? not _{{1,2}})?|the_other_way_round|the_other_way_around"
_ONE = "(TAKE|CARRY|SWITCH|TRIES|only|COMMA)* DET ((ORDINAL|last|latter|former) one?|other one) ((should|MODAL|BE) _{1,4})?"
_SIGH = "(ah|aah|hm|hmm|oh|er|erm|um|uh) (COMMA|DASH|FILLER)* (to|DET)* PRESET"

_ANYWHERE = (
    f"({'|'.join(MOTION_VERBS)}) _{{1,6}}? (BE|'s) (not_enough|not enough|too much|too little) FILLER* (STOP|\\Z)",
    "NUM (x|xs|×) NUM (x|xs|×)",
    "(TRACK|TRACK-ING) ((?!COMMA|STOP|AND) _){0,3} EXCEPT",
    "(TRACK|TRACK-ING) DET? FREE{1,2} (stop|halt) (STOP|\\Z)",
    "(with|on|from|using|via|through) (DET)? (CAMERA NUMBERWORD? NUM|(other|ORDINAL) CAMERA) (FILLER)* (STOP|COMMA|\\Z)",
    "on_camera NUMBERWORD? NUM (FILLER)* (STOP|COMMA|\\Z)",
    "whenever (?!SELF)",
    "(TRACK|TRACK-ING) ((?!STOP|COMMA) _){1,6} WHEN (it|he|she|they) (CARRY|CARRY-S|starts|start|sets|set|leaves|leave)",
)
"""Words that change a command wherever they stand: an amount that is not enough, exceptions, another camera, repeated events."""

_QUOTED = f"FILLER* SELF (heard|overheard|hear|remember) ((SOMEONE|him|her|them) (say|shout))? ({'|'.join(VERBS)}) _+"
"""A command that is only quoted: "I heard follow the truck on the radio"."""

_COUNTING = ("COUNT", "HOWMANY", "COUNTNOUN", "LISTING", "FIND", "TRACK", "READ", "TELL", "QUESTION", "PRESETNOUN", "WHQ", "BE")
_REPEATING = ("UNTIL", "WHILE", "REPEAT", "EACHTIME", "ATATIME", "KEEP")


def unclear_last_words(text: str, presets: tuple[str, ...]) -> str | None:
    """Return words that change a command without saying what is meant; None if there are none.

    Args:
        text: The instruction, with abbreviations written out.
        presets: The camera's presets.
    """
    lexemes = lexemes_of(text, presets)
    if not any(x.has(*VERBS, *DIRECTIONS, "PRESET") for x in lexemes) or lexemes[0].has("WHQ", "HOWMANY", "BE"):
        return None
    if full_match(_QUOTED, lexemes):
        return _quoted(text, lexemes)
    if _is_remedy(lexemes):
        return None
    for pattern in _ANYWHERE:
        if (found := search(f"(?P<words>{pattern})", lexemes)) is not None:
            return _quoted(text, found["words"])
    last = len(lexemes)
    while last and lexemes[last - 1].has("STOP"):
        last -= 1
    start = next((i for i in range(last - 1, 0, -1) if lexemes[i].has(*_PAUSES) and _changes(lexemes[:i], lexemes[i:last])), None)
    return None if start is None else _quoted(text, lexemes[start + 1 : last])


def _is_remedy(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether lexemes are one command that lessens, and the reason for it: "zoom out, that was too much"."""
    match = full_match(
        f"(?P<command>((?!COMMA|STOP|AND|THEN) _){{1,8}}) (COMMA|STOP|DASH) {_WAS_TOO_MUCH} {_CLOSERS} STOP?", lexemes
    )
    return match is not None and any(x.has(*_REMEDY) for x in match["command"]) and not any(x.has("NUM") for x in match["command"])


def _changes(before: Sequence[Lexeme], end: Sequence[Lexeme]) -> bool:
    """Return whether the last words change the command before them.

    Args:
        before: The lexemes before the pause.
        end: The pause and the last words.
    """
    if not any(x.has(*VERBS, *DIRECTIONS, "PRESET") for x in before):
        return False
    words, is_sentence = end[1:], end[0].has("STOP")
    is_single = not any(x.has(*_PAUSES, "AND", "THEN") for x in before)
    is_turn = any(x.has(*MOTION_VERBS, *DIRECTIONS) for x in before) and not any(x.has(*_COUNTING, *_REPEATING) for x in before)
    is_conditional = any(x.has(*MARKERS, "IFNOT") for x in before)
    if not is_conditional and _is(_STOPPING, words) and (is_single or _is(_NOTHING, words)):
        return True
    if is_turn and ((is_single and _is(_AMOUNT, words)) or (is_sentence and _is(_NOT_SO, words)) or _is_too_much(before, words)):
        return True
    if is_turn and not any(x.has("PICTURE") for x in before) and _is(_LEAVING, words):
        return True
    if is_turn and (_is(_WAY, words) or (is_sentence and _denies_way(before, words))):
        return True
    names_place = any(x.has("PRESET") for x in before)
    if (is_turn or names_place) and not any(x.has(*_COUNTING) for x in before) and _is(_ONE, words):
        return True
    return is_sentence and names_place and full_match(_SIGH, words) is not None


def _is(pattern: str, words: Sequence[Lexeme]) -> bool:
    return full_match(f"{_OPENERS} ({pattern}) {_CLOSERS}", words) is not None


def _is_too_much(before: Sequence[Lexeme], words: Sequence[Lexeme]) -> bool:
    """Return whether words say that the move before them is too much: "zoom in. Too far"."""
    match = full_match(f"{_OPENERS} {_TOO} {_CLOSERS}", words)
    if match is None:
        return False
    much = match["much"][0].word
    return not any(x.has(way) and much in reasons for x in before for way, reasons in _REASONS.items())


def _denies_way(before: Sequence[Lexeme], words: Sequence[Lexeme]) -> bool:
    """Return whether words deny the direction of the move before them: "pan left 20. Not left"."""
    match = full_match(f"{_OPENERS} not (?P<way>{'|'.join(DIRECTIONS)}|IN|OUT) {_CLOSERS}", words)
    return match is not None and match["way"][0].word in {x.word for x in before}


def _quoted(text: str, lexemes: Sequence[Lexeme]) -> str:
    """Return the words of lexemes as the user wrote them."""
    return text[lexemes[0].start : lexemes[-1].end].strip(" ,.;!")
