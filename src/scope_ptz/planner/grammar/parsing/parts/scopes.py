"""Strip adjuncts from a clause: the view, the place, repetitions and durations."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from scope_ptz.english import is_plural
from scope_ptz.english.grammar.lexicon import lexicon
from scope_ptz.planner.grammar.instruction_tree import PresetRef
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.clause import Source, trimmed
from scope_ptz.planner.grammar.parsing.parts.noun_phrases import is_noun
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, search
from scope_ptz.planner.grammar.parsing.parts.preset_refs import places_of

if TYPE_CHECKING:
    from scope_ptz.tools.arguments import View

_TRIVIAL = ("FILLER", "COMMA", "LEADFILLER", "FIRSTLY", "INSTEAD", "QUOTE", "ATSAMETIME")
_FIXED_TO_THINGS = frozenset({
    "sign", "signs", "text", "word", "words", "writing", "written", "letters", "lettering", "logo", "number", "name", "label",
    "notice", "poster", "lock", "padlock", "handle", "says", "say", "printed", "painted", "colour", "color", "time",
})  # fmt: skip
"""Words for things fixed to other things: in "the sign on the gate", "gate" is not the preset."""

_PARTS_OF_DAY = frozenset({"morning", "afternoon", "evening", "arvo", "minute", "moment", "time", "week"})
_PARTICLES = frozenset({"over", "up", "off", "out", "down", "away", "in"})
_AT_PRESENT = frozenset({
    "now", "right_now", "currently", "at_the_moment", "at_present", "just_now", "at_this_moment", "presently", "this_instant",
    "at_the_mo",
    "at_the_minute", "at_this_point", "this_moment",
})  # fmt: skip

_TIMES = (
    r"(COMMA)? (for)? (?P<times>(?P<number>NUM) X(?! (DET|as|ASCLOSE|ZOOMNOUN|ZOOM|IN|OUT|more|further|"
    r"further_in))|(?P<twice>twice)|(?P<thrice>thrice)|X (?P<number2>NUM)) (INTURN|FILLER)*"
)
_TERSE_PLACE = (
    "(FILLER)* (COUNT|HOWMANY|(DET)? COUNTNOUN) (DET)? (?P<things>FREE{1,3} (AND FREE{1,3})?) "
    "(?P<place>PRESET ((COMMA|AND)+ PRESET)*)"
)
"""A count and its presets without a preposition: "count trucks lane 3"."""

_OVER_THE_WHOLE = "(?P<body>_+?) COMMA? (over|across|throughout|around|all_over) the (whole|entire) (?P<site>FREE{1,2}) (FILLER)*"
_ALL_OF_IT = "((for|over|across|of|around|within|throughout)? FULL (AROUND|VISIBLE|only)*)"
"""The whole scene: "for the whole scene", "the whole place around"."""

_THIS_VIEW = (
    "((within|in|inside|from|on|for)? (the|this|your)? (current|present) (VIEWNOUN|PICTURE) (only|alone|FILLER)*|NOW (only|alone))"
)
"""The current view: "within the present field of view", "current view only"."""

_FOR_SCOPE = f"(?P<body>_+?) (fall|falls)? COMMA? ((?P<full>{_ALL_OF_IT})|(?P<current>{_THIS_VIEW}))"
MAX_TIMES = 50
SECONDS = (
    r"((?P<a>DET|about|AMOUNTISH|interval of|period of|next|full|whole|good|solid|LIMIT)* "
    r"(?P<seconds>NUM)? (?P<part>FRACTION)? (DET|of|of a)* (?P<unit>SECONDS|"
    r"MINUTES|HOURS) (and (DET)? (?P<more>FRACTION|half)|and? (?P<rest>NUM) SECONDS?)?)"
)


def without_view(lexemes: Sequence[Lexeme]) -> tuple[tuple[Lexeme, ...], View | None]:
    """Strip the words for the view from a clause. Return the rest and the view: "current", "full" or None."""
    view: View | None = None
    lexemes = trimmed(lexemes, *_TRIVIAL)
    if seen := full_match(
        "(?P<body>_+?) COMMA? (AIM-ING|SCAN-ING|looking|checking) (over|across|through)* (?P<scope>FULL)", lexemes
    ):
        lexemes = (*seen["body"], *seen["scope"])  # "the number of flags, looking over the whole area"
    if (scoped := full_match(_FOR_SCOPE, lexemes)) is not None and not _needs_more(scoped["body"]):
        lexemes, view = trimmed(scoped["body"], *_TRIVIAL), "full" if scoped.has("full") else "current"
    if all_around := full_match("(?P<body>_+) COMMA SCAN-ING", lexemes):
        lexemes, view = tuple(all_around["body"]), "full"  # "how many trailers, looking all around?"
    if (whole := full_match(_OVER_THE_WHOLE, lexemes)) is not None and lexicon().concept(whole["site"][-1].word) is None:
        lexemes, view = tuple(whole["body"]), "full"  # "the number of light poles over the entire terminal"
    changed = True
    while changed and len(lexemes) > 1:
        changed = False
        for end in (-1, 0):
            x = lexemes[end]
            near = lexemes[-2] if end else lexemes[1]
            if (
                x.has("FULL")
                and not (end == 0 and near.has("BE"))
                and not (end and near.has("DET", "PREP") and not near.has("ADVERB"))
            ):
                view, changed = "full", True
            elif x.has("NOW") and not near.has("WHQ", "BE") and not (end == -1 and near.has("BE", "PREP", "DET")):
                view, changed = view or ("current" if not x.word.startswith("from") else view), True
            if changed:
                lexemes = trimmed(lexemes[:-1] if end else lexemes[1:], *_TRIVIAL)
                break
    return lexemes, view


def _needs_more(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether lexemes cannot stand without the words after them: "what is", "count the"."""
    return lexemes[-1].has("PREP", "DET", "WHQ") or (lexemes[-1].has("BE") and lexemes[0].has("WHQ", "BE", "TELL"))


