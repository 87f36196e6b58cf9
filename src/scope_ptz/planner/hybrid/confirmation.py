"""Ask the user to confirm calls, and find out from the conversation what was confirmed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from scope_ptz import english
from scope_ptz.planner.base import Exchange, PastTurn, ToolCall
from scope_ptz.planner.confirmations import yes_or_no
from scope_ptz.planner.hybrid.call_words import named, read

_BEGIN = "Shall I do this: "
_END = "? Please answer yes or no."
_SEPARATOR = "; then "
_MAX_REASONS = 4  # further parts without grounds are not listed


@dataclass(frozen=True, slots=True)
class Proposal:
    """Calls about which the user was asked in the last turn.

    Attributes:
        calls: The calls.
        instruction: The instruction for which they were planned.
        texts: What the user said or confirmed: the instruction, and the calls of earlier confirmations in words.
        exchanges: The calls that were carried out for this instruction, with their results.
        first: The index of the turn with the instruction in the conversation.
    """

    calls: tuple[ToolCall, ...]
    instruction: str
    texts: tuple[str, ...]
    exchanges: tuple[Exchange, ...]
    first: int


def confirmation_question(calls: Sequence[ToolCall], missing: Sequence[str]) -> str:
    """Return the question that names calls in words.

    Args:
        calls: The calls, in the order in which they would be made.
        missing: The parts of the calls that stand neither in the instruction nor in earlier results.
    """
    reasons = english.listing(list(dict.fromkeys(missing))[:_MAX_REASONS])
    return f"You did not mention {reasons}. {_BEGIN}{_SEPARATOR.join(named(call) for call in calls)}{_END}"


def proposed_calls(reply: str) -> tuple[ToolCall, ...]:
    """Return the calls that a reply asks about; none for other replies."""
    start = reply.rfind(_BEGIN)
    if start < 0 or not reply.endswith(_END):
        return ()
    calls = [read(words) for words in _split(reply[start + len(_BEGIN) : -len(_END)])]
    found = [call for call in calls if call is not None]
    if len(found) < len(calls):
        return ()
    return tuple(
        ToolCall(id=f"confirmed-{i}", name=name, arguments=arguments) for i, (name, arguments) in enumerate(found, start=1)
    )


def _split(text: str) -> list[str]:
    """Split words of calls at the separator, but not inside quotation marks."""
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


def open_proposal(conversation: Sequence[PastTurn]) -> Proposal | None:
    """Return the calls about which the last turn asked; None if it did not ask about any.

    A turn that only confirms earlier calls continues the turn before it, so that the proposal belongs to the first instruction.
    """
    if not conversation or not (calls := proposed_calls(conversation[-1].reply)):
        return None
    first = len(conversation) - 1
    while first > 0 and yes_or_no(conversation[first].instruction) == "yes" and proposed_calls(conversation[first - 1].reply):
        first -= 1
    turns = conversation[first:]
    confirmed = [named(call) for turn in turns[:-1] for call in proposed_calls(turn.reply)]
    return Proposal(
        calls=calls,
        instruction=turns[0].instruction,
        texts=(turns[0].instruction, *confirmed),
        exchanges=tuple(exchange for turn in turns for exchange in turn.exchanges),
        first=first,
    )
