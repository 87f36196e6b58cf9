"""Read instructions that continue or correct earlier turns: "a bit more", "the other way", "no, I meant 30", "the next preset"."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.binding.commands import Command, Continuation, correctable_command, standing_command
from scope_ptz.planner.grammar.binding.corrections import (
    asks_for_another_move,
    corrected_text,
    duration_in_answer,
    rejects_for_other_way,
    size_in_answer,
    thing_after_failure,
    thing_beside_rejected,
    turns_the_other_way,
)
from scope_ptz.planner.grammar.binding.overshoots import move_after_overshoot
from scope_ptz.planner.grammar.binding.repeated_returns import continued_return
from scope_ptz.planner.grammar.binding.single_moves import SingleMove, single_move, towards
from scope_ptz.planner.grammar.binding.small_talk import NEVER_MIND
from scope_ptz.planner.grammar.binding.zoom_factors import factor_for_last_zoom
from scope_ptz.planner.grammar.execution.camera_history import Effect
from scope_ptz.planner.grammar.lexing.lexer import Lexeme, lexemes_of
from scope_ptz.planner.grammar.parsing.instruction_parser import parse
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start

if TYPE_CHECKING:
    from scope_ptz.planner.base import PastTurn

_MAX_TURNS = 30  # maximum number of earlier turns that are considered
_NUMBER = r"(?P<number>\d+(?:\.\d+)?)(?: degrees?| deg|°)?"
_LITTLE = r"(?:just )?(?:a )?(?:little |tiny |wee )?(?:bit|touch|smidge|smidgen|tad|fraction|hair|little)"
_MORE = re.compile(
    rf"(?:and |now |ok |okay |yes |please )*(?:(?P<little>{_LITTLE}) (?:more|further)|(?:another|by another) (?P<small>{_LITTLE})"
    rf"|(?P<lot>a lot|lots|much|way) (?:more|further)"
    rf"|{_NUMBER} (?:more|further)|(?:another|by another) {_NUMBER.replace('number', 'added')})(?: please)?[.!]*",
    re.IGNORECASE,
)
_SAME = re.compile(r"(?:and |now |ok |okay |yes |please )*(?:more|further|keep going|some more)(?: please)?[.!]*", re.IGNORECASE)
_NEIGHBOUR = re.compile(
    r"(?:and |now |ok |okay |please )*(?:(?:go|move|switch|jump|on) (?:on )?to |show (?:me )?)?"
    r"(?:the )?(?P<which>next|following|previous)"
    r" (?:preset|one|position|view|place|stop)(?: please)?[.!?]*",
    re.IGNORECASE,
)
_PICTURES = re.compile(
    r"(?:and )?(?:another(?: one)?|one more|(?P<number>two|three|four|five|\d) more)(?: please)?[.!]*", re.IGNORECASE
)
_NOW = re.compile(r"(?:and |what about |how about )?now\?*", re.IGNORECASE)
_CORRECTION = re.compile(r"(?:no|nope|sorry|wait|oops|i meant|i mean|i said|make that|make it|actually)\b", re.IGNORECASE)
_ASKED = re.compile(r"By (?:how many degrees|what factor) shall I (?:pan|tilt|zoom) (left|right|up|down|in|out)\?")
"""The question about "the other way", which the next turn may answer with an amount."""

_NO_LEAD = "(FILLER|oh|COMMA|DASH|STOP)* (no|nope|nah|oops|wait|sorry) (FILLER|no|wait|sorry|COMMA|DASH|STOP)*"
"""Words before a command that reject the last one."""

_NO_PAUSE = "(FILLER|oh|COMMA|DASH|STOP)* (no|nope|nah) (FILLER|COMMA|DASH|STOP)* (COMMA|DASH|STOP) (FILLER)*"
"""Words before "more" that reject the last amount. Without a pause, "no more" asks for the opposite."""

_ZOOM_BACK = "(ZOOM|go|come|FILLER)* (back_out|back_in) (FILLER|AGAINWORD|STOP)*"
_ANY_WAY = "Which way do you mean: left, right, up, down, in or out?"

_SHARE = "(FILLER|AND|THEN)* ((?P<fraction>FRACTION)|(?P<twice>TWICE)) (of)? (that|it) (FILLER|AGAINWORD)*"
_MAX_LEXEMES = 16  # longer instructions neither continue nor correct an earlier turn
_DONE_WITHOUT_CALLS = (ast.CameraState, ast.Help)
NOTHING_DONE = "Then I do nothing. What shall I do instead?"
"""The reply to a bare "no" and to a command that is withdrawn."""


def continuation_of(instruction: str, conversation: Sequence[PastTurn], presets: tuple[str, ...]) -> Continuation:
    """Return what an instruction stands for. One that refers to no earlier turn stands for itself."""
    recent = conversation[-_MAX_TURNS:]
    return _continuation(instruction, recent, commands_of(recent, presets), presets) if recent else Continuation(instruction)


def commands_of(conversation: Sequence[PastTurn], presets: tuple[str, ...]) -> list[Command]:
    """Return the commands of the latest turns, oldest first."""
    recent = conversation[-_MAX_TURNS:]
    commands: list[Command] = []
    for i, turn in enumerate(recent):
        said = _continuation(turn.instruction, recent[:i], commands, presets)
        steps = parse(said.text, presets).steps or ()
        effect = _effect(turn, steps, commands, corrects=said.corrects)
        repeated = standing_command(commands) if steps and all(isinstance(step, ast.DoAgain) for step in steps) else None
        commands.append(Command(said.text, steps, effect) if repeated is None else Command(repeated.text, repeated.steps, effect))
    return commands


def _effect(turn: PastTurn, steps: Sequence[ast.Step], before: Sequence[Command], *, corrects: bool) -> Effect:
    """Return what came of a turn."""
    was_done = any(outcome.error is None for exchange in turn.exchanges for outcome in exchange.outcomes)
    steps = [step for step in steps if not isinstance(step, ast.Forbid)]  # "scrap that, go back"
    last = next((command.effect for command in reversed(before) if command.effect != "nothing"), "nothing")
    if was_done and steps and all(_returns(step, is_trip_back=last == "returned") for step in steps):
        return "returned"
    if was_done:
        return "corrected" if corrects else "done"
    if turn.reply in {NOTHING_DONE, NEVER_MIND} and before and before[-1].effect in {"done", "corrected"}:
        return "rejected"
    return "done" if steps and all(isinstance(step, _DONE_WITHOUT_CALLS) for step in steps) else "nothing"


def _returns(step: ast.Step, *, is_trip_back: bool) -> bool:
    """Return whether a step takes back the last command: "undo", "go back twice".

    With ``is_trip_back``, the camera was put back just before, so "and back again" is a new command.
    """
    if isinstance(step, ast.Repeat):
        return all(_returns(inner, is_trip_back=is_trip_back) for inner in step.body)
    return isinstance(step, ast.Back) and not (step.amount or step.turn or step.to_start or (step.again and is_trip_back))


def _continuation(
    instruction: str, conversation: Sequence[PastTurn], commands: Sequence[Command], presets: tuple[str, ...]
) -> Continuation:
    """Return what an instruction stands for, given the earlier turns and their commands."""
    said = instruction.strip()
    lexemes = lexemes_of(said, presets)
    if not conversation or not lexemes or len(lexemes) > _MAX_LEXEMES:
        return Continuation(instruction)
    if (wanted := _return_after_no(lexemes, said, presets)) is not None:
        return Continuation(wanted)
    if (lead := match_start(_NO_LEAD, lexemes)) is not None and full_match(_ZOOM_BACK, lexemes[lead.size :]):
        said = said[lexemes[lead.size].start :]  # "no, back out"
        lexemes = lexemes[lead.size :]
    if (returned := continued_return(lexemes, said, commands, conversation)) is not None:
        return returned
    last = standing_command(commands)
    if (answered := _answer_about_other_way(lexemes, conversation[-1], last)) is not None:
        return Continuation(answered)
    if (neighbour := _neighbour(said, conversation, presets)) is not None:
        return Continuation(f"go to preset {neighbour}")
    if (meant := _about_same_command(lexemes, said, commands, conversation)) is not None:
        return meant
    if (wrong := correctable_command(commands)) is not None:
        was_rejected = commands[-1].effect == "rejected"
        if (text := corrected_text(lexemes, said, wrong, was_rejected=was_rejected)) is not None:
            return Continuation(text, corrects=True)
    if rejects_for_other_way(lexemes):
        return Continuation(said, question=_ANY_WAY)
    if last is None:
        return Continuation(instruction)
    move = single_move(last.steps)
    if move is not None and turns_the_other_way(lexemes):
        return _other_way(said, lexemes, move)
    if (changed := _changed_instruction(said, last)) is not None:
        return Continuation(changed)
    if (text := _corrected_within(said, last, presets)) is not None:
        return Continuation(text, corrects=True)
    if (again := _same_axis_again(said, lexemes, commands, presets) or _share_of_zoom(lexemes, move)) is not None:
        return Continuation(again)
    return Continuation(_more(_without_no(lexemes, said), last) or _measured_by_last(said, last, presets) or instruction)


def _return_after_no(lexemes: Sequence[Lexeme], said: str, presets: tuple[str, ...]) -> str | None:
    """Return "go back" for "no, go back", which rejects the last command and says to take it back; None for others."""
    lead = match_start(_NO_LEAD, lexemes)
    if lead is None or lead.size >= len(lexemes):
        return None
    wanted = said[lexemes[lead.size].start :]
    steps = parse(wanted, presets).steps or ()
    return wanted if steps and all(_returns(step, is_trip_back=False) for step in steps) else None


def _about_same_command(
    lexemes: Sequence[Lexeme], said: str, commands: Sequence[Command], conversation: Sequence[PastTurn]
) -> Continuation | None:
    """Return what a factor, a duration, a thing or a complaint stands for after the last command; None for other instructions."""
    if (text := thing_after_failure(lexemes, said, commands[-1], conversation[-1])) is not None:
        return Continuation(text)
    last = standing_command(commands)
    turn = None if last is None else next(conversation[i] for i in reversed(range(len(commands))) if commands[i] is last)
    if (undershot := move_after_overshoot(lexemes, said, last, turn)) is not None:
        return undershot
    if last is None or turn is None:
        return None
    if (text := duration_in_answer(lexemes, last)) is not None:
        return Continuation(text)
    if (text := thing_beside_rejected(lexemes, last, turn)) is not None:
        return Continuation(text, corrects=True)
    return factor_for_last_zoom(lexemes, last, turn)


def _without_no(lexemes: Sequence[Lexeme], said: str) -> str:
    """Return an instruction without a "no" and the pause after it: "a bit more" for "no, a bit more"."""
    lead = match_start(_NO_PAUSE, lexemes)
    return said if lead is None or lead.size >= len(lexemes) else said[lexemes[lead.size].start :]


def _answer_about_other_way(lexemes: Sequence[Lexeme], turn: PastTurn, last: Command | None) -> str | None:
    """Return the move that the last turn asked about, if the instruction says how far: "20", "by 20 degrees", "the same"."""
    asked = _ASKED.fullmatch(turn.reply)
    if asked is None:
        return None
    answered = size_in_answer(lexemes, towards(asked[1]), single_move(last.steps) if last is not None else None)
    return answered.text if answered is not None else None


def _other_way(said: str, lexemes: Sequence[Lexeme], move: SingleMove) -> Continuation:
    """Return the move by the same amount in the other direction, or the question how far if that is not clear."""
    other = move.reversed()
    if asks_for_another_move(lexemes):
        return Continuation(other.text)  # "now the other way"
    amount = "By what factor" if other.axis == "zoom" else "By how many degrees"
    return Continuation(said, question=f"{amount} shall I {other.axis} {other.way}?")


def _more(said: str, last: Command) -> str | None:
    """Return the move of "a bit more" or "another 10" after a move or a close-up; None for other instructions."""
    move, match = single_move(last.steps), _MORE.fullmatch(said)
    if match is None and not _SAME.fullmatch(said):
        return None
    if move is None:
        is_close_up = len(last.steps) == 1 and isinstance(last.steps[0], ast.ZoomTo)
        move = towards("in") if is_close_up and (match is None or not (match["number"] or match["added"])) else None
        return None if move is None else f"{move.axis} {move.way} {'a lot' if match is not None and match['lot'] else 'a bit'}"
    if match is None:
        return "again"
    number = match["number"] or match["added"]
    if number and move.axis == "zoom":
        return None
    if number:
        return f"{move.axis} {move.way} {number} degrees"
    return f"{move.axis} {move.way} {'a lot' if match['lot'] else 'a bit'}"


def _measured_by_last(said: str, last: Command, presets: tuple[str, ...]) -> str | None:
    """Return the move of an instruction that needs the last move, about one axis, to be understood: "back 5"."""
    alone = parse(said, presets).steps
    if single_move(last.steps) is None or alone is None or not any(isinstance(step, ast.Unclear) for step in alone):
        return None
    together = parse(f"{last.text.rstrip('.!? ')}, {said}", presets).steps
    if together is None or len(together) != 2 or together[:1] != last.steps:
        return None
    move = single_move(together[1:])
    return move.text if move is not None else None


def _same_axis_again(said: str, lexemes: Sequence[Lexeme], commands: Sequence[Command], presets: tuple[str, ...]) -> str | None:
    """Return the amount that "pan left again" or "zoom back out" takes from the last move about that axis; None for others.

    In the same direction, it repeats that move. In the other direction, it undoes it.
    """
    is_again = any(x.has("AGAINWORD") or x.word in {"back_out", "back_in"} for x in lexemes)
    if not is_again or any(x.has("NUM", "LITTLE", "LOT", "LIMIT", "FRACTION") for x in lexemes):
        return None
    wanted = single_move(parse(said, presets).steps or ())
    if wanted is None:
        return None
    for command in reversed(commands):
        if command.effect not in {"done", "corrected"}:
            return None
        if wanted.axis == "zoom" and wanted.way == "out" and len(command.steps) == 1 and isinstance(command.steps[0], ast.ZoomTo):
            return "undo the zoom"
        if (move := single_move(command.steps)) is None or move.axis != wanted.axis:
            continue
        if move.way == wanted.way:
            return move.text if any(x.has("AGAINWORD") for x in lexemes) else None
        return "undo the zoom" if move.axis == "zoom" else move.reversed().text
    return None


def _share_of_zoom(lexemes: Sequence[Lexeme], move: SingleMove | None) -> str | None:
    """Return the zoom to a multiple of the current magnification: "half of that", "double that" after a zoom."""
    match = full_match(_SHARE, lexemes)
    if match is None or move is None or move.axis != "zoom":
        return None
    factor = match["fraction"][0].value if match.has("fraction") else 2.0
    share = SingleMove("zoom", "in" if factor >= 1 else "out", f"{max(factor, 1 / factor):g} times")
    return "undo the zoom" if share == move.reversed() else share.text


def _changed_instruction(said: str, last: Command) -> str | None:
    """Return the last instruction as changed by an addition ("two more", "and now?"); None for others."""
    if len(last.steps) != 1:
        return None
    (step,) = last.steps
    if isinstance(step, ast.Snap) and (more := _PICTURES.fullmatch(said)) is not None:
        return f"take {more['number'] or 'another'} {'pictures' if more['number'] else 'picture'}"
    if isinstance(step, ast.Count | ast.Ask) and _NOW.fullmatch(said):
        return last.text
    return None


def _corrected_within(said: str, last: Command, presets: tuple[str, ...]) -> str | None:
    """Return the last instruction with the part replaced that a correction names ("no, the yard"); None for others."""
    if len(last.steps) != 1:
        return None
    (step,) = last.steps
    is_aim = isinstance(step, ast.Move) and all(isinstance(part, ast.Aim) for part in step.parts)
    if _CORRECTION.match(said) and (is_aim or isinstance(step, ast.GoToPreset | ast.ZoomTo | ast.Count | ast.Track)):
        corrected = parse(f"{last.text.rstrip('.!? ')}, {said}", presets)
        if corrected.steps is not None and [type(other) for other in corrected.steps] == [type(step)]:
            return corrected.text
    return None


def _neighbour(said: str, conversation: Sequence[PastTurn], presets: tuple[str, ...]) -> str | None:
    """Return the preset before or after the one visited last, if the instruction asks for it; otherwise None."""
    match = _NEIGHBOUR.fullmatch(said)
    outcomes = [outcome for turn in conversation for exchange in turn.exchanges for outcome in exchange.outcomes]
    visited = [str(o.call.arguments.get("name")) for o in outcomes if o.call.name == "go_to_preset" and o.error is None]
    if match is None or not visited or visited[-1] not in presets:
        return None
    step = -1 if match["which"].lower() == "previous" else 1
    return presets[(presets.index(visited[-1]) + step) % len(presets)]
