"""Read instructions that correct the last command ("no, I meant 30", "wrong way", "no, the red one"), or turn the other way."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from scope_ptz.english.grammar.lexicon import lexicon
from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.binding.earlier_moves.commands import Command
from scope_ptz.planner.grammar.binding.earlier_moves.single_moves import SingleMove, axis_of_way, single_move, towards
from scope_ptz.planner.grammar.binding.focus import foci_of
from scope_ptz.planner.grammar.binding.noun_heads import bare_noun, head_noun, names_several
from scope_ptz.planner.grammar.execution.answer_sentences import is_not_understood
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.instruction_parser import parse
from scope_ptz.planner.grammar.parsing.parts.noun_phrases import is_noun_phrase
from scope_ptz.planner.grammar.parsing.parts.patterns import Match, full_match, match_start
from scope_ptz.planner.grammar.parsing.rewording.repairs import EDITING, NEW_AMOUNT, NEW_WAY

if TYPE_CHECKING:
    from scope_ptz.planner.base import PastTurn

_PAUSE = "(COMMA|STOP|DASH)"
_CLAIM = (
    rf"(FILLER|no|nope|{_PAUSE})* (?P<retraction>i_said|SELF (said|TELL-ED)|(it|that) should (be|have been)|"
    rf"should (be|have been)) {_PAUSE}*"
)
_NOT_THAT = rf"(FILLER|no|nope|{_PAUSE})* not (that|this|it|him|her|them|those|these) (one|ones)? {_PAUSE}+ (FILLER)*"
_CORRECTING = rf"({_NOT_THAT}|{_CLAIM}|{EDITING})"
_OTHER = "(in|DET)* (other|opposite) (way|direction|SIDE)|the_opposite_direction|the_other_direction|the_other_way|the_opposite_way"
_WRONG_WAY = (
    rf"(FILLER|no|nope|that|it|this|is|'s|was|DET|{_PAUSE})* (wrong_way|the_wrong_way|wrong (way|direction)) (FILLER|{_PAUSE})*"
)
_NO_OTHER_WAY = rf"(FILLER|oops|wait|{_PAUSE})* (no|nope|nah) (FILLER|wait|{_PAUSE})* ({_OTHER}) (AROUND|FILLER|{_PAUSE})*"
_OTHER_WAY = rf"(FILLER|AND|THEN|SAMEAMOUNT|{_PAUSE})* ({_OTHER}) (FILLER|AROUND|{_PAUSE})*"
_NEW_SIZE = "(DET|go|just|only|but|FILLER)* ((?P<little>LITTLE)|(?P<lot>LOT)|(?P<limit>LIMIT)) (FILLER)*"
_SIZE_IN_ANSWER = (
    r"((oh|oops|sorry|FILLER) (COMMA|DASH|STOP)*)* "
    r"(by|DET|AMOUNTISH|FILLER)* ((?P<number>NUM) (DEG|X|PERCENT)?|(?P<same>(SAMEAMOUNT|same (amount|angle)?|as_before) "
    r"(as before|as last_time|amount|as (much|far))?)|(?P<little>LITTLE)|(?P<lot>LOT)|(?P<limit>LIMIT)) (FILLER|AGAINWORD|STOP)*"
)
_ON_SIDE = "DET (one (on|to) DET ((?P<left>LEFT)|(?P<right>RIGHT)) (SIDE)?|((?P<left>LEFT)|(?P<right>RIGHT)) one)"
_DURATION = (
    rf"(?P<editing>{_CORRECTING})? (it|him|her|them|just|only|make|FILLER)* (?P<for>for)? (just|only)? (?P<number>NUM) "
    rf"(?P<unit>SECONDS|MINUTES)? (INSTEAD|FILLER|{_PAUSE})*"
)
_HESITATION = "(FILLER|wait|hang_on|hold_on|hang on|hold on)+"
_OTHER_NUMBER = "DET? (?P<which>ORDINAL) (one|PRESETNOUN)?"
_SIZES = {"little": "a bit", "lot": "a lot", "limit": "all the way"}
_UNITS = {"DEG": "degrees", "X": "times", "PERCENT": "percent"}
_VERBS = ("PAN", "TILT", "TURN", "ZOOM", "AIM", "SWITCH", "SHOW", "FIND", "COUNT", "TRACK", "SNAP", "READ")


def corrected_text(lexemes: Sequence[Lexeme], text: str, last: Command, *, was_rejected: bool = False) -> str | None:
    """Return the instruction that the user meant instead of the last command; None if the text does not correct it.

    Args:
        lexemes: The lexemes of the text.
        text: The user's text.
        last: The command that it may correct.
        was_rejected: Whether the user has rejected the command, and now says what to do instead, without "no" or "I meant".
    """
    move = single_move(last.steps)
    if rejects_for_other_way(lexemes) or (turns_the_other_way(lexemes) and not asks_for_another_move(lexemes)):
        return move.reversed().text if move is not None else None
    if move is not None and (instead := _move_instead(lexemes, text, move)) is not None:
        return instead.text
    editing = match_start(_CORRECTING, lexemes)
    size = editing.size if editing is not None else 0
    if size == 0 and not was_rejected:
        return None
    rest = _without_edges(lexemes[size:])
    if not rest or any(x.has("NOT", "OR") for x in rest):
        return None
    if full_match(_HESITATION, lexemes[:size]):
        return None  # "wait a bit", unlike "wait, 10"
    if _is_bare_no(lexemes[:size]) or _may_approve(lexemes[:size], rest):
        return None  # "no left" may forbid a turn
    if len(last.steps) == 1 and isinstance(last.steps[0], ast.GoToPreset):
        number = full_match(_OTHER_NUMBER, rest)
        return f"go to the {text[number['which'][0].start : number['which'][0].end]} preset" if number is not None else None
    if isinstance(last.steps[0] if len(last.steps) == 1 else None, ast.ZoomTo | ast.Track | ast.Count):
        return _with_other_thing(last.steps[0], text[rest[0].start : rest[-1].end], rest)
    if any(x.has(*_VERBS) for x in rest):
        command = text[rest[0].start : rest[-1].end]
        is_retracted = editing is not None and editing.has("retraction")
        is_move = move is not None and is_retracted and single_move(parse(command).steps or ()) is not None
        return command if is_move else None  # "sorry, pan left" may be another command
    changed = _changed_move(move, rest) if move is not None else None
    return changed.text if changed is not None else None


def thing_after_failure(lexemes: Sequence[Lexeme], text: str, last: Command, turn: PastTurn) -> str | None:
    """Return the last command for another thing if its own was not understood: "no, the van" after "zoom in on the lorrry".

    Args:
        lexemes: The lexemes of the text.
        text: The user's text, which may also name the thing without "no".
        last: The command of the last turn.
        turn: The last turn.
    """
    outcomes = [outcome for exchange in turn.exchanges for outcome in exchange.outcomes]
    if len(last.steps) != 1 or not outcomes or not all(is_not_understood(o.error or "") for o in outcomes):
        return None
    step, editing = last.steps[0], match_start(_CORRECTING, lexemes)
    rest = _without_edges(lexemes[editing.size if editing is not None else 0 :])
    if not isinstance(step, ast.ZoomTo | ast.Track | ast.Count) or not rest or any(x.has("NOT", "OR", *_VERBS) for x in rest):
        return None
    if editing is None and any(x.has("PRESET") for x in rest):
        return None  # "the gate" may be the preset
    thing = text[rest[0].start : rest[-1].end]
    if lexicon().concept(bare_noun(thing).lower()) is None:
        return None  # "a moment please", "no, bad idea"
    if editing is not None and not _is_bare_no(lexemes[: editing.size]) and all(x.has("FREE") for x in rest):
        return _about(step, f"the {thing}" if not isinstance(step, ast.Count) else thing)  # "no, road roller"
    return _with_other_thing(step, thing, rest)


def thing_beside_rejected(lexemes: Sequence[Lexeme], last: Command, turn: PastTurn) -> str | None:
    """Return the close-up of "no, the one on the right": of a thing to the right of the one that the camera zoomed in on.

    None for other texts, and if it is not known which single thing that was.
    """
    match = full_match(f"{_CORRECTING} {_ON_SIDE} (FILLER|INSTEAD|{_PAUSE})*", lexemes)
    if match is None or len(last.steps) != 1 or not isinstance(last.steps[0], ast.ZoomTo):
        return None
    rejected = foci_of([turn])[-1:]
    if not rejected or rejected[0].number != 1 or names_several(rejected[0].description):
        return None
    side = "left" if match.has("left") else "right"
    kind = head_noun(rejected[0].description)
    return f"zoom in on the {kind} to the {side} of the {rejected[0].description}"


def duration_in_answer(lexemes: Sequence[Lexeme], last: Command) -> str | None:
    """Return the last pursuit with another duration: "no, 10" or "for 10 seconds" after "follow him for 5 seconds"."""
    match = full_match(_DURATION, lexemes)
    if match is None or len(last.steps) != 1 or not isinstance(last.steps[0], ast.Track):
        return None
    if not (match.has("editing") or match.has("for") or match.has("unit")):
        return None
    if hesitates(lexemes):
        return None  # "hang on 5 minutes", unlike "wait, 10 seconds"
    thing = last.steps[0].thing
    followed = f"the {thing.text}" if thing.text else thing.pronoun or "it"
    unit = "minutes" if match.has("unit") and match["unit"][0].has("MINUTES") else "seconds"
    return f"follow {followed} for {match['number'][0].value:g} {unit}"


def hesitates(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether a text begins with a hesitation and no pause after it: "wait 10 seconds", unlike "wait, 10 seconds"."""
    editing = match_start(_CORRECTING, lexemes)
    return editing is not None and full_match(_HESITATION, lexemes[: editing.size]) is not None


