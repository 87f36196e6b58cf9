"""Find the preset to which "there" refers after a turn that compared presets."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.binding.question_text import bare_comparison
from scope_ptz.planner.grammar.execution.comparison_sentences import presets_of_rank
from scope_ptz.planner.grammar.parsing.instruction_parser import parse

if TYPE_CHECKING:
    from scope_ptz.planner.base import PastTurn


def earlier_winners(conversation: Sequence[PastTurn], presets: tuple[str, ...]) -> tuple[str, ...] | None:
    """Return the preset that won the comparison of the last turn with tool calls, or several presets in a tie.

    None if that turn did not compare presets.
    """
    last = next((turn for turn in reversed(conversation) if turn.exchanges), None)
    steps = parse(last.instruction, presets).steps if last is not None else None
    compared = next((found for step in reversed(steps or ()) if (found := _comparison_of(step)) is not None), None)
    if last is None or compared is None or compared.any_of:
        return None
    counts: dict[str, int] = {}
    at = ""
    for outcome in (outcome for exchange in last.exchanges for outcome in exchange.outcomes):
        if outcome.call.name == "go_to_preset":
            at = str(outcome.call.arguments.get("name", ""))
        elif outcome.call.name == "count_objects" and at and outcome.result is not None:
            counts[at] = int(outcome.result["count"])
    return tuple(presets_of_rank(counts, compared.comparison, compared.rank)) or None


def _comparison_of(step: ast.Step) -> ast.WhichPreset | None:
    """Return a step as a comparison of presets, which "which has more?" also asks for; None for other steps."""
    if isinstance(step, ast.Ask) and (way := bare_comparison(step.question)) is not None:
        return ast.WhichPreset(ast.Thing(), way)
    return step if isinstance(step, ast.WhichPreset) else None
