"""Read instructions that continue or correct earlier turns: "a bit more", "the other way", "no, I meant 30", "the next preset"."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import takewhile
from typing import TYPE_CHECKING

from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.binding.earlier_moves.commands import Command, Continuation, correctable_command, standing_command
from scope_ptz.planner.grammar.binding.earlier_moves.corrections import (
    asks_for_another_move,
    corrected_text,
    duration_in_answer,
    hesitates,
    rejects_for_other_way,
    repeats_amount,
    size_in_answer,
    thing_after_failure,
    thing_beside_rejected,
    turns_the_other_way,
)
from scope_ptz.planner.grammar.binding.earlier_moves.further_moves import (
    measured_by_last,
    more,
    next_thing,
    same_axis_again,
    share_of_turn,
    share_of_zoom,
)
from scope_ptz.planner.grammar.binding.earlier_moves.overshoots import move_after_overshoot
from scope_ptz.planner.grammar.binding.earlier_moves.repeated_returns import continued_return
from scope_ptz.planner.grammar.binding.earlier_moves.single_moves import SingleMove, single_move, towards
from scope_ptz.planner.grammar.binding.earlier_moves.zoom_factors import factor_for_last_zoom
from scope_ptz.planner.grammar.binding.focus import foci_of
from scope_ptz.planner.grammar.binding.small_talk import NEVER_MIND
from scope_ptz.planner.grammar.execution.camera_history import Effect
from scope_ptz.planner.grammar.lexing.lexer import Lexeme, lexemes_of
from scope_ptz.planner.grammar.parsing.instruction_parser import parse
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start

if TYPE_CHECKING:
    from scope_ptz.planner.base import PastTurn

_MAX_TURNS = 30  # maximum number of earlier turns that are considered
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
_CORRECTION = re.compile(r"(?:no|nope|sorry|wait|oops|i meant|i mean|i said|make that|make it|actually)\b", re.IGNORECASE)
_ASKED = re.compile(r"By (?:how many degrees|what factor) shall I (?:pan|tilt|zoom) (left|right|up|down|in|out)\?")
"""The question about "the other way", which the next turn may answer with an amount."""

_ASKED_WAY = re.compile(r"Shall I (?:turn|tilt) (left|up) or (right|down)\?")
"""The question about a turn without a direction, which the next turn may answer with one."""

_ANSWERED_WAY = (
    "(FILLER|COMMA|AND|what_about|how_about|to|DET)* ((?P<left>LEFT)|(?P<right>RIGHT)|(?P<up>UP)|(?P<down>DOWN)) "
    "(SIDE|FILLER|THEN|STOP|QUESTION|COMMA)*"
)
_ASKED_SHARE = re.compile(r"Shall I (?P<move>(?:pan|tilt) \w+ [\d.]+ degrees) instead, or [\d.]+ degrees more\?")
"""The question about "half of that", which the next turn may answer with "instead" or "more"."""

_NO_LEAD = "(FILLER|oh|COMMA|DASH|STOP)* (no|nope|nah|oops|wait|sorry) (FILLER|no|wait|sorry|COMMA|DASH|STOP)*"
"""Words before a command that reject the last one."""

_INSTEAD_OR_MORE = "(FILLER|COMMA)* ((?P<number>NUM) DEG?)? (INSTEAD|more|MORE|further) (FILLER|COMMA|STOP)*"
_ZOOM_BACK = "(ZOOM|go|come|FILLER)* (back_out|back_in) (FILLER|AGAINWORD|STOP)*"
_ANY_WAY = "Which way do you mean: left, right, up, down, in or out?"

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
        text, steps = (said.text, steps) if repeated is None else (repeated.text, repeated.steps)
        commands.append(Command(text, steps, effect, repeats=repeated is not None))
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
        return "rejected" if turn.reply == NOTHING_DONE else "dismissed"
    if turn.reply == NEVER_MIND and before and before[-1].effect == "rejected":
        return "dismissed"
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
        instruction = said = said[lexemes[lead.size].start :]  # "no, back out"
        lexemes = lexemes[lead.size :]
    if (returned := continued_return(lexemes, said, commands, conversation)) is not None:
        return returned
    last = standing_command(commands)
    if (answered := _answer_about_other_way(lexemes, conversation[-1], last)) is not None:
        return Continuation(answered)
    if (turned := _answer_about_way(lexemes, conversation[-1])) is not None:
        return Continuation(turned)
    if (share := _ASKED_SHARE.fullmatch(conversation[-1].reply)) is not None and (answer := full_match(_INSTEAD_OR_MORE, lexemes)):
        axis, way = share["move"].split(" ")[:2]
        text = f"{axis} {way} {answer['number'][0].value:g} degrees" if answer.has("number") else share["move"]
        return Continuation(text, corrects=any(x.has("INSTEAD") for x in lexemes))
    if (neighbour := _neighbour(said, conversation, presets)) is not None:
        return Continuation(f"go to preset {neighbour}")
    if (meant := _about_same_command(lexemes, said, commands, conversation)) is not None:
        return meant
    if (wrong := correctable_command(commands)) is not None:
        if wrong.repeats and wrong is commands[-1] and repeats_amount(lexemes, wrong):
            return Continuation(_return_before_repetitions(commands))
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
    if (question := share_of_turn(lexemes, move)) is not None:
        return Continuation(said, question=question)
    if (changed := next_thing(lexemes, said, last) or _changed_instruction(said, last)) is not None:
        return Continuation(changed)
    if (text := _corrected_within(lexemes, said, last, presets)) is not None:
        return Continuation(text, corrects=True)
    if (again := same_axis_again(said, lexemes, commands, presets) or share_of_zoom(lexemes, move)) is not None:
        return Continuation(again)
    return Continuation(more(lexemes, said, last) or measured_by_last(said, last, presets) or instruction)


def _return_after_no(lexemes: Sequence[Lexeme], said: str, presets: tuple[str, ...]) -> str | None:
    """Return "go back" for "no, go back", which rejects the last command and says to take it back; None for others."""
    lead = match_start(_NO_LEAD, lexemes)
    if lead is None or lead.size >= len(lexemes):
        return None
    wanted = said[lexemes[lead.size].start :]
    steps = parse(wanted, presets).steps or ()
    return wanted if steps and all(_returns(step, is_trip_back=False) for step in steps) else None


def _return_before_repetitions(commands: Sequence[Command]) -> str:
    """Return the instruction that takes back the repetitions of a move: "no, 2x" after "zoom in 2x", "again" means 2x in all."""
    repetitions = len(list(takewhile(lambda command: command.repeats, reversed(commands))))
    return "undo" if repetitions == 1 else f"go back {repetitions} times"


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


def _answer_about_other_way(lexemes: Sequence[Lexeme], turn: PastTurn, last: Command | None) -> str | None:
    """Return the move that the last turn asked about, if the instruction says how far: "20", "by 20 degrees", "the same"."""
    asked = _ASKED.fullmatch(turn.reply)
    if asked is None:
        return None
    answered = size_in_answer(lexemes, towards(asked[1]), single_move(last.steps) if last is not None else None)
    return answered.text if answered is not None else None


def _answer_about_way(lexemes: Sequence[Lexeme], turn: PastTurn) -> str | None:
    """Return the move that answers "shall I turn left or right?": "what about left?"; None for others."""
    asked, match = _ASKED_WAY.fullmatch(turn.reply), full_match(_ANSWERED_WAY, lexemes)
    if asked is None or match is None:
        return None
    return next((towards(way).text for way in asked.groups() if match.has(way)), None)


def _other_way(said: str, lexemes: Sequence[Lexeme], move: SingleMove) -> Continuation:
    """Return the move by the same amount in the other direction, or the question how far if that is not clear."""
    other = move.reversed()
    if asks_for_another_move(lexemes):
        return Continuation(other.text)  # "now the other way"
    amount = "By what factor" if other.axis == "zoom" else "By how many degrees"
    return Continuation(said, question=f"{amount} shall I {other.axis} {other.way}?")


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


def _corrected_within(lexemes: Sequence[Lexeme], said: str, last: Command, presets: tuple[str, ...]) -> str | None:
    """Return the last instruction with the part replaced that a correction names ("no, the yard"); None for others."""
    if len(last.steps) != 1:
        return None
    (step,) = last.steps
    if isinstance(step, ast.Track) and hesitates(lexemes):
        return None
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
