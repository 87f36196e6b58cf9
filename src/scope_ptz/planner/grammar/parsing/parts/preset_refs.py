"""Read references to presets: one, a list, or every preset."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

from scope_ptz.english.grammar.lexicon import lexicon
from scope_ptz.planner.grammar.instruction_tree import PresetRef
from scope_ptz.planner.grammar.lexing.lexer import Lexeme, lexemes_of
from scope_ptz.planner.grammar.parsing.parts.clause import Source, text_of
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start

_APOSTROPHES = frozenset("'’")
_PRESETS_NAMED = re.compile(r"\b(?:preset|position|view|bookmark|viewpoint|waypoint|location|spot|place|stop)s?\b", re.IGNORECASE)
PLACE = (
    r"((DET)? (PRESETNOUN)? (CALLED|(for|of) (DET)?)? (QUOTE)? (?P<name>PRESET) (QUOTE)?"
    r" (PRESETNOUN|one|VIEWNOUN|CAMERA|PICTURE|position)?"
    r"|(DET)? PRESETNOUN (NUMBERWORD)? (?P<number>NUM)|(DET)? (?P<ordinal>ORDINAL) (PRESETNOUN|one))"
)
"""A reference to a preset that the camera has, or to its number."""


_SAVED_BY_US = (
    r"((that|which)? SELF (HAVEV|have)? (got|already|ADVERB)* (saved|stored|programmed|set_up|know|save-ED|TAKE-ED|memorised|"
    r"memorized|(in|on|stored|saved)* (memory|file)))?"
)
"""Words which say that the camera knows the positions: "the places you've got saved"."""

EVERY_PLACE = (
    r"((DET)* (EVERY|both) (of)? (DET|EVERY|SELF|saved|stored|available|different|of|single|other|known|NUM)* "
    rf"(PRESETNOUN|one) {_SAVED_BY_US}|(DET|SELF|saved|stored|available|different|NUM)* (presets|positions|views|bookmarks|"
    r"viewpoints|waypoints))"
)


_OCCUPANCY = frozenset(
    {"empty", "full", "clear", "busy", "quiet", "crowded", "packed", "deserted", "occupied", "vacant", "blocked"}
)
_STILL = re.compile(
    r"\bwithout (?:moving|panning|turning)\b|\b(?:do not|don['’]?t|never) move\b|\bfrom here\b|\bstay (?:here|put|where)\b",
    re.IGNORECASE,
)
_PREPOSITIONS_OF_PLACES = frozenset(
    {"at", "in", "on", "inside", "of", "off", "into", "onto", "around", "round", "outside", "across", "down", "along", "over"}
)
_WAYS_IN = frozenset({
    "gate", "gates", "door", "doors", "entrance", "exit", "entry", "access", "hatch", "ramp", "steps", "stairs", "barrier", "path",
    "road", "shutter",
})  # fmt: skip
"""Things that are at the place to which they lead: "the gate to the yard"."""

_IS = "(BE|LOOKSLIKE|looks|seems|gets)"


def place_of(source: Source, lexemes: Sequence[Lexeme]) -> PresetRef | None:
    """Return the preset that lexemes refer to; None for anything else."""
    match = full_match(rf"(at|in|from|on|to|of|FILLER)* {PLACE} (FILLER)*", lexemes)
    if match is None:
        return None
    if match.has("name"):
        explicit = any(x.has("PRESETNOUN") for x in lexemes) or not any(x.has("DET") for x in lexemes)
        return PresetRef(match["name"][0].preset, explicit=explicit)
    number = match["number"] or match["ordinal"]
    if not any(x.has("PRESETNOUN") for x in lexemes) and not _PRESETS_NAMED.search(source.text):
        return None  # "and the second one?" after a question about cars
    return PresetRef(text_of(source, lexemes), number=round(number[0].value), explicit=True)


def occupied_place(source: Source, lexemes: Sequence[Lexeme]) -> PresetRef | None:
    """Return the preset in a statement or question about how busy it is: "the yard is empty", "is the yard busy?"."""
    match = full_match(
        f"((?P<place>_{{1,3}}?) {_IS}|{_IS} (?P<asked>_{{1,3}}?)) (ADVERB|FILLER|not|NOW|still)* (?P<state>FREE|_)", lexemes
    )
    described = full_match(
        "(FILLER)* (how BE (?P<place>_{1,3}?) (looking|doing|AIM-ING|FILLER|NOW)*|"
        "what BE (?P<place2>_{1,3}?) (looking)? like (FILLER|NOW)*|"
        f"how ({'|'.join(sorted(_OCCUPANCY))}) (BE|'s) (?P<place3>_{{1,3}}?) (FILLER|NOW)*)",
        lexemes,
    )
    if described is not None:
        return place_of(source, described["place"] or described["place2"] or described["place3"])  # "how is the yard looking?"
    if match is None or match["state"][0].word not in _OCCUPANCY:
        return None
    return place_of(source, match["place"] or match["asked"])


def stays_in_view(source: Source) -> bool:
    """Return whether a question is about the current view: the camera has been moved already, or must not be moved."""
    return source.has_moved or _STILL.search(source.text) is not None


def place_asked_about(source: Source, lexemes: Sequence[Lexeme]) -> PresetRef | None:
    """Return the only preset that a question names, if the name cannot be that of a thing in the current view.

    Names of several words ("bus-bay") and words that are in no lexicon ("debarker") are taken for the preset. A preset after
    a preposition such as "near" only says where something is.
    """
    found = [i for i, x in enumerate(lexemes) if x.has("PRESET")]
    is_list = any(x.has("COMMA") for x in lexemes)  # "put the awning, the town hall clock and the bus in order"
    if len(found) != 1 or is_list or stays_in_view(source):
        return None
    name = lexemes[found[0]]
    if sum(x.preset == name.preset for x in lexemes_of(source.text, source.presets)) > 1:
        return None  # "count the vans at the yard and at the dock. How many more does the dock have?"
    before = [x for x in lexemes[: found[0]] if not x.has("DET") or x.has("PREP")]
    leads_there = len(before) > 1 and before[-1].word in {"to", "into"} and before[-2].word in _WAYS_IN
    if before and before[-1].has("PREP") and before[-1].word not in _PREPOSITIONS_OF_PLACES and not leads_there:
        return None
    if before and before[-1].has("FREE") and lexemes[found[0] - 1] is before[-1]:
        return None  # "at Freight yard" is not the preset "yard"
    is_unmistakable = "_" in name.word or lexicon().concept(name.word) is None
    return PresetRef(name.preset, explicit=True) if is_unmistakable else None


def place_sought(source: Source, lexemes: Sequence[Lexeme]) -> PresetRef | None:
    """Return the preset in "where is the town hall?"; None for other clauses, and if the camera must stay in the current view."""
    match = full_match("where BE (?P<place>(DET)? PRESET) (FILLER|NOW)*", lexemes)
    return place_of(source, match["place"]) if match is not None and not stays_in_view(source) else None


def without_inner_place(source: Source, lexemes: Sequence[Lexeme]) -> tuple[Source, tuple[Lexeme, ...], PresetRef] | None:
    """Return "is the barrier up?" and the preset for "is the barrier at the crossing up?"; None for other clauses.

    The question is returned as a new source with its lexemes.
    """
    match = full_match("(?P<before>_+? (FREE|SOMEONE)) (?P<at>(at|on) (DET)? PRESET PRESETNOUN?) (?P<after>_+)", lexemes)
    if (
        match is not None
        and match["at"][0].word == "on"
        and lexicon().concept(match["at"][-1].preset.replace("-", " ")) is not None
    ):
        return None  # "is the sign on the gantry lit?"
    if match is None or sum(x.has("PRESET") for x in lexemes) > 1 or not any(x.has("BE", "HAVEV", "DOV") for x in lexemes):
        return None
    before, after, place = match["before"], match["after"], place_of(source, match["at"])
    is_noun_next = (
        after[0].has("PREP") and len(after) > 1 and not (after[0].word.endswith("ing") or after[0].word in {"with", "without"})
    )
    is_choice = match_start("(UP|DOWN|IN|OUT) OR", after) is not None
    if place is None or after[0].has("COMMA", "AND", "OR") or (is_noun_next and not is_choice):
        return None
    rest = text_of(source, after)
    text = f"{text_of(source, before)} {f'is{rest[2:]}' if after[0].has('BE') and rest[0] in _APOSTROPHES else rest}"
    return replace(source, text=text), lexemes_of(text, source.presets), place


def places_of(source: Source, lexemes: Sequence[Lexeme]) -> tuple[PresetRef, ...] | None:
    """Return the presets of a list; empty for "every preset"; None for anything else."""
    if full_match(
        (
            rf"(at|in|from|on|to|of|through|FILLER|between|across|over|around)* ({EVERY_PLACE}|each of them|EVERY one|"
            rf"ALLPRESETS (?!\Z)) (INTURN|FILLER|COMMA)*"
        ),
        lexemes,
    ):
        return ()
    if match := full_match(rf"(at|in|from|on|to|of|through|FILLER)* {EVERY_PLACE} (EXCEPT|PREP) (?P<left_out>_+)", lexemes):
        left_out = places_of(source, match["left_out"])
        is_exception = any(x.has("EXCEPT") for x in lexemes) and left_out and source.presets
        names = {ref.name for ref in left_out or ()}
        return tuple(PresetRef(p, explicit=True) for p in source.presets if p not in names) if is_exception else None
    while lexemes and (lexemes[0].has("EVERY") or lexemes[0].word in {"of", "both"}) and not lexemes[0].has("PRESET"):
        lexemes = lexemes[1:]
    parts: list[list[Lexeme]] = [[]]
    for x in lexemes:
        if x.has("AND", "COMMA", "OR", "THEN", "THAN"):
            parts.append([])
        elif x.has("PRESET") and parts[-1] and parts[-1][-1].has("PRESET"):
            parts.append([x])  # "in yard dock and roof"
        else:
            parts[-1].append(x)
    refs = [place_of(source, part) for part in parts if part]
    return tuple(ref for ref in refs if ref) if refs and all(refs) else None
