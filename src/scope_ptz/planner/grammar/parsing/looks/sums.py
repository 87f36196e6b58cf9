"""Read counts that are added, subtracted or tested for equality: "cars minus vans", "add the cars at the gate to those at B"."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.planner.grammar.instruction_tree import AtPlaces, Compare, Count, Difference, Step, Tally, Thing, Total
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.calculations import without_sum
from scope_ptz.planner.grammar.parsing.parts.clause import Source, trimmed
from scope_ptz.planner.grammar.parsing.parts.noun_phrases import thing_of, things_of
from scope_ptz.planner.grammar.parsing.parts.patterns import Match, full_match
from scope_ptz.planner.grammar.parsing.parts.preset_refs import place_of, places_of
from scope_ptz.planner.grammar.parsing.parts.scopes import has_full_scope, without_view

_LEAD = r"(FILLER|TELL|SELF|me|us|COUNT|WHQ|BE|CALCULATE|work_out|and|if|IF|whether|COMMA)*"
_NUMBER = r"(DET|COUNTNOUN|HOWMANY|number of|total|BE|there|VISIBLE)*"
_SEEN = r"(BE there|there BE|VISIBLE|SELF SEE|do SELF SEE|can SELF SEE|HAVEV|SELF|have|FILLER)*"
_AT = r"(at|in|from|on)"
_PRESET = r"(DET)? PRESET (PRESETNOUN)?"

_DIFFERENCES = (
    (
        rf"{_LEAD} (by)? (HOWMANYMORE|HOWMANY MORE) (?P<first>_+?) (BE|there|VISIBLE|SELF SEE|do SELF SEE|can SELF SEE)* {_AT} "
        rf"(?P<place>{_PRESET}) (than|THAN) (there BE)? (?P<second>_+)"
    ),
    rf"{_LEAD} (subtract|deduct|(TAKE|take) (?=_* away from|(DET)? (COUNTNOUN|number of))) {_NUMBER} (?P<second>_+?) "
    rf"(away)? from {_NUMBER} (?P<first>_+?)",
    rf"{_LEAD} {_NUMBER} (?P<first>_+?) {_SEEN} (minus|less) {_NUMBER} (?P<second>_+?) {_SEEN}",
    rf"{_LEAD} (by HOWMANY|HOWMANY) (DOV|do|does)? (DET)? (?P<first>_+?) "
    rf"(outnumber|exceed|beat|outstrip|surpass) (DET)? (?P<second>_+)",
    rf"{_LEAD} (DET)? difference (in (number|numbers|count|quantity))? (in|between) {_NUMBER} (?P<first>_+?) (and|"
    rf"AND) {_NUMBER} (?P<second>_+)",
)
_SUM_OF = (
    r"(FILLER|TELL|SELF|me|us|COUNT|WHQ|BE|CALCULATE|work_out|compute|find|FIND|give|TAKE|CARRY|DET|combined|overall)* "
    r"(sum|total|COUNTNOUN) (of)? (EVERY|DET)* (?P<things>_+?) (that|which)? (BE there|there BE|VISIBLE|SELF SEE|"
    r"do SELF SEE|(that)? SELF can SEE|HAVEV|SELF|have|FILLER)*"
)
_TOTALS = (
    rf"{_LEAD} (add|COUNT|sum) {_NUMBER} (?P<first>_+?) (to|with|onto|AND|and) {_NUMBER} (?P<second>_+? (at|in|from|on) _+)",
    rf"{_LEAD} add {_NUMBER} (?P<first>_+?) (and|AND) {_NUMBER} (?P<second>_+?) (together|up)",
    rf"{_LEAD} add {_NUMBER} (?P<first>_+?) to {_NUMBER} (?P<second>_+)",
    rf"{_LEAD} {_NUMBER} (?P<first>_+?) (at|in|from|on) {_PRESET} plus {_NUMBER} (?P<second>_+)",
)
_SAME = r"(the)? (the_same|SAMEAMOUNT|same|equal|identical|matching)"
_EQUALITIES = (
    rf"{_LEAD} (there|there BE)? (as many|{_SAME} (COUNTNOUN|number of|amount of)) (?P<first>_+?) {_SEEN} (as|and|"
    rf"AND) (?P<second>_+?) {_SEEN}",
    (
        rf"{_LEAD} (DET)? (COUNTNOUN|number of) (?P<first>_+?) {_SEEN} {_SAME} (as|to|as_the)? (DET|that)* (COUNTNOUN|number of) "
        r"(?P<second>_+)"
    ),
)
_MORE_OF_KIND = rf"{_LEAD} (HOWMANYMORE|HOWMANY MORE) (?P<thing>_+?) BE (?P<one>FREE) (than|THAN) (BE)? (?P<other>FREE)"
_EQUAL_AT = (
    rf"{_LEAD} (DOV|do)? (?P<one>_+?) (AND|and) (?P<other>_+?) (HAVEV|have|SHOW) {_SAME} (COUNTNOUN|number "
    rf"of|numbers of) (?P<thing>_+)"
)
_THOSE = "(those|that|the ones|ones|PRON|HOWMANY|HOWMANY there BE|the number|VISIBLE|BE|there)+"


def sum_step(source: Source, lexemes: Sequence[Lexeme]) -> Step | tuple[Step, ...] | None:
    """Return the step of a clause that adds or subtracts counts; None for other clauses."""
    return _calculation(source, lexemes) or _counts_at_presets(source, lexemes)


def _calculation(source: Source, lexemes: Sequence[Lexeme]) -> Step | None:
    """Read two counts (of different things or at different presets) and the operation that joins them."""
    words, view = without_view(lexemes)
    view = "full" if has_full_scope(lexemes) else view
    if (summed := full_match(_SUM_OF, words)) is not None and (step := _total(source, summed["things"], view, lexemes)) is not None:
        return step
    if (
        (kinds := full_match(_MORE_OF_KIND, words)) is not None
        and (whole := thing_of(source, kinds["thing"])) is not None
        and whole.text
    ):
        one, other = (Thing(f"{kinds[name][0].word} {whole.text}") for name in ("one", "other"))
        return Difference(Tally(one, view=view), Tally(other, view=view))
    if (equal := full_match(_EQUAL_AT, words)) is not None:
        places, thing = (place_of(source, equal["one"]), place_of(source, equal["other"])), thing_of(source, equal["thing"])
        if places[0] and places[1] and thing is not None and thing.text:
            return Difference(Tally(thing, places[0]), Tally(thing, places[1]))
    for patterns, operation in ((_DIFFERENCES, "difference"), (_TOTALS, "total"), (_EQUALITIES, "equality")):
        for pattern in patterns:
            if (match := full_match(pattern, words)) is None or (parts := _operands(source, match, view)) is None:
                continue
            first, second = parts
            if operation == "total":
                return Total(parts)
            if operation == "equality" and first.place is None and second.place is None:
                return Compare(first.thing, second.thing, "more", view)
            return Difference(first, second)
    return None


def _total(source: Source, lexemes: Sequence[Lexeme], view: object, clause: Sequence[Lexeme]) -> Step | None:
    """Return the total of several kinds, or of one kind at several presets: "the sum of the cars at gate and yard"."""
    if not any(x.word in {"sum", "total"} or x.word.startswith(("total", "combined", "overall")) for x in clause):
        return None
    lexemes = without_sum(lexemes)
    if placed := full_match(rf"(?P<thing>_+?) {_SEEN} {_AT} (?P<places>_+)", lexemes):
        places, thing = places_of(source, placed["places"]), thing_of(source, placed["thing"])
        kinds = things_of(source, placed["thing"]) or ()
        if places and len(places) == 1:  # "the total of trucks and buses at the gate"
            return AtPlaces(places, (Total(tuple(Tally(kind) for kind in kinds)),)) if len(kinds) > 1 else None
        if places and thing is not None and thing.text:
            return Total(tuple(Tally(thing, place) for place in places))
    things = things_of(source, lexemes)
    if things is None or len(things) < 2:
        return None
    return Total(tuple(Tally(thing, view=view) for thing in things))  # type: ignore[arg-type]


def _operands(source: Source, match: Match, view: object) -> tuple[Tally, Tally] | None:
    """Return the two counts of a match; None unless each counts one thing, at one preset or at none."""
    second = match["second"]
    first_part = _tally(source, match["first"], view)
    if first_part is None:
        return None
    if match.has("place"):
        first_part = Tally(first_part.thing, place_of(source, match["place"]))
    if first_part.place is not None and (place := place_of(source, second)) is not None:
        return first_part, Tally(first_part.thing, place)  # "cars at the gate and the yard"
    if those := full_match(rf"{_THOSE} {_AT} (?P<place>_+)", second):
        place = place_of(source, those["place"])
        return (first_part, Tally(first_part.thing, place)) if place is not None and first_part.place is not None else None
    if (bare := full_match(rf"{_AT} (?P<place>_+)", second)) and (place := place_of(source, bare["place"])) is not None:
        return (first_part, Tally(first_part.thing, place)) if first_part.place is not None else None
    second_part = _tally(source, second, view)
    if second_part is None or (first_part.place is None) != (second_part.place is None):
        return None
    return first_part, second_part


def _tally(source: Source, lexemes: Sequence[Lexeme], view: object) -> Tally | None:
    """Return the count of a thing, which may be followed by a preset: "cars at the gate"."""
    lexemes = trimmed(lexemes, "FILLER", "COMMA", "VISIBLE")
    placed = full_match(rf"(?P<thing>_+?) {_SEEN} {_AT} (?P<place>{_PRESET})", lexemes)
    words = trimmed(placed["thing"] if placed else lexemes, "COUNTNOUN", "HOWMANY", "DET")
    if not words or words[0].word == "there" or any(x.has("AND", "OR", "COMMA") or x.word == "between" for x in words):
        return None
    thing = thing_of(source, words)
    if thing is None or not thing.text:
        return None
    return Tally(thing, place_of(source, placed["place"])) if placed else Tally(thing, view=view)  # type: ignore[arg-type]


def _counts_at_presets(source: Source, lexemes: Sequence[Lexeme]) -> Step | tuple[Step, ...] | None:
    """Read counts over several presets: "add up the people at the gate and the yard"; None for other clauses."""
    match = full_match(
        (
            r"(FILLER|TELL|SELF|me|COUNT|COUNTNOUN|HOWMANY|WHQ|BE|DET|difference|between|in|number of|COMPARE|CARRY|"
            r"total|up|sum|of|CALCULATE|work_out)+ (?P<thing>_+?) (BE there|VISIBLE|in total|altogether|SELF SEE)* (at|in|from|"
            r"on) (?P<first>(DET)? PRESET (PRESETNOUN)?) (COMMA|and|AND|minus|plus|versus|THAN)+ (DET|those|the ones|"
            r"COUNTNOUN|number of)* (?P<other>_+?)?? (at|in|from|on) (?P<second>_+)"
        ),
        lexemes,
    )
    if not match and (
        match := full_match(
            (
                r"(FILLER|TELL|SELF|WHQ|BE|DET|in|COMPARE|of)* (COUNTNOUN|HOWMANY|difference|sum|total|COUNT) (COUNTNOUN|"
                r"in|of|DET|number)* (?P<thing>_+?) (BE there|VISIBLE|total)* between (?P<places>_+)"
            ),
            lexemes,
        )
    ):
        places, things = places_of(source, match["places"]), things_of(source, match["thing"])
        return AtPlaces(places, (Count(things),)) if places and things and len(places) > 1 else None
    if not match:
        return None
    things = things_of(source, match["thing"])
    if any(x.has("PICTURE", "SNAP") for x in match["thing"]):
        return None
    first, second = places_of(source, match["first"]), places_of(source, match["second"])
    if not (things and first and second):
        return None
    other = things_of(source, match["other"]) if match.has("other") else things
    if other is None:
        return None
    if other != things:  # "count cars at the gate and vans at the yard"
        return (AtPlaces(first, (Count(things),)), AtPlaces(second, (Count(other),)))
    return AtPlaces((*first, *second), (Count(things),))
