"""Read requests to order things or presets by their counts: "rank the presets by the number of cars"."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.planner.grammar.instruction_tree import Compare, Comparison, PresetRef, RankCounts, Step, Tally, Thing
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.clause import Source, trimmed
from scope_ptz.planner.grammar.parsing.parts.noun_phrases import thing_of, things_of
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match
from scope_ptz.planner.grammar.parsing.parts.preset_refs import places_of
from scope_ptz.planner.grammar.parsing.parts.scopes import has_full_scope, without_view

_LEAD = "(FILLER|FIRSTLY|LEADFILLER|TELL|me|us|SELF|COMMA)*"
_ORDERING = "(rank|order|sort|arrange|put|list|name|COMPARE)"
_IN_ORDER = "(in_order|INTURN|in (DET)? order|into order|ordered|ranked|sorted|up)"
_NUMBER = "(the|their)? (COUNTNOUN|number of|count of|amount of|HOWMANY)"
_SEEN = "(BE there|there BE|VISIBLE|SELF SEE|SELF can SEE|they have|PRON HAVEV|PRON SHOW|each one has|at each|each|in each)*"
_WAY = (
    r"(COMMA|in|from|OPEN|DASH|with|the)* (?P<way>SUPERLATIVE FREE? (first|FIRSTLY|to _+)?|LEADMORE FREE? (first|FIRSTLY|to _+)?|"
    r"(highest|biggest|largest|busiest|lowest|smallest|quietest) (number)? (first|FIRSTLY|to _+)|descending (order)?|"
    r"(ascending|increasing|decreasing) (order)?) (CLOSE)?"
)
_FEWEST_FIRST = frozenset({"lowest", "smallest", "quietest", "ascending", "increasing"})
_PATTERNS = (
    # "rank the presets by number of cars, fewest first", "put gate and yard in order of how many people they have"
    rf"{_LEAD} {_ORDERING} (?P<names>_+?) {_IN_ORDER}? (of|by|according to|on) {_NUMBER} (?P<thing>_+?) {_SEEN} ({_WAY})?",
    rf"{_LEAD} (WHQ BE)? (DET)? (order|ranking|rank) of (?P<names>_+?) (by|in terms of|for|in) {_NUMBER} (?P<thing>_+?) ({_WAY})?",
    # "list the presets from most vans to fewest"
    rf"{_LEAD} {_ORDERING} (?P<names>_+?) {_IN_ORDER}? (COMMA)? from (the)? (?P<way>SUPERLATIVE) (?P<thing>_+?) to "
    rf"(the)? SUPERLATIVE",
    # "rank cars, vans and bikes by number", "sort cars, vans and bikes from most to fewest"
    (
        rf"{_LEAD} {_ORDERING} (?P<names>_+?) {_IN_ORDER}? (of|by) (DET)? (COUNTNOUN|number|count|quantity|frequency|numbers|"
        rf"HOWMANY (of (each|PRON|them|EVERY))? {_SEEN}) ({_WAY})?"
    ),
    rf"{_LEAD} {_ORDERING} (?P<names>_+?) {_IN_ORDER}? {_WAY}",
)
_MOST_OF = (
    # "which is there most of: cars, vans or bikes?", "what are there fewest of, cars or vans?"
    rf"{_LEAD} WHQ (FREE)? (BE there|DOV SELF (SEE|have)|SELF (SEE|have)) (the)? (?P<way>SUPERLATIVE|LEADMORE) (of)? "
    rf"(COLON|COMMA|DASH)* "
    r"(?P<names>_+ (OR|AND) _+)",
    # "of cars, vans and bikes, which are there most of?"
    rf"{_LEAD} (WHQ)? (out_of|of|among|between|OFNOUN) (?P<names>_+? (OR|AND) _+?) (COMMA)? (WHQ)? (FREE)? "
    r"(BE there|DOV SELF (SEE|have)|SELF (SEE|have)) (the)? (?P<way>SUPERLATIVE|LEADMORE) (of)?",
    # "are there more cars, vans or bikes?"
    rf"{_LEAD} (if|IF|whether)? (BE there|there BE|DOV SELF SEE|can SELF SEE) (the)? (?P<way>SUPERLATIVE|LEADMORE) "
    r"(?P<names>_+ COMMA _+ OR _+)",
)  # fmt: skip


def ranking_step(source: Source, lexemes: Sequence[Lexeme]) -> Step | None:
    """Return the step of a clause that orders things or presets by their counts; None for other clauses."""
    if not any(x.has("SUPERLATIVE", "LEADMORE", "COUNTNOUN", "HOWMANY") or x.word in _ORDER_WORDS for x in lexemes):
        return None
    words, view = without_view(lexemes)
    view = "full" if has_full_scope(lexemes) else view
    for pattern in _PATTERNS:
        if (match := full_match(pattern, words)) is None:
            continue
        first = _leading_comparison(match["way"]) if "way" in match.names else "more"
        if "thing" in match.names:
            places, thing = _places(source, match["names"]), thing_of(source, trimmed(match["thing"], "VISIBLE"))
            if places is not None and thing is not None and thing.text:
                parts = tuple(Tally(thing, place) for place in places) or (Tally(thing, everywhere=True),)
                return RankCounts(parts, first)
        elif (things := _kinds(source, match["names"])) is not None:
            return RankCounts(tuple(Tally(thing, view=view) for thing in things), first)
    for pattern in _MOST_OF:
        if (match := full_match(pattern, words)) is not None and (things := _kinds(source, match["names"])) is not None:
            first = _leading_comparison(match["way"])
            if len(things) == 2:
                return Compare(*things, first, view)
            return RankCounts(tuple(Tally(thing, view=view) for thing in things), first, winner=True)
    return None


_ORDER_WORDS = (
    frozenset({"number", "numbers", "count", "quantity", "frequency", "descending", "ascending", "first"}) | _FEWEST_FIRST
)


def _leading_comparison(way: Sequence[Lexeme]) -> Comparison:
    """Return "more" if an order begins with the most, or "fewer" if it begins with the fewest."""
    return "fewer" if way[0].has("FEW") or way[0].word in _FEWEST_FIRST | {"fewer", "less"} else "more"


def _places(source: Source, lexemes: Sequence[Lexeme]) -> tuple[PresetRef, ...] | None:
    """Return the presets to order; empty for all presets; None for other words or for a single preset."""
    places = places_of(source, trimmed(lexemes, "COMMA", "DASH", "COLON"))
    return places if places is None or len(places) != 1 else None


def _kinds(source: Source, lexemes: Sequence[Lexeme]) -> tuple[Thing, ...] | None:
    """Return the kinds of things in a list with "and" or "or"; None for other words or for a single kind."""
    parts: list[list[Lexeme]] = [[]]
    for x in lexemes:
        if x.has("AND", "OR", "COMMA"):
            parts.append([])
        elif not (x.has("LEADMORE", "SUPERLATIVE") and not parts[-1]):
            parts[-1].append(x)
    if any(part[0].has("WHQ", "HOWMANY") or part[0].word == "how" for part in parts if part):
        return None
    things = [things_of(source, part) for part in parts if part]
    kinds = [found[0] for found in things if found is not None and len(found) == 1 and found[0].text]
    has_presets = any(x.has("PRESET", "PRESETNOUN") for x in lexemes)
    return tuple(kinds) if len(kinds) == len(things) > 1 and not has_presets else None
