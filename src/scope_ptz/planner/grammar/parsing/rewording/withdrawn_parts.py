"""Leave out the part of an instruction that is taken back: "pan left 20 and tilt up 10. Actually, leave the tilt alone".

The words that take a part back name it again: its action ("the tilt", "the picture"), its preset, its thing, or its verb ("no,
don't follow him"). If they fit exactly one part, that part is left out. If they fit several, or if it is unclear what remains
of the others, the user is asked.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from scope_ptz.planner.grammar.lexing.lexer import Lexeme, lexemes_of
from scope_ptz.planner.grammar.parsing.parts.clause import MARKERS
from scope_ptz.planner.grammar.parsing.parts.patterns import Match, full_match, match_start, search
from scope_ptz.planner.grammar.parsing.rewording.repairs import Repaired, without_text

_ENDS = "COMMA|STOP|DASH|COLON|QUESTION"
_SEPARATORS = ("COMMA", "STOP", "DASH", "COLON", "AND", "THEN", "BUT")
_SIGNAL = (
    "no|nah|nope|wait|sorry|actually|hang_on|hold_on|hang on|hold on|(scratch|scrap|strike) that|on (second|ORDINAL) "
    "(thought|thoughts)|on reflection|changed my mind|correction COLON?"
)
_PAUSES = "((?!actually|sorry|wait) FILLER|COMMA|DASH|STOP|BUT|SELF)*"
_ALONE = "alone|as it is|as_it_is|as is|where it is|the way it is|be"
_ACTS = "PAN|TILT|ZOOM|PANNOUN|TILTNOUN|ZOOMNOUN|PICTURE|COUNT|COUNT-ING|TRACK-ING|PAN-ING|TILT-ING|ZOOM-ING"
_OBJECT = f"(DET|about|with|PRON)* (?P<object>((?!{_ENDS}|AND|THEN|BUT|NUM|LEFT|RIGHT|UP|DOWN|IN) _){{1,4}})"
_FORMS = (
    rf"(LEAVE|keep) DET* (?P<object>{_ACTS}) (?P<alone>({_ALONE}))",
    rf"(?P<firm>(forget|omit|skip|cancel|scrap|drop|scratch|ignore|disregard|never mind|LEAVE OUT)) {_OBJECT}",
    rf"LEAVE {_OBJECT}",
    "(do|DOV|please_do) not (bother)? (?P<verb>TRACK|ZOOM|COUNT|SNAP|PAN|TILT|TAKE|READ|FIND|TRACK-ING|ZOOM-ING|COUNT-ING|PAN-ING|"
    rf"TILT-ING) (in|IN|on)* (PRON|it|him|them|{_OBJECT})?",
)
_SIGNALS = f"(?P<signal>({_SIGNAL}) (({_SIGNAL})|{_PAUSES.rstrip('*')})*)"
_TAKING_BACK = tuple(
    rf"(?P<pause>({_ENDS})) {_PAUSES} {_SIGNALS}? (please)? {form} (please|FILLER)* (?=({_ENDS}|AND)|\Z)" for form in _FORMS
)
_FURTHER = rf"({_ENDS}|AND|OR|FILLER)+ (DET ({_ACTS})|({_ACTS}) (too|either|FILLER|ADVERB)* (({_ENDS})|\Z))"
"""Another action that is taken back along with the first one: "forget the tilt and the pan"."""

_KEPT = "((?P<there>(CARRY|go|goto) there|SHOW SELF (it|there)?)|(DOACT)? (DET)? (?P<act>PAN|TILT|ZOOM|COUNT|PICTURE))"
_NEEDED = "((BE|'s) (required|needed|wanted|necessary))?"
_REASON = (
    f"({_ENDS}) (because|as|since|FILLER)* (NOONE|(DET|FREE|SELF|SOMEONE){{1,4}} ((DOV|do|MODAL) not|never)) "
    f"(want|wants|WRAPPER|like|likes|allow|allows|need|needs) (it|that|this|them|any|PRON) (FILLER)* ({_ENDS})*"
)
"""Words that say why a part is taken back: "forget the photo, the boss doesn't want that"."""

_DEPENDENT = (
    "(FILLER|do|DOV|DOACT|CARRY|PRON|DET|in)* (AGAINWORD|SAMEAMOUNT|TWICE|THRICE|NUM X|REPEAT|UNDO|BACK|go_back|return|redo|"
    "FRACTION|other|opposite|the_other_way|the_opposite_way)"
)
"""A part that has no meaning without the one before it."""

_TURNS = {"PAN": ("PAN", "LEFT", "RIGHT"), "TILT": ("TILT", "UP", "DOWN")}
_KINDS = ("PAN", "TILT", "ZOOM", "COUNT", "TRACK", "READ", "FIND", "PICTURE")
_PICTURES = ("PICTURE", "SNAP")


@dataclass(frozen=True, slots=True)
class _Part:
    """A part of an instruction between two separators, with its position among the lexemes."""

    first: int
    last: int
    lexemes: tuple[Lexeme, ...]


def without_withdrawn_parts(said: Repaired) -> tuple[Repaired, Sequence[Lexeme]]:
    """Return an instruction without the part that is taken back, and the words that take back an unclear part (often none)."""
    for i in range(1, len(said.lexemes)):
        match = next((found for form in _TAKING_BACK if (found := match_start(form, said.lexemes[i:]))), None)
        if match is None or not (match.has("signal") or match.has("firm") or match.has("alone")):
            continue
        before, after = said.lexemes[:i], said.lexemes[i + match.size :]
        fitting = [part for part in _parts(before) if _fits(match, part)]
        if not fitting:
            continue
        kept = _without(before, fitting[0], is_act=_kind(match) != "") if len(fitting) == 1 else None
        if kept is not None and _is_named_or_reason(kept, after):
            after = ()
        is_only = match_start(f"({_ENDS}|FILLER)* (just|only)", after) is not None
        is_said_later = match.has("signal") or match.has("firm")
        is_clear = is_said_later and not (kept and is_only) and (kept or after) and not search("|".join(MARKERS), before)
        names_more = match_start(_FURTHER, after) is not None or _offers_choice(match)
        if kept is None or not is_clear or names_more or _needs_what_is_dropped(said.lexemes, fitting[0], i, i + match.size):
            return said, said.lexemes[i + 1 : i + match.size]
        return without_text(said, _joined(kept, after)), ()
    return said, ()


def _is_named_or_reason(kept: tuple[Lexeme, ...], after: Sequence[Lexeme]) -> bool:
    """Return whether the words after those that take a part back only name the part that remains, or say why.

    Examples are "cancel the zoom, pan only", "forget the photos, only go there" and "forget the photo, Dave doesn't want that".
    """
    if full_match(_REASON, after):
        return True
    only = full_match(f"({_ENDS}|FILLER)* ((just|only) {_KEPT} {_NEEDED}|{_KEPT} (only|alone)) ({_ENDS}|FILLER)*", after)
    parts = _parts(kept)
    if only is None or len(parts) != 1:
        return False
    if only.has("there"):
        return any(x.has("PRESET") for x in parts[0].lexemes)
    act = next(name for name in _KINDS if any(x.has(name) for x in only["act"]))
    return any(x.has(act, *_TURNS.get(act, ())) for x in parts[0].lexemes) and not (
        act in _TURNS and any(x.has("ZOOM") for x in parts[0].lexemes)
    )


def _needs_what_is_dropped(lexemes: Sequence[Lexeme], dropped: _Part, first: int, last: int) -> bool:
    """Return whether a part after a dropped one only repeats or reverses what came before it, such as "and again" or "undo".

    Args:
        lexemes: The lexemes of the instruction.
        dropped: The part that is taken back.
        first: The index of the first lexeme that takes it back.
        last: The index after the last one.
    """
    parts = (part for part in _parts(lexemes) if part.first > dropped.last and not first <= part.first < last)
    return any(depends_on_part_before(part.lexemes) for part in parts)


def depends_on_part_before(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether a part of an instruction only repeats or reverses the one before it: "again", "twice", "undo"."""
    return match_start(_DEPENDENT, lexemes) is not None


