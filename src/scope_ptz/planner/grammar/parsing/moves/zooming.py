"""Parse clauses that change the magnification."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from scope_ptz.planner.grammar.instruction_tree import Aim, Back, Move, Repeat, Step, Unclear, Zoom
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.clause import (
    AS_FAR_AS,
    DANGLING,
    DIRECTIONS,
    UNTIL_LIMIT,
    NotUnderstoodError,
    fraction_of,
)
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start, search

_MAX_PLAUSIBLE_FACTOR = 20.0  # larger numbers without a unit may be percentages
LITTLE_FACTOR, LOT_FACTOR, PLAIN_FACTOR = 1.25, 4.0, 2.0  # factors for "a little", "a lot" and no amount
_VERBS = (
    "ZOOM",
    "ENLARGE",
    "WIDEN",
    "INCREASE",
    "DECREASE",
    "CARRY",
    "DOACT",
    "AIM",
    "SWITCH",
    "DOUBLE",
    "TRIPLE",
    "QUADRUPLE",
    "HALVE",
    "KEEP",
    "LOWER",
    "RAISE",
    "TURN",
)
_SILENT = (
    *_VERBS, *(f"{verb}-ING" for verb in _VERBS), "ZOOMNOUN", "CAMERA", "VIEWNOUN", "PICTURE", "PRON", "DET", "AMOUNTISH", "MORE",
    "FILLER", "SELF", "GLUE", "ATSAMETIME", "WHOLETHING", "COMMA", "CLOSER", "WIDER", "IN", "OUT", "LEADFILLER", "BACK", "QUOTE",
    "ABSOLUTE", "FIRSTLY", "INTURN", "BUT",
)  # fmt: skip
_INWARDS = ("ENLARGE", "CLOSER", "IN", "INCREASE", "DOUBLE", "TRIPLE", "QUADRUPLE", "TIGHT", "RAISE")
_OUTWARDS = ("WIDEN", "WIDER", "OUT", "DECREASE", "HALVE", "WIDE", "LOWER", "RESETZOOM")
ZOOM_TOPICS = (
    "ZOOM",
    "ZOOMNOUN",
    "ENLARGE",
    "WIDEN",
    "CLOSER",
    "WIDER",
    "WIDE",
    "TIGHT",
    "RESETZOOM",
    "DOUBLE",
    "TRIPLE",
    "QUADRUPLE",
    "HALVE",
)
_SIZES = frozenset({"close", "big", "large", "near", "tight", "wide"})
_AS_NOW = "((as|that|NOW)* (SELF HAVEV|(it|PRON|DET? PICTURE|DET? VIEWNOUN) (BE|DOV|appears|looks)) (NOW|now|FILLER)*)?"
"""Words that compare with the current picture: "half the size it is now", "twice as close as it does now"."""
_MAG = (
    r"((as|of|DET|SELF|current|present)* (ASCLOSE|ZOOMNOUN|level|close|big|large|near|tight|wide|value) "
    rf"{_AS_NOW}|(of)? what (SELF HAVEV|it BE) (now)?)"
)
_RELATIVE_MAG = (
    r"((as|of|DET|current|present)+ (ZOOMNOUN|level|close|big|large|near|tight|wide)|"
    r"(as|of|DET|current|present)* (?!ZOOMNOUN) ASCLOSE)"
)
"""The base that an amount multiplies. "3 times the magnification" is relative to the current zoom; "3x zoom" is absolute."""

_CHUNKS = (
    ("to factor", rf"(to|at) (DET|AMOUNTISH)* (?P<number>NUM) X? {_RELATIVE_MAG}"),
    ("to factor", rf"to (?P<multiple>TWICE|THRICE) {_MAG}"),
    ("to", (
r"(to|at|up to|down to|back to|ABSOLUTE) (DET|AMOUNTISH|ZOOMNOUN|FACTOR|of|ABSOLUTE)* (?P<number>NUM) "
r"(?P<percent>PERCENT)? X? ZOOMNOUN?"
)),
    ("fraction", rf"(by|to|of|AMOUNTISH|DET)* (?P<fraction>FRACTION) ({_MAG}|X)?"),
    ("steps", r"(in)? (?P<number>NUM) (?P<percent>PERCENT)? (X)? (STEPNOUN|ATATIME)"),
    ("percent", r"(AMOUNTISH|by)* (?P<number>NUM) PERCENT"),
    ("factor", rf"(AMOUNTISH|by|FACTOR|X|of)* (?P<number>NUM) (X)? (INTURN)? (FACTOR)? ({_MAG})?"),
    ("factor", rf"(AMOUNTISH|by)* (?P<multiple>TWICE|THRICE) ({_MAG})?"),
    ("limit", AS_FAR_AS),
    ("limit", UNTIL_LIMIT),
    ("limit", r"(AMOUNTISH)* LIMIT "),
    ("little", r"in (small|little|LITTLE) STEPNOUN"),
    ("nothing", r"(that)? SELF (can|HAVEV) (do|manage|get|got|CARRY|HAVEV)"),
    ("fraction", r"in (?P<fraction>FRACTION)"),
    ("limit", r"right(?= (IN|OUT))"),
    ("limit", r"to (DET)? (max|full|maximum|LIMIT)"),
    ("lot", r"(AMOUNTISH|DET)* LOT (MORE)? "),
    ("little", r"(AMOUNTISH|DET)* LITTLE (MORE)? "),
)  # fmt: skip
_NOT_CLEAR = Unclear("Shall I zoom in or out?")


def _with_split_direction(lexemes: Sequence[Lexeme]) -> tuple[Lexeme, ...]:
    """Split "in there" after "zoom" into a direction and a filler, as in "zoom in there as close as it goes"."""
    for i, x in enumerate(lexemes):
        if x.word in {"in_there", "in_here"} and 0 < i < len(lexemes) - 1 and lexemes[i - 1].has("ZOOM", "ZOOM-ING"):
            way = Lexeme("in", x.start, x.start + 2, frozenset({"IN", "GLUE"}))
            return (*lexemes[:i], way, Lexeme(x.word[3:], x.start + 2, x.end, frozenset({"GLUE"})), *lexemes[i + 1 :])
    return tuple(lexemes)


def zoom_step(lexemes: Sequence[Lexeme]) -> Step | None:
    """Return the step of a clause that changes the magnification; None if the clause is about something else.

    Raises:
        NotUnderstoodError: The clause is about zooming, but contains words that were not understood.
    """
    lexemes = _with_split_direction(lexemes)
    if search(
        r"(on|onto|upon|at) (?!(DET)? (ZOOM|ZOOMNOUN|(current|present) (VIEWNOUN|PICTURE))) (DET|PRON|FREE|PICTURE|"
        r"EVERY|SOMEONE)|(on|onto|upon) NUM|to (PRON|DET) (FREE|\Z)",
        lexemes,
    ):
        return None  # "zoom in on it"
    if search("CLOSER of (DET|PRON|FREE|EVERY)", lexemes):
        return None  # "get a close-up of it"
    if full_match(
        r"(FILLER)* (UNDOZOOM|(ZOOM|CARRY|PULL) (it|CAMERA)? (BACK|back) (IN|OUT|OUT again)?) (FILLER|again)*", lexemes
    ) and any(x.has("ZOOM", "UNDOZOOM") for x in lexemes):
        return Back(zoom_only=True)
    if full_match(
        (
            "(FILLER)* (SHOW|ZOOM OUT|ZOOM) (me|us|until|to|so|so_that|that|SELF|MODAL|SEE)* (everything|WHOLETHING|"
            "it all|the lot) (FILLER)*"
        ),
        lexemes,
    ) and any(x.word == "everything" or x.has("OUT") for x in lexemes):
        return Move((Zoom("out"),))
    if match_start("(FILLER)* NUM times ZOOM", lexemes):
        return _NOT_CLEAR
    is_limit = all(x.has("LIMIT", "IN", "OUT", "FILLER", "CARRY", "DET") for x in lexemes) and any(
        x.has("IN", "OUT") for x in lexemes
    )
    is_factor = (
        bool(
            match_start(
                (
                    r"(FILLER|NOW|FIRSTLY|BACK)* (OUT LITTLE|OUT LOT|IN LOT) (FILLER)*|(FILLER)* (IN|OUT) as far as|"
                    r"(FILLER|FIRSTLY)* NOW IN LITTLE (FILLER)*|(FILLER|NOW|FIRSTLY|BACK)* IN "
                    r"((?!a_bit|bit|a_little|a_step) LITTLE|LITTLE (more|further|closer)|MORE) (FILLER)* \Z|"
                    r"(FILLER|DET|BACK)* (IN|OUT)? (BACK)? NUM (X|PERCENT)|(CARRY|SWITCH|DET|CAMERA|FILLER)* (to|at) "
                    r"NUM X|(FILLER|FIRSTLY|DET|"
                    r"BACK)* (IN|OUT) (by (AMOUNTISH)* NUM|X NUM|(by)? FRACTION)|CARRY (it|"
                    r"DET VIEWNOUN|CAMERA)? NUM X"
                ),
                lexemes,
            )
        )
        or bool(search("as (big|large|close|wide)|bigger|larger|(FRACTION|TWICE|THRICE|NUM X) (of)? DET size", lexemes))
    ) and not any(x.has("PAN", "TILT", "TURN", *DIRECTIONS) or (x.has("FREE") and x.word not in _SIZES) for x in lexemes)
    if (
        not any(x.has(*ZOOM_TOPICS, *(f"{topic}-ING" for topic in ZOOM_TOPICS)) for x in lexemes)
        and not is_limit
        and not is_factor
        and not _view_limit(lexemes)
    ):
        return None
    if not any(x.has("ZOOM", "ZOOM-ING", "ZOOMNOUN", *ZOOM_TOPICS) for x in lexemes) and any(
        x.has("PAN", "TILT", "TURN") for x in lexemes
    ):
        return None
    lexemes = _in_active_voice(lexemes)
    amounts: list[tuple[str, float]] = []
    allowed: list[Lexeme] = []
    unread: list[Lexeme] = []
    i = 0
    while i < len(lexemes):
        rest = lexemes[i:]
        match, name = next(((m, name) for name, pattern in _CHUNKS if (m := match_start(pattern, rest)) and m.size), (None, ""))
        if rest[0].has("RESETZOOM", "WIDE", "TIGHT"):
            amounts.append(("limit", 0.0))
            allowed.append(rest[0])
            i += 1
        elif (match and not rest[0].has("DOUBLE", "TRIPLE")) or (match and i):
            if name != "nothing":
                amounts.append(_amount(name, match))
            i += match.size
        elif (
            rest[0].has(*_SILENT)
            or rest[0].word in {"present", "current"}
            or (rest[0].has("UP", "DOWN") and _has_zoom_noun(lexemes))
        ) and not rest[0].has("NEGATED", "NOT", "NONE"):
            allowed.append(rest[0])
            i += 1
        else:
            unread.append(rest[0])
            i += 1
    if lexemes[-1].word in DANGLING:
        unread.append(lexemes[-1])
    if unread:
        raise NotUnderstoodError(unread)
    step = _step(amounts, allowed, lexemes)
    has_verb = bool(amounts) or any(x.has(*_VERBS, *(f"{verb}-ING" for verb in _VERBS)) for x in lexemes)
    return replace(step, has_verb=has_verb) if isinstance(step, Move) else step


def _in_active_voice(lexemes: Sequence[Lexeme]) -> Sequence[Lexeme]:
    """Return "increase the zoom by 20 percent" for "the zoom should be increased by 20 percent"; other clauses unchanged."""
    verbs = "|".join(f"{verb}-ED" for verb in _VERBS)
    match = full_match(
        rf"(?P<noun>(DET|FILLER)* ZOOMNOUN) (MODAL|needs to|has to|ought to) be (?P<verb>{verbs}) (?P<rest>_*)", lexemes
    )
    if match is None:
        return lexemes
    verb = match["verb"][0]
    active = frozenset(name.removesuffix("-ED") for name in verb.classes if name.endswith("-ED"))
    return (replace(verb, classes=active), *match["noun"], *match["rest"])


def _has_zoom_noun(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether a clause names the magnification, which can go up and down: "take the zoom down 25%"."""
    return any(
        x.has("ZOOMNOUN") and (i == 0 or (lexemes[i - 1].has("DET", "UP") or lexemes[i - 1].word == "current"))
        for i, x in enumerate(lexemes)
        if i
    )