def scope_of(lexemes: Sequence[Lexeme]) -> View | None:
    """Return the view if lexemes only say where to look: "the whole place around", "current view only"; None for other words."""
    lexemes = trimmed(lexemes, *_TRIVIAL)
    return (
        "full"
        if full_match(f"{_ALL_OF_IT}|(DET)? (LIMIT|full|complete|entire|whole) (VIEWNOUN|panorama) only?", lexemes)
        else "current"
        if full_match(_THIS_VIEW, lexemes)
        else None
    )


def has_full_scope(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether words for the whole scene occur anywhere in a clause."""
    return any(x.has("FULL") for x in lexemes)


def split_leading_place(source: Source, lexemes: Sequence[Lexeme]) -> tuple[tuple[Lexeme, ...], tuple[PresetRef, ...] | None]:
    """Return a clause without the preset that begins it ("at the gate, count ..."), and that preset, or None if there is none."""
    for size in range(min(len(lexemes) - 1, 12), 0, -1):
        head, rest = lexemes[:size], lexemes[size:]
        if head[0].has("FILLER", "LEADFILLER", "COMMA", "FIRSTLY"):
            return split_leading_place(source, lexemes[1:])
        lead = full_match(
            (
                r"(at|from|in|on|using|starting from|starting at|with (DET)? CAMERA (on|at)|for|SWITCH-ING|between) "
                r"(?P<place>_+?) (COMMA|FILLER)*"
            ),
            head,
        )
        if lead and (places := places_of(source, lead["place"])) is not None and not _is_part_of_noun(rest):
            return trimmed(rest, "COMMA"), places
    return tuple(lexemes), None


def _is_part_of_noun(rest: Sequence[Lexeme]) -> bool:
    return bool(rest) and rest[0].has("AND", "FREE", "PREP") and not rest[0].has("PAN")


def split_trailing_place(source: Source, lexemes: Sequence[Lexeme]) -> tuple[tuple[Lexeme, ...], tuple[PresetRef, ...] | None]:
    """Return a clause without the preset that ends it ("count the cars at the gate"), and that preset, or None."""
    lexemes = _without_present_time(trimmed(lexemes, *_TRIVIAL))
    if (terse := full_match(_TERSE_PLACE, lexemes)) is not None and is_plural(terse["things"][-1].word):
        return trimmed(lexemes[: len(lexemes) - len(terse["place"])], "COMMA"), places_of(source, terse["place"])
    for size in range(min(len(lexemes) - 1, 14), 1, -1):
        tail = lexemes[len(lexemes) - size :]
        before = lexemes[len(lexemes) - size - 1]
        lead = full_match(r"(?P<prep>at|from|in|on|using|for|for each|between|across|to|outside|by) (?P<place>_+)", tail)
        is_past_particle = (
            before.word in _PARTICLES and len(lexemes) > size + 1 and lexemes[len(lexemes) - size - 2].has("FREE", "HAVEV")
        )
        if before.has("BE", "HAVEV") or before.word == "'s":
            subject = lexemes[len(lexemes) - size - 2] if len(lexemes) > size + 1 else None
            if subject is not None and subject.word in {"whatever", "whoever", "whichever"}:
                continue  # "the plate of whatever is on the weighbridge"
        is_likeness = before.word == "like" and lexemes[0].has("WHQ")  # "what is the queue like at the gate?"
        if not lead or (
            before.has("PREP", "DET", "AND") and not before.has("VISIBLE", "ADVERB") and not is_likeness and not is_past_particle
        ):
            continue
        if lead["place"][0].has("PREP"):
            continue
        places = places_of(source, lead["place"])
        if places is None or (lead["prep"][0].word in {"for", "to", "between"} and places):
            continue
        preposition = lead["prep"][0].word
        is_certain = (
            not places
            or preposition in {"at", "from", "in", "using", "across"}
            or any(x.has("PRESETNOUN") for x in lead["place"])
            or (
                preposition in {"outside", "by"}
                and search("HOWMANY|COUNTNOUN|COUNT", lexemes) is not None
                and not _any_names_a_thing(places)
                and not (preposition == "by" and any(place.name.isalpha() for place in places))
            )
            or (
                preposition == "on"
                and not source.has_moved
                and _allows_place_after_on(lexemes[: len(lexemes) - size])
                and not _any_names_a_thing(places)
            )
        )
        nouns = (
            "" if len(places) > 1 else "sign|word|text|"
        )  # "the sign at the gate" may be a description, but with two presets it cannot be
        if is_certain and not search(rf"(near|by|behind|{nouns}written|of) \Z", lexemes[: len(lexemes) - size]):
            return trimmed(lexemes[: len(lexemes) - size], "COMMA", "AND"), places
    return lexemes, None


def _without_present_time(lexemes: Sequence[Lexeme]) -> tuple[Lexeme, ...]:
    """Return lexemes without trailing words that refer to the present: "... on the bridge at the minute", "... this morning"."""
    lexemes = tuple(lexemes)
    if len(lexemes) > 3 and lexemes[-1].word in {"yet", "still", "already"}:
        lexemes = lexemes[:-1]
    counts = any(x.has("HOWMANY", "COUNT", "COUNTNOUN") for x in lexemes) or bool(search("BE there|ANY", lexemes[:3]))
    if counts and len(lexemes) > 3 and lexemes[-2].word == "this" and lexemes[-1].word in _PARTS_OF_DAY:
        return lexemes[:-2]
    if len(lexemes) > 3 and lexemes[-1].word in {"yet", "already", "still"} and lexemes[-2].has("PRESET", "PRESETNOUN"):
        return lexemes[:-1]  # "any lorries at the loading dock yet?"
    return lexemes[:-1] if len(lexemes) > 2 and lexemes[-1].has("NOW") and lexemes[-1].word in _AT_PRESENT else lexemes


def _allows_place_after_on(before: Sequence[Lexeme]) -> bool:
    """Return whether "on" after these words introduces a place: "people on the bridge", unlike "signs on the bridge"."""
    if any(x.word in _FIXED_TO_THINGS for x in before):
        return False
    if before[-1].word in _PARTICLES and len(before) > 1:
        before = before[:-1]  # "birds out on the roof"
    return before[-1].has("FREE", "VISIBLE", "SOMEONE", "NOONE", "BE", "HAVEV", "SEE", "COUNT", "COUNTNOUN") or is_noun(
        before[-1].word
    )


def _any_names_a_thing(places: Sequence[PresetRef]) -> bool:
    """Return whether the name of any preset is also a word for a thing that can be in the picture: "the signs on the gantry"."""
    return any(place.name.isalpha() and lexicon().concept(place.name) is not None for place in places)


def without_repetitions(lexemes: Sequence[Lexeme]) -> tuple[tuple[Lexeme, ...], int, bool]:
    """Strip the number of repetitions from a clause. Return the rest, the number, and whether a comma precedes it."""
    match = full_match(rf"(?P<body>_*?) {_TIMES}", lexemes)
    if not match or not match.has("times"):
        return tuple(lexemes), 1, False
    if match["body"] and match["body"][-1].word == "at":
        return tuple(lexemes), 1, False  # "a picture at 3x"
    number = match["number"] or match["number2"]
    times = round(number[0].value) if number else 2 if match.has("twice") else 3
    body = match["body"]
    return trimmed(body, "COMMA"), max(1, min(times, MAX_TIMES)), len(body) > 0 and lexemes[len(body)].has("COMMA")


def duration_of(match) -> float:  # type: ignore[no-untyped-def]
    """Return the duration, in seconds, that a match of ``SECONDS`` expresses."""
    unit = match["unit"][0]
    size = 1.0 if unit.has("SECONDS") else 60.0 if unit.has("MINUTES") else 3600.0
    value = match["seconds"][0].value if match["seconds"] else 1.0
    if match["part"]:
        value = (value if match["seconds"] else 1.0) * match["part"][0].value
    if match["more"]:
        value += match["more"][0].value or 0.5
    return size * value + (match["rest"][0].value if match["rest"] else 0.0)
