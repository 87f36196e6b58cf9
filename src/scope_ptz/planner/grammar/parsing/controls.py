"""Read clauses that control others: what not to do, what to do again, and how to report the result."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.planner.grammar.instruction_tree import DoAgain, EachTime, Forbid, Report, SameAt, Snap, Step, Unclear
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.clause import VERBS, NotUnderstoodError, Source
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start, search
from scope_ptz.planner.grammar.parsing.parts.preset_refs import places_of

_NEGATION = "(NEGATED|(SELF)? (do|MODAL|need) not|DOV not)"

_FOLLOWING_ANYONE = (
    "(TRACK|TRACK-ING) (SOMEONE|anything|ANY FREE|DET FREE{1,3}) (REL (BE|FREE|PREP|PRON|DET|GLUE|CARRY|CARRY-S)+)? (FILLER)*"
)

_SUMS = frozenset({"add", "sum", "total", "together", "sum_up", "add_up", "total_up", "tot_up"})
_DIFFERENCES = frozenset({"difference", "the_difference"})
"""Words of clauses that ask to add or subtract the earlier counts: "... and add them up"."""


def control_step(source: Source, lexemes: Sequence[Lexeme]) -> tuple[Step, ...] | None:
    """Read clauses that say what not to do, what to do again, or how to report the result."""
    if full_match(
        "(NEGATED|(SELF)? (do|MODAL|need) not|DOV not) (bother|worry|do anything|anything) (FILLER)*|do_not_bother "
        "(FILLER|with it)*|(FILLER)* (do nothing|(CARRY|TAKE|DOACT)? no action (FREE|FILLER)*|nothing)|"
        "(TAKE|SNAP|DOACT) no MORE? PICTURE (FILLER|(at|of|on|for) _+)*",
        lexemes,
    ):
        return (Forbid(),)  # "otherwise do nothing", "take no photos"
    if full_match("(FILLER)* (never mind|(cancel|forget|scrap|scratch|drop|leave) (that|it)) (FILLER)*", lexemes):
        return (Forbid(),)
    if match_start(_NEGATION, lexemes) and not match_start("NEGATED (more)? (FREE|PRESETNOUN) BE", lexemes):
        return _forbid_step(lexemes)
    if full_match("(FILLER)* (STAY|STAY-ING) (FILLER|there|here|where|SELF|BE|CAMERA|still|DET|VIEWNOUN|this|put|as)*", lexemes):
        return (Forbid(any_move=True),)
    if match := full_match(
        (
            "(REPEAT|AGAINWORD|TURN)? (REPEAT|AGAINWORD) (FILLER|AGAINWORD|INTURN|COMMA|THEN)* ((?P<number>NUM) (X|"
            "MORE X|MORE) (INTURN|MORE|FILLER)*|(?P<twice>twice)|(?P<thrice>thrice)|X (?P<x>NUM))? (INTURN|MORE|"
            "FILLER|AGAINWORD)*"
        ),
        lexemes,
    ):
        number = match["number"] or match["x"]
        times = round(number[0].value) if number else 2 if match.has("twice") else 3 if match.has("thrice") else None
        more = any(x.has("MORE") and x.word in {"more", "another"} for x in lexemes)
        return (DoAgain(times, more=more),)
    if full_match("(FILLER)* NUM (x|PERCENT) (FILLER)*", lexemes):
        return (Unclear("Shall I zoom, or do that several times?"),)
    if match := full_match(
        (
            "(FILLER|AGAINWORD)* ((?P<number>NUM) X|(?P<twice>twice)|(?P<thrice>thrice)|X (?P<x>NUM)) (INTURN|FILLER|"
            "MORE|over|AGAINWORD)*"
        ),
        lexemes,
    ):
        number = match["number"] or match["x"]
        return (
            DoAgain(
                round(number[0].value) if number else 2 if match.has("twice") else 3,
                more=any(x.word == "more" for x in lexemes),
            ),
        )
    if match := full_match("(REPEAT|REPEAT SELF) (FILLER)* (at|for|in|on|from) (?P<places>_+)", lexemes):
        places = places_of(source, match["places"])
        return (SameAt(places),) if places is not None else None
    if full_match(
        (
            r"(FILLER)* (LEAVE|keep) (DET|SELF|CAMERA)* (pan|tilt|zoom|CAMERA|ZOOMNOUN|height|angle|focus|PANNOUN|"
            r"TILTNOUN) (level|setting)? (alone|as it is|where it is|the same|SAMEAMOUNT|unchanged|as is|fixed|put) "
            r"(FILLER)*"
        ),
        lexemes,
    ) and any(x.has("PAN", "TILT", "ZOOM", "ZOOMNOUN", "TILTNOUN", "PANNOUN") or x.word in {"lens", "focus"} for x in lexemes):
        return (Forbid(),)
    numbers = "(numbers|totals|counts|figures|results|number|figure|total|tally|COUNTNOUN)"
    is_told = full_match(f"(FILLER)* (CARRY|TELL|SHOW) (me|us)* (both|DET|SELF|all)+ {numbers} (FILLER)*", lexemes)
    if is_told or full_match(f"(FILLER|WRAPPER|SELF|want|need)* (both|all) (the)? {numbers} (FILLER)*", lexemes):
        return (Report(),)  # "... and give me both numbers"
    if full_match("(DET|EXACTLY|FILLER)* (NUMBERWORD|number|numbers|count|total|figure) (only|alone) (FILLER)*", lexemes):
        return (Report(),)  # "how many vans? Number only."
    if full_match("(FILLER)* (check|TELL|AIM|look at|SHOW) (at)? both (of (them|PRON)|PRESETNOUN|presets)? (FILLER)*", lexemes):
        return (Report(),)  # "are there more cars at the gate or in the yard? Check both."
    if full_match("(look|TELL|AIM|have_a_look|take_a_look) (FILLER|there|here|now|please)*", lexemes) and any(
        x.word in {"look", "have_a_look", "take_a_look", "see", "check"} for x in lexemes
    ):
        return (Report(),)
    if full_match(
        (
            "(TELL|READ) (me|us)* (whether|if|IF|that|so) (SELF|it|there)* (can|BE|HAVEV)* (FIND-ED|SEE-ED|found|"
            "find|SEE|FIND|so)? (one|it|any|them|so)*"
        ),
        lexemes,
    ) and any(x.word in {"whether", "if", "so"} for x in lexemes):
        return (Report(),)
    if full_match("(which|that|those|they|these) (BE) (not)? (DET)? (different|same|other|distinct) _*", lexemes):
        return (Report(),)
    if full_match(
        (
            "(add|sum|total|COUNT) (DET|PRON|NUM|both|EVERY|up|together|of|FREE)* (up|together|total|UP)|(TELL|CARRY|"
            "TAKE|SHOW|what is) (me|us)* (the|DET)? (sum|total|difference|result|count|answer)|COUNT (DET)? difference"
        ),
        lexemes,
    ) and not any(x.has("FREE") and x.word not in {"sum", "difference", "result", "together", "total"} for x in lexemes):
        words = {x.word for x in lexemes}
        return (Report("difference" if words & _DIFFERENCES else "total" if words & _SUMS else "none"),)
    if full_match(
        "(SNAP|TAKE|SNAP-ING|TAKE-ING) (DET)? (PICTURE)? (of)? (both|EVERY|all|each) (of them|one|PRON|of)*", lexemes
    ) and any(x.has("SNAP", "PICTURE", "SNAP-ING") for x in lexemes):
        return (EachTime((Snap(),)),)
    if full_match("(HALT|HALT-ING|hold|wait|pause) (there|here|FILLER|moving|CAMERA|it)*", lexemes):
        return (Forbid(any_move=True),)
    if full_match(
        (
            "(TELL|report|SAY|let me know|REPORT) (me|us|SELF|back|FILLER|DET|result|results|so|that|it|answer|"
            "number|what SELF FIND|what SELF SEE|to|findings|count|how SELF get on|about|PRON|TELL|DET COUNTNOUN|how "
            "it went|total|both (numbers|totals|counts|figures|results)?)*"
        ),
        lexemes,
    ) and not search("what SELF SEE|another \\Z", lexemes):
        return (Report(),)
    return None


def _forbid_step(lexemes: Sequence[Lexeme]) -> tuple[Step, ...] | None:
    """Read "don't zoom", "without moving the camera" and "no zooming"."""
    match = match_start(f"{_NEGATION} (FILLER|need to|have to|ever|bother)*", lexemes)
    rest = lexemes[match.size :] if match else lexemes
    if not rest:
        return None
    if search("(past|beyond|over|above|under|below|MORE|MORETHAN|FEWERTHAN|further) (than)? NUM", rest):
        raise NotUnderstoodError(lexemes)  # "zoom in, but don't go past 3x"
    no_picture = (
        "(FILLER|DET|any|MORE|need for)* PICTURE "
        "(FILLER|BE|needed|required|wanted|necessary|allowed|though|either|(at|of|on|for) _+)*"
    )
    if full_match(no_picture, rest):
        return (Forbid(),)  # "go to the gate, no photos"
    if full_match(_FOLLOWING_ANYONE, rest):
        return (Forbid(),)  # "zoom in on the van and don't follow anyone who walks past it"
    forms = "|".join(f"{verb}|{verb}-ING" for verb in VERBS)
    if not match_start(f"(FILLER|DET|any)* ({forms}|ZOOMNOUN|LEFT|RIGHT|UP|DOWN|NUM|movement|LITTLE|LOT)", rest):
        return None
    parts = [x for x in rest if not x.has("FILLER", "CAMERA", "DET", "PRON", "SELF", "COMMA", "AROUND")]
    is_any = all(
        x.word in {"move", "moving", "movement", "turn", "turning", "anything", "at_all", "all", "at"} or x.has("OR", "CAMERA")
        for x in parts
    )
    allowed = all(
        x.has(
            "FREE",
            "DET",
            "FILLER",
            "CAMERA",
            "PREP",
            "PRON",
            "SELF",
            "COMMA",
            "OR",
            "AND",
            *VERBS,
            "ZOOMNOUN",
            "NUM",
            "DEG",
            "LEFT",
            "RIGHT",
            "UP",
            "DOWN",
            "IN",
            "OUT",
            "LITTLE",
            "LOT",
            "LIMIT",
            "X",
            "MORE",
            "AMOUNTISH",
            "PRESET",
            "HOME",
            "PICTURE",
            "VIEWNOUN",
            "NOW",
            "ANY",
            *(f"{v}-ING" for v in VERBS),
            "GLUE",
            "PERCENT",
            "HOWEVER",
        )
        for x in rest
    )
    return (Forbid(any_move=is_any),) if allowed else None
