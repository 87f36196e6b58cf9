"""Read comparisons: between two things, between presets, and before and after a move."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from scope_ptz.english import COLOURS, plural
from scope_ptz.planner.grammar.instruction_tree import (
    AtPlaces,
    BeforeAfter,
    Compare,
    CompareWithBefore,
    Comparison,
    Count,
    Step,
    Thing,
    Unclear,
    WhichPreset,
)
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.looks.here_and_there import comparison_with_preset
from scope_ptz.planner.grammar.parsing.looks.preset_presence import preset_presence_step
from scope_ptz.planner.grammar.parsing.looks.rankings import ranking_step
from scope_ptz.planner.grammar.parsing.parts.clause import NotUnderstoodError, Source, text_of, trimmed
from scope_ptz.planner.grammar.parsing.parts.noun_phrases import thing_of
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match
from scope_ptz.planner.grammar.parsing.parts.preset_refs import place_of, places_of
from scope_ptz.planner.grammar.parsing.parts.scopes import has_full_scope, split_trailing_place, without_view

if TYPE_CHECKING:
    from scope_ptz.tools.arguments import View

_SKIP = "(FILLER|FIRSTLY|LEADFILLER|TELL|know|WRAPPER|wonder|me|us|SELF|if|whether|IF|COMMA|and|COMPARE|COLON|check|see)*"
_SEE = (
    r"(BE there|BE it|it BE|HAVEV SELF|SELF (HAVEV|have)|DOV SELF (SEE|have|count)|can SELF SEE|SELF SEE|there "
    r"BE|BE|can be SEE-ED|HAVEV SELF got)"
)
_SHOWS = (
    r"(BE there|where BE|have|has|HAVEV|SHOW|SHOW-S|show|shows|SEE-S|contain|contains|hold|holds|BE showing|"
    r"there BE|(BE)? got|HAVEV got|see)"
)
_WAY = (
    r"(the)? (?P<nth>ORDINAL)? (?P<way>(busier|busiest|fuller|fullest|quieter|quietest|emptier|emptiest) with|SUPERLATIVE|"
    r"LEADMORE|more|most|fewer|fewest|less|least|(higher|lower|greater|highest|"
    r"lowest|larger|biggest|largest) (number|count) of)"
)
_WHICH = (
    r"(in|at|from|on|of)? (WHQ|which|what|where|find WHQ|find) (one|of these|of those|of the|of)? (PRESETNOUN|"
    r"presets|views|NUM)? (of them)?"
)

ReadMoves = Callable[[Sequence[Lexeme]], "tuple[Step, ...] | None"]


def _comparison(words: Sequence[Lexeme]) -> Comparison:
    return (
        "fewer"
        if any(
            x.has("FEW")
            or x.has("FEWERTHAN")
            or x.word in {"fewer", "less", "lower", "lowest", "quieter", "quietest", "emptier", "emptiest"}
            for x in words
        )
        else "more"
    )


def comparison_step(source: Source, lexemes: Sequence[Lexeme], read_moves: ReadMoves) -> Step | tuple[Step, ...] | None:
    """Return the step of a clause that compares counts; None for other clauses.

    Args:
        source: The instruction.
        lexemes: The clause.
        read_moves: Reads the moves in "before or after panning left 20".
    """
    lexemes = trimmed(lexemes, "FILLER", "COMMA", "FIRSTLY", "LEADFILLER")
    if (
        guess := full_match("(?P<asked>_+?) (COMMA)? (do SELF|DOV SELF|MODAL SELF|would_you) (say|reckon|think|guess)", lexemes)
    ) is not None:
        lexemes = tuple(guess["asked"])  # "more people at the gate or in the yard, would you say?"
    if (asked := full_match("((FILLER|COMMA)* WHQ BE it COMMA)? (?P<asked>_+?) ((COMMA)? (or|OR) not)?", lexemes)) is not None:
        lexemes = tuple(asked["asked"])  # "which is it, more girls or more boys?", "fewer cars than vans, or not?"
    return (
        _same_thing_at_two_presets(source, lexemes)
        or comparison_with_preset(source, lexemes)
        or ranking_step(source, lexemes)
        or _preset_comparison(source, lexemes)
        or _before_after(source, lexemes, read_moves)
        or _thing_comparison(source, lexemes)
        or preset_presence_step(source, lexemes)
    )


def _preset_comparison(source: Source, lexemes: Sequence[Lexeme]) -> Step | None:
    """Read comparisons of presets."""
    listing = r"(COMMA|COLON|DASH|between|out of|of|at|OPEN)* (?P<places>_+?) (CLOSE)?"
    patterns = (
        rf"{_SKIP} {_WHICH} {_SHOWS}? (can|do|does)? (SELF)? (SEE)? {_WAY} (?P<thing>_+?) ((on|at|in) it)? "
        rf"((COMMA|COLON|DASH|OPEN|of)+ {listing})?",
        rf"{_SKIP} {_WHICH} {_SHOWS}? (can|do|does)? (SELF)? (SEE)? {_WAY} (?P<thing>_+?) (?P<places>(DET)? PRESET "
        rf"_*? (or|and) _+)",
        rf"(SWITCH|CARRY|SHOW|AIM|TAKE|me|us|to|at|FILLER|COMMA)* whichever (PRESETNOUN|one)? (of)? (?P<places>_+?)? "
        rf"(PRESETNOUN|one)? {_SHOWS} {_WAY} (?P<thing>_+?)",
        rf"(SWITCH|CARRY|SHOW|AIM|TAKE|me|us|to|at|FILLER)+ (?P<places>_+? (or|and) _+?) (COMMA|DASH)* whichever (one|PRESETNOUN)? "
        rf"(of them)? {_SHOWS} {_WAY} (?P<thing>_+?)",
        rf"{_SKIP} (?P<places>_+? (AND|THAN|OR) _+?) (COMMA|COLON|DASH) {_WHICH} {_SHOWS} {_WAY} (?P<thing>_+)",
        rf"{_SKIP} ({_WHICH} BE)? {_WAY} (?P<thing>_+?) (COMMA|COLON|DASH)+ (at|in)? (?P<places>_+? (or|OR) _+)",
        rf"{_SKIP} {_WHICH} (?P<places>_+?) {_SHOWS} {_WAY} (?P<thing>_+?)",
        rf"{_SKIP} (between|out_of|of|among|DET presets) (?P<places>_+?) COMMA? {_WHICH} {_SHOWS} {_WAY} (?P<thing>_+?)",
        (
            rf"{_SKIP} ({_SEE})? {_WAY} (?P<thing>_+?) (at|in|on|from) (?P<places>_+? (than|than_at|than_in|or|OR|THAN) "
            rf"(at|in|on|from)* _+)"
        ),
        rf"{_SKIP} {_SEE} {_WAY} (?P<thing>_+) (at|in|on|from) (?P<places>_+? (than_at|than_in|or|THAN) (at|in|on|from)* _+)",
        rf"{_SKIP} (DOV|BE) (?P<one>_+?) ({_SHOWS}|with) {_WAY} (?P<thing>_+?) (than|THAN) (DOV)? (?P<other>_+?)",
        (
            rf"{_SKIP} (is|BE) (the)? (COUNTNOUN|number of) (?P<thing>_+?) (at|in|on|from) (?P<one>_+?) ({_WAY} (than|"
            rf"THAN)|(?P<way>MORETHAN|FEWERTHAN)) (at|in)* (?P<other>_+?)"
        ),
        (
            rf"{_SKIP} BE (the)? (?P<thing>FREE{{1,3}} COUNT) ((at|in|on|from) (?P<one>_+?) ({_WAY} (than|THAN)|"
            rf"(?P<way>MORETHAN|FEWERTHAN))|{_WAY} (at|in|on|from) (?P<one>_+?) (than|THAN)) (that)? (at|in|on)* (?P<other>_+?)"
        ),
        (
            rf"{_SKIP} COMPARE (DET)? (COUNTNOUN|count of|number of|HOWMANY)* (?P<thing>_+?) (SELF SEE|there BE|"
            rf"VISIBLE)? (at|in|on|from|between|for|COMMA|COLON|DASH) (?P<places>_+ (and|AND|with|to|THAN) _+)"
        ),
        (
            rf"{_SKIP} COMPARE (?P<one>_+?) (with|to|AND|and) (?P<other>_+?) (for|by|COLON|COMMA)+ (number of|COUNTNOUN|"
            rf"DET)* (?P<thing>_+)"
        ),
        (
            rf"{_SKIP} COMPARE (?P<places>_+ (and|AND|with|to|THAN) _+?) (for|by|COLON|COMMA)+ (number of|COUNTNOUN|"
            rf"DET)* (?P<thing>_+)"
        ),
        rf"{_SKIP} how DOV (?P<one>_+?) COMPARE (to|with|THAN)+ (?P<other>_+?) (for|in|on) (number of|COUNTNOUN)* (?P<thing>_+)",
        (
            rf"{_SKIP} (PRESETNOUN|PRESETNOUN with|(CARRY|TAKE) (me|us)? (over|back)? to|SWITCH|to|the|go to|show me)* "
            rf"(PRESETNOUN|one|WHQ|"
            rf"whichever|place|view) (PRESETNOUN|one|view)? (with|that has|that shows|has|shows|that SHOW-S|{_SHOWS}) "
            rf"{_WAY} (?P<thing>_+?) ((COMMA|COLON|DASH|OPEN|of)+ {listing})?"
        ),
        rf"{_SKIP} (COMPARE)? (presets)? (?P<places>_+?) (COLON|COMMA)+ {_WHICH} {_SHOWS} {_WAY} (?P<thing>_+)",
        rf"{_SKIP} COMPARE (?P<one>_+?) (with|to|AND|THAN) (?P<other>_+?) (AND|COMMA)+ {_SKIP} {_WHICH} ({_SHOWS}|"
        rf"{_SEE}) {_WAY} (?P<thing>_+)",
    )
    more_patterns = (
        rf"{_SKIP} WHQ FREE {_SHOWS} {_WAY} (?P<thing>_+?) (COMMA|COLON|DASH) (?P<places>_+)",
        rf"{_SKIP} where BE {_WAY} (?P<thing>_+?) (VISIBLE)? (COMMA|COLON|DASH) (?P<places>_+)",
        (
            rf"{_SKIP} (HOWMANYMORE|HOWMANY MORE) (?P<thing>_+?) (BE there|VISIBLE|SELF SEE|do SELF SEE|can SELF SEE)* "
            rf"(at|in|from) (?P<one>_+?) (than|THAN) (there BE)? (at|in|from)* (?P<other>_+)"
        ),
        rf"{_SKIP} (rank|order|sort|RANK) (?P<places>_+?) by (DET)? (COUNTNOUN|number of|HOWMANY) (?P<thing>_+)",
    )
    for pattern in (*patterns, *more_patterns):
        match = full_match(pattern, lexemes)
        if not match:
            continue
        if "one" in match.names:
            refs = (place_of(source, match["one"]), place_of(source, match["other"]))
            places = tuple(ref for ref in refs if ref) if all(refs) else None
        elif match.has("places"):
            places = places_of(source, match["places"])
        else:
            places = ()
        thing = _counted_thing(source, trimmed(match["thing"], "VISIBLE", "NOW"))
        if places is None or thing is None or any(x.has("COMMA") for x in match["thing"]):
            continue
        go = bool(lexemes[0].has("SWITCH", "CARRY") and not lexemes[0].has("HAVEV"))
        go |= any(x.word == "whichever" for x in lexemes) and lexemes[0].word != "whichever"
        rank = round(match["nth"][0].value) if "nth" in match.names and match["nth"] else 1
        way = _comparison(match["way"]) if "way" in match.names else "more"
        of_two = "way" in match.names and any(x.word in {"more", "fewer", "less"} for x in match["way"])
        return WhichPreset(thing, way, places, go=go, rank=rank, yes_no=bool(places) and _is_yes_no(lexemes), of_two=of_two)
    if full_match(rf"{_SKIP} {_WHICH} {_SHOWS} (NONE|no|MORETHAN|ATLEAST|FEWERTHAN|ATMOST|EXACTLY) _+", lexemes) and any(
        x.has("PRESETNOUN", "PRESET") for x in lexemes[:6]
    ):
        return Unclear("I can tell which preset shows the most or the fewest. Shall I compare the presets?")
    if (match := full_match(rf"{_SKIP} {_WHICH} {_SHOWS} {_WAY} _+ COMMA (?P<places>_+ (or|OR|and) _+)", lexemes)) and any(
        x.has("PRESET", "PRESETNOUN") for x in lexemes
    ):
        raise NotUnderstoodError(match["places"])
    if full_match(
        rf"{_SKIP} (WHQ|which|BE) _* (busier|quieter|emptier|fuller|fullest|busiest|quietest|calmer|most crowded) _*", lexemes
    ) and any(x.has("PRESET", "PRESETNOUN") for x in lexemes):
        return Unclear("What shall I count to tell which is busier: vehicles or people?")
    return None


_COUNT_OF = "(count|counts|numbers|total|totals|tally|tallies)"


def _counted_thing(source: Source, lexemes: Sequence[Lexeme]) -> Thing | None:
    """Return "pedestrians" for "pedestrian count"; otherwise the thing that lexemes describe."""
    match = full_match(f"(?P<thing>_+) {_COUNT_OF}", lexemes)
    if match is None:
        return thing_of(source, lexemes)
    thing = thing_of(source, match["thing"])
    return replace(thing, text=plural(thing.text)) if thing is not None else None


def _same_thing_at_two_presets(source: Source, lexemes: Sequence[Lexeme]) -> Step | tuple[Step, ...] | None:
    """Read "compare vans at the gate with vans in the yard"."""
    head = r"(COMPARE (DET|COUNTNOUN)*|(WHQ BE)? (DET)? difference (in|between) (DET|COUNTNOUN)*)"
    second = r"(with|to|AND|against) (DET|those|COUNTNOUN|one|that)* (?P<again>_+?)?? (at|in|on) (?P<other>_+)"
    match = full_match(rf"{_SKIP} {head} (?P<thing>_+?) (at|in|on|for) (?P<one>_+?) {second}", lexemes)
    if not match:
        return None
    thing, places = _counted_thing(source, match["thing"]), (place_of(source, match["one"]), place_of(source, match["other"]))
    again = thing_of(source, match["again"]) if match.has("again") else thing
    if thing is None or again is None or not places[0] or not places[1]:
        return None
    if again != thing:  # "compare the trucks at the gate with the wagons in the yard"
        return tuple(AtPlaces((place,), (Count((each,)),)) for place, each in zip(places, (thing, again), strict=True) if place)
    return WhichPreset(thing, "more", (places[0], places[1]))


def _is_yes_no(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether a comparison asks for yes or no: "are there more cars than vans?", unlike "which ..." and "... or vans?"."""
    first = next((x for x in lexemes if not x.has("FILLER", "TELL", "FIRSTLY") and x.word not in {"me", "us", "check"}), lexemes[0])
    asks = first.has("BE", "DOV", "MODAL", "IF") or first.word in {"if", "whether", "have"}
    return (
        asks and any(x.has("THAN") or x.word in {"outnumber", "exceed"} for x in lexemes) and not any(x.has("OR") for x in lexemes)
    )


