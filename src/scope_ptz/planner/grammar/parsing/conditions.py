"""Read conditions: "you see at least three cars", "the gate is open", "it is raining"."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from scope_ptz.planner.grammar.instruction_tree.conditions import (
    Answered,
    Condition,
    Joined,
    Negated,
    Operator,
    Outnumbers,
    PresetOutnumbers,
    Quantity,
    Readable,
    Seen,
    Statement,
    Thing,
)
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.clause import Source, text_of, trimmed
from scope_ptz.planner.grammar.parsing.parts.noun_phrases import is_noun, is_noun_phrase, people_description, thing_of, things_of
from scope_ptz.planner.grammar.parsing.parts.patterns import Match, full_match, search
from scope_ptz.planner.grammar.parsing.parts.preset_refs import place_of
from scope_ptz.planner.grammar.parsing.parts.scopes import has_full_scope, without_view

if TYPE_CHECKING:
    from scope_ptz.tools.arguments import View

_QUANTITY = (
    r"(?P<quantity>(ATLEAST|MORETHAN|FEWERTHAN|EXACTLY|ATMOST|no MORETHAN|not MORETHAN|up to|MORE)? "
    r"(?P<number>NUM) (?P<tail>ORMORE|ORFEWER)?"
    r"|SEVERAL|MORETHAN one)"
)
_SEES = (
    r"(SELF|it|CAMERA|one|PRON|DET CAMERA) (can|could|do|ADVERB|now|actually|finally|first|HAVEV|start to|"
    r"happen to|be able to|am|are|able|to|get)* (?P<not>(do|DOV|MODAL)? not|no)? (longer|ADVERB)? (COUNT|FIND|"
    r"SEE|SEE-S|SEE-ED|SEE-ING|got|have|HAVEV|get|SHOW|hit|hits|reach|reaches|come_across|get_to|CARRY to)"
)
_APPEARS = (
    r"(BE|DOV)? (?P<not>not)? (ADVERB|clearly)* (VISIBLE|BE VISIBLE|BE (in the)? CENTREWORD|SHOW-S|SHOW-ING|"
    r"in view|(appear|appears)|(show|shows) up|(come|comes) into view|"
    r"(CARRY-S|CARRY|come|comes) into DET (PICTURE|VIEWNOUN)|appear|appears|show_up|shows_up|turns "
    r"up|turn up|come into view|comes into view|(enter|enters) the view|(get|gets) VISIBLE|come VISIBLE|comes "
    r"VISIBLE|shows VISIBLE|is VISIBLE|there|left|remain|remains|LEFT|can be SEE-ED|can be seen|exist|passes "
    r"by|(arrive|arrives)|arrive|CARRY-S up|CARRY-S VISIBLE|CARRY-S|enter DET VIEWNOUN|enters DET VIEWNOUN|"
    r"enter|enters)+ (VISIBLE|DET|VIEWNOUN|PICTURE|again|FILLER)*"
)
_GONE = (
    r"(BE)? (gone|dis(appear|appears)|disappear|disappears|vanishes|vanish|(leave|leaves) DET VIEWNOUN|leaves|"
    r"out of VISIBLE|out of (sight|view|frame|PICTURE|VIEWNOUN)|no longer VISIBLE|not VISIBLE|absent)+"
)
_READABLE = (
    r"(SELF (can|could|be|are|able|to|ADVERB|now|actually|clearly|finally)* (READ|make_out|make out)|it can "
    r"READ) (?P<thing>_+?)(clearly|properly|FILLER)*"
)
_LEGIBLE = (
    r"(?P<thing>_+?) (can be (READ|READ-ED|read)|(BE|becomes|gets)+ (ADVERB|clearly|FREE)? (readable|legible|"
    r"big enough to READ|clear "
    r"enough to READ|large enough to READ|easy to READ))"
)


def condition_of(source: Source, lexemes: Sequence[Lexeme]) -> Condition | None:
    """Return the condition that lexemes state; None if they do not state one."""
    lexemes = without_happening(trimmed(lexemes, "FILLER", "COMMA", "QUOTE", "THEN"))
    if not lexemes:
        return None
    return _joined(source, lexemes) or _seen_but_not(source, lexemes) or _single(source, lexemes)


def without_happening(lexemes: Sequence[Lexeme]) -> tuple[Lexeme, ...]:
    """Return lexemes without "happens to": "a van happens to be at the gate" becomes "a van is at the gate"."""
    for i, x in enumerate(lexemes):
        if x.word in {"happens", "happen"} and [y.word for y in lexemes[i + 1 : i + 3]] == ["to", "be"]:
            return (*lexemes[:i], replace(lexemes[i + 2], word="is", classes=lexemes[i + 2].classes | {"BE"}), *lexemes[i + 3 :])
    return tuple(lexemes)


def _joined(source: Source, lexemes: Sequence[Lexeme]) -> Condition | None:
    """Read "there is a van and the gate is open": two complete conditions joined by "and" or "or"."""
    for i, x in enumerate(lexemes):
        if x.has("AND", "OR") and 1 < i < len(lexemes) - 2:
            first, second = lexemes[:i], lexemes[i + 1 :]
            if not search("BE|SEE|HAVEV|MODAL|DOV", first) or not search("BE|SEE|HAVEV|MODAL|DOV", second):
                continue
            one, other = _single(source, first), condition_of(source, second)
            if one is not None and other is not None:
                return Joined((one, other), "all" if x.has("AND") else "any")
    return None


def _seen_but_not(source: Source, lexemes: Sequence[Lexeme]) -> Condition | None:
    """Read "there are cars but no people"."""
    match = full_match(r"(?P<first>_+?) (BUT|AND) (?P<second>NONE _+)", lexemes)
    if not match:
        return None
    one, other = _single(source, match["first"]), _single(source, match["second"])
    return Joined((one, other), "all") if isinstance(one, Seen) and isinstance(other, Seen) else None


def _single(source: Source, lexemes: Sequence[Lexeme]) -> Condition | None:
    if full_match(
        r"(so|yes|it is|it does|that is so|there is|there are|they are|SELF (do|can|see one|find one|SEE it|SEE one|SEE any))",
        lexemes,
    ):
        return Answered()
    if full_match("(one|it|ANY|some) (of (PRON|those))? (BE VISIBLE|VISIBLE|can be (SEE-ED|seen|found)|BE FIND-ED)+", lexemes):
        return Seen(Thing())
    if match := full_match(_READABLE, lexemes):
        return Readable(thing) if (thing := thing_of(source, match["thing"])) is not None else None
    if match := full_match(_LEGIBLE, lexemes):
        return Readable(thing) if (thing := thing_of(source, match["thing"])) is not None else None
    bare, view = without_view(lexemes)
    if has_full_scope(lexemes):
        view = "full"
    return (
        _comparison(source, lexemes)
        or _count_condition(source, bare, view)
        or _visibility_condition(source, lexemes, bare, view)
        or _statement_condition(source, lexemes)
    )


def _comparison(source: Source, lexemes: Sequence[Lexeme]) -> Condition | None:
    """Read "there are more cars than vans" and "there are more cars at the gate than in the yard"."""
    match = full_match(
        r"(there BE|SELF (can)? (SEE|have))? (?P<way>more|fewer|less) (?P<first>_+?) (than|than_there_are) (?P<second>_+?)", lexemes
    )
    if placed := full_match(
        r"(?P<first>_+?) (has|have|HAVEV|shows|SHOW-S|SEE-S) (?P<way>more|fewer|less) (?P<thing>_+?) than (?P<second>_+)", lexemes
    ):
        places, thing = (place_of(source, placed["first"]), place_of(source, placed["second"])), thing_of(source, placed["thing"])
        if places[0] and places[1] and thing:
            return PresetOutnumbers(thing, places[0], places[1], "more" if placed["way"][0].word == "more" else "fewer")
    if not match:
        match = full_match(r"(?P<first>_+?) (outnumber|outnumbers) (?P<second>_+)", lexemes)
    if not match:
        return None
    way = "fewer" if "way" in match.names and match["way"][0].word in {"fewer", "less"} else "more"
    if placed := full_match(r"(?P<thing>_+?) (at|in|on|from) (?P<place>_+)", match["first"]):
        places = place_of(source, placed["place"]), place_of(source, match["second"])
        thing = thing_of(source, placed["thing"])
        if places[0] and places[1] and thing:
            return PresetOutnumbers(thing, places[0], places[1], way)  # type: ignore[arg-type]
    first, second = thing_of(source, match["first"]), thing_of(source, match["second"])
    if match["second"][0].has("NUM"):
        return None
    return Outnumbers(first, second, way) if first and second else None  # type: ignore[arg-type]


def _quantity(match: Match) -> Quantity:
    """Return the quantity of a match of ``_QUANTITY``."""
    words = match["quantity"]
    number = match["number"][0].value if match["number"] else 1.0
    operator: Operator = ">="
    lead = {name for x in words for name in x.classes}
    tail = match["tail"][0] if match["tail"] else None
    if words[0].has("SEVERAL"):
        return Quantity(">=", 2)
    if tail is not None:
        operator = ">=" if tail.has("ORMORE") else "<="
    elif words[0].word in {"no", "not"} or "ATMOST" in lead or words[0].word == "up":
        operator = "<="
    elif "MORETHAN" in lead:
        operator = ">"
    elif "FEWERTHAN" in lead:
        operator = "<"
    elif "EXACTLY" in lead:
        operator = "=="
    return Quantity(operator, number)


def _count_condition(source: Source, lexemes: Sequence[Lexeme], view: View | None) -> Condition | None:
    """Read conditions about a number of things."""
    patterns = (
        rf"(there|DET)* (BE|HAVEV|happen to be)* (?P<not>not)? {_QUANTITY} (of)? (?P<thing>_+?) ({_APPEARS})?",
        rf"{_SEES} {_QUANTITY} (of)? (?P<thing>_+?)",
        (
            rf"(DET)? (COUNTNOUN|count|number of) (?P<thing>_+?) (?P<not>not)? (BE|goes|rises|drops|falls|CARRY-S|"
            rf"reaches)+ {_QUANTITY}"
        ),
        r"(DET)? (COUNTNOUN) (?P<thing>_+?) (?P<quantity>(exceeds|MORETHAN) (?P<number>NUM) (?P<tail>ORMORE)?)",
        rf"(?P<thing>_+?) (BE|number) {_QUANTITY}",
        rf"{_QUANTITY} (of)? (?P<thing>_+?) BE (?P<state>(?!not)_+)",
    )
    for pattern in patterns:
        match = full_match(pattern, lexemes)
        if not match or not match.has("quantity"):
            continue
        words = match["thing"]
        if full_match("(of them|PRON|VISIBLE|there)+", words):
            thing: Thing | None = Thing()
        else:
            thing = thing_of(source, words)
        if thing is None or (words and words[0].has("DEG", "X", "PERCENT")):
            continue
        if match.has("state"):
            thing = replace(thing, text=f"{thing.text} {text_of(source, match['state'])}")  # "two or more people are waiting"
        seen = Seen(thing, _quantity(match), view)
        return Negated(seen) if "not" in match.names else seen
    return None


def _visibility_condition(source: Source, lexemes: Sequence[Lexeme], bare: Sequence[Lexeme], view: View | None) -> Condition | None:
    """Read conditions that something is or is not visible."""
    for words in (bare, lexemes) if bare != lexemes else (lexemes,):
        if match := full_match(rf"(?P<none>NOONE|NONE)? (?P<someone>SOMEONE)? (?P<thing>_*?) ({_APPEARS}|BE) ?", words):
            nobody = match.has("none") and match["none"][0].has("NOONE")
            who = people_description(source, match["thing"]) if nobody or match.has("someone") else None
            if who is not None:
                return Seen(who, Quantity("==", 0) if match.has("none") or match.has("not") else Quantity(), view)
        patterns = (
            (rf"{_SEES} (?P<none>NONE)? (?P<thing>_+?) (VISIBLE)*", False),
            (
                (
                    r"there (?P<not2>not)? (BE|HAVEV been|(happen|happens) to BE|happen to BE|(seem|seems) to BE|(appear|"
                    r"appears) to BE|may BE|might BE|to BE)+ (still)? (?P<not>not)? (ANY|still)? (?P<none>NONE)? (more)? "
                    r"(?P<thing>_+?) (VISIBLE|left|remaining)*"
                ),
                False,
            ),
            (r"(BE) there (?P<not>not)? (?P<none>NONE)? (?P<thing>_+?) (VISIBLE|left|remaining)*", False),
            (rf"(?P<none>NONE) (?P<thing>_+?) {_APPEARS}", True),
            (r"(?P<none>NONE) (MORE)? (?P<thing>_+)", False),
            (rf"(?P<thing>_+?) {_APPEARS}", True),
            (rf"(?P<thing>_+?) (?P<not>{_GONE})", True),
            (r"(SELF|HAVEV)* (find|FIND|FIND-ING|FIND-ED|spot|SEE|SEE-ING|SEE-ED|detect) (?P<none>NONE)? (?P<thing>_+)", False),
            (r"(SELF) (lose|lost) (sight of|track of)? (?P<not>(?P<thing>_+))", False),
        )
        for pattern, _ in patterns:
            match = full_match(pattern, words)
            if not match:
                continue
            negated = bool({"none", "not", "not2"} & match.names)
            words_of_thing = match["thing"]
            thing: Thing | None
            if words_of_thing and words_of_thing[0].has("NOONE"):
                thing, negated = people_description(source, words_of_thing[1:]), True
            elif words_of_thing and words_of_thing[0].has("SOMEONE"):
                thing = people_description(source, words_of_thing[1:])
            elif things := things_of(source, trimmed(words_of_thing, "NONE" if negated else "FILLER")):
                if negated and len(things) > 1:
                    return Joined(tuple(Seen(thing, Quantity("==", 0), view) for thing in things), "all")
                if len(things) > 1:
                    is_either = any(x.has("OR") for x in words_of_thing)
                    return Joined(tuple(Seen(thing, Quantity(), view) for thing in things), "any" if is_either else "all")
                thing = things[0] if len(things) == 1 else thing_of(source, words_of_thing)
            elif not negated and (either := _alternatives(source, words_of_thing)):
                return Joined(tuple(Seen(thing, Quantity(), view) for thing in either), "any")
            else:
                thing = None
            if thing is not None:
                return Seen(thing, Quantity("==", 0) if negated else Quantity(), view)
    return _bare_thing(source, bare, view)


def _alternatives(source: Source, lexemes: Sequence[Lexeme]) -> tuple[Thing, ...]:
    """Return the things of "the red van or a blue truck"; an empty tuple for other lexemes."""
    at = [i for i, x in enumerate(lexemes) if x.has("OR")]
    if len(at) != 1 or at[0] + 1 >= len(lexemes) or not lexemes[at[0] + 1].has("DET"):
        return ()
    things = [thing_of(source, part) for part in (lexemes[: at[0]], lexemes[at[0] + 1 :])]
    return tuple(thing for thing in things if thing is not None and thing.text) if all(things) else ()


def _bare_thing(source: Source, lexemes: Sequence[Lexeme], view: View | None) -> Condition | None:
    """Read "any people" after "if"."""
    match = full_match(r"(any|ANY|there|still)+ (?P<thing>_+)", lexemes)
    thing = thing_of(source, match["thing"]) if match else None
    return Seen(thing, Quantity(), view) if thing is not None and thing.text and not search("BE|HAVEV", lexemes) else None


def named_thing(source: Source, lexemes: Sequence[Lexeme]) -> Condition | None:
    """Read "smoke" after "if" or "in case of"."""
    words, view = without_view(lexemes[1:] if lexemes and lexemes[0].word == "of" else lexemes)
    thing = thing_of(source, words) if words and _names_a_thing(words) else None
    return Seen(thing, Quantity(), "full" if has_full_scope(lexemes) else view) if thing is not None and thing.text else None


def _names_a_thing(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether lexemes are a known noun with its modifiers: "smoke", "queue at the gate", unlike "open"."""
    head = next((i for i, x in enumerate(lexemes) if x.has("PREP")), len(lexemes))
    return 0 < head < 4 and all(x.has("FREE", "DET") for x in lexemes[:head]) and is_noun(lexemes[head - 1].word)


