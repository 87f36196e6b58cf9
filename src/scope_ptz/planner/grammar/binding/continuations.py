"""Read instructions that continue or correct earlier turns: "a bit more", "the other way", "no, I meant 30", "the next preset"."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.binding.commands import Command, correctable_command, standing_command
from scope_ptz.planner.grammar.binding.corrections import (
    asks_for_another_move,
    corrected_text,
    size_in_answer,
    turns_the_other_way,
)
from scope_ptz.planner.grammar.binding.focus import foci_of
from scope_ptz.planner.grammar.binding.single_moves import SingleMove, single_move, towards
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
    rf"|{_NUMBER} (?:more|further)|(?:another|by another) {_NUMBER.replace('number', 'added')})(?: please)?[.!]*",
    re.IGNORECASE,
)
_SAME = re.compile(r"(?:and |now |ok |okay |yes |please )*(?:more|further|keep going|some more)(?: please)?[.!]*", re.IGNORECASE)
_NEIGHBOUR = re.compile(
    r"(?:and |now |ok |okay |please )*(?:(?:go|move|switch|jump|on) (?:on )?to |show (?:me )?)?"
    r"(?:the )?(?P<which>next|following|previous)"
    r" (?P<noun>preset|one|position|view|place|stop)(?: please)?[.!?]*",
    re.IGNORECASE,
)
_PICTURES = re.compile(
    r"(?:and )?(?:another(?: one)?|one more|(?P<number>two|three|four|five|\d) more)(?: please)?[.!]*", re.IGNORECASE
)
_NOW = re.compile(r"(?:and |what about |how about )?now\?*", re.IGNORECASE)
_FOR = re.compile(r"for (.+ (?:seconds?|minutes?))[.!]*", re.IGNORECASE)
_CORRECTION = re.compile(r"(?:no|nope|sorry|wait|oops|i meant|i mean|i said|make that|make it|actually)\b", re.IGNORECASE)
_ASKED = re.compile(r"By (?:how many degrees|what factor) shall I (?:pan|tilt|zoom) (left|right|up|down|in|out)\?")
"""The question about "the other way", which the next turn may answer with an amount."""

_NO_LEAD = "(FILLER|oh|COMMA|DASH|STOP)* (no|nope|nah|oops|wait|sorry) (FILLER|no|wait|sorry|COMMA|DASH|STOP)*"
"""Words before a command that reject the last one."""

_SHARE = "(FILLER|AND|THEN)* ((?P<fraction>FRACTION)|(?P<twice>TWICE)) (of)? (that|it) (FILLER|AGAINWORD)*"
_MAX_LEXEMES = 16  # longer instructions neither continue nor correct an earlier turn
_DONE_WITHOUT_CALLS = (ast.CameraState, ast.Help)
FILLS_THE_VIEW = "A thing I zoom in on fills the view. Shall I do that, or zoom where I look now?"
"""The question about a factor for a zoom on a thing."""

NOTHING_DONE = "Then I do nothing. What shall I do instead?"
"""The reply to a bare "no" and to a command that is withdrawn."""


@dataclass(frozen=True, slots=True)
class Continuation:
    """What an instruction stands for, given the earlier turns.

    Attributes:
        text: The full instruction, such as "pan left a bit" for "a bit more".
        corrects: Whether it is to be carried out in place of the last command.
        question: The question to ask the user instead; None if the instruction is clear.
    """

    text: str
    corrects: bool = False
    question: str | None = None


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
    if turn.reply == NOTHING_DONE and before and before[-1].effect in {"done", "corrected"}:
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
    last = standing_command(commands)
    if (answered := _answer_about_other_way(lexemes, conversation[-1], last)) is not None:
        return Continuation(answered)
    if (neighbour := _neighbour(said, conversation, presets)) is not None:
        return Continuation(f"go to preset {neighbour}")
    if (wrong := correctable_command(commands)) is not None:
        was_rejected = commands[-1].effect == "rejected"
        if (meant := corrected_text(lexemes, said, wrong, was_rejected=was_rejected)) is not None:
            return Continuation(meant, corrects=True)
    if last is None:
        return Continuation(instruction)
    if _amount_after_close_up(lexemes, last):
        return Continuation(said, question=FILLS_THE_VIEW)
    move = single_move(last.steps)
    if move is not None and turns_the_other_way(lexemes):
        return _other_way(said, lexemes, move)
    if (changed := _changed_instruction(said, last)) is not None:
        return Continuation(changed)
    if (meant := _corrected_within(said, last, presets)) is not None:
        return Continuation(meant, corrects=True)
    if (again := _same_axis_again(said, lexemes, commands, presets) or _share_of_zoom(lexemes, move)) is not None:
        return Continuation(again)
    return Continuation(_more(said, move) or _measured_by_last(said, last, presets) or instruction)


def _return_after_no(lexemes: Sequence[Lexeme], said: str, presets: tuple[str, ...]) -> str | None:
    """Return "go back" for "no, go back", which rejects the last command and says to take it back; None for others."""
    lead = match_start(_NO_LEAD, lexemes)
    if lead is None or lead.size >= len(lexemes):
        return None
    wanted = said[lexemes[lead.size].start :]
    steps = parse(wanted, presets).steps or ()
    return wanted if steps and all(_returns(step, is_trip_back=False) for step in steps) else None


def _amount_after_close_up(lexemes: Sequence[Lexeme], last: Command) -> bool:
    """Return whether a correction only names a factor, such as "no, 2x", although the last command zoomed in on a thing."""
    is_close_up = len(last.steps) == 1 and isinstance(last.steps[0], ast.ZoomTo)
    return is_close_up and full_match(f"{_NO_LEAD} (make it|by|to|FILLER)* NUM (X|PERCENT) (FILLER|STOP)*", lexemes) is not None


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


def _more(said: str, move: SingleMove | None) -> str | None:
    """Return the move of "a bit more" or "another 10" after a move; None for other instructions."""
    match = _MORE.fullmatch(said)
    if move is None or (match is None and not _SAME.fullmatch(said)):
        return None
    if match is None:
        return "again"
    number = match["number"] or match["added"]
    if number and move.axis == "zoom":
        return None
    return f"{move.axis} {move.way} {number} degrees" if number else f"{move.axis} {move.way} a bit"


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
    """Return the last instruction as changed by an addition ("two more", "and now?", "for 20 seconds"); None for others."""
    if len(last.steps) != 1:
        return None
    (step,) = last.steps
    if isinstance(step, ast.Snap) and (more := _PICTURES.fullmatch(said)) is not None:
        return f"take {more['number'] or 'another'} {'pictures' if more['number'] else 'picture'}"
    if isinstance(step, ast.Count | ast.Ask) and _NOW.fullmatch(said):
        return last.text
    if isinstance(step, ast.Track) and step.thing.text and (time := _FOR.fullmatch(said)) is not None:
        return f"follow the {step.thing.text} for {time[1]}"
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
    if match["noun"] == "one" and foci_of(conversation[-1:]):
        return None  # "and the next one?" after a close-up of the first board
    step = -1 if match["which"].lower() == "previous" else 1
    return presets[(presets.index(visited[-1]) + step) % len(presets)]
