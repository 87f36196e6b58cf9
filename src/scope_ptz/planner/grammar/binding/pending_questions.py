"""Complete the instruction whose pronoun the planner has asked about: "zoom in on him" after "the one on the left"."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.binding.focus import WHICH_ONE
from scope_ptz.planner.grammar.binding.followups import followup_of
from scope_ptz.planner.grammar.binding.question_pronouns import with_referents
from scope_ptz.planner.grammar.parsing.instruction_parser import parse

if TYPE_CHECKING:
    from scope_ptz.planner.base import PastTurn

Pending = ast.ZoomTo | ast.Track | ast.Read | ast.Ask


def pending_step(conversation: Sequence[PastTurn], presets: tuple[str, ...]) -> Pending | None:
    """Return the step that waits for the answer to "which of the 3 people do you mean?"; None if nothing waits."""
    if not conversation or conversation[-1].exchanges or not conversation[-1].reply.startswith(WHICH_ONE):
        return None
    asked = conversation[-1].instruction
    steps = parse(asked, presets).steps or followup_of(asked, presets) or ()
    return steps[0] if len(steps) == 1 and isinstance(steps[0], Pending) else None


def with_thing(step: Pending, description: str) -> Pending:
    """Return a waiting step about the thing that the user has named."""
    if isinstance(step, ast.Ask):
        return replace(step, question=with_referents(step.question, lambda _: description))
    return replace(step, thing=ast.Thing(description, definite=True))