def _before_after(source: Source, lexemes: Sequence[Lexeme], read_moves: ReadMoves) -> Step | None:
    """Read comparisons of the counts before and after a move."""
    patterns = (
        (
            rf"{_SKIP} {_SEE} {_WAY} (?P<thing>_+?) (VISIBLE)? (before or AFTER|BEFORE or AFTER|AFTER or BEFORE|AFTER|"
            rf"once|if) (SELF|HAVEV)* (?P<moves>_+?) (than BEFORE|THAN before|than before)?"
        ),
        rf"{_SKIP} (DOV|will|would) (?P<moves>_+?) (SHOW|reveal|bring|show|give|uncover|SEE) (SELF)? {_WAY} (?P<thing>_+?)",
        rf"{_SKIP} COMPARE (DET)? (COUNTNOUN|number of|count of)* (?P<thing>_+?) BEFORE and AFTER (SELF)* (?P<moves>_+)",
        (
            rf"{_SKIP} (COUNT|HOWMANY|DET COUNTNOUN|number of|report|DET)* (?P<thing>_+?) (BE there|VISIBLE|SELF SEE)? "
            rf"BEFORE and AFTER (SELF)* (?P<moves>_+)"
        ),
    )
    for pattern in patterns:
        match = full_match(pattern, lexemes)
        if not match:
            continue
        moves = read_moves(trimmed(match["moves"], "FILLER", "SELF"))
        thing = thing_of(source, trimmed(match["thing"], "VISIBLE"))
        if moves is None or thing is None:
            continue
        if isinstance(moves[0], Unclear):
            return moves[0]
        return BeforeAfter(thing, moves, _comparison(match["way"]) if "way" in match.names else "more")
    if match := full_match(
        (
            rf"{_SKIP} {_SEE}? {_WAY} (?P<thing>_*?) (VISIBLE|now|NOW)? (than|THAN) (before|earlier|previously|last "
            rf"time|at first|BEFORE|AFTER|SELF SEE-ED)+"
        ),
        lexemes,
    ):
        words = trimmed(match["thing"], "VISIBLE", "of", "PRON")
        thing = thing_of(source, words) if words else Thing()
        return CompareWithBefore(thing, _comparison(match["way"])) if thing is not None else None
    if (match := full_match(rf"(TELL|me|us|whether|if|IF|FILLER|check)+ there BE {_WAY} (?P<thing>_*)", lexemes)) and not any(
        x.has("OR", "ORMORE", "ORFEWER", "THAN") for x in lexemes
    ):
        thing = thing_of(source, match["thing"]) if match["thing"] else Thing()
        return CompareWithBefore(thing, _comparison(match["way"])) if thing is not None else None
    return None