def _offers_choice(match: Match) -> bool:
    """Return whether the words that take something back name several things: "forget the tilt or the pan"."""
    return match.has("object") and any(x.has("OR") for x in match["object"])


def takes_back_unclearly(text: str, presets: tuple[str, ...]) -> bool:
    """Return whether a text takes something back without making clear what remains, so that none of it may be left unread."""
    lexemes = tuple(lexemes_of(text, presets))
    return bool(without_withdrawn_parts(Repaired(lexemes, text))[1])


def _parts(lexemes: Sequence[Lexeme]) -> list[_Part]:
    """Return the parts of an instruction."""
    parts: list[_Part] = []
    first = 0
    for i in range(len(lexemes) + 1):
        if i == len(lexemes) or lexemes[i].has(*_SEPARATORS):
            if i > first:
                parts.append(_Part(first, i, tuple(lexemes[first:i])))
            first = i + 1
    return parts


def _kind(match: Match) -> str:
    """Return the class of the action that is taken back, such as "TILT"; empty for a preset or a thing."""
    named = match["verb"] if match.has("verb") else match["object"]
    if match.has("verb") and named[0].has("TAKE", "SNAP", "SNAP-ING"):
        return "PICTURE"
    nouns = {"PAN": "PANNOUN", "TILT": "TILTNOUN", "ZOOM": "ZOOMNOUN"}
    return next((kind for kind in _KINDS for x in named[:1] if x.has(kind, f"{kind}-ING", nouns.get(kind, kind))), "")


