"""Read references to presets, and clauses that go to one, go home, or list the presets."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from scope_ptz.planner.grammar.instruction_tree import (
    AtPlaces,
    GoThere,
    GoToPreset,
    Home,
    ListPresets,
    PresetRef,
    Snap,
    Step,
    Unclear,
)
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.clause import DIRECTIONS, Source, text_of
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start, search
from scope_ptz.planner.grammar.parsing.parts.preset_refs import EVERY_PLACE, PLACE, place_of, places_of

_GO = (
    r"(LEAVE (?=CAMERA|it|DET CAMERA)|(can|could|may) (i|we) (please)? (?=SHOW|TAKE)|SWITCH|CARRY|TURN|AIM|"
    r"PAN|SHOW|KEEP|FIND|TAKE|SWITCH-ING|CARRY-ING|SHOW-ING|TURN-ING|HOMEWARD|BACK|over|straight|on|up|to|"
    r"onto|into|at|me|us|it|SELF|CAMERA|FILLER|FIRSTLY|AROUND|DET|VIEWNOUN|back|towards|toward|for|"
    r"from|out|in|PRON|next|now|with|through|again|by|of|down|along|LEADFILLER|look|GLUE|TRACK|HOMEVERB|QUOTE|"
    r"AGAINWORD|DOACT)*"
)
_TAIL = (
    r"(FILLER|on (DET)? (big|large|main)? (VIEWNOUN|screen)|on|screen|up|now|please|VIEWNOUN|"
    r"PRESETNOUN|again|first|next|instead|INSTEAD|AGAINWORD|SELF|"
    r"BACK (up|on)|for a (AMOUNTISH|quick|couple of)* (SECONDS|MINUTES|moment|while|bit|LITTLE)|"
    r"FIRSTLY|VISIBLE|QUOTE|INTURN|over|COMMA (?=over)|CAMERA|ORDINAL|for|me|is|what|i|need|want|NOW)*"
)
_SUPERLATIVES = frozenset({"busiest", "quietest", "fullest", "emptiest", "most crowded", "least crowded", "calmest"})


_BEGINNING = frozenset({"start", "starting", "initial", "original", "beginning", "opening"})
_RETURNING = frozenset(
    {"return", "revert", "go_back", "come_back", "get_back", "switch_back", "turn_back", "swing_back", "move_back"}
)

_STORED = (
    "(FILLER)* ((LISTING|TELL|READ)? (me|us|out)* (WHQ|DET|all|EVERY|HOWMANY|named|preprogrammed|predefined)* PRESETNOUN (names)? "
    "(DOV|HAVEV|BE|MODAL|SELF|there|got|have|"
    "hold|holds|know|keep|been|so|far|save|saved|store|stored|set|set_up|up|programmed|loaded|available|in|on|DET|CAMERA|FILLER|this|"
    "thing|system|unit|memory|box|rig|device|right|now|here|at|the|moment|to|choose|from|pick|disposal|my|our|as PRESETNOUN|(this|"
    "(?!ANY)DET) FREE \\Z)*)"
)
"""A question about the presets themselves: "presets?", "what views have we got saved on this thing?"."""


def go_step(source: Source, lexemes: Sequence[Lexeme]) -> Step | None:
    """Return the step of a clause that goes to a preset or home, or lists the presets; None for other clauses."""
    if (parked := full_match("(FILLER)* park (CAMERA|it|DET|SELF)* (?P<place>(at|on|over|by|in) _+)", lexemes)) is not None:
        place = place_of(source, parked["place"])
        return Home() if full_match("_ HOME (FILLER)*", parked["place"]) else GoToPreset(place) if place else None
    if lexemes[0].has("BE") and any(x.has("HOME") for x in lexemes):
        return None  # "is the home view on?"
    if full_match(
        (
            r"(SWITCH|CARRY|SWITCH-ING|CARRY-ING|TURN|TAKE|back|BACK|to|it|CAMERA|DET|FILLER|FIRSTLY|SELF|RESET|GLUE|"
            r"VIEWNOUN|PRON|LEADFILLER|AIM|straight|PAN|up|at|from)* HOME (FILLER|FIRSTLY|ORDINAL|now|again|position|"
            r"VIEWNOUN|GLUE|PRESETNOUN|DET? CAMERA)*|(FILLER)* RESET (FILLER|GLUE|to|HOME|CAMERA|DET|VIEWNOUN|PRESETNOUN)*|"
            r"(FILLER)* park (CAMERA|it|DET)* (FILLER)*"
        ),
        lexemes,
    ):
        return Home(is_start=any(x.has("HOME") and _is_beginning(x) for x in lexemes))
    if opened := full_match(
        rf"(FILLER)* open (up)? (DET)? (PRESETNOUN|VIEWNOUN) (of|for|CALLED)? (?P<place>{PLACE}) (FILLER)*", lexemes
    ):
        place = place_of(source, opened["place"])
        return GoToPreset(place) if place else None
    if any(x.has("SNAP") for x in lexemes):
        return None  # "capture the gate"
    if search("HOWMANY|ANY PRESET", lexemes):
        return None  # "any containers?" asks for things, also if a preset has the same name
    if match := full_match(rf"{_GO} {PLACE} {_TAIL}", lexemes) or full_match(
        (
            rf"(PAN|TILT|TURN|AIM|SWITCH|CARRY) (CAMERA|it|FILLER|over|AMOUNTISH)* (LEFT|RIGHT|UP|DOWN) (over|back|"
            rf"AROUND)? (to|towards) {PLACE} {_TAIL}"
        ),
        lexemes,
    ):
        return GoToPreset(_ref(source, match, lexemes), _verb_kind(lexemes))
    if full_match(
        (
            r"(SWITCH|CARRY|back|FILLER|to|over|it|CAMERA|SHOW|me|take|us|DET|AIM)* (to)? (there|that one|that preset|"
            r"the winner|that view|DET winner|the first one|the best one|that position|whichever has more|the one "
            r"with the most)"
        ),
        lexemes,
    ) and any(x.has("SWITCH", "CARRY") for x in lexemes):
        return GoThere()
    if full_match("(FILLER|FIRSTLY)* (SWITCH|CARRY|goto) (me|us|CAMERA|back|over|FILLER)* (to)? it (FILLER|NOW|then)*", lexemes):
        return GoThere("winner")
    if ranked := full_match(
        "(FILLER|FIRSTLY)* (SWITCH|CARRY|goto|SHOW) (me|us|CAMERA|back|over|FILLER)* (to)? the "
        "(?P<way>busier|busiest|fuller|fullest|quieter|quietest|emptier|emptiest) (one|PRESETNOUN|VIEWNOUN)? (FILLER)*",
        lexemes,
    ):
        return GoThere("fewer" if ranked["way"][0].word.startswith(("quiet", "empt")) else "more")
    return None


def listing_step(lexemes: Sequence[Lexeme]) -> Step | None:
    """Return the step of a clause that asks for a list of the presets; None for other clauses."""
    if match_start("(FILLER|AND|THEN)* (?!LISTING|TAKE) (SWITCH|CARRY|SCAN) _* EVERY", lexemes):
        return None  # "visit all the spots you have stored"
    if (
        full_match(
            (
                r"(LISTING|SHOW|TELL|WHQ|DET|SELF|me|us|FILLER|list of|DOV|BE|have|HAVEV|there|available|saved|stored|"
                r"defined|of|EVERY|know|for|VISIBLE|got|set|up|does|CAMERA|can|MODAL|use|i|to|go|list|the|names of|"
                r"HOWMANY|NAMES|name|names|save|PICTURES|SWITCH|CARRY|in|on|has|been|this|choose|from|and|which|existing|options|choices|"
                r"configured|exist|at|here|them|saving|offer|your|my|our|what|hold|save-ED|keep)* (presets|preset list|positions|"
                r"views|bookmarks|"
                r"PRESETNOUN) (LISTING|SHOW|DET|SELF|FILLER|list|DOV|BE|have|HAVEV|there|available|saved|stored|for|of|to|"
                r"can|MODAL|SWITCH|i|go|does|CAMERA|exist|are|you|know|got|set|up|this|use|defined|configured|on|in|the|"
                r"here|it|knows|LISTING-S|one|been|save-ED|CARRY|names|have|choose|from|we|offer|VISIBLE|PREP|name|hold|WHOLETHING|system|memory|got|keep|"
                r"(of|for|at) FREE+)*"
            ),
            lexemes,
        )
        and any((x.word.endswith("s") and x.has("PRESETNOUN")) or x.word in {"list", "names"} for x in lexemes)
        and any(
            x.has("LISTING", "WHQ", "SHOW", "TELL", "HOWMANY") or x.word == "names" or x.word in {"list", "available", "names"}
            for x in lexemes
        )
        and not any(x.word in {"check", "both"} for x in lexemes)
    ):
        return ListPresets()
    is_plural = any((x.has("PRESETNOUN") and x.word.endswith("s")) or x.word == "names" for x in lexemes)
    if is_plural and full_match(_STORED, lexemes) and not any(x.has("EVERY") or x.word == "both" for x in lexemes):
        return ListPresets()
    return None


def tour_step(source: Source, lexemes: Sequence[Lexeme]) -> Step | tuple[Step, ...] | None:
    """Return the step of "visit every preset", a tour without actions yet; None for other clauses."""
    if match := full_match(
        r"(SWITCH|CARRY|SHOW|SCAN|tour|through|to|at|FILLER)* (?P<places>(DET|EVERY)* _* PRESETNOUN EXCEPT _+)", lexemes
    ):
        places = places_of(source, match["places"])
        return AtPlaces(places, ()) if places else None
    if (
        match := full_match(r"(FILLER|SWITCH|CARRY|TAKE|me|us|CAMERA|it)* from (?P<first>_+?) (to|on to) (?P<second>_+)", lexemes)
    ) is not None:
        first, second = place_of(source, match["first"]), place_of(source, match["second"])
        return (GoToPreset(first), GoToPreset(second)) if first and second else None
    if (match := full_match(r"(FILLER|SWITCH|CARRY)* (via|through) (?P<first>_+?) (to|on to) (?P<second>_+)", lexemes)) is not None:
        first, second = place_of(source, match["first"]), place_of(source, match["second"])
        return (GoToPreset(first), GoToPreset(second)) if first and second else None
    if full_match(rf"(FILLER)* (SNAP) (of)? {EVERY_PLACE} (INTURN|FILLER)*", lexemes):
        return AtPlaces((), (Snap(),))  # "photograph each preset in turn"
    match = full_match(
        (
            rf"(SWITCH|CARRY|SCAN|SHOW|AIM|TURN|SWITCH-ING|CARRY-ING|through|to|at|in|me|SELF|CAMERA|FILLER|over|on|"
            rf"for|from|up|DET (tour|round|lap|circuit) of|tour|around|round|FIRSTLY|around|AROUND|a tour of|of|TAKE|it|TRACK|do|"
            rf"run|each|DOACT|(DET|NUM|LIMIT|complete|quick)+ (tour|round|lap|circuit) of|DET (rounds|round) of|DET rounds COMMA|"
            rf"DET FREE? (tour|round) of)* "
            rf"(?P<places>{EVERY_PLACE}) (INTURN|COMMA|FILLER|one|by|in|turn|AND|GLUE)*"
        ),
        lexemes,
    )
    return AtPlaces((), ()) if match and not any(x.word == "both" for x in lexemes) else None


def _ref(source: Source, match: Any, lexemes: Sequence[Lexeme]) -> PresetRef:
    if match.has("name"):
        name = match["name"][0]
        position = list(lexemes).index(name)
        near = lexemes[max(0, position - 2) : position + 2]
        explicit = any(x.has("PRESETNOUN") and not x.has("PRESET") for x in near) or not any(
            x.has("DET") for x in lexemes[max(0, position - 1) : position]
        )
        return PresetRef(name.preset, explicit=explicit)
    number = match["number"] or match["ordinal"]
    return PresetRef(text_of(source, lexemes), number=round(number[0].value), explicit=True, is_first_view=_is_first_view(lexemes))


def _is_beginning(home: Lexeme) -> bool:
    """Return whether words for the home view can also mean the view at the beginning of a conversation: "the original view"."""
    return any(part in _BEGINNING for part in home.word.split("_"))


def _is_first_view(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether a clause returns to "the first view", which may be the first of the conversation and not the first preset."""
    returns = any(x.has("BACK", "AGAINWORD") or x.word in _RETURNING for x in lexemes)
    return returns and search("(first|very_first|FIRSTLY) (VIEWNOUN|PICTURE|position|place|spot)", lexemes) is not None