_HALVES = {"left": "right", "top": "bottom", "upper": "lower"}


def _half_comparison(source: Source, lexemes: Sequence[Lexeme], view: View | None) -> Step | None:
    """Read "which half of the picture has more cars?" and "which side has more people, left or right?"."""
    match = full_match(
        rf"{_SKIP} (on|in)? (WHQ|which) (half|side|SIDE) (of DET (PICTURE|VIEWNOUN|frame|FREE))? {_SHOWS} {_WAY} (?P<thing>_+?) "
        r"((COMMA|COLON|DASH)+ (DET)? (?P<one>left|right|top|bottom|upper|lower|LEFT|RIGHT|UP|DOWN) (half|side|SIDE)? "
        r"(or|OR) (DET)? "
        r"(?P<other>left|right|top|bottom|upper|lower|LEFT|RIGHT|UP|DOWN) (half|side|SIDE)?)?",
        lexemes,
    )
    thing = thing_of(source, match["thing"]) if match else None
    if match is None or thing is None or not thing.text or (not match.has("one") and any(x.word in {"side"} for x in lexemes)):
        return None
    one, other = (match["one"][0].word, match["other"][0].word) if match.has("one") else ("left", "right")
    if _HALVES.get(one, "") != other and _HALVES.get(other, "") != one:
        return None
    first, second = (Thing(f"{thing.text} in the {end} half") for end in (one, other))
    return Compare(first, second, _comparison(match["way"]), view)


