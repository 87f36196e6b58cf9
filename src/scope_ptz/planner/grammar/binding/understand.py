"""Understand an instruction: parse it into steps, and resolve the names in them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.binding.offtopic import REFUSAL, is_about_the_scene, is_harmful
from scope_ptz.planner.grammar.binding.resolver import Resolver, UnresolvedError
from scope_ptz.planner.grammar.binding.unparsed import unparsed_phrases
from scope_ptz.planner.grammar.consistency.check import not_understood, objection
from scope_ptz.planner.grammar.lexing.corrections import corrected
from scope_ptz.planner.grammar.lexing.settings_first import with_settings_first
from scope_ptz.planner.grammar.parsing.instruction_parser import MAX_CHARS, parse

if TYPE_CHECKING:
    from scope_ptz.planner.base import PastTurn

_EXAMPLES = "'pan right 20 degrees', 'how many cars are there?', or 'zoom in on the sign and read it'"

_ASKS = re.compile(
    r"(?:(?:and|so|ok|okay|please|hey|tell me|say|excuse me|sorry|now),? )*"
    r"(?:what|which|who|whom|whose|where|when|why|how|is|are|was|were|isn't|aren't|do|does|did|doesn't|has|have|any|anyone|anybody"
    r"|anything|can you (?:see|tell|read|spot|make out)|could you (?:see|tell)|(?:at|in|on) what|(?:in|on|at|from) which)\b",
    re.IGNORECASE,
)
"""The pattern for the beginning of a question."""


@dataclass(frozen=True, slots=True)
class Understanding:
    """The result of understanding an instruction: resolved steps, a clarifying question or a refusal."""

    steps: tuple[ast.Step, ...] = ()
    clarification: str | None = None
    refusal: str | None = None


def understand(instruction: str, presets: Sequence[str] | None, conversation: Sequence[PastTurn] = ()) -> Understanding:
    """Return the steps of an instruction, or a clarifying question or refusal. Never raises, whatever the text.

    Args:
        instruction: The text of the user.
        presets: The camera's presets; None accepts preset names as written.
        conversation: The earlier turns.
    """
    if not instruction.strip():
        return Understanding(clarification=f"What shall I do? For example: {_EXAMPLES}.")
    if is_harmful(instruction):
        return Understanding(refusal=REFUSAL)
    preset_names = None if presets is None else tuple(presets)
    if len(instruction) <= MAX_CHARS:
        instruction = with_settings_first(corrected(instruction, preset_names or ()))
    resolver = Resolver(preset_names, tuple(conversation))
    steps = parse(instruction, preset_names or ()).steps
    try:
        bound = resolver.bind(steps) if steps is not None else _as_question(resolver, instruction, preset_names or ())
    except UnresolvedError as unresolved:
        return Understanding(clarification=str(unresolved))
    if all(isinstance(step, ast.Forbid | ast.Report) for step in bound):
        return Understanding(clarification="Then I do nothing. What shall I do instead?")
    if all(isinstance(step, ast.Sweep) and step.turn for step in bound):
        bound = (ast.Move((ast.Turn("pan", 1, ast.Amount("degrees", 360.0)),)),)
    if all(isinstance(step, ast.Sweep | ast.Forbid) for step in bound):
        return Understanding(clarification="What shall I look for when I look all around?")
    if question := objection(instruction, bound, preset_names or ()):
        return Understanding(clarification=question)
    return Understanding(bound)


def _as_question(resolver: Resolver, instruction: str, presets: tuple[str, ...]) -> tuple[ast.Step, ...]:
    """Return the step that passes a question to perception when no grammar rule matches it."""
    text = instruction.strip()
    if len(text) > MAX_CHARS:
        raise UnresolvedError(f"That is too long: I read at most {MAX_CHARS} characters, so I did nothing. Please split it.")
    is_question = _ASKS.match(text) and text.endswith("?") and len(text.split()) > 1 and text.count("?") == 1
    if is_question and is_about_the_scene(text):
        return resolver.bind([ast.Ask(text)])
    if phrases := unparsed_phrases(text, presets):
        raise UnresolvedError(not_understood(phrases))
    raise UnresolvedError(f"I did not understand that. Please say it another way, for example: {_EXAMPLES}.")