def _statement_condition(source: Source, lexemes: Sequence[Lexeme]) -> Condition | None:
    """Read "the gate is open", "a worker is not wearing a helmet" and "the sign says stop"."""
    if search("PAN|TILT|ZOOM|DEG|UNTIL|THEN|WRAPPER|IFSO|IFNOT", lexemes):
        return None
    if match := full_match(r"(?P<thing>_+?) (says|say|reads|READ-S) (?P<text>_+)", lexemes):
        thing = thing_of(source, match["thing"])
        text = text_of(source, match["text"])
        return Statement(thing, text, question=f"does the {thing.text} say {text}?") if thing else None
    match = full_match(
        r"(?P<thing>_+?) (?P<verb>BE|HAVEV|LOOKSLIKE|looks|seems|appears|stays|becomes|gets) (?P<not>not)? (?P<rest>_+)", lexemes
    )
    if not match:
        match = full_match(r"(?P<thing>_+?) (?P<verb>DOV) (?P<not>not) (have|look) (?P<rest>_+)", lexemes)
    if not match:
        return _verb_condition(source, lexemes)
    expected = not match.has("not")
    if match["thing"][0].has("SOMEONE", "NOONE") and len(match["thing"]) == 1:
        text = f"people {text_of(source, match['rest'])}"
        return Seen(
            Thing(text if expected else f"people not {text_of(source, match['rest'])}"),
            Quantity("==", 0) if match["thing"][0].has("NOONE") else Quantity(),
        )
    if full_match("it", match["thing"]):
        return Statement(Thing(), text_of(source, match["rest"]), expected)
    thing = thing_of(source, match["thing"])
    if thing is None:
        return None
    predicate = text_of(source, match["rest"])
    if match["verb"][0].has("HAVEV"):
        return Statement(thing, predicate, expected, question=f"does the {thing.text} have {predicate}?")
    if match["thing"][0].word in {"a", "an", "any", "some", "one"} or match["thing"][0].has("ANY"):
        return Seen(Thing(f"{thing.text} {'' if expected else 'not '}{predicate}".replace("  ", " ")))
    return Statement(thing, predicate, expected)


def _verb_condition(source: Source, lexemes: Sequence[Lexeme]) -> Condition | None:
    """Read "a van pulls up": a thing and a verb in the third person."""
    for i in range(len(lexemes) - 1, 0, -1):
        x = lexemes[i]
        if (
            x.word.endswith("s")
            and x.has("FREE")
            and lexemes[0].word in {"a", "an", "the", "any", "someone"}
            and is_noun_phrase(lexemes[:i])
            and i > 1
        ):
            thing = thing_of(source, lexemes[:i])
            if thing and not thing.definite:
                return None
    return None