def _view_limit(lexemes: Sequence[Lexeme]) -> int:
    """Return -1 for "as wide as possible", +1 for "as close as you can", and 0 for other words."""
    match = search(AS_FAR_AS, lexemes)
    word = match["extent"][0].word if match else ""
    return -1 if word == "wide" else 1 if word in {"close", "tight", "near"} else 0


def _amount(name: str, match) -> tuple[str, float]:  # type: ignore[no-untyped-def]
    """Return the kind and the value of an amount."""
    names = match.names
    value = match["number"][0].value if "number" in names else fraction_of(match["fraction"][0]) if "fraction" in names else 0.0
    if "multiple" in names:
        value = 2.0 if match["multiple"][0].has("TWICE") else 3.0
    if "percent" in names:
        return ("percent", value) if name == "steps" else (name, value / 100)
    return ("factor" if name in {"to factor", "steps"} else name), value


def _step(amounts: list[tuple[str, float]], allowed: Sequence[Lexeme], lexemes: Sequence[Lexeme]) -> Step:
    """Return the step for a zoom, given its amounts and its other allowed words."""
    verbs = next((x for x in allowed if x.has("DOUBLE", "TRIPLE", "QUADRUPLE", "HALVE")), None)
    inwards = any(x.has(*_INWARDS, *(f"{c}-ING" for c in _INWARDS)) for x in allowed)
    outwards = any(x.has(*_OUTWARDS, *(f"{c}-ING" for c in _OUTWARDS)) for x in allowed)
    if outwards and any(x.has("OUT") for x in allowed) and all(x.has("TIGHT", "OUT") or not x.has(*_INWARDS) for x in allowed):
        inwards = False  # "full zoom out"
    if search(r"BACK (IN|OUT)", lexemes) or (any(x.has("BACK") for x in allowed) and outwards):
        inwards = inwards and bool(search("BACK IN", lexemes))
    has_zoom_noun = _has_zoom_noun(lexemes)
    inwards = (
        inwards or _view_limit(lexemes) > 0 or lexemes[0].word == "up" or (has_zoom_noun and any(x.has("UP") for x in allowed))
    )
    outwards = outwards or _view_limit(lexemes) < 0 or (has_zoom_noun and any(x.has("DOWN") for x in allowed))
    if search("(pull|bring|take|ease|wind|ZOOM) _* BACK|(BACK|ease) DET? ZOOMNOUN (off|BACK)", lexemes) and not inwards:
        outwards = True  # "pull the zoom back"
    if inwards and outwards:
        return _NOT_CLEAR
    if any(x.has("RESETZOOM") for x in allowed):
        return Move((Zoom("out"),))
    times = 1
    if (
        len(amounts) == 2
        and amounts[1][0] == "factor"
        and search(r"(NUM X|TWICE|THRICE) (INTURN|FILLER)* \Z", lexemes)
        and amounts[0][0] in {"factor", "percent", "little", "lot"}
    ):
        times = max(1, min(round(amounts[1][1]), 50))
        amounts = amounts[:1]
    exact = [amount for amount in amounts if amount[0] not in {"little", "lot"}]
    if len(exact) == 1 and len(amounts) > 1:
        amounts = exact
    if len(set(amounts)) == 1:
        amounts = amounts[:1]
    if len(amounts) > 1:
        return Unclear("By how much shall I zoom?")
    if verbs is not None and not amounts:
        value = 2.0 if verbs.has("DOUBLE") else 3.0 if verbs.has("TRIPLE") else 4.0 if verbs.has("QUADRUPLE") else 0.5
        return Move((Zoom("factor", value),))
    step = _zoomed(
        amounts[0] if amounts else ("plain", PLAIN_FACTOR), inwards - outwards, bare=not (inwards or outwards), lexemes=lexemes
    )
    return Repeat((step,), times) if times > 1 and isinstance(step, Move) else step


