"""Understand an instruction: parse it into steps, and resolve the names in them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from scope_ptz.english.grammar.numbers import NUMBER_WORDS
from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.english.grammar.questions.question_parser import parse_question
from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.answerable import answerable_questions, is_whole_question
from scope_ptz.planner.grammar.binding.earlier_moves.continuations import NOTHING_DONE, continuation_of
from scope_ptz.planner.grammar.binding.focus import foci_of
from scope_ptz.planner.grammar.binding.followups import (
    followup_of,
    is_return_to_centre,
    question_about_side,
    question_about_topic,
    question_in_other_direction,
)
from scope_ptz.planner.grammar.binding.names import UnresolvedError
from scope_ptz.planner.grammar.binding.offtopic import REFUSAL, is_harmful
from scope_ptz.planner.grammar.binding.question_text import is_request_for_total, lacks_noun
from scope_ptz.planner.grammar.binding.resolver import Resolver
from scope_ptz.planner.grammar.binding.small_talk import (
    NEVER_MIND,
    asks_to_repeat_reply,
    dismisses,
    question_about_rejection,
    recalled_message,
    reply_to_small_talk,
)
from scope_ptz.planner.grammar.binding.unknowable import why_unknowable
from scope_ptz.planner.grammar.consistency.check import (
    not_understood,
    objection,
    objection_to_forbidden,
    objection_to_loss,
    objection_to_wording,
)
from scope_ptz.planner.grammar.consistency.evidence import evidence_of
from scope_ptz.planner.grammar.lexing.lexer import lexemes_of
from scope_ptz.planner.grammar.parsing.instruction_parser import MAX_CHARS, Parsed, parse
from scope_ptz.planner.grammar.parsing.remark_detection.shorter_versions import MAX_SHORTENED_CHARS, shorter_versions
from scope_ptz.planner.grammar.parsing.remark_detection.versions import versions_without_remarks
from scope_ptz.planner.grammar.parsing.remark_detection.withdrawing_segments import withdrawing_segments
from scope_ptz.planner.grammar.parsing.rewording.plain_text import without_set_remarks, written_out
from scope_ptz.planner.grammar.parsing.rewording.withdrawn_parts import takes_back_unclearly

if TYPE_CHECKING:
    from scope_ptz.planner.base import PastTurn

_EXAMPLES = "'pan right 20 degrees', 'how many cars are there?', or 'zoom in on the sign and read it'"

_MULTIPLE = re.compile(r"\b(?:twice|double|half|triple|three times) (?:that|this)\b(?! \w+ing)\W*(?:$|and\b|then\b)", re.IGNORECASE)
_NUMBERS = "|".join(word for word in NUMBER_WORDS if word.isalpha() and word not in {"half", "twice", "double"})
_NAMED_AMOUNT = re.compile(rf"\d|\b(?:{_NUMBERS}|bit|lot|touch|quarter turn)\b", re.IGNORECASE)
"""An amount of which another may be a multiple: "left 10, then twice that"."""

_NO_CLOSE_UP = re.compile(r"\b(?:without (?:moving|zooming)|(?:don['’]?t|do not) (?:move|zoom)|no zoom)\b", re.IGNORECASE)
"""Words with which a picture of a thing is a picture of the current view."""

_IMPOSSIBLE = "I cannot"
"""The beginning of the questions about requests that were understood but cannot be carried out."""

_WHICH_CENTRE = 'Where is the centre? Please say "go home", or "point at 0 degrees" to pan back to 0.'
"""The question about "back to centre" in a conversation, which may be the home view, the straight-ahead view or an earlier one."""

_NO = re.compile(r"(?:no|nope|nah|no,? thanks|no,? thank you|no,? it['’]s fine|nothing)[.!]*", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Understanding:
    """The result of understanding an instruction: resolved steps, a clarifying question or a refusal."""

    steps: tuple[ast.Step, ...] = ()
    clarification: str | None = None
    refusal: str | None = None


def understand(instruction: str, presets: Sequence[str] | None, conversation: Sequence[PastTurn] = ()) -> Understanding:
    """Return the steps of an instruction, or a clarifying question or refusal. Never raises, whatever the text.

    Args:
        instruction: The user's text.
        presets: The camera's presets; None accepts preset names as written.
        conversation: The earlier turns.
    """
    if not instruction.strip():
        return Understanding(clarification=f"What shall I do? For example: {_EXAMPLES}.")
    if is_harmful(instruction):
        return Understanding(refusal=REFUSAL)
    if reply := reply_to_small_talk(instruction):
        return Understanding((ast.Reply(reply),))
    if dismisses(instruction):
        return Understanding((ast.Reply(NEVER_MIND),))
    if conversation and asks_to_repeat_reply(instruction):
        return Understanding((ast.Reply(conversation[-1].reply),))
    while conversation and asks_to_repeat_reply(conversation[-1].instruction):
        conversation = conversation[:-1]  # a question that was repeated can still be answered
    if recalled := recalled_message(instruction, [turn.instruction for turn in conversation]):
        return Understanding((ast.Reply(recalled),))
    if reason := why_unknowable(instruction):
        return Understanding(clarification=reason)
    preset_names = None if presets is None else tuple(presets)
    if _NO.fullmatch(instruction.strip()):
        return Understanding(clarification=NOTHING_DONE)
    continuation = continuation_of(instruction, conversation, preset_names or ())
    if (question := continuation.question or objection_to_wording(written_out(instruction), preset_names or ())) is not None:
        return Understanding(clarification=question)
    said = continuation.text
    if not conversation and lacks_noun(said):
        return Understanding(clarification="How many of what? Please name the things to count.")
    if conversation and is_return_to_centre(said):
        return Understanding(clarification=_WHICH_CENTRE)
    understanding = _read(said, preset_names, conversation)
    if understanding.steps and continuation.corrects:
        return Understanding((ast.Instead(understanding.steps),))
    if not understanding.steps:
        if question := question_about_rejection(instruction):
            return Understanding(clarification=question)
        if continuation.corrects:
            return understanding
        understanding = _read_without_remarks(said, understanding, preset_names, conversation)
    return _unless_taken_back(said, understanding, preset_names, conversation)


def _unless_taken_back(
    said: str, understanding: Understanding, preset_names: tuple[str, ...] | None, conversation: Sequence[PastTurn]
) -> Understanding:
    """Return an understanding, or a question if it moves the camera although a statement probably takes the command back.

    Words that introduce a correction ("tilt up 15. On second thoughts, make that 12") do not: that command is replaced.
    """
    if not evidence_of(understanding.steps).moves:
        return understanding
    for segment in withdrawing_segments(without_set_remarks(said), preset_names or ()):
        other = _read(segment.rest, preset_names, conversation)
        if not other.steps:
            other = _read_without_remarks(segment.rest, other, preset_names, conversation)
        if other.steps != understanding.steps:
            continue
        earlier = next((steps for text in segment.before if (steps := _read(text, preset_names, conversation).steps)), ())
        if not earlier or understanding.steps[: len(earlier)] == earlier:
            return Understanding(clarification=f'You said "{segment.text}", so I did nothing. Please say only what I should do.')
    return understanding


def _read_without_remarks(
    said: str, whole_text: Understanding, preset_names: tuple[str, ...] | None, conversation: Sequence[PastTurn]
) -> Understanding:
    """Return the steps of a shorter version of a text that was not understood; if no version is, the question about the whole text.

    Remarks with a known form may name directions and amounts ("Dave panned left 20 yesterday"). Those that only the model
    recognises may not: the steps must account for the whole text. A question with a reason, such as "I cannot wait for something to
    happen", stands.
    """
    whole, presets = written_out(said), preset_names or ()
    if len(whole) > MAX_SHORTENED_CHARS or takes_back_unclearly(whole, presets):
        return whole_text
    for shorter in shorter_versions(whole, presets):
        if (understanding := _read(shorter, preset_names, conversation)).steps:
            return understanding
    is_impossible = (whole_text.clarification or "").startswith(_IMPOSSIBLE)
    for shorter in versions_without_remarks(whole, presets) if not is_impossible else ():
        steps = (understanding := _read(shorter, preset_names, conversation)).steps
        if steps and not (objection_to_loss(whole, steps, presets) or objection_to_forbidden(whole, steps)):
            return understanding
    return whole_text


def _read(said: str, preset_names: tuple[str, ...] | None, conversation: Sequence[PastTurn]) -> Understanding:
    """Return the steps of a text, or a clarifying question."""
    parsed = parse(said, preset_names or ())
    try:
        steps = question_about_topic(said, preset_names or ()) or parsed.steps
        resolver = Resolver(preset_names, tuple(conversation))
        if conversation and is_request_for_total(said):
            counted = resolver.only_count()
            steps = (ast.Count((ast.Thing(counted),)),) if counted else (ast.Total(()),)
        if about_side := question_about_side(said, preset_names or ()):
            steps = about_side
        if in_other_direction := _question_in_other_direction(said, preset_names or (), conversation):
            steps = in_other_direction
        if conversation and steps and all(isinstance(step, ast.Report) for step in steps):
            steps = followup_of(said, preset_names or ()) or steps  # "look at both" reports no calculation
        if steps is None and conversation:
            steps = followup_of(said, preset_names or ())
        if steps is None:
            raise _question_about_unparsed(parsed)
        bound = _without_repeated_visits(resolver.bind(steps))
    except UnresolvedError as unresolved:
        return Understanding(clarification=str(unresolved))
    if _NO_CLOSE_UP.search(said):
        bound = tuple(replace(step, of=None) if isinstance(step, ast.Snap) else step for step in bound)
    if all(isinstance(step, ast.Forbid | ast.Report) for step in bound):
        return Understanding(clarification=NOTHING_DONE)
    if all(isinstance(step, ast.Sweep) and step.turn for step in bound):
        bound = (ast.Move((ast.Turn("pan", 1, ast.Amount("degrees", 360.0)),)),)
    if all(isinstance(step, ast.Sweep | ast.Forbid) for step in bound):
        return Understanding(clarification="What shall I look for when I look all around?")
    question = (
        objection(parsed.text, bound, preset_names or ())
        or objection_to_loss(parsed.said, bound, preset_names or ())
        or objection_to_forbidden(said, bound)
    )
    if question is None and not conversation and _MULTIPLE.search(said) and not _NAMED_AMOUNT.search(said):
        question = "How much is that? Please say the amount."
    if question:
        return Understanding(clarification=question)
    return Understanding(bound)


def _question_in_other_direction(
    said: str, presets: tuple[str, ...], conversation: Sequence[PastTurn]
) -> tuple[ast.Step, ...] | None:
    """Return the step of "and to the right?" directly after "what is to the left of the van?"; None for other texts."""
    done = [turn for turn in conversation if any(o.error is None for exchange in turn.exchanges for o in exchange.outcomes)]
    asked = [parse_question(focus.question) for focus in foci_of(done[-1:])[-1:] if focus.question]
    if not asked or not isinstance(asked[0], tree.Describe) or not any(isinstance(test, tree.Relation) for test in asked[0].tests):
        return None
    return question_in_other_direction(said, presets)


def _without_repeated_visits(steps: Sequence[ast.Step]) -> tuple[ast.Step, ...]:
    """Return steps in which a preset is not gone to twice in a row: "show me the paint hall. Sorry, the paint hall"."""
    return tuple(step for i, step in enumerate(steps) if not (i and isinstance(step, ast.GoToPreset) and step == steps[i - 1]))


def _question_about_unparsed(parsed: Parsed) -> UnresolvedError:
    """Return the clarifying question about an instruction that was not parsed."""
    if len(parsed.text) > MAX_CHARS:
        return UnresolvedError(f"That is too long: I read at most {MAX_CHARS} characters, so I did nothing. Please split it.")
    if parsed.unread:
        if is_whole_question(parsed.text, parsed.unread):
            return UnresolvedError(f"I did not understand that question. {answerable_questions(parsed.text)}")
        return UnresolvedError(not_understood(parsed.unread))
    if all(x.has("FILLER", "COMMA", "STOP", "QUESTION") for x in lexemes_of(parsed.text)):
        return UnresolvedError(f"What shall I do? For example: {_EXAMPLES}.")  # "hello"
    return UnresolvedError(f"I did not understand that. Please say it another way, for example: {_EXAMPLES}.")
