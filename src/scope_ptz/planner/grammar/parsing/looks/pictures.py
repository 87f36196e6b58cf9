"""Read clauses that take pictures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from scope_ptz.planner.grammar.instruction_tree import (
    AtPlaces,
    Snap,
    Step,
    Unclear,
)
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.clause import SKIP, Source, trimmed
from scope_ptz.planner.grammar.parsing.parts.noun_phrases import thing_of
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start
from scope_ptz.planner.grammar.parsing.parts.preset_refs import place_of, places_of

if TYPE_CHECKING:
    pass


_USES = (
    "reference|record|baseline|control|test|sample|proof|evidence|comparison|inspection|overview|progress|handover|documentation|"
    "backup|spare|dated|official|extra|plain|simple|decent|proper"
)
"""Words before "picture" that say what it is for, or how good it is, and not what it shows."""

_PICTURE_WORDS = (
    r"(DET|NUM|AMOUNTISH|quick|nice|good|single|couple of|SEVERAL|few|more|new|clear|fresh|final|last|high|"
    rf"FREE PICTURE|{_USES}|MORE|current|a|ANOTHER|CLOSER|WIDE|wide|second|ORDINAL|pair of|full|LITTLE|separate)*"
)


_MAX_PICTURES = 50


def picture_step(source: Source, lexemes: Sequence[Lexeme]) -> Step | None:
    """Read "take three photos of the van", "photograph it" or "snap"."""
    if named := full_match(rf"{SKIP} (photo|snapshot|screenshot) (?P<rest>(it|him|her|them|PRON|that) {SKIP})", lexemes):
        return _pictured(source, named["rest"], 1, ())
    lead = rf"{SKIP} (TAKE|TAKE-ING|SNAP|SNAP-ING|with|CARRY|FILLER|me|us|SELF|it)*"
    if match := full_match(rf"{lead} (?P<words>{_PICTURE_WORDS}) (PICTURE|SNAP) (?P<rest>_*)", lexemes):
        is_verbless = not any(
            x.has("TAKE", "TAKE-ING", "SNAP", "SNAP-ING", "CARRY") or x.word == "with"
            for x in lexemes[: len(lexemes) - len(match["rest"])]
        )
        if (
            is_verbless and match["rest"] and match["rest"][0].word != "each" and match["rest"][0].has("DET", "FREE", "PRON")
        ) or any(x.word == "frame" for x in lexemes[:1]):
            return None
        times = next((x.value for x in match["words"] if x.has("NUM")), 1.0)
        times = 2.0 if any(x.word.startswith(("couple", "a_couple", "pair")) for x in match["words"]) else times
        return _pictured(source, match["rest"], max(1, min(round(times), _MAX_PICTURES)), match["words"])
    if match := full_match(rf"{SKIP} (SNAP|SNAP-ING|photograph|TAKE (DET)? SNAP) (?P<rest>_*)", lexemes):
        return _pictured(source, match["rest"], 1, ())
    if full_match(
        rf"{SKIP} (TAKE|TAKE-ING|and|SNAP) (DET)? (ANOTHER|NUM|one|ORDINAL) (one|PICTURE|ANOTHER)? {SKIP}", lexemes
    ) and any(
        x.word in {"take", "snap", "taking", "shoot", "grab", "capture", "photograph", "record", "save", "store", "get"}
        for x in lexemes
    ):
        return Snap()
    if full_match(
        (
            rf"{SKIP} (capture|save|record|store|screenshot|image) (DET|this|current|what|SELF|is|on|are|now|VIEWNOUN|"
            rf"PICTURE|SHOW|AIM-ING|looking|at|BE|FILLER|NOW|screen|see|can|SEE)+"
        ),
        lexemes,
    ):
        return Snap()
    return None


def _pictured(source: Source, rest: Sequence[Lexeme], times: int, words: Sequence[Lexeme]) -> Step | None:
    """Return the pictures for the words after "take a picture"."""
    if (single := full_match("(COMMA)? (just|only)? (the)? one (only|PICTURE|shot)? ((COMMA)+ (?P<rest>_+))?", rest)) is not None:
        rest = single["rest"]  # "snapshot, one only, current framing"
    rest = _without_purpose(trimmed(rest, "FILLER", "COMMA", "AGAINWORD", "NOW", "INTURN", "DASH"))
    if (match := full_match("(?P<rest>_+?) as (it|they) (BE|looks) _*", rest)) is not None:
        rest = match["rest"]
    if full_match(
        (
            r"(of|from|at|with|on|OFNOUN|DET|current|present|whole|this|what|SELF|VIEWNOUN|AIM-ING|looking|at|BE|here|"
            r"is|NOW|PICTURE|FULL|everything|CAMERA|"
            r"(this|current|present|its|your) (position|location|setting|settings|pose)|it|there|that|can|SEE|SHOW|now|shown|"
            r"VISIBLE|as|way|proof|"
            r"evidence|MORE|AGAINWORD|again|ANOTHER|shown|present|for|us|me|records|file|report|too)*"
        ),
        rest,
    ):
        return Snap(times)
    if match_start("of (whatever|what) (BE|'s|SELF|CAMERA)", rest):
        return Snap(times)  # "take a picture of whatever is there now"
    if not rest or rest[0].word in {"for", "as"} or match_start("of (this|these) FREE", rest):
        return Snap(times)
    if match := full_match(
        r"(of|at|from|in|on) (?P<one>_+?) (and|AND) (ANOTHER|another|one) (PICTURE)? (of|at|from|in|on) (?P<other>_+)", rest
    ):
        refs = (place_of(source, match["one"]), place_of(source, match["other"]))
        return AtPlaces((refs[0], refs[1]), (Snap(times),)) if refs[0] and refs[1] else None
    if match := full_match(r"(each)? (of|from|at|in)? (?P<places>_+)", rest):
        places = places_of(source, match["places"])
        if places is not None:
            return AtPlaces(places, (Snap(times),))
    match = full_match(r"(of|showing|with|at)? (?P<thing>_+)", rest)
    if match and any(x.word in {"each", "every"} for x in match["thing"]):
        return None
    if match and (rest[0].word in {"of", "showing"} or not words) and (thing := thing_of(source, match["thing"])) is not None:
        if times > 1 and not match_start("of", rest):
            return Unclear("What should I take pictures of, and how many?")
        return Snap(times, thing) if thing.text else Snap(times)
    return None


def _without_purpose(lexemes: Sequence[Lexeme]) -> tuple[Lexeme, ...]:
    """Return the words after "a picture" without its purpose, recipient or time: "for the report", "before we open"."""
    for i, x in enumerate(lexemes):
        is_time = match_start("BEFORE (we|SELF) (FREE|ADVERB) (FILLER)* \\Z", lexemes[i:]) is not None
        if i and (x.word == "for" or is_time):
            return tuple(lexemes[:i])
    return tuple(lexemes)
