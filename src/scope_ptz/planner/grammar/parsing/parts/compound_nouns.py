"""Read command words as nouns where they are part of a compound: "the tilt truck", "the penalty spot", "call buttons"."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.english import is_plural
from scope_ptz.english.grammar.parts_of_speech import parts_of_speech, verb_form
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.clause import DIRECTIONS, VERBS
from scope_ptz.planner.grammar.parsing.parts.patterns import match_start

_MODIFIERS = frozenset({
    "tilt", "zoom", "pan", "degree", "film", "show", "record", "call", "help", "check", "centre", "center", "camera", "search",
    "watch", "track", "tracking", "point", "turn", "head", "focus", "shot", "cover", "stop", "step", "home", "picture", "photo",
    "capture", "swing", "look", "tell", "face", "parking", "moving", "end", "spot", "scan", "frame", "tail",
})  # fmt: skip
"""Command words that can begin a compound noun."""

_INNER = frozenset({"centre", "center", "end", "spot", "camera", "cover", "check", "call", "help", "home", "tilt"})
"""Command words that can stand between two nouns: "the visitor centre sign". Others may be verbs: "does the floor look wet"."""

_CAMERA_NOUNS = frozenset({
    "angle", "angles", "level", "levels", "position", "positions", "speed", "setting", "settings", "value", "values", "axis",
    "axes", "limit", "limits", "factor", "amount", "motor", "motors", "direction", "range", "view", "preset", "presets", "feed",
    "picture", "image", "shot", "one", "ones", "please", "now", "pose", "percent", "magnification", "increments", "steps",
    "degrees", "side", "back", "again", "slightly", "straight", "slowly", "gently", "more",
})  # fmt: skip
"""Words after which a modifier is about the camera itself: "the tilt angle"."""

_HEADS = frozenset({
    "spot", "spots", "camera", "cameras", "pan", "pans", "circle", "cover", "covers", "watch", "post", "posts", "stop", "stops",
    "point", "points", "frame", "frames", "head", "heads", "film", "step", "steps", "board", "stand", "guard", "check", "swing",
    "switch", "switches",
})  # fmt: skip
"""Command words, and words for the camera, that can end a compound noun."""

_SHOWN_HEADS = frozenset({"spot", "spots", "stop", "stops", "stand", "post", "posts"})
"""Those that also end a compound after "show me": the others may end the description of a preset ("the gate camera")."""

_TOPIC = "_ (?P<nouns>_{1,2}) (PREP (DET)? (FREE|PRESET){1,3})? COMMA (BE|DOV|HAVEV) (they|PRON) _"
_TOPIC_MODIFIERS = frozenset({"stop", "call", "check", "parking", "head", "tail", "end", "step"})
"""Command words that can begin the plural thing of a question that follows it: "stop lights on the bridge, are they red?"."""

_SIDES = frozenset({"back", "front", "side", "lower", "upper"})
"""Words for the side of a building that are command words elsewhere."""

_PLACES = frozenset({"pitch", "track", "swing", "stand", "roll"})
"""Command words that are places after a preposition and an article: "the sprinklers on the pitch"."""

_NUMBERED = frozenset({"track", "stand", "pitch", "stop", "head", "switch", "board"})
"""Command words that are places or things when a number follows: "track 4"."""

_BEFORE_NUMBERED = frozenset({"on", "at", "in", "by", "near", "beside", "from", "of", "along"})
"""Prepositions before a numbered place."""

_BREAKS = (
    "COMMA",
    "STOP",
    "QUESTION",
    "PREP",
    "AND",
    "OR",
    "BUT",
    "BE",
    "HAVEV",
    "MODAL",
    "THEN",
    "DASH",
    "REL",
    "VISIBLE",
    "FILLER",
)
"""Kinds of lexemes that end a noun phrase."""

_BEFORE_OBJECT = frozenset({"on", "at", "onto", "find", "locate", "follow", "track", "count", "of", "see", "is", "are", "has"})
"""Words before a noun phrase that names an object in the picture."""


_LAST_WORDS = {
    "can": frozenset(
        {"jerry", "watering", "petrol", "gas", "fuel", "oil", "paint", "spray", "tin", "trash", "garbage", "milk", "beer"}
    ),
    "steer": frozenset({"skid"}),
}
"""Command words and auxiliaries that end a compound with certain nouns: "the jerry can", "the skid steer"."""

_NO_MODIFIERS = frozenset({"other", "same", "own", "next", "last", "only", "whole"})
"""Words before a noun that form no compound with it: "the other camera"."""


def with_compound_nouns(lexemes: Sequence[Lexeme]) -> Sequence[Lexeme]:
    """Return the lexemes, in which command words that are part of a compound noun are nouns."""
    out = list(lexemes)
    if (topic := match_start(_TOPIC, lexemes)) is not None and lexemes[0].word in _TOPIC_MODIFIERS:
        nouns = topic["nouns"]
        if all(x.has("FREE", "EXCEPT") for x in nouns) and _is_noun(nouns[-1]) and is_plural(nouns[-1].word):
            out[: len(nouns) + 1] = [x.reworded(x.word, "FREE") for x in lexemes[: len(nouns) + 1]]
    for i, x in enumerate(lexemes):
        if x.has("FREE", "PRESET") or not i:
            continue
        after = lexemes[i + 1] if i + 1 < len(lexemes) else None
        later = lexemes[i + 2] if i + 2 < len(lexemes) else None
        if x.has("ORDINAL") and _is_counted_ordinal(out[i - 1], after):
            out[i] = x.reworded(x.word, "FREE")
        if x.word in _SIDES and _is_side_of_building(out[i - 1], after, later):
            out[i] = x.reworded(x.word, "FREE")
        if x.word == "no" and _is_prohibition(out[i - 1], after, later):
            out[i] = x.reworded(x.word, "FREE")
        is_last = out[i - 1].word in _LAST_WORDS.get(x.word, ()) and not (after is not None and after.has("SELF"))
        if is_last or _is_modifier(out, i, after) or _is_head(out, i, after) or _is_numbered(out, i, after):
            out[i] = x.reworded(x.word, "FREE")
    return out


def _begins_noun_phrase(lexeme: Lexeme) -> bool:
    return (
        lexeme.has("DET", "HOWMANY", "ANY", "COUNT") and not lexeme.has("NUM") and lexeme.word not in {"it", "all", "that", "them"}
    )


def _is_noun(lexeme: Lexeme) -> bool:
    return lexeme.has("FREE") and "NOUN" in parts_of_speech(lexeme.word) and lexeme.word not in _CAMERA_NOUNS


def _is_modifier(lexemes: Sequence[Lexeme], i: int, after: Lexeme | None) -> bool:
    """Return whether a command word modifies the noun of a compound: "the tilt truck", unlike "the tilt angle"."""
    first = _phrase_start(lexemes, i)
    words = _MODIFIERS if first == i - 1 else _INNER
    return lexemes[i].word in words and after is not None and _is_noun(after) and _begins_noun_phrase(lexemes[first])


def _is_head(lexemes: Sequence[Lexeme], i: int, after: Lexeme | None) -> bool:
    """Return whether a command word ends a compound: "zoom in on the penalty spot", "how many covers are open?"."""
    if after is not None and (not after.has(*_BREAKS) or after.has(*DIRECTIONS)):
        return False
    x, before, first = lexemes[i], lexemes[i - 1], _phrase_start(lexemes, i)
    if not _begins_noun_phrase(lexemes[first]):
        return False
    if first == i - 1:
        is_counted = before.has("HOWMANY") and x.has(*(f"{verb}-S" for verb in VERBS))
        is_subject = x.word == "watch" and after is not None and after.has("BE", "HAVEV")  # "my watch has stopped"
        is_place = x.word in _PLACES and i > 1 and lexemes[i - 2].has("PREP")  # "the sprinklers on the pitch"
        is_lift = x.word in {"lift", "lifts"} and before.word == "the"  # "start the lift"
        return is_counted or is_subject or is_place or is_lift
    if (
        x.word not in _HEADS
        or before.word in _NO_MODIFIERS
        or not ("NOUN" in parts_of_speech(before.word) or before.word.endswith("ing"))
    ):
        return False
    before_phrase = lexemes[first - 1] if first else None
    if before_phrase is None or before_phrase.word in _BEFORE_OBJECT:
        return True
    is_shown = before_phrase.has("SELF") and first > 1 and lexemes[first - 2].has("SHOW")  # "show me the penalty spot"
    return before_phrase.has("FIND", "TRACK", "COMMA", "FILLER", "STOP") or (is_shown and x.word in _SHOWN_HEADS)


def _is_counted_ordinal(before: Lexeme, after: Lexeme | None) -> bool:
    """Return whether an ordinal begins a compound, because what is counted has no order: "how many first aiders"."""
    return before.has("HOWMANY", "COUNTNOUN") and after is not None and after.has("FREE")


def _is_side_of_building(before: Lexeme, after: Lexeme | None, later: Lexeme | None) -> bool:
    """Return whether "back" or the like describes the thing that a question without an article is about: "is back gate shut"."""
    is_asked = before.has("BE") and after is not None and _is_noun(after) and later is not None and not later.has("PREP")
    return (
        is_asked
        and later is not None
        and (later.has("ADVERB") or "ADJ" in parts_of_speech(later.word) or verb_form(later.word) in {"past", "participle"})
    )


def _is_prohibition(before: Lexeme, after: Lexeme | None, later: Lexeme | None) -> bool:
    """Return whether "no" begins the name of a sign: "the no entry sign", "how many no parking cones"."""
    is_named = before.has("HOWMANY") or before.word in {"the", "a", "an", "this", "these", "those", "that", "each", "every"}
    return is_named and after is not None and later is not None and after.has("FREE", "ENTER") and _is_noun(later)


def _is_numbered(lexemes: Sequence[Lexeme], i: int, after: Lexeme | None) -> bool:
    """Return whether a command word with a number names a place: "is track 4 empty?", "the people on stand 2"."""
    before = lexemes[i - 1]
    return (
        lexemes[i].word in _NUMBERED
        and after is not None
        and after.has("NUM")
        and (before.has("BE") or before.word in _BEFORE_NUMBERED)
    )


def _phrase_start(lexemes: Sequence[Lexeme], i: int) -> int:
    """Return the index of the word before the free words that precede a position; 0 if there is none."""
    first = i - 1
    while first > 0 and lexemes[first].has("FREE"):
        first -= 1
    return first