def rejects_for_other_way(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether a text rejects the last move for the other direction: "wrong way", "no, the other way"."""
    return bool(full_match(_WRONG_WAY, lexemes) or full_match(_NO_OTHER_WAY, lexemes))


def repeats_amount(lexemes: Sequence[Lexeme], last: Command) -> bool:
    """Return whether a text corrects the last move to the amount that it had: "no, 2x" after "zoom in 2x"."""
    move, editing = single_move(last.steps), match_start(_CORRECTING, lexemes)
    rest = _without_edges(lexemes[editing.size :]) if editing is not None else ()
    if not rest or move is None or any(x.has("NOT", "OR", *_VERBS) for x in rest):
        return False
    return _changed_move(move, rest) == move


def turns_the_other_way(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether a text only asks for the other direction: "the other way", "and now the other way"."""
    return full_match(_OTHER_WAY, lexemes) is not None


def asks_for_another_move(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether "the other way" is asked for as a further move by the same amount: "now the other way"."""
    return any(x.word in {"now", "and", "then", "next"} or x.has("SAMEAMOUNT") for x in lexemes)


def size_in_answer(lexemes: Sequence[Lexeme], asked: SingleMove, last: SingleMove | None) -> SingleMove | None:
    """Return the move that was asked about, with the amount of the answer: "20", "by 20 degrees", "the same", "a bit".

    Args:
        lexemes: The lexemes of the answer.
        asked: The move whose amount was asked for.
        last: The move of the last command, which has "the same" amount.
    """
    match = full_match(_SIZE_IN_ANSWER, lexemes)
    if match is None:
        return None
    if match.has("same"):
        return SingleMove(asked.axis, asked.way, last.size) if last is not None and last.axis == asked.axis else None
    return _sized(asked, match, lexemes)


def _move_instead(lexemes: Sequence[Lexeme], text: str, move: SingleMove) -> SingleMove | None:
    """Return the move of "pan right instead"; None for other texts.

    A move about the axis of the corrected move has its amount if it states none itself.
    """
    rest = _without_edges(lexemes)
    if not rest or not any(x.has("INSTEAD") for x in lexemes) or any(x.has("NOT", "OR") for x in rest):
        return None
    wanted = single_move(parse(text[rest[0].start : rest[-1].end]).steps or ())
    if wanted is None or wanted.axis != move.axis or any(x.has("NUM", "LITTLE", "LOT", "LIMIT", "FRACTION") for x in rest):
        return wanted
    return SingleMove(wanted.axis, wanted.way, move.size)


def _changed_move(move: SingleMove, rest: Sequence[Lexeme]) -> SingleMove | None:
    """Return a move with another direction, another amount or both."""
    if any(x.word in {"one", "ones"} for x in rest):
        return None  # "no, the left one"
    if (match := full_match(NEW_WAY, rest)) is not None:
        return _sized(move.reversed(), match, rest) if match.has("number") else move.reversed()
    if (match := full_match(_NEW_SIZE, rest)) is not None:
        return _sized(move, match, rest)
    if (match := full_match(NEW_AMOUNT, rest)) is None:
        return None
    changed: SingleMove | None = move
    if match.has("way"):
        way = next(name for name in ("left", "right", "up", "down", "in", "out") if match["way"][0].has(name.upper()))
        is_same_axis = axis_of_way(way) == move.axis
        if not is_same_axis and not match.has("number"):
            return None  # "no, up" after "pan right 20" does not say how far
        changed = SingleMove(move.axis, way, move.size) if is_same_axis else towards(way)
    return _sized(changed, match, rest) if changed is not None and match.has("number") else changed


def _sized(move: SingleMove, match: Match, lexemes: Sequence[Lexeme]) -> SingleMove | None:
    """Return a move with the amount in a match."""
    if match.has("number"):
        unit = next((name for kind, name in _UNITS.items() if any(x.has(kind) for x in lexemes)), "")
        is_time = any(x.has("SECONDS", "MINUTES", "HOURS") for x in lexemes)
        return None if is_time else move.sized(match["number"][0].value, unit)
    size = next((words for name, words in _SIZES.items() if match.has(name)), None)
    return SingleMove(move.axis, move.way, size) if size is not None else None


def _with_other_thing(step: ast.Step, thing: str, lexemes: Sequence[Lexeme]) -> str | None:
    """Return the command for another thing: "zoom in on the red one"."""
    if isinstance(step, ast.ZoomTo) and lexemes[0].word in {"on", "onto"} and len(lexemes) > 1:
        lexemes, thing = lexemes[1:], thing[lexemes[1].start - lexemes[0].start :]  # "no, on the van"
    return _about(step, thing) if lexemes[0].has("DET") and len(lexemes) > 1 and is_noun_phrase(lexemes) else None


def _about(step: ast.Step, thing: str) -> str:
    """Return a command to zoom in on, follow or count a thing."""
    if isinstance(step, ast.ZoomTo):
        return f"zoom in on {thing}"
    if isinstance(step, ast.Track):
        return f"follow {thing} for {step.seconds:g} seconds"
    return f"count {thing}"


def _is_bare_no(editing: Sequence[Lexeme]) -> bool:
    """Return whether "no" stands directly before a word, so that it may belong to that word: "no left"."""
    return [x.word for x in editing] in (["no"], ["nope"], ["nah"])


def _may_approve(editing: Sequence[Lexeme], rest: Sequence[Lexeme]) -> bool:
    """Return whether "right" may mean "correct": "no, that's right", "that should be right"."""
    states = any(x.word in {"that", "is", "'s", "it", "be"} for x in rest) or any(x.word == "should" for x in editing)
    return states and rest[-1].has("RIGHT")


def _without_edges(lexemes: Sequence[Lexeme]) -> Sequence[Lexeme]:
    """Return lexemes without courtesy, "instead" and punctuation at their ends."""
    edge = ("STOP", "COMMA", "FILLER", "DASH", "INSTEAD")
    kept = [i for i, x in enumerate(lexemes) if not x.has(*edge)]
    return lexemes[kept[0] : kept[-1] + 1] if kept else ()
