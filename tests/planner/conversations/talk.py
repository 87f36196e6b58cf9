"""Conversations with the built-in planner on a stage, turn by turn."""

from __future__ import annotations

from typing import Any

from scope_ptz.planner.base import PastTurn
from tests.planner.stage import Stage


def last_calls(*instructions: str, looks: tuple[Any, ...] = (1,)) -> tuple[list[tuple[str, dict[str, Any]]], str]:
    """Return the calls and the reply of the last turn of a conversation."""
    stage = Stage(looks)
    turns: tuple[PastTurn, ...] = ()
    for instruction in instructions:
        stage.calls.clear()
        turns = (*turns, stage.turn(instruction, turns))
    return list(stage.calls), turns[-1].reply


def talk(stage: Stage, *instructions: str) -> tuple[PastTurn, ...]:
    """Return the turns of a conversation. Afterwards, ``stage.calls`` holds the calls of the last turn."""
    turns: tuple[PastTurn, ...] = ()
    for instruction in instructions:
        stage.calls.clear()
        turns = (*turns, stage.turn(instruction, turns))
    return turns