def _verb_kind(lexemes: Sequence[Lexeme]) -> Any:
    """Return the kind of verb with which a clause names a preset, as in ``GoToPreset.how``."""
    words = {x.word for x in lexemes}
    if words & {"use", "using"}:
        return "use"
    if "at" in words and any(x.has("AIM") for x in lexemes) and not any(x.has("SWITCH") for x in lexemes):
        return "look" if any(x.has(*DIRECTIONS) for x in lexemes) else "show"
    if any(x.has("SWITCH", "CARRY", "TURN", "SWITCH-ING", "CARRY-ING", "AIM", "PAN") for x in lexemes) or "to" in words:
        return "go"
    return "show" if any(x.has("SHOW", "FIND") for x in lexemes) else "bare"


def unknown_place(source: Source, lexemes: Sequence[Lexeme]) -> Step | None:
    """Return the step of "go to X", where X is not a preset that the camera has; None for other clauses."""
    match = full_match(
        (
            r"(FILLER|FIRSTLY)* (SWITCH|CARRY|goto|SHOW|back) (me|us|it|SELF|CAMERA|back|over|on|FILLER|up|straight|"
            r"DET CAMERA)* (to|onto)? (DET)? (PRESETNOUN (CALLED)?)? (?P<name>(FREE|NUM|ORDINAL|UP|DOWN|COMPASS|IN|"
            r"LITTLE|LEFT|RIGHT|OTHER|STOPNOUN|PREP|AND|ADVERB|HEADNOUN|TURNNOUN|STEPNOUN|of|WIDE|FULL|X|CAMERA|"
            r"PICTURE|one|LOT|AROUND|VIEWNOUN){1,4}?) (?P<marked>PRESETNOUN)? (FILLER)*"
        ),
        lexemes,
    )
    if not match:
        return None
    words = {x.word for x in lexemes}
    name = text_of(source, match["name"])
    if name.lower() in _SUPERLATIVES:
        return Unclear("What shall I count to tell which is busier: vehicles or people?")  # "go to the busiest preset"
    marked = match.has("marked") or any(x.has("PRESETNOUN") for x in lexemes)
    if match["name"][0].has("PREP", "AND") and not marked:
        return None
    if (
        ("to" in words and any(x.has("SWITCH", "CARRY") for x in lexemes))
        or (marked and any(x.has("SWITCH", "CARRY", "SHOW") for x in lexemes))
        or words & {"recall", "visit", "load", "goto", "use", "select"}
    ):
        if match["name"][0].has("NUM") and not marked:
            return Unclear("Is that number the pan angle in degrees, or the number of a preset?")
        return GoToPreset(PresetRef(name, explicit=marked), "go")
    return None
