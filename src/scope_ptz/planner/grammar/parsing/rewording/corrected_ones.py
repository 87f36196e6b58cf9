"""Name the thing that "one" stands for in a correction: "follow the red car, no, the blue one" becomes "..., no, the blue car"."""

from __future__ import annotations

import re
from collections.abc import Sequence

from scope_ptz.english import is_plural, singular
from scope_ptz.english.grammar.lexicon import nouns_in
from scope_ptz.planner.grammar.lexing.lexer import Lexeme, lexemes_of
from scope_ptz.planner.grammar.parsing.parts.noun_phrases import is_noun_phrase
from scope_ptz.planner.grammar.parsing.parts.patterns import match_start
from scope_ptz.planner.grammar.parsing.rewording.repairs import EDITING, first_end, last_clause

_LOOKS = ("ZOOM", "COUNT", "TRACK", "FIND", "SHOW", "AIM")
_REFERRING = frozenset({"other", "others", "next", "previous", "same", "wrong"})
"""Words with which "one" refers to a thing of an earlier turn or to the thing before it in an order."""


def with_noun_for_corrected_one(text: str, presets: tuple[str, ...]) -> str:
    """Return a text in which "one" in a correction of a thing is replaced by the noun of that thing; other texts are unchanged."""
    if re.search(r"\bones?\b", text, re.IGNORECASE) is None:
        return text
    lexemes = lexemes_of(text, presets)
    for i in range(1, len(lexemes)):
        editing = match_start(EDITING, lexemes[i:])
        if editing is not None and (named := _named(text, lexemes[:i], lexemes[i + editing.size :])) is not None:
            return named
    return text


def _named(text: str, before: Sequence[Lexeme], after: Sequence[Lexeme]) -> str | None:
    """Return the text with the noun of the thing before a correction in place of "one" after it; None if there is no such thing."""
    old, new = before[last_clause(before) :], after[: first_end(after)]
    thing = old[next((i for i, x in enumerate(old) if i and x.has("DET")), len(old)) + 1 :]
    ones = [x for x in new if x.word in {"one", "ones"}]
    if len(ones) != 1 or not thing or not any(x.has(*_LOOKS) for x in old) or any(x.word in _REFERRING for x in new):
        return None
    if not new[0].has("DET") or not is_noun_phrase(new) or any(x.has("PRESET") for x in thing):
        return None
    kind, one = _kind(thing), ones[0]
    if not kind or (one.word == "ones" and not is_plural(kind)):
        return None
    return f"{text[: one.start]}{kind if one.word == 'ones' else singular(kind)}{text[one.end :]}"


def _kind(thing: Sequence[Lexeme]) -> str:
    """Return the noun of a thing: "phone box" for "red phone box on the corner"; empty if it begins with no noun phrase."""
    end = next((i for i, x in enumerate(thing) if x.has("PREP") or x.word in {"with", "wearing", "that", "which"}), len(thing))
    words = tuple(x.word for x in thing[:end])
    spans = [start for start, stop in nouns_in(words) if stop == len(words)]
    return " ".join(words[min(spans, default=len(words) - 1) :]) if words else ""