def _fits(match: Match, part: _Part) -> bool:
    """Return whether words that take something back name a part."""
    kind, named = _kind(match), match["object"] if match.has("object") else ()
    content = [x for x in named if x.has("FREE", "PRESET") and not x.has("FILLER")]
    if kind:
        is_same = any(x.has(*_PICTURES) if kind == "PICTURE" else x.has(kind) for x in part.lexemes)
        ways = _TURNS.get(kind, ())
        is_turn = any(x.has(*ways) for x in part.lexemes) and not any(x.has("ZOOM", "PRESET") for x in part.lexemes)
        if not (is_same or is_turn):
            return False
        is_pronoun = any(x.has("PRON") for x in part.lexemes)
        return not (match.has("verb") and content) or is_pronoun or _names(content, part)
    return bool(content) and len(content) == len(named) and _names(content, part)


def _names(content: Sequence[Lexeme], part: _Part) -> bool:
    """Return whether a part has all the given words or presets."""
    return all(any(x.word == y.word and x.preset == y.preset for y in part.lexemes) for x in content)


def _without(lexemes: tuple[Lexeme, ...], part: _Part, *, is_act: bool) -> tuple[Lexeme, ...] | None:
    """Return lexemes without a part; None if it is unclear what remains: "zoom in on the van and read it; forget the van"."""
    later = [other for other in _parts(lexemes) if other.first > part.last]
    if is_act and any(x.has(*_PICTURES) for x in part.lexemes) and any(x.has("PRESET") for x in part.lexemes):
        return None  # "a picture of the gate": going there may still be wanted
    if any(search("PRON|there|EVERY|EACHTIME", other.lexemes) for other in later):
        return None
    if not is_act and not all(search("PRESET", other.lexemes) and len(other.lexemes) <= 3 for other in later):
        return None
    start = part.first
    while start and lexemes[start - 1].has(*_SEPARATORS):
        start -= 1
    end = part.last
    while not start and end < len(lexemes) and lexemes[end].has(*_SEPARATORS):
        end += 1
    return (*lexemes[:start], *lexemes[end:])


def _joined(kept: tuple[Lexeme, ...], after: tuple[Lexeme, ...]) -> tuple[Lexeme, ...]:
    """Return what remains, followed by what comes after the words that took a part back."""
    if match := match_start(f"({_ENDS})* (?=AND|THEN)" if kept else f"({_ENDS}|AND|BUT|THEN|just|only)*", after):
        after = after[match.size :]
    return (*kept, *after)