def _is_multiple(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether a factor multiplies the current zoom: "make it twice as big", unlike "set it to 2x"."""
    return search("TWICE|THRICE|NUM X (as (close|big|large|near|tight)|DET ASCLOSE|(?!ZOOMNOUN) ASCLOSE)", lexemes) is not None


def _zoomed(amount: tuple[str, float], sign: int, *, bare: bool, lexemes: Sequence[Lexeme]) -> Step:
    """Return the step that zooms in or out by an amount, or in an unstated direction."""
    kind, value = amount
    if search("as wide", lexemes) and kind in {"fraction", "factor"} and value > 0:
        return Move((Zoom("factor", 1 / value),))  # half as wide is twice as close
    if kind == "to" and sign == 0 and search("at (AMOUNTISH)* NUM PERCENT", lexemes):
        return _NOT_CLEAR
    if kind == "to" and value > _MAX_PLAUSIBLE_FACTOR and not search("X", lexemes):
        return Unclear("Is that a factor or a percentage?")
    if kind == "to" or (kind == "factor" and bare and search(r"(set|put|make|ABSOLUTE) ", lexemes) and not _is_multiple(lexemes)):
        return Move((Aim("zoom", value, sign),)) if value > 0 else Unclear("To how many times shall I zoom?")
    if kind in {"little", "lot", "plain"}:
        factor = {"little": LITTLE_FACTOR, "lot": LOT_FACTOR}.get(kind, PLAIN_FACTOR)
        return _NOT_CLEAR if bare else Move((Zoom("factor", factor if sign > 0 else 1 / factor),))
    if kind == "limit":
        if bare and search("(max|full|maximum)", lexemes):
            return Move((Zoom("in"),))
        return _NOT_CLEAR if bare else Move((Zoom("in" if sign > 0 else "out"),))
    if kind == "percent":
        if value < 0:
            return Move((Zoom("percent", value),)) if sign < 0 or bare else _NOT_CLEAR
        if sign < 0 and value >= 100:
            return Unclear("I can zoom out by less than 100 per cent. By how many times shall I zoom out?")
        return Move((Zoom("percent", (sign or 1) * value),))
    is_part = search("FRACTION as (close|big|large|near|tight)", lexemes) or (
        sign <= 0 and search("FRACTION (of)? DET size", lexemes)
    )
    if kind == "fraction" and is_part:
        return Move((Zoom("factor", value),))
    if kind == "fraction":
        if bare:
            return Move((Zoom("factor", value),)) if search("to|of|ZOOMNOUN", lexemes) else _NOT_CLEAR
        return Move((Zoom("factor", 1 + value if sign > 0 else (value if search("to", lexemes) else 1 - value)),))
    if value > _MAX_PLAUSIBLE_FACTOR and not search("X", lexemes):
        return Unclear("Is that a factor or a percentage?")  # "zoom in 50"
    if not 0 < value < 1000:
        return Unclear("How many times shall I zoom?")
    if sign > 0 and value < 1:
        return Unclear("A factor below 1 zooms out. Shall I zoom in or out, and how many times?")
    return Move((Zoom("factor", value if sign >= 0 or value < 1 else 1 / value),))
