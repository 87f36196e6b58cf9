"""Replace some wordings with equivalent ones that the other rules already cover."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.clause import DIRECTIONS
from scope_ptz.planner.grammar.parsing.parts.compound_nouns import with_compound_nouns
from scope_ptz.planner.grammar.parsing.parts.noun_phrases import is_noun
from scope_ptz.planner.grammar.parsing.parts.patterns import match_start, search
from scope_ptz.planner.grammar.parsing.parts.scopes import SECONDS
from scope_ptz.planner.grammar.parsing.rewording.preset_lists import with_presets_reworded
from scope_ptz.planner.grammar.parsing.rewording.single_words import reworded_in_context
from scope_ptz.planner.grammar.parsing.rewording.stated_angles import with_angles_in_place
from scope_ptz.planner.grammar.parsing.rewording.word_order import in_order_of_command

_WANTS = ("want_to", "like_to", "love_to", "need_to", "wish_to")
_NOT_SHOWN = ("WHQ", "HOWMANY", "HOWMANYMORE", "IF", "REL", "PRON", "SOMEONE", "FULL", "ANY", "EVERY")
_FUNCTION_WORDS = frozenset({"whether", "if", "how", "what", "where", "who", "that", "it", "more", "less", "in", "a"})

_AIMED = frozenset({"aimed", "pointed", "turned", "looking", "facing", "pointing"})
_VERBS_AND_NOUNS = tuple(
    form for verb in ("AIM", "CARRY", "FIND", "SHOW", "SWITCH", "TRACK", "TURN") for form in (verb, f"{verb}-S")
)
"""Classes of verbs that can also be nouns, such as "train", "head", "frame" and "swing"."""

_PLACES_FIRST = (
    "(FILLER|COMMA)* (?P<at>at|in|from|for) (?P<each>EVERY of?)? (DET|PRESETNOUN)* PRESET PRESETNOUN?"
    " ((COMMA|AND)+ (DET|PRESETNOUN)* PRESET PRESETNOUN?)+ (?P<end>COMMA|COLON)"
    " (?P<go>(CARRY (there|to them|to each) (COMMA|AND)+))?"
)
"""A list of places, followed by what to do at each of them."""

_COUNT_AT_LIST = (
    "(FILLER|WRAPPER|SELF|need|want)* (DET)? (COUNTNOUN|COUNT|HOWMANY) (DET|FREE){1,4} (FILLER|COMMA)* (?P<end>COLON|COMMA|DASH) "
    "(EVERY PRESETNOUN|(DET)? PRESET ((COMMA|AND)+ (DET)? PRESET)+) (FILLER|STOP|QUESTION)* \\Z"
)
"""A count, and the list of places for it: "numbers of people: main lift, ticket office, bus bay"."""

_AT_EACH = frozenset({"at_each", "at_each_one", "at_each_of_them", "at_every_one", "at_each_place", "at_each_stop"})

_WANTED_PICTURE = (
    "(FILLER)* ((DET)? FREE{1,2} (wants|needs|WRAPPER)|WRAPPER|SELF (want|need)) (DET|ANY|NUM|SEVERAL)? PICTURE of _+?"
    " PREP? (DET)? (?P<place>PRESET) PRESETNOUN? STOP (FILLER)* (?P<go>CARRY|SWITCH) (over|ADVERB|FILLER)* there (COMMA|AND|THEN)*"
)
"""A request for a picture of something at a preset, followed by commands to go there and take it."""

_FOLLOWED_AT_PLACE = (
    "(FILLER|COMMA)* (KEEP|TRACK|TRACK-ING) ((?!COMMA|STOP|AND|THEN) _)+? (?P<place>(at|in|on) (DET)? PRESET PRESETNOUN?) (COMMA)? "
    rf"(for|during|over) {SECONDS} FILLER* (?=COMMA|STOP|AND|THEN|\Z)"
)
"""A thing to follow at a preset, then a duration: "follow the van at the gate for 20 seconds"."""

_ORDERED_COUNT = (
    "(?P<verb>return|run|perform|execute|produce|compute|calculate|obtain|carry_out|make) (DET)? (FREE|total|full|quick)? "
    "(COUNTNOUN|head_count|headcount)"
)
"""A verb that orders a count: "return the number of vans", "run a count of flags"."""

_CHECKED_AT_PLACE = (
    "(FILLER|COMMA)* (TELL|SEE) (me|us)? (?P<place>(at|in) (EVERY (of)? (DET)? PRESETNOUN|(DET)? PRESET PRESETNOUN?))"
    " (whether|if) _"
)
"""A place, then what to find out there: "check at each preset whether a lamp is broken"."""


def reworded(lexemes: Sequence[Lexeme]) -> tuple[Lexeme, ...]:
    """Replace some wordings: "I want to see the yard" becomes "let me see the yard", and "return left" becomes "go back left"."""
    lexemes = in_order_of_command(with_compound_nouns(with_angles_in_place(lexemes)))
    lexemes = _with_place_first(_without_in_steps_of(lexemes))
    lexemes = _without_yes_or_no(with_presets_reworded(lexemes))
    lexemes = _told_count(_count_at_list(_picture_wanted_first(_at_places_first(lexemes))))
    out: list[Lexeme] = []
    i = 0
    while i < len(lexemes):
        if _wants_to_see(out, lexemes[i:]):
            out.append(lexemes[i].reworded("let_me_see", "SHOW", "SHOW-ED"))
            i += 2
        else:
            out += _replacement(out, lexemes[i], lexemes[i + 1] if i + 1 < len(lexemes) else None)
            i += 1
    return tuple(out)


def _at_places_first(lexemes: Sequence[Lexeme]) -> Sequence[Lexeme]:
    """Return lexemes with "for each of gate and yard: go there, ..." shortened to "at gate and yard, ..."."""
    match = match_start(_PLACES_FIRST, lexemes)
    if match is None:
        return lexemes
    dropped = [*match["each"], *match["go"]]
    changed = {id(match["at"][0]): ("at", "PREP", "GLUE"), id(match["end"][0]): (",", "COMMA")}
    kept = (x for x in lexemes if not any(x is other for other in dropped))
    return [x.reworded(*changed[id(x)]) if id(x) in changed else x for x in kept]


def _with_place_first(lexemes: Sequence[Lexeme]) -> Sequence[Lexeme]:
    """Return lexemes with the preset of a thing to follow or check first: "at the gate, follow the van for 20 seconds"."""
    match = match_start(_FOLLOWED_AT_PLACE, lexemes) or match_start(_CHECKED_AT_PLACE, lexemes)
    if match is None:
        return lexemes
    place = match["place"]
    if place[0].word == "on" and all("_" not in x.word for x in place if x.has("PRESET")):
        return lexemes  # "the cyclist on the bridge" may be on a bridge in the current view
    kept = [x for x in lexemes if not any(x is y for y in place)]
    return [place[0].reworded("at", "PREP", "GLUE"), *place[1:], place[-1].reworded(",", "COMMA"), *kept]


def _without_in_steps_of(lexemes: Sequence[Lexeme]) -> Sequence[Lexeme]:
    """Return lexemes with "zoom out 1.5x until ..." in place of "zoom out in steps of 1.5x until ..."."""
    match = search(
        "(ZOOM|ENLARGE|WIDEN|ZOOM-ING) (IN|OUT)? (?P<dropped>in (STEPNOUN|steps|increments|stages) of) NUM X UNTIL", lexemes
    )
    return lexemes if match is None else [x for x in lexemes if not any(x is other for other in match["dropped"])]


def _without_yes_or_no(lexemes: Sequence[Lexeme]) -> Sequence[Lexeme]:
    """Return lexemes with "yes or no" at the end replaced by a question mark: "kids on the crossing, yes or no"."""
    ending = [x.word for x in lexemes[-4:] if not x.has("STOP", "QUESTION")][-3:]
    if ending != ["yes", "or", "no"] or len(lexemes) < 6:
        return lexemes
    first = next(i for i in range(len(lexemes) - 1, -1, -1) if lexemes[i].word == "yes")
    kept = lexemes[: first - 1] if lexemes[first - 1].has("COMMA", "DASH", "COLON", "STOP") else lexemes[:first]
    return [*kept, lexemes[first].reworded("?", "QUESTION")]


def _count_at_list(lexemes: Sequence[Lexeme]) -> Sequence[Lexeme]:
    """Return lexemes with "count people at the gate and the yard" in place of "count people: the gate, the yard"."""
    match = match_start(_COUNT_AT_LIST, lexemes)
    return lexemes if match is None else [x.reworded("at", "PREP", "GLUE") if x is match["end"][0] else x for x in lexemes]


def _told_count(lexemes: Sequence[Lexeme]) -> Sequence[Lexeme]:
    """Return lexemes with "tell the number of vans" in place of "return the number of vans"."""
    match = search(_ORDERED_COUNT, lexemes)
    return lexemes if match is None else [x.reworded("tell", "TELL", "LISTING") if x is match["verb"][0] else x for x in lexemes]


def _picture_wanted_first(lexemes: Sequence[Lexeme]) -> Sequence[Lexeme]:
    """Return lexemes with "go to the gate, take one" for "he wants a picture of a van at the gate. Go there, take one"."""
    match = match_start(_WANTED_PICTURE, lexemes)
    if match is None or not any(x.has("PICTURE", "SNAP", "ANOTHER") or x.word == "one" for x in lexemes[match.size :]):
        return lexemes
    if any(x.word in {"it", "him", "her", "them"} for x in lexemes[match.size :]):
        return lexemes  # "zoom in on it" needs the thing in the request
    go, place = match["go"][0], match["place"][0]
    return [go, go.reworded("to", "PREP", "GLUE"), place, go.reworded(",", "COMMA"), *lexemes[match.size :]]


def _replacement(before: Sequence[Lexeme], lexeme: Lexeme, after: Lexeme | None) -> list[Lexeme]:
    """Return the lexemes that replace a lexeme, or just that lexeme if it is unchanged."""
    last = before[-1] if before else None
    if (changed := reworded_in_context(before, lexeme, after)) is not None:
        return changed
    if _is_noun_here(before, lexeme) and not (before[-1].has("NONE") and after is not None and after.has("DET", "PRON")):
        return [lexeme.reworded(lexeme.word, "FREE")]  # "is there a train at the crossing?"
    if lexeme.word in {"into", "close_to"} and last is not None and _is_approach(before, lexeme):
        way = [] if last.has("IN", "ENLARGE") else [lexeme.reworded("in", "IN", "GLUE")]
        return [*way, lexeme.reworded("on", "ADVERB", "GLUE", "PREP")]  # "zoom into it", "get close to it"
    if lexeme.word == "where_you_are" and after is not None and (after.has("AIM-ING") or after.word in _AIMED):
        return [lexeme.reworded("where", "WHQ", "REL"), lexeme.reworded("you", "SELF"), lexeme.reworded("are", "BE", "GLUE")]
    if lexeme.word == "remind" and after is not None and after.has("SELF"):
        return [lexeme.reworded("tell", "TELL", "LISTING")]  # "remind me which presets there are"
    if lexeme.has("TILT") and match_start("(DET|SELF|current) PAN AND", before[-3:]):
        return [lexeme.reworded("tilt", "TILTNOUN")]  # "what is the pan and tilt?"
    if lexeme.word == "right_now" and last is not None and last.word == "the":
        return [lexeme.reworded("right", "RIGHT", "ADVERB"), lexeme.reworded("now", "NOW", "FILLER")]  # "over to the right now"
    if lexeme.word == "at_each" and after is not None and after.has("COLON"):
        return [lexeme.reworded("at", "PREP", "GLUE"), lexeme.reworded("each_of", "EVERY")]  # "take a picture at each: gate, yard"
    if lexeme.has("COLON") and last is not None and last.word == "each_of":
        return []
    if lexeme.word in {"last", "lastly"} and last is not None and last.has("COMMA", "AND") and _is_place_next(after):
        return [lexeme.reworded("finally", "FIRSTLY")]  # "first the gate, then the yard, last the dock"
    if lexeme.word in _AT_EACH and last is not None and last.has("BE") and _counts_on_tour(before):
        return [lexeme.reworded("there", "ADVERB", "GLUE", "VISIBLE")]  # "do a lap of the presets and tell me how many are at each"
    if lexeme.word == "and_please" and after is not None and after.has("DOV", "NEGATED"):
        return [lexeme.reworded("and", "AND", "GLUE"), lexeme.reworded("please", "FILLER")]  # "... and please don't follow it"
    if lexeme.word == "return" and after is not None and after.has(*DIRECTIONS):
        return [lexeme.reworded("go", "CARRY"), lexeme.reworded("back", "BACK")]
    return [lexeme]


def _is_noun_here(before: Sequence[Lexeme], lexeme: Lexeme) -> bool:
    """Return whether a verb is used as a noun: "follow the train", "is there a swing at the gate?"."""
    if not before or not before[-1].has("DET", "ANY", "NONE"):
        return False
    exists = match_start("(BE there|there BE)", before[-3:-1]) is not None
    return (exists and lexeme.has(*_VERBS_AND_NOUNS)) or (lexeme.has("AIM") and is_noun(lexeme.word))


def _is_place_next(after: Lexeme | None) -> bool:
    return after is not None and (after.has("PRESET", "HOME") or after.word in {"the", "to", "at"})


def _counts_on_tour(before: Sequence[Lexeme]) -> bool:
    """Return whether lexemes name every preset, and then begin a count."""
    count = next((i for i, x in enumerate(before) if x.has("HOWMANY")), 0)
    return search("EVERY (of|DET|SELF|single)* PRESETNOUN", before[:count]) is not None or any(
        x.has("PRESETNOUN") and x.word.endswith("s") for x in before[:count]
    )


def _wants_to_see(before: Sequence[Lexeme], lexemes: Sequence[Lexeme]) -> bool:
    """Return whether lexemes begin with "I want to see" and a thing or preset, and do not only give the reason for a move."""
    if len(lexemes) < 3 or not lexemes[0].has("WRAPPER") or not lexemes[0].word.endswith(_WANTS) or lexemes[1].word != "see":
        return False
    return _is_shown(lexemes[2]) and not _is_reason(before)


def _is_shown(lexeme: Lexeme) -> bool:
    """Return whether a lexeme can begin the name of a thing or preset to be shown."""
    return lexeme.has("DET", "PRESET", "FREE") and not lexeme.has(*_NOT_SHOWN) and lexeme.word not in _FUNCTION_WORDS


def _is_reason(before: Sequence[Lexeme]) -> bool:
    """Return whether "I want to see" after these lexemes is the reason for a move: "tilt up a lot, I want to see the roof"."""
    sentence: list[Lexeme] = []
    for x in reversed(before):
        if x.has("STOP", "QUESTION") and sentence:
            break
        if not x.has("STOP", "FILLER"):
            sentence.append(x)
    if not sentence:
        return False
    moves = any(x.has(*DIRECTIONS, "PAN", "TILT", "ZOOM", "ENLARGE", "WIDEN", "IN", "OUT") for x in sentence)
    return moves and not sentence[0].has("AND", "THEN")


def _is_approach(before: Sequence[Lexeme], preposition: Lexeme) -> bool:
    """Return whether "into" or "close to" after these lexemes says what to zoom in on: "zoom into", "zoom in close to"."""
    words = [x for x in before[-4:] if not x.has("FILLER", "CAMERA", "DET", "IN")]
    if not words:
        return False
    verb = words[-1]
    return verb.has("ZOOM", "ENLARGE") or (preposition.word == "close_to" and verb.word in {"get", "go", "move", "come"})
