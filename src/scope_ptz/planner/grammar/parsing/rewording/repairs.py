"""Read self-repairs: "pan left 20, sorry, I meant right 20" is read as "pan right 20".

In a repair, a speaker signals that something was wrong ("no", "sorry", "I mean", "make that") and says what to do instead.
A repair replaces a direction, a number or a preset of the previous clause, reverses its direction ("no, the other way"), or
replaces a single command as a whole ("scratch that, tilt down 5"). Anything else is left as it is, and the user is asked.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.clause import DIRECTIONS, VERBS
from scope_ptz.planner.grammar.parsing.parts.noun_phrases import is_noun_phrase
from scope_ptz.planner.grammar.parsing.parts.patterns import Match, full_match, match_start, search
from scope_ptz.planner.grammar.parsing.segments.clause_starts import FRAGMENT
from scope_ptz.planner.grammar.parsing.segments.segmentation import clauses_of

_MAX_REPAIRS = 3
_PAUSE = "(COMMA|STOP|DASH|COLON)"
_RETRACTION = (
    "(i_mean|i_meant|i_do_mean|SELF meant) (to (say|TELL))?|SELF (wanted|meant|intended) to (say|write|type|put)|"
    "(scratch|scrap|strike|belay|cancel|forget|ignore|disregard) (that|it)|"
    "(do|DOV) not (do (that|it|this)|REPEAT)|"
    "(disregard|cancel|belay|scratch|scrap) (?=COMMA|STOP|DASH|COLON)|"
    "correction|on (second|ORDINAL) (thought|thoughts)|my mistake|wrong_way|(negative|wrong (sign|one|direction)?)(?! NUM)"
)
"""Words that retract what was said just before them."""

_SLIP = (
    "hang on|hold on|hang_on|hold_on|"
    "no|nah|naw|nope|sorry|wait|oops|gah|argh|aargh|ugh|damn|dammit|drat|er|erm|actually|OR? rather|OR no|(make|made) (that|it)"
)
"""Words that retract what was said before only if what follows replaces a part of it: "wait, zoom in" may be an extra command,
and "no zoom" forbids zooming."""

_HESITATION = "FILLER|well|oops|hang on|hold on"
EDITING = (
    rf"{_PAUSE}* (({_HESITATION}) {_PAUSE}*)* ((?P<retraction>{_RETRACTION})|{_SLIP}) "
    rf"((?P<retraction>{_RETRACTION})|{_SLIP}|{_HESITATION}|{_PAUSE})*"
)
ENDS = ("COMMA", "STOP", "QUESTION", "COLON", "DASH", "AND", "THEN", "BUT")
"""Classes of the words that end a clause."""

_LEAD = "(WRAPPER|do|try|CARRY|to|DET|TURN|PAN|TILT|go|goto|by|not|about|PRESETNOUN|it|that|is|'s|FILLER)*"
_UNIT = "(?P<unit>DEG|X|PERCENT|SECONDS|MINUTES|HOURS)"
_WAY = "(LEFT|RIGHT|UP|DOWN|IN|OUT)"
_WAYS = (*DIRECTIONS, "IN", "OUT")
_NEW_PRESET = (
    "(WRAPPER|SELF|SHOW|AIM|use|do|try|TAKE|to|DET|go|goto|SWITCH|CARRY|DOACT|DOV|at|in|not|FILLER|PRESETNOUN)* (?P<preset>PRESET) "
    "(PRESETNOUN|FILLER|INSTEAD)*"
)
NEW_AMOUNT = (
    rf"{_LEAD} (?P<way>{_WAY}) (by|to|DET|COMMA|DASH)* ((?P<number>NUM) {_UNIT}?)? (FILLER|INSTEAD)*|"
    rf"{_LEAD} (?P<number>NUM) {_UNIT}? ((to)? (DET)? (?P<way>{_WAY}))? (FILLER|INSTEAD)*"
)
NEW_WAY = rf"{_LEAD} ((?P<number>NUM) (DEG)?)? (DET)? (?P<said>(other|opposite|wrong) (way|direction|SIDE)) (AROUND|FILLER)*"
_OPPOSITE = {"LEFT": "RIGHT", "RIGHT": "LEFT", "UP": "DOWN", "DOWN": "UP", "IN": "OUT", "OUT": "IN"}
_ALIKE = (frozenset({"SECONDS", "MINUTES", "HOURS"}), frozenset({"X", "PERCENT"}), frozenset({"DEG"}))
"""Classes of units that can replace one another."""


@dataclass(frozen=True, slots=True)
class Repaired:
    """An instruction after its repairs.

    Attributes:
        lexemes: The lexemes that are meant.
        text: The text, in which spaces stand for the words that were retracted.
    """

    lexemes: tuple[Lexeme, ...]
    text: str


def repaired(lexemes: Sequence[Lexeme], text: str) -> Repaired:
    """Return an instruction with its repairs applied."""
    said = Repaired(tuple(lexemes), text)
    for _ in range(_MAX_REPAIRS):
        positions = range(1, len(said.lexemes))
        meant = next((found for i in positions if (found := _repaired_at(said.lexemes, i)) is not None), None)
        if meant is None:
            break
        said = without_text(said, meant)
    return said


def unresolved_editing(lexemes: Sequence[Lexeme]) -> Sequence[Lexeme]:
    """Return the words that retract something without a repair that says what; empty if there are none."""
    found = search(
        rf"{_PAUSE} (FILLER)* (?P<editing>(no|wait|oops|hang on|hold on|(scratch|scrap|strike) that)+) (FILLER)* {_PAUSE}", lexemes
    )
    if found is None:
        found = search(f"_ {_PAUSE} (FILLER|no|COMMA)* (?P<editing>(do|DOV) not (REPEAT|do (that|it|this))) {_PAUSE}", lexemes)
    if found is None:
        found = search("(COMMA|DASH) (FILLER)* (?P<editing>(i_mean|i_meant) DET (FREE|LEFT|RIGHT)* (one|ones))", lexemes)
    return found["editing"] if found else ()


def without_text(said: Repaired, meant: tuple[Lexeme, ...]) -> Repaired:
    """Return an instruction with new lexemes, and with spaces in its text in place of the words that were dropped."""
    text = said.text
    for lexeme in said.lexemes:
        if not any(kept.start <= lexeme.start and lexeme.end <= kept.end for kept in meant):
            text = text[: lexeme.start] + " " * (lexeme.end - lexeme.start) + text[lexeme.end :]
    return Repaired(meant, text)


def _repaired_at(lexemes: tuple[Lexeme, ...], i: int) -> tuple[Lexeme, ...] | None:
    """Return the lexemes that are meant if a repair begins at a position; None if there is none, or it is unclear."""
    editing = match_start(EDITING, lexemes[i:])
    if editing is None or match_start("i_said|SELF (said|TELL-ED)", lexemes):
        return None
    if lexemes[i].word == "wrong":
        return None  # "if the points are wrong go home" has no pause before "wrong"
    before, after = lexemes[:i], lexemes[i + editing.size :]
    old, new = before[last_clause(before) :], after[: first_end(after)]
    if not old or not new:
        return None
    changed = _with_preset(old, new) or _with_direction_reversed(old, new) or _with_amount(old, new)
    if changed is None and (editing.has("retraction") or any(x.has("ZOOM", "COUNT", "TRACK", "FIND", "SHOW", "AIM") for x in old)):
        changed = _with_thing(old, new)
    if changed is not None:
        rest = after[len(new) :]
        if rest and rest[0].has("DASH") and not editing.has("retraction"):
            return None  # "zoom out - sorry, in - 2x"
        if rest and rest[0].has("COMMA", "DASH") and match_start(f"_ (NUM|{_UNIT})", rest):
            rest = rest[1:]  # "pan left, I mean right, 20"
        return (*before[: len(before) - len(old)], *changed, *rest)
    return after if editing.has("retraction") and _replaces_all(before, after) else None


def last_clause(lexemes: Sequence[Lexeme]) -> int:
    """Return the position at which the last clause begins."""
    return max((i + 1 for i, x in enumerate(lexemes) if x.has(*ENDS)), default=0)


def first_end(lexemes: Sequence[Lexeme]) -> int:
    """Return the number of lexemes before the first one that ends a clause."""
    return next((i for i, x in enumerate(lexemes) if x.has(*ENDS)), len(lexemes))


def _replaces_all(before: Sequence[Lexeme], after: Sequence[Lexeme]) -> bool:
    """Return whether a command replaces everything before it, which must be a single command."""
    ways = sum(x.has(*_WAYS) for x in before)
    first = next((x for x in after if not x.has("FILLER", "FIRSTLY", "INSTEAD")), None)
    is_command = first is not None and first.has(*VERBS, "HOME", "PRESET")
    is_fragment = not ways and match_start(FRAGMENT, after) is not None
    return (is_command or is_fragment) and ways < 2 and len(clauses_of(before)) == 1


def _with_preset(old: tuple[Lexeme, ...], new: Sequence[Lexeme]) -> tuple[Lexeme, ...] | None:
    """Return a clause with its preset replaced: "go to the gate, no, the yard"."""
    match = full_match(_NEW_PRESET, new)
    places = [i for i, x in enumerate(old) if x.has("PRESET")]
    leads = "(FILLER|WRAPPER)* (SWITCH|CARRY) (back|over|on|FILLER)* to|(DET|FILLER)* FREE{1,3} \\Z"
    if match is not None and not places and match_start(leads, old):
        return tuple(new)  # the name of the first preset is misspelt or unknown
    if match is None or not places:
        return None
    goes = any(x.has("SHOW", "SWITCH", "CARRY", "AIM") for x in new)
    if goes and any(x.has("PICTURE", "SNAP", "COUNT", "HOWMANY", "TRACK") for x in old):
        return None  # "a picture of the gate. Scratch that, show me the gate": the picture may not be wanted
    return (*old[: places[-1]], *match["preset"], *old[places[-1] + 1 :])


def _with_thing(old: tuple[Lexeme, ...], new: Sequence[Lexeme]) -> tuple[Lexeme, ...] | None:
    """Return a clause with the thing at its end replaced: "zoom in on the van, I mean the lorry by the gate"."""
    thing = new[next((i for i, x in enumerate(new) if not x.has("FILLER")), len(new)) :]
    start = next((i for i, x in enumerate(old) if i and x.has("DET")), len(old))
    if any(x.word in {"one", "ones"} for x in thing):
        return None  # "the red one" needs the noun of the first thing
    if not (thing and thing[0].has("DET") and old[start:] and is_noun_phrase(thing) and is_noun_phrase(old[start:])):
        return None
    return (*old[:start], *thing)


def _with_direction_reversed(old: tuple[Lexeme, ...], new: Sequence[Lexeme]) -> tuple[Lexeme, ...] | None:
    """Return a clause with its only direction reversed: "pan right 30, no, the other way"."""
    match = full_match(NEW_WAY, new)
    ways = [i for i, x in enumerate(old) if x.has(*_WAYS)]
    if match is None or len(ways) != 1:
        return None
    way = next(name for name in _WAYS if old[ways[0]].has(name))
    said = match["said"]
    opposite = Lexeme(_OPPOSITE[way].lower(), said[0].start, said[-1].end, frozenset({_OPPOSITE[way]}))
    turned = (*old[: ways[0]], opposite, *old[ways[0] + 1 :])
    return _with_number(turned, match) if match.has("number") else turned


def _with_amount(old: tuple[Lexeme, ...], new: Sequence[Lexeme]) -> tuple[Lexeme, ...] | None:
    """Return a clause with its direction, its number or both replaced: "pan left 20, sorry, right 30"."""
    match = full_match(NEW_AMOUNT, new)
    if match is None:
        return None
    if not match.has("way"):
        return _with_number(old, match)
    ways = [i for i, x in enumerate(old) if x.has(*_WAYS)]
    if len(ways) > 1:
        horizontal = match["way"][0].has("LEFT", "RIGHT")
        ways = [i for i in ways if old[i].has("LEFT", "RIGHT") == horizontal] if not match.has("number") else []
    if len(ways) != 1 or (any(x.has("PAN", "TILT") for x in new) and not _same_axis(old[ways[0]], match["way"][0])):
        return None
    is_sized = any(x.has("NUM") for x in old)
    added = match["number"] if match.has("number") and not is_sized else ()
    turned = (*old[: ways[0]], *match["way"], *added, *old[ways[0] + 1 :])
    return _with_number(turned, match) if match.has("number") and is_sized else turned


def _same_axis(one: Lexeme, other: Lexeme) -> bool:
    """Return whether two directions are opposite or equal."""
    return any(one.has(*axis) and other.has(*axis) for axis in (("LEFT", "RIGHT"), ("UP", "DOWN"), ("IN", "OUT")))


def _with_number(old: tuple[Lexeme, ...], match: Match) -> tuple[Lexeme, ...] | None:
    """Return a clause with its last number replaced, along with its unit if the new number has a unit of the same kind."""
    numbers = [i for i, x in enumerate(old) if x.has("NUM")]
    if not numbers:
        return None
    at, units = numbers[-1], match["unit"] if match.has("unit") else ()
    after = old[at + 1 :]
    kinds = next((kinds for kinds in _ALIKE if units and units[0].has(*kinds)), frozenset[str]())
    if units and after and after[0].has(*kinds):
        after = after[1:]
    elif units and (any(after[:1] and after[0].has(*kinds) for kinds in _ALIKE) or _is_foreign(kinds, old)):
        return None
    return (*old[:at], *match["number"], *units, *after)


def _is_foreign(kinds: frozenset[str], old: Sequence[Lexeme]) -> bool:
    """Return whether a unit does not suit a clause whose number has none: times suit a zoom, and degrees a turn."""
    is_zoom = any(x.has("ZOOM", "ZOOM-ING", "ZOOMNOUN", "ENLARGE", "WIDEN") for x in old)
    return is_zoom if "DEG" in kinds else not is_zoom
