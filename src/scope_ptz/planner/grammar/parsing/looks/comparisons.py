"""Read comparisons: between two things, between presets, and before and after a move."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from scope_ptz.planner.grammar.instruction_tree import (
    AtPlaces,
    BeforeAfter,
    Compare,
    CompareWithBefore,
    Comparison,
    Count,
    FirstWith,
    Step,
    Thing,
    Unclear,
    WhichPreset,
)
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.clause import NotUnderstoodError, Source, text_of, trimmed
from scope_ptz.planner.grammar.parsing.parts.noun_phrases import thing_of, things_of
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match
from scope_ptz.planner.grammar.parsing.parts.preset_refs import place_of, places_of
from scope_ptz.planner.grammar.parsing.parts.scopes import has_full_scope, place_after, without_view

_SKIP = "(FILLER|FIRSTLY|LEADFILLER|TELL|me|us|SELF|if|whether|IF|COMMA|and|COMPARE|check|see)*"
_SEE = r"(BE there|DOV SELF (SEE|have|count)|can SELF SEE|SELF SEE|there BE|BE|can be SEE-ED|HAVEV SELF got)"
_SHOWS = (
    r"(BE there|where BE|have|has|HAVEV|SHOW|SHOW-S|show|shows|SEE-S|contain|contains|hold|holds|BE showing|"
    r"there BE|got|HAVEV got|see)"
)
_WAY = (
    r"(the)? (?P<way>SUPERLATIVE|LEADMORE|more|most|fewer|fewest|less|least|(higher|lower|greater|highest|"
    r"lowest|larger|biggest|largest) (number|count) of)"
)
_WHICH = (
    r"(in|at|from|on|of)? (WHQ|which|what|where|find WHQ|find) (one|of these|of those|of the|of)? (PRESETNOUN|"
    r"presets|views)? (of them)?"
)

ReadMoves = Callable[[Sequence[Lexeme]], "tuple[Step, ...] | None"]


def _comparison(words: Sequence[Lexeme]) -> Comparison:
    return (
        "fewer"
        if any(x.has("FEW") or x.has("FEWERTHAN") or x.word in {"fewer", "less", "lower", "lowest"} for x in words)
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
    return (
        _same_thing_at_two(source, lexemes)
        or _presets(source, lexemes)
        or _before_after(source, lexemes, read_moves)
        or _things(source, lexemes)
        or _first_with(source, lexemes)
        or _first_preset(source, lexemes)
    )


def _presets(source: Source, lexemes: Sequence[Lexeme]) -> Step | None:
    """Read comparisons of presets."""
    listing = r"(COMMA|COLON|DASH|between|out of|of|at|OPEN)* (?P<places>_+?) (CLOSE)?"
    patterns = (
        rf"{_SKIP} {_WHICH} {_SHOWS}? (can|do|does)? (SELF)? (SEE)? {_WAY} (?P<thing>_+?) ((COMMA|COLON|DASH|OPEN|of)+ {listing})?",
        rf"{_SKIP} {_WHICH} (?P<places>_+?) {_SHOWS} {_WAY} (?P<thing>_+?)",
        rf"{_SKIP} (between|out of|of|among|DET presets) (?P<places>_+?) COMMA? {_WHICH} {_SHOWS} {_WAY} (?P<thing>_+?)",
        (
            rf"{_SKIP} ({_SEE})? {_WAY} (?P<thing>_+?) (at|in|on|from) (?P<places>_+? (than|than_at|than_in|or|OR|THAN) "
            rf"(at|in|on|from)* _+)"
        ),
        rf"{_SKIP} {_SEE} {_WAY} (?P<thing>_+) (at|in|on|from) (?P<places>_+? (than_at|than_in|or|THAN) (at|in|on|from)* _+)",
        rf"{_SKIP} (DOV) (?P<one>_+?) {_SHOWS} {_WAY} (?P<thing>_+?) (than|THAN) (DOV)? (?P<other>_+?)",
        (
            rf"{_SKIP} (is|BE) (the)? (COUNTNOUN|number of) (?P<thing>_+?) (at|in|on|from) (?P<one>_+?) ({_WAY} (than|"
            rf"THAN)|(?P<way>MORETHAN|FEWERTHAN)) (at|in)* (?P<other>_+?)"
        ),
        (
            rf"{_SKIP} COMPARE (DET)? (COUNTNOUN|count of|number of|HOWMANY)* (?P<thing>_+?) (SELF SEE|there BE|"
            rf"VISIBLE)? (at|in|on|from|between|for) (?P<places>_+ (and|AND|with|to|THAN) _+)"
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
            rf"{_SKIP} (PRESETNOUN|PRESETNOUN with|CARRY to|SWITCH|to|the|go to|show me)* (PRESETNOUN|one|WHQ|"
            rf"whichever|place|view) (PRESETNOUN|one|view)? (with|that has|that shows|has|shows|that SHOW-S|{_SHOWS}) "
            rf"{_WAY} (?P<thing>_+?) ((COMMA|COLON|DASH|OPEN|of)+ {listing})?"
        ),
        rf"{_SKIP} (COMPARE)? (presets)? (?P<places>_+?) (COLON|COMMA)+ {_WHICH} {_SHOWS} {_WAY} (?P<thing>_+)",
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
        elif "places" in match.names:
            places = places_of(source, match["places"])
        else:
            places = ()
        thing = thing_of(source, trimmed(match["thing"], "VISIBLE", "NOW"))
        if places is None or thing is None or any(x.has("COMMA") for x in match["thing"]):
            continue
        go = bool(lexemes[0].has("SWITCH", "CARRY") and not lexemes[0].has("HAVEV"))
        return WhichPreset(thing, _comparison(match["way"]) if "way" in match.names else "more", places, go=go)
    if full_match(rf"{_SKIP} {_WHICH} {_SHOWS} (NONE|no|MORETHAN|ATLEAST|FEWERTHAN|ATMOST|EXACTLY) _+", lexemes) and any(
        x.has("PRESETNOUN", "PRESET") for x in lexemes[:6]
    ):
        return Unclear("I can tell which preset shows the most or the fewest. Shall I compare the presets?")
    if (match := full_match(rf"{_SKIP} {_WHICH} {_SHOWS} {_WAY} _+ COMMA (?P<places>_+ (or|OR|and) _+)", lexemes)) and any(
        x.has("PRESET", "PRESETNOUN") for x in lexemes
    ):
        raise NotUnderstoodError(match["places"])
    if match := full_match(
        rf"{_SKIP} {_WHICH} (can|do|could) SELF (SEE|have) (?P<thing>_+?) (from|at|in)? ((COMMA|COLON|DASH)+ (?P<places>_+))?",
        lexemes,
    ):
        places = places_of(source, match["places"]) if match.has("places") else ()
        thing = thing_of(source, match["thing"])
        if thing and thing.text != "available" and places is not None and any(x.has("PRESETNOUN") for x in lexemes[:6]):
            return WhichPreset(thing, "more", places, any_of=True)
    if match := full_match(rf"{_SKIP} {_WHICH} {_SHOWS} (?P<thing>(ANY|DET|NUM) _+?|people) ((COMMA)+ (?P<places>_+))?", lexemes):
        places = places_of(source, match["places"]) if match.has("places") else ()
        has_place = any(x.has("PRESETNOUN") for x in lexemes[:5])
        thing = thing_of(source, match["thing"])
        if thing and places is not None and (has_place or places):
            return WhichPreset(thing, "more", places, any_of=True)
    if full_match(
        rf"{_SKIP} (WHQ|which|BE) _* (busier|quieter|emptier|fuller|fullest|busiest|quietest|calmer|most crowded) _*", lexemes
    ) and any(x.has("PRESET", "PRESETNOUN") for x in lexemes):
        return Unclear("What shall I count to tell which is busier: vehicles or people?")
    return None


def _same_thing_at_two(source: Source, lexemes: Sequence[Lexeme]) -> Step | None:
    """Read "compare vans at the gate with vans in the yard"."""
    head = r"(COMPARE (DET|COUNTNOUN)*|(WHQ BE)? (DET)? difference (in|between) (DET|COUNTNOUN)*)"
    second = r"(with|to|AND|against) (DET|those|COUNTNOUN)* (?P<again>_+?)?? (at|in|on) (?P<other>_+)"
    match = full_match(rf"{_SKIP} {head} (?P<thing>_+?) (at|in|on) (?P<one>_+?) {second}", lexemes)
    if not match:
        return None
    thing, places = thing_of(source, match["thing"]), (place_of(source, match["one"]), place_of(source, match["other"]))
    again = thing_of(source, match["again"]) if match.has("again") else thing
    if thing is None or again != thing or not places[0] or not places[1]:
        return None
    return WhichPreset(thing, "more", (places[0], places[1]))


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


def _things(source: Source, lexemes: Sequence[Lexeme]) -> Step | None:
    """Read comparisons of the counts of two things in one view."""
    words, view = without_view(lexemes)
    if has_full_scope(lexemes):
        view = "full"
        words = tuple(x for x in words if not x.has("FULL"))
    words, places = place_after(source, words)
    patterns = (
        (
            rf"{_SKIP} {_SEE}? (any)? {_WAY} (?P<first>_+?) (than|THAN|or|OR|ORMORE|ORFEWER) (there BE|the|more|"
            rf"fewer)* (?P<second>_+?)"
        ),
        (
            rf"{_SKIP} (HOWMANYMORE|(by|in) HOWMANY BE there more|HOWMANY MORE) (?P<first>_+?) (BE there|VISIBLE|SELF "
            rf"SEE|than|do SELF SEE)* than (?P<second>_+?) (BE there|VISIBLE|there BE|do SELF SEE|can SELF SEE|SELF "
            rf"SEE)*"
        ),
        rf"{_SKIP} (WHQ BE)? (DET)? difference between (DET)? COUNTNOUN (?P<first>_+?) and (DET)? COUNTNOUN (?P<second>_+)",
        rf"{_SKIP} {_SEE} as many (?P<first>_+?) as (there BE)? (?P<second>_+?)",
        (
            rf"{_SKIP} COMPARE (DET)? (COUNTNOUN|number of|count of|HOWMANY)* (?P<first>_+?) (and|AND|with|to|against) "
            rf"(DET)? (COUNTNOUN|number of)* (?P<second>_+)"
        ),
        (
            rf"{_SKIP} WHQ BE (?P<way>LEADMORE|larger|bigger|smaller|greater) COMMA? (DET)? COUNTNOUN (?P<first>_+?) "
            rf"or (DET)? COUNTNOUN (?P<second>_+)"
        ),
        rf"{_SKIP} (WHQ) BE there more of COMMA (?P<first>_+?) or (?P<second>_+)",
        rf"{_SKIP} (by HOWMANY|HOWMANY) DOV DET (?P<first>_+?) outnumber DET (?P<second>_+)",
        rf"{_SKIP} (DOV|BE) (the)? (?P<first>_+?) outnumber (the)? (?P<second>_+)",
    )
    sides = r"(on|at|in|to|near|by) _+?"
    if match := full_match(
        rf"{_SKIP} {_SEE} (any)? {_WAY} (?P<thing>_+?) (?P<first>{sides}) (than|THAN|or|OR) (?P<second>({sides})|_+)", words
    ):
        thing = thing_of(source, match["thing"])
        ends = [text_of(source, match[name]) for name in ("first", "second")]
        if thing and not place_of(source, match["first"]):
            lead = "" if match["second"][0].has("PREP") else f"{match['first'][0].word} "
            return Compare(
                Thing(f"{thing.text} {ends[0]}"), Thing(f"{thing.text} {lead}{ends[1]}"), _comparison(match["way"]), view
            )
    for pattern in patterns:
        match = full_match(pattern, words)
        if not match:
            continue
        first, second = thing_of(source, match["first"]), thing_of(source, trimmed(match["second"], "VISIBLE"))
        if first and second and first.text and second.text:
            step: Step = Compare(first, second, _comparison(match["way"]) if "way" in match.names else "more", view)
            return AtPlaces(places, (step,)) if places else step
    return None


def _first_with(source: Source, lexemes: Sequence[Lexeme]) -> Step | None:
    """Read "go through the presets and stop at the first with a crane"."""
    stop = (
        r"(STAY|stop|stopping|HALT-ING|pause|STOP|CARRY|remain|halt|TAKE|end) (at|on|up)? (the)? first (one|PRESETNOUN|place)? "
        r"(with|that has|that shows|which has|showing|where SELF SEE|where there BE|that HAVEV|where SELF FIND|"
        r"where SELF can SEE|with_a|that SHOW-S|that SELF SEE) (?P<thing>_+)"
    )
    match = full_match(
        (
            rf"{_SKIP} (SWITCH|CARRY|step|try|check|through|to|at|AIM|SCAN|visit|TRY|SHOW)* (?P<places>_+?) (INTURN|COMMA|"
            rf"AND|and|FILLER|until)* {stop}"
        ),
        lexemes,
    )
    if not match:
        return None
    places, thing = places_of(source, match["places"]), thing_of(source, match["thing"])
    return FirstWith(thing, places) if thing is not None and places is not None else None


def _first_preset(source: Source, lexemes: Sequence[Lexeme]) -> Step | None:
    """Read "find the first preset with a van"."""
    match = full_match(
        (
            rf"{_SKIP} (FIND|SWITCH|CARRY|SHOW|to|me|at)* (the)? first PRESETNOUN (with|that HAVEV|that SHOW-S|showing|"
            rf"where SELF SEE|where there BE) (?P<thing>_+)"
        ),
        lexemes,
    )
    thing = thing_of(source, match["thing"]) if match else None
    return FirstWith(thing, ()) if thing is not None else None


def sum_step(source: Source, lexemes: Sequence[Lexeme]) -> Step | tuple[Step, ...] | None:
    """Read counts over several presets: "add up the people at the gate and in the yard"; None for other clauses."""
    match = full_match(
        (
            r"(FILLER|TELL|SELF|me|COUNT|COUNTNOUN|HOWMANY|WHQ|BE|DET|difference|between|in|number of|COMPARE|CARRY|"
            r"total|up|sum|of|CALCULATE|work_out)+ (?P<thing>_+?) (BE there|VISIBLE|in total|altogether)* (at|in|from|"
            r"on) (?P<first>(DET)? PRESET (PRESETNOUN)?) (COMMA|and|AND|minus|plus|versus|THAN)+ (DET|those|the ones|"
            r"COUNTNOUN|number of)* (?P<other>_+?)?? (at|in|from|on) (?P<second>_+)"
        ),
        lexemes,
    )
    if not match and (
        match := full_match(
            (
                r"(FILLER|TELL|SELF|WHQ|BE|DET|in|COMPARE|of)* (COUNTNOUN|HOWMANY|difference|sum|total|COUNT) (COUNTNOUN|"
                r"in|of|DET|number)* (?P<thing>_+?) (BE there|VISIBLE)* between (?P<places>_+)"
            ),
            lexemes,
        )
    ):
        places, things = places_of(source, match["places"]), things_of(source, match["thing"])
        return AtPlaces(places, (Count(things),)) if places and things and len(places) > 1 else None
    if not match:
        return None
    things = things_of(source, match["thing"])
    first, second = places_of(source, match["first"]), places_of(source, match["second"])
    if not (things and first and second):
        return None
    other = things_of(source, match["other"]) if match.has("other") else things
    if other is None:
        return None
    if other != things:  # "count cars at the gate and vans at the yard"
        return (AtPlaces(first, (Count(things),)), AtPlaces(second, (Count(other),)))
    return AtPlaces((*first, *second), (Count(things),))
