"""Counts that earlier turns made at presets, and the preset to which "there" refers after a turn that compared presets."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.binding.question_text import bare_comparison
from scope_ptz.planner.grammar.execution.comparison_sentences import presets_of_rank
from scope_ptz.planner.grammar.parsing.instruction_parser import parse

if TYPE_CHECKING:
    from scope_ptz.planner.base import PastTurn

_LEAVE_PRESET = frozenset({"adjust_ptz", "go_home", "zoom_to_object", "track_object"})


@dataclass(frozen=True, slots=True)
class EarlierCount:
    """A count of an earlier turn.

    Attributes:
        preset: The preset at which the camera was.
        description: The objects that were counted.
        number: How many there were.
        turn: The index of the turn in the conversation.
        complete: Whether there were no more; if false, ``number`` is a lower bound.
    """

    preset: str
    description: str
    number: int
    turn: int
    complete: bool = True


def last_preset(conversation: Sequence[PastTurn]) -> str:
    """Return the preset that was visited last; empty if none was."""
    outcomes = [o for turn in conversation for exchange in turn.exchanges for o in exchange.outcomes]
    visited = (
        str(o.call.arguments.get("name", "")) for o in reversed(outcomes) if o.call.name == "go_to_preset" and o.error is None
    )
    return next(visited, "")


def counts_at_presets(conversation: Sequence[PastTurn]) -> list[EarlierCount]:
    """Return the counts that were made at presets, oldest first."""
    counts: list[EarlierCount] = []
    at = ""  # the preset at which the camera was; empty elsewhere
    for index, turn in enumerate(conversation):
        for outcome in (outcome for exchange in turn.exchanges for outcome in exchange.outcomes):
            arguments = outcome.call.arguments
            if outcome.call.name == "go_to_preset" and outcome.error is None:
                at = str(arguments.get("name", ""))
            elif outcome.call.name in _LEAVE_PRESET:
                at = ""
            elif outcome.call.name == "count_objects" and at and outcome.result is not None:
                complete = bool(outcome.result.get("complete", True))
                counts.append(
                    EarlierCount(at, str(arguments.get("description", "")), int(outcome.result["count"]), index, complete)
                )
    return counts


def counts_of_tour(counts: Sequence[EarlierCount]) -> list[EarlierCount]:
    """Return the counts of the last turn that counted, if it counted the same objects at several presets; otherwise none."""
    if not counts:
        return []
    tour = [count for count in counts if count.turn == counts[-1].turn and count.description == counts[-1].description]
    return tour if len({count.preset for count in tour}) > 1 else []


def counts_to_add(counts: Sequence[EarlierCount]) -> list[EarlierCount]:
    """Return the counts of the same objects at several presets that "altogether" adds; nothing if there are none."""
    if not counts:
        return []
    if tour := counts_of_tour(counts):
        return tour if all(count.complete for count in tour) else []
    two = last_two_presets(counts)
    latest = {count.preset: count for count in counts if count.description == counts[-1].description}
    added = [latest[preset] for preset in two] if two is not None else []
    return added if all(count.complete for count in added) else []


def last_two_presets(counts: Sequence[EarlierCount]) -> tuple[str, str] | None:
    """Return the two presets at which the same objects were counted last, the earlier one first; None if there are no two."""
    for earlier in reversed(counts[:-1]):
        if earlier.preset != counts[-1].preset and earlier.description == counts[-1].description:
            return earlier.preset, counts[-1].preset
    return None


def earlier_winners(conversation: Sequence[PastTurn], presets: tuple[str, ...]) -> tuple[str, ...] | None:
    """Return the preset that won the comparison of an earlier turn, or several presets in a tie.

    The comparison is that of the last turn with tool calls, or of a later turn that compared the counts of earlier ones. None if
    these turns did not compare presets.
    """
    last = next((i for i in reversed(range(len(conversation))) if conversation[i].exchanges), None)
    if last is None:
        return None
    for index in range(len(conversation) - 1, last - 1, -1):
        compared = comparison_of_turn(conversation[: index + 1], presets)
        if compared is not None and not compared.any_of:
            counts = counts_at_presets(conversation[: index + 1])
            counts = counts_of_tour(counts) if index > last else [count for count in counts if count.turn == index]
            ranked = presets_of_rank({c.preset: c.number for c in counts}, compared.comparison, compared.rank)
            return tuple(ranked) or None
    return None


def comparison_of_turn(conversation: Sequence[PastTurn], presets: tuple[str, ...]) -> ast.WhichPreset | None:
    """Return the comparison of presets that the last turn of a conversation made; None if it made none.

    A short follow-up that visited several presets ("and forklifts?") made that of the turn before.
    """
    for end in range(len(conversation), 0, -1):
        steps = parse(conversation[end - 1].instruction, presets).steps
        if (compared := next((found for s in reversed(steps or ()) if (found := _comparison_of(s)) is not None), None)) is not None:
            return compared
        visited = {o.call.arguments.get("name") for e in conversation[end - 1].exchanges for o in e.outcomes}
        is_followup = steps is None or all(isinstance(step, ast.WhatAbout) for step in steps)
        if not is_followup or len(visited - {None}) < 2:
            return None
    return None


def left_view_won(conversation: Sequence[PastTurn], presets: tuple[str, ...]) -> bool:
    """Return whether the last turn with calls found more objects in the view that the camera then left than at a preset."""
    last = next((turn for turn in reversed(conversation) if turn.exchanges), None)
    steps = (parse(last.instruction, presets).steps or ()) if last is not None else ()
    if last is None or len(steps) != 1 or not isinstance(step := steps[0], ast.Compare) or step.second_place is None:
        return False
    outcomes = [outcome for exchange in last.exchanges for outcome in exchange.outcomes]
    numbers = [int(o.result["count"]) for o in outcomes if o.call.name == "count_objects" and o.result is not None]
    if len(numbers) != 2:
        return False
    return numbers[0] > numbers[1] if step.comparison == "more" else numbers[0] < numbers[1]


def _comparison_of(step: ast.Step) -> ast.WhichPreset | None:
    """Return a step as a comparison of presets, which "which has more?" also asks for; None for other steps."""
    if isinstance(step, ast.Ask) and (way := bare_comparison(step.question)) is not None:
        return ast.WhichPreset(ast.Thing(), way)
    return step if isinstance(step, ast.WhichPreset) else None
