"""Ask the user to confirm calls, and find the confirmed calls in the conversation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from scope_ptz import english
from scope_ptz.planner.base import Exchange, PastTurn, ToolCall
from scope_ptz.planner.confirmations import yes_or_no
from scope_ptz.planner.hybrid.call_words import call_from_words, call_in_words

_BEGIN = "Shall I do this: "
_END = "? Please answer yes or no."
_SEPARATOR = "; then "
_MAX_REASONS = 4  # maximum number of unsupported parts to list


@dataclass(frozen=True, slots=True)
class Proposal:
    """The calls that the user was asked to confirm in the last turn.

    Attributes:
        instruction: The instruction for which the calls were planned.
        texts: The instruction, and the descriptions of the calls that the user confirmed earlier.
        exchanges: The calls already carried out for this instruction, with their results.
        instruction_index: Index, in the conversation, of the turn with the instruction.
    """

    calls: tuple[ToolCall, ...]
    instruction: str
    texts: tuple[str, ...]
    exchanges: tuple[Exchange, ...]
    instruction_index: int


def confirmation_question(calls: Sequence[ToolCall], unsupported: Sequence[str]) -> str:
    """Return the question that asks the user to confirm calls.

    Args:
        calls: The calls, in order.
        unsupported: The parts of the calls that neither the instruction nor earlier results support.
    """
    reasons = english.listing(list(dict.fromkeys(unsupported))[:_MAX_REASONS])
    return f"You did not mention {reasons}. {_BEGIN}{_SEPARATOR.join(call_in_words(call) for call in calls)}{_END}"


def proposed_calls(reply: str) -> tuple[ToolCall, ...]:
    """Return the calls that a reply asks the user to confirm; empty for other replies."""
    start = reply.rfind(_BEGIN)
    if start < 0 or not reply.endswith(_END):
        return ()
    calls = [call_from_words(words) for words in _split(reply[start + len(_BEGIN) : -len(_END)])]
    found = [call for call in calls if call is not None]
    if len(found) < len(calls):
        return ()
    return tuple(
        ToolCall(id=f"confirmed-{i}", name=name, arguments=arguments) for i, (name, arguments) in enumerate(found, start=1)
    )


def _split(text: str) -> list[str]:
    """Split call descriptions at the separator, but not inside quotation marks."""
    parts, quoted, start, i = list[str](), False, 0, 0
    while i < len(text):
        if text[i] == "\\" and quoted:
            i += 1
        elif text[i] == '"':
            quoted = not quoted
        elif not quoted and text.startswith(_SEPARATOR, i):
            parts.append(text[start:i])
            i += len(_SEPARATOR) - 1
            start = i + 1
        i += 1
    return [*parts, text[start:]]


def pending_proposal(conversation: Sequence[PastTurn]) -> Proposal | None:
    """Return the proposal that is waiting for the user's confirmation; None if the last turn proposed no calls.

    A turn that only confirms calls continues the turn before it, so a proposal made in it belongs to the
    instruction with which these turns began.
    """
    if not conversation or not (calls := proposed_calls(conversation[-1].reply)):
        return None
    first = len(conversation) - 1
    while first > 0 and yes_or_no(conversation[first].instruction) == "yes" and proposed_calls(conversation[first - 1].reply):
        first -= 1
    turns = conversation[first:]
    confirmed = [call_in_words(call) for turn in turns[:-1] for call in proposed_calls(turn.reply)]
    return Proposal(
        calls=calls,
        instruction=turns[0].instruction,
        texts=(turns[0].instruction, *confirmed),
        exchanges=tuple(exchange for turn in turns for exchange in turn.exchanges),
        instruction_index=first,
    )
