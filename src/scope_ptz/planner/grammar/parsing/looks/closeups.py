"""Read clauses that zoom in on a thing, follow it, or read what is on it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from scope_ptz.english import listing
from scope_ptz.planner.grammar.execution.answer_sentences import noun
from scope_ptz.planner.grammar.instruction_tree import (
    Ask,
    Read,
    Step,
    Thing,
    Track,
    Unclear,
    ZoomTo,
)
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.lexing.preset_names import preset_key
from scope_ptz.planner.grammar.parsing.parts.clause import ME, SKIP, Source, text_of, trimmed
from scope_ptz.planner.grammar.parsing.parts.noun_phrases import thing_of, things_of
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, search
from scope_ptz.planner.grammar.parsing.parts.scopes import SECONDS, duration_of

if TYPE_CHECKING:
    from scope_ptz.tools.arguments import View


MAX_SECONDS = 600
FILLS_THE_VIEW = "A thing I zoom in on fills the view. Shall I do that, or zoom where I look now?"
"""The question about a magnification for a zoom on a thing."""

_MAGNIFIED = (
    rf"{SKIP} ZOOM (IN|CLOSER|AMOUNTISH)* ((by)? NUM (X|PERCENT) (on|onto|upon) (?P<thing>_+)|"
    rf"(on|onto|upon) (?P<thing>_+?) (COMMA|by)* NUM (X|PERCENT)) {SKIP}"
)
"""A zoom on a thing by a factor: "zoom in on it 3x"."""


def read_step(source: Source, lexemes: Sequence[Lexeme], view: View | None) -> Step | tuple[Step, ...] | None:
    """Read "read the sign", "read what it says" and "read it"."""
    match = full_match(
        (
            rf"{SKIP} (READ|READ-ING|DESCRIBE READ|TELL READ|try READ|see if SELF can READ) {ME} (out|off|aloud|to "
            rf"me|back)? (?P<thing>_+?) (out_loud|out|loud|aloud|to me|to us|for me|off|again|back|INTURN|separately)* {SKIP}"
        ),
        lexemes,
    )
    if not match:
        match = full_match(
            rf"{SKIP} (TELL|TAKE|CARRY|SHOW|give|WHQ BE)? {ME} (the) (reading|READ-ING) (of|on|from|at) (?P<thing>_+)", lexemes
        )
    if not match:
        return None
    if (inner := full_match(r"(what (BE)? (written|DET|it|on|says|say|there|PRON|text|printed) _*)", match["thing"])) is not None:
        return Ask(text_of(source, match["thing"]), view, embedded=True) if inner else None
    words = match["thing"]
    if full_match(
        "(EVERY|DET|all|FULL|WHOLETHING|everything|anything|what|of)* (that|which)? (SELF (can|do)? SEE|VISIBLE|BE VISIBLE)*", words
    ):
        return Ask("What text can you see?", view)  # "read everything you can see"
    if seen := full_match(
        "(?!(its|his|her|their))(EVERY|all|each|ANY|DET)+ (of)? (DET)? (?P<thing>_+?) ((that|which)? SELF (can|do)? (SEE|"
        "FIND)|INTURN|separately|VISIBLE)*",
        words,
    ):
        words = seen["thing"]  # "every sign you can see"
    things = things_of(source, words) or things_of(source, match["thing"])  # "nearest sign" is a noun phrase only with its article
    if things is None:
        return None
    if match["thing"][0].has("EVERY", "all", "each") and len(things) == 1 and things[0].text:
        things = (replace(things[0], text=noun(things[0].text, 2)),)  # "every sign" are all signs
    return Read(things[0], view) if len(things) == 1 else tuple(Read(thing, view) for thing in things)


_CANNOT_WAIT = Unclear("I cannot wait. Shall I follow it now?")


def track_step(source: Source, lexemes: Sequence[Lexeme]) -> Step | None:
    """Read "follow the van for 20 seconds"."""
    head = rf"{SKIP} (KEEP|CARRY)? (TRACK|TRACK-ING) {ME}"
    match = full_match(
        (
            rf"{SKIP} (for {SECONDS})? (COMMA)? {head} (?P<thing>_+?) (with DET? CAMERA)? (COMMA)? ((for|during|over|"
            rf"FILLER|about)* {SECONDS} (long)?)? ((COMMA|for|with|DET)* (default|usual|standard|normal) (duration|"
            rf"time|length|period))? "
            rf"(as (PRON|it|they|he|she) _+)? {SKIP}"
        ),
        lexemes,
    )
    if not match:
        match = full_match(
            (
                rf"{SKIP} (keep|hold|KEEP) (?P<thing>_+?) (CENTREWORD|VISIBLE|in (DET)? (centre|center|middle|CENTREWORD|"
                rf"frame|VIEWNOUN|PICTURE)( of DET (PICTURE|VIEWNOUN))?|framed) ((for|AMOUNTISH)* {SECONDS})? {SKIP}"
            ),
            lexemes,
        )
    if not match:
        match = full_match(
            rf"{SKIP} (keep|hold|KEEP|STAY|leave|LEAVE) (DET)? (CAMERA|VIEWNOUN|focus|eyes|lens|it) (trained|fixed|"
            rf"pointed|focused|locked)? "
            rf"(on|onto) (?P<thing>_+?) (as PRON _+)? ((for|AMOUNTISH)* {SECONDS})? {SKIP}",
            lexemes,
        )
    if not match:
        match = full_match(
            rf"{SKIP} (do not|NEGATED|never|DOV not) (lose|let go of|lose sight of|lose track of|(take|TAKE) (your)? "
            rf"eyes off) (?P<thing>_+)",
            lexemes,
        )
    if not match or not (thing := thing_of(source, match["thing"])):
        return None
    if match["thing"][-1].word in {"in", "within", "after"}:
        return _CANNOT_WAIT  # "follow the van in five minutes"
    seconds = 10.0
    if match.has("unit"):
        seconds = duration_of(match)
    if not 0 < seconds <= MAX_SECONDS:
        return Unclear("I can follow something for at most 600 seconds. How long should I follow it?")
    return Track(thing, seconds)


def close_up_step(source: Source, lexemes: Sequence[Lexeme]) -> Step | None:
    """Read "zoom in on the sign", "find the van", "look at the door" and "get me a close-up of it"."""
    patterns = (
        (
            r"(KEEP)? (ZOOM|ENLARGE|ZOOM-ING|ENLARGE-ING|CLOSER|(CARRY|AIM|TURN) (?=_*? (IN|CLOSER|close|tight))) (AMOUNTISH|"
            r"LITTLE|FILLER|right|DET (?=CAMERA|VIEWNOUN)|CAMERA|VIEWNOUN|it|SELF|straight|LOT|LIMIT|over|IN|CLOSER|"
            r"back|close|tight|TIGHT)* (on|onto|to|at|towards|over to|upon|CLOSER to) (?P<thing>_+)"
        ),
        (
            r"(FIND|FIND-ING) ((DET)? (CAMERA|VIEWNOUN|PICTURE) (?=on)|me|us|SELF|FILLER|on|IN|in|up)* (on|onto|for|"
            r"in on)? (?P<thing>_+)"
        ),
        (
            r"(show|display|see|let_me_see|let_us_see|showing|watch|view) (me|us|SELF)? (?P<thing>_+?) (up|close|"
            r"(LITTLE|LOT)? CLOSER|from_close|closer|close up|on|screen|in close|in more detail|better|properly|more clearly)*"
        ),
        r"(SHOW|FIND|show|let_me_see|let_us_see) (me|us)* where ((?P<thing>_+?) BE|BE (?P<thing>_+))",
        (
            r"(AIM|AIM-ING|(PAN|TILT|turn) (?=_*? (to|towards|toward|to face))|(TURN (?!_*? at)|SCAN|RAISE) (?=_* (LEFT|RIGHT|UP|"
            r"DOWN))|SHOW at) (DET (?=CAMERA|VIEWNOUN|PICTURE)|CAMERA|FILLER|it|SELF|over|across|AROUND|LEFT|RIGHT|UP|"
            r"DOWN|AMOUNTISH|LITTLE|back|straight|to face|view|VIEWNOUN|directly|again|now|PICTURE)* (at|on|onto|to "
            r"face|to|towards|toward|over to|over at|upon) (?P<thing>_+)"
        ),
        (
            r"(TAKE|SHOW|CARRY|FIND|DET|AIM)? (me|us|SELF)* (DET|good|nice|proper|quick|much|tight|clear|detailed)* (close_up|"
            r"CLOSER|(close|tight) PICTURE|close look|closer look|better look|good look|better view|look|tight "
            r"PICTURE|tighter PICTURE|"
            r"PICTURE|WIDER|closer view|view) (PICTURE|VIEWNOUN|look)? (of|at|on) (?P<thing>_+)"
        ),
        r"((CARRY|TAKE|SHOW|put) (me|us|SELF|FILLER)* (DET)?)? (eyes|eye) on (?P<thing>_+)",
        r"close_up (?P<thing>(FREE|DET) _*)",
        r"(CLOSER|tighter|in) (on|to) (?P<thing>_+)",
        r"(?P<thing>DET _+?) ((up|in) close|close up|CLOSER)",
        r"(ZOOM|ENLARGE|CARRY|TIGHTEN) (IN|CLOSER)* (GLUE|so_that|until|so|FILLER)* (?P<thing>(DET|it) _*?) (fills|takes up) _+",
        r"(let|make|have|CARRY|TAKE)? (?P<thing>DET _*? FREE) (filling|(to)? fill) (DET|whole|entire)* "
        r"(PICTURE|VIEWNOUN|frame|screen)",
        r"((TURN|SWING|CARRY) (LEFT|RIGHT|AROUND|CAMERA|it|FILLER)* to)? face (?P<thing>_+)",
        (
            r"(put|get|CARRY|have|keep|bring|TAKE|SHOW|AIM) (?P<thing>_+?) (in|into|to|at|on) (DET)? (centre|center|"
            r"middle|frame|view|shot|VISIBLE|middle|sharp focus|focus|PICTURE)+ (of|FILLER|DET|PICTURE|VIEWNOUN|"
            r"frame)*"
        ),
        r"(put|get|CARRY|have|bring|TAKE) (?P<thing>(DET|it) _*?) CENTREWORD",
        r"(fill) (DET)? (PICTURE|VIEWNOUN|frame) with (?P<thing>_+)",
    )
    if full_match(rf"{SKIP} (fill) (DET)? (PICTURE|VIEWNOUN|frame) {SKIP}", lexemes):
        return ZoomTo(Thing())
    if (magnified := full_match(_MAGNIFIED, lexemes)) is not None and thing_of(source, magnified["thing"]) is not None:
        return Unclear(FILLS_THE_VIEW)
    for pattern in patterns:
        match = full_match(rf"{SKIP} {pattern} {SKIP}", lexemes)
        if not match:
            continue
        words = trimmed(match["thing"], "FILLER")
        if shown := full_match("DET (good|nice|proper|tight|clear)? close_up (VIEWNOUN|PICTURE)? (of|on) (?P<thing>_+)", words):
            words = tuple(shown["thing"])  # "let me see a close-up of the van"
        if search("PRESETNOUN (for|of|CALLED)", words[:3]) or (words and words[-1].word == "preset"):
            return None  # "show me the preset for the laundry room", "look at the higway preset"
        if (
            not words
            or words[0].has("WHQ", "HOWMANY", "IF")
            or any(x.has("SECONDS", "MINUTES") and lexemes[0].has("TRACK") for x in words)
        ):
            continue
        if full_match(f"_+ for {SECONDS}", words):
            continue  # "zoom in on the van for 20 seconds" may ask to follow it
        if full_match(r"(DET)? (left|right|LEFT|RIGHT|UP|DOWN|SIDE)+", words):
            return None
        if full_match(
            "(DET|current|present|whole|same|overall)* (HOME|FULL|VIEWNOUN|HORIZON|LEVEL|WHOLETHING|CAMERA|CAMERA BACK|CENTREWORD)",
            words,
        ) or (words[0].has("NUM") and len(words) > 1 and words[1].has("X", "PERCENT", "DEG")):
            continue
        if (thing := thing_of(source, words)) is not None:
            similar = [preset for preset in source.presets if set(preset_key(thing.text)) < set(preset_key(preset))]
            if thing.text and len(similar) > 1 and lexemes[0].has("SHOW"):
                return Unclear(f"Which one do you mean: {listing(similar, 'or')}?")
            return ZoomTo(thing)
    return None
