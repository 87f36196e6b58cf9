"""What the earlier turns of a conversation commanded, which command still stands, and what an instruction adds to it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from scope_ptz.planner.grammar.execution.camera_history import Effect
from scope_ptz.planner.grammar.instruction_tree import Step


@dataclass(frozen=True, slots=True)
class Command:
    """The command of an earlier turn.

    Attributes:
        text: The full instruction that the turn stands for, such as "pan left a bit" for "a bit more".
        steps: The steps of that instruction, with names as the user wrote them.
        effect: What came of it.
        repeats: Whether the turn only repeated the command before it ("again").
    """

    text: str
    steps: tuple[Step, ...]
    effect: Effect
    repeats: bool = False


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


def standing_command(commands: Sequence[Command]) -> Command | None:
    """Return the last command that was carried out, to which "again" and "a bit more" refer.

    Return None if that command was rejected or taken back, or if there is none, so that the user must be asked.
    """
    last = next((command for command in reversed(commands) if command.effect != "nothing"), None)
    return last if last is not None and last.effect in {"done", "corrected"} else None


def correctable_command(commands: Sequence[Command]) -> Command | None:
    """Return the command that "no, I meant 30" corrects: that of the last turn, or the one that the last turn rejected."""
    recent = commands[:-1] if commands and commands[-1].effect == "rejected" else commands
    return recent[-1] if recent and recent[-1].effect in {"done", "corrected"} else None
