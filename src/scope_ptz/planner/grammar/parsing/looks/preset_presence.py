"""Read questions about which presets show something: "does any preset show a van?", "find the first preset with a dog"."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.planner.grammar.instruction_tree import FirstWith, PresetRef, Step, Thing, WhichPreset
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.clause import Source, trimmed
from scope_ptz.planner.grammar.parsing.parts.noun_phrases import people_description, thing_of
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match
from scope_ptz.planner.grammar.parsing.parts.preset_refs import places_of

_SKIP = "(FILLER|FIRSTLY|LEADFILLER|TELL|me|us|SELF|if|whether|IF|COMMA|check|see)*"
_THERE = "(in (PRON|it|them|VIEWNOUN)|on (PRON|it|them)|VISIBLE|NOW|FILLER)*"
"""Words after a thing that only repeat that it is at the preset: "which presets have people in them"."""

_ANY_PRESET = (
    r"(ANY|any|either|one|any_of_the|either_of_the|any_of|any_of_these) (of)? (DET|SELF|NUM|PRON|saved|"
    r"stored|other|different|available|EVERY)* (PRESETNOUN|presets|one)"
)
_SEE = r"(BE there|there BE|(can|could|do|DOV|MODAL) SELF (SEE|SHOW|have|FIND)|SELF (can)? (SEE|have))"
_SHOW = r"(have|has|HAVEV|SHOW|SHOW-S|show|shows|contain|contains|SEE|SEE-S|cover|covers|include|includes)"
_WITH = (
    r"(with|(that|which|to) (HAVEV|SHOW-S|SHOW|SEE-S|have|has|show|contain|contains)|SHOW-ING|showing|containing|with_a|"
    r"(where|from which|in which|at which) (SELF (can)? (SEE|FIND|have)|there BE|it SEE-S))"
)
_WHICH = r"(in|at|from|on|of)? (WHQ|which|what|where) (one|of these|of those|of the|of)? (PRESETNOUN|presets|views)? (of them)?"
_LISTED = r"((COMMA|COLON|DASH|OPEN)+ (?P<places>_+?) (CLOSE)?)?"

_STORED = frozenset({"available", "saved", "stored", "set", "defined", "configured", "programmed", "there", "loaded", "left"})
_HOW_WELL = frozenset({"best", "better", "clearly", "well", "closest"})
"""Words of questions about how well a preset shows something, which counts cannot answer."""

_YES_NO = (
    rf"{_SKIP} (DOV|do|does|MODAL) {_ANY_PRESET} {_SHOW} (?P<thing>_+?) {_THERE}",
    rf"{_SKIP} (BE there|there BE|HAVEV SELF got|DOV SELF have) {_ANY_PRESET} {_WITH} (?P<thing>_+?) {_THERE}",
    rf"{_SKIP} {_SEE} (?P<thing>_+?) (VISIBLE)? (at|in|on|from) {_ANY_PRESET} (FILLER|NOW)*",
    rf"{_SKIP} {_SEE} (?P<thing>_+?) (VISIBLE)? (at|in|on|from) (either|both)? (?P<places>_+? OR (at|in|on)? _+?) (FILLER|NOW)*",
    rf"{_SKIP} (DOV|do|does) (either|one)? (of|DET)* (?P<places>_+? OR _+?) {_SHOW} (?P<thing>_+?) {_THERE}",
)
_WHICH_ONES = (
    rf"{_SKIP} {_WHICH} (BE there|where BE|{_SHOW}|there BE) (?P<thing>_+?) {_THERE} {_LISTED}",
    rf"{_SKIP} {_WHICH} (can|do|could|DOV|MODAL) SELF (SEE|SHOW|have) (?P<thing>_+?) (from|at|in)? {_LISTED}",
    rf"{_SKIP} (WHQ|which) (one)? of (?P<places>_+?) {_SHOW} (?P<thing>_+?) {_THERE}",
    rf"{_SKIP} (DESCRIBE|LISTING|list|name|SHOW) (me|us)* (EVERY|all|DET|of)* PRESETNOUN {_WITH} (?P<thing>_+?) {_THERE}",
)
_FIRST = (
    (
        rf"{_SKIP} (FIND|SWITCH|CARRY|SHOW|STAY|HALT|to|me|at|WHQ BE)* (the)? (very)? (?P<end>first|last) (PRESETNOUN|"
        rf"one of DET PRESETNOUN) "
        rf"{_WITH} (?P<thing>_+?) {_THERE}"
    ),
    rf"{_SKIP} (WHQ|which) PRESETNOUN BE (the)? (?P<end>first|last) (one|PRESETNOUN)? {_WITH} (?P<thing>_+?) {_THERE}",
)
_STOP = (
    r"(STAY|stop|stopping|HALT-ING|pause|STOP|CARRY|remain|halt|TAKE|end) (at|on|up)? (the)? (?P<end>first|last) "
    rf"(one|PRESETNOUN|place)? ({_WITH} (?P<thing>_+?)|where (?P<thing>_+?) BE VISIBLE) {_THERE}"
)
_ROUND = (
    rf"{_SKIP} (SWITCH|CARRY|step|try|check|through|to|at|AIM|SCAN|visit|TRY|SHOW)* (?P<places>_+?) (INTURN|COMMA|AND|and|FILLER|"
    rf"until)* {_STOP}"
)


def preset_presence_step(source: Source, lexemes: Sequence[Lexeme]) -> Step | None:
    """Return the step of a clause that asks which presets show something; None for other clauses."""
    for patterns, is_yes_no in ((_YES_NO, True), (_WHICH_ONES, False)):
        for pattern in patterns:
            if (match := full_match(pattern, lexemes)) is None:
                continue
            thing, places = _thing(source, match["thing"]), _places(source, match["places"])
            is_placed = bool(places) or any(x.has("PRESETNOUN") for x in lexemes[:8] if x not in match["thing"])
            if thing is not None and places is not None and (is_placed or (is_yes_no and not match.has("places"))):
                return WhichPreset(thing, "more", places, any_of=True, yes_no=is_yes_no)
    for pattern in (*_FIRST, _ROUND):
        if (match := full_match(pattern, lexemes)) is None:
            continue
        thing, places = _thing(source, match["thing"]), _places(source, match["places"])
        if thing is not None and places is not None:
            return FirstWith(thing, places, last=match["end"][0].word == "last")
    return None


def _places(source: Source, lexemes: Sequence[Lexeme]) -> tuple[PresetRef, ...] | None:
    """Return the presets of a list; empty for no words, which stand for all presets; None for other words."""
    return places_of(source, lexemes) if lexemes else ()


def _thing(source: Source, lexemes: Sequence[Lexeme]) -> Thing | None:
    """Return the thing that lexemes describe; None for pronouns, quantities and words that are not a noun phrase."""
    lexemes = trimmed(lexemes, "VISIBLE", "FILLER", "COMMA")
    if not lexemes or lexemes[0].has("SUPERLATIVE", "NONE", "MORETHAN", "ATLEAST", "FEWERTHAN", "ATMOST", "EXACTLY", "ORDINAL"):
        return None
    if any(x.has("SUPERLATIVE") for x in lexemes[:3]) or any(
        x.has("PRESETNOUN", "VIEWNOUN") or x.word in _HOW_WELL for x in lexemes
    ):
        return None
    if lexemes[0].has("SOMEONE"):
        return people_description(source, lexemes[1:])
    if lexemes[0].word in _STORED or lexemes[0].has("PREP"):
        return None  # "which views do we have saved?"
    thing = thing_of(source, lexemes)
    return thing if thing is not None and thing.text else None