def _thing_comparison(source: Source, lexemes: Sequence[Lexeme]) -> Step | None:
    """Read comparisons of the counts of two things in one view."""
    words, view = without_view(lexemes)
    if has_full_scope(lexemes):
        view = "full"
        words = tuple(x for x in words if not x.has("FULL"))
    words, places = split_trailing_place(source, words)
    patterns = (
        (
            rf"{_SKIP} (WHQ BE it COMMA)? {_SEE}? (any)? {_WAY} (?P<first>_+?) (than|THAN|or|OR|ORMORE|ORFEWER) (there BE|the|more|"
            rf"fewer)* (?P<second>_+?)"
        ),
        (
            rf"{_SKIP} (HOWMANYMORE|(by|in) HOWMANY BE there more|HOWMANY MORE) (?P<first>_+?) (BE there|VISIBLE|SELF "
            rf"SEE|than|do SELF SEE)* than (?P<second>_+?) (BE there|VISIBLE|there BE|do SELF SEE|can SELF SEE|SELF "
            rf"SEE|SELF HAVEV|SELF have|PRON HAVEV|(do|DOV) SELF (HAVEV|have)|BE)*"
        ),
        rf"{_SKIP} (WHQ BE)? (DET)? difference between (DET)? COUNTNOUN (?P<first>_+?) and (DET)? COUNTNOUN (?P<second>_+)",
        rf"{_SKIP} BE DET (?P<first>_+?) (?P<way>fewer_than|more_than|(LEADMORE|more|fewer) (numerous)? (than|THAN)) "
        rf"DET (?P<second>_+)",
        rf"{_SKIP} DET (?P<first>_+?) BE (?P<way>fewer_than|more_than|(LEADMORE|more|fewer) (numerous)? (than|THAN)) "
        rf"DET (?P<second>_+)",
        rf"{_SKIP} {_SEE} as many (?P<first>_+?) as (there BE)? (?P<second>_+?)",
        (
            rf"{_SKIP} COMPARE (DET)? (COUNTNOUN|number of|count of|HOWMANY)* (?P<first>_+?) (and|AND|with|to|against) "
            rf"(DET)? (COUNTNOUN|number of)* (?P<second>_+)"
        ),
        (
            rf"{_SKIP} WHQ BE (?P<way>LEADMORE|larger|bigger|smaller|greater) COMMA? (DET)? COUNTNOUN (?P<first>_+?) "
            rf"or (DET)? COUNTNOUN (?P<second>_+)"
        ),
        rf"{_SKIP} (DOV|BE)? (DET)? COUNTNOUN (?P<first>_+?) (exceed|exceeds|BE? MORETHAN|BE? (?P<way>FEWERTHAN)) "
        rf"(DET|that of)* (COUNTNOUN)? (?P<second>_+)",
        rf"{_SKIP} BE (DET)? (?P<first>_+?) (?P<way>LEADMORE|more|less) (common|numerous|frequent|plentiful) (than|"
        rf"THAN) (DET)? (?P<second>_+)",
        rf"{_SKIP} (WHQ) BE there more of COMMA (?P<first>_+?) or (?P<second>_+)",
        rf"{_SKIP} (by HOWMANY|HOWMANY) DOV DET (?P<first>_+?) outnumber DET (?P<second>_+)",
        rf"{_SKIP} (DOV|BE) (the)? (?P<first>_+?) outnumber (the)? (?P<second>_+)",
    )
    if (halves := _half_comparison(source, words, view)) is not None:
        return AtPlaces(places, (halves,)) if places else halves
    sides = r"(on|at|in|to|near|by) _+?"
    if match := full_match(
        rf"{_SKIP} {_SEE} (any)? {_WAY} (?P<thing>_+?) (?P<first>{sides}) (than|THAN|or|OR) (?P<second>({sides})|_+)", words
    ):
        thing = thing_of(source, match["thing"])
        ends = [text_of(source, match[name]) for name in ("first", "second")]
        if thing and not place_of(source, match["first"]):
            lead = "" if match["second"][0].has("PREP") else f"{match['first'][0].word} "
            one, other = Thing(f"{thing.text} {ends[0]}"), Thing(f"{thing.text} {lead}{ends[1]}")
            return Compare(one, other, _comparison(match["way"]), view, yes_no=_is_yes_no(lexemes))
    for pattern in patterns:
        match = full_match(pattern, words)
        if not match:
            continue
        first, second = thing_of(source, match["first"]), thing_of(source, trimmed(match["second"], "VISIBLE"))
        if first and second and first.text and second.text:
            if first.text.lower() in COLOURS and second.text.lower().endswith(" ones"):
                first = replace(first, text=f"{first.text} ones")  # "more blue than red ones"
            way = _comparison(match["way"]) if "way" in match.names else "more"
            step: Step = Compare(first, second, way, view, yes_no=_is_yes_no(lexemes))
            return AtPlaces(places, (step,)) if places else step
    return None
