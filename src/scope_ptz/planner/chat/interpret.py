"""From a server's reply to a decision, by fixed rules:

- Calls are taken from the server's own field. When that is empty, they are taken from the text, in any notation of ``tool_text``.
- A reply without calls ends the run. It is a clarification when it begins with ``CLARIFY:``, or when it ends with a question before
any tool was called; a refusal when it begins with ``REFUSE:``; otherwise it is the answer.
- A reply that was cut off at the token limit is a planner error, except for calls that were complete.
"""

from __future__ import annotations

import re

from scope_ptz.endpoints.chat_replies import ChatReply
from scope_ptz.endpoints.failures import Attempt, FailureKind
from scope_ptz.errors import PlannerError
from scope_ptz.planner.base import CallTools, Decision, Finish, Served, State, ToolCall, Usage
from scope_ptz.planner.chat.reasoning_text import part
from scope_ptz.planner.chat.tool_text import FoundCalls, find_calls
from scope_ptz.planner.chat.written import Signatures, WrittenCall, plain_name, read_arguments

MOST_CALLS = 32
"""Calls executed in one step. A model that writes more is out of control."""

MOST_CHARS = 20_000
"""Characters kept of an answer, or of the text that accompanies calls. Longer texts are truncated and marked."""

_FULL = 0.98
_CONTROL = re.compile(r"<\|[\w ]{2,30}\|>|</s>|<(?:end|start)_of_turn>|<turn\|>")
_KIND = re.compile(r"\A[\s*_#>\"']*(?P<kind>CLARIFY|REFUSE)[\s*_]*:[\s*_]*", re.IGNORECASE)
_QUESTION = re.compile(r"\?[\s\"'*_)]*\Z")


def decide(reply: ChatReply, state: State, *, context_tokens: int | None = None) -> Decision:
    """Return the decision in a reply.

    Args:
        reply: The server's reply.
        state: The state that was sent.
        context_tokens: The size of the model's context, where it is known.

    Raises:
        PlannerError: The reply holds no decision; ``kind`` says why.
    """
    parted = part(reply.text, reply.reasoning)
    found = _native(reply, parted.text) or _in_text(parted.text, parted.reasoning, state)
    usage = Usage(input_tokens=reply.input_tokens, output_tokens=reply.output_tokens, cached_tokens=reply.cached_tokens)
    served = Served(
        model=reply.model,
        finish_reason=reply.finish_reason,
        first_token_s=reply.first_token_s,
        seconds=reply.seconds,
        calls_from=found.notation,
        attempts=reply.attempts,
    )
    text = _cut_short(_CONTROL.sub("", found.rest).strip())
    if found.calls:
        calls = _tool_calls(reply, found, len(state.history))
        return CallTools(calls=calls, thought=text, usage=usage, reasoning=parted.reasoning, served=served)
    if reply.finish_reason == "length":
        raise _cut_off(reply, context_tokens)
    if not text:
        what = "only reasoning and no answer" if parted.reasoning else "nothing"
        raise PlannerError(f"The planner's reply holds {what}.", kind=FailureKind.EMPTY.value, attempts=_useless(reply))
    kind, text = _ending(text, called=any(exchange.outcomes for exchange in state.history))
    return Finish.model_validate({"kind": kind, "text": text, "usage": usage, "reasoning": parted.reasoning, "served": served})


def _useless(reply: ChatReply) -> tuple[Attempt, ...]:
    """Return the attempts of a reply that holds no decision, with the tokens that it used."""
    cost = {"input_tokens": reply.input_tokens, "output_tokens": reply.output_tokens}
    return (*reply.attempts[:-1], *(last.model_copy(update=cost) for last in reply.attempts[-1:]))


def _native(reply: ChatReply, text: str) -> FoundCalls | None:
    if not reply.tool_calls:
        return None
    calls = []
    for raw in reply.tool_calls:
        arguments, malformed = read_arguments(raw.arguments_text)
        calls.append(WrittenCall(plain_name(raw.name), arguments, malformed))
    # Some servers leave the calls in the text after they have parsed them.
    return FoundCalls(tuple(calls), find_calls(text, Signatures({}), marked_only=True).rest, "native")


def _in_text(text: str, reasoning: str, state: State) -> FoundCalls:
    tools = Signatures.of(state.tools)
    found = find_calls(text, tools)
    if not found.calls and not text:
        # A model that calls before it closes its reasoning: the server took the call for reasoning, too.
        inside = find_calls(reasoning, tools, marked_only=True)
        if inside.calls:
            return FoundCalls(inside.calls, "", inside.notation)
    return found


def _tool_calls(reply: ChatReply, found: FoundCalls, step: int) -> tuple[ToolCall, ...]:
    ids = [raw.id for raw in reply.tool_calls] if found.notation == "native" else []
    calls = []
    for index, written in enumerate(found.calls[:MOST_CALLS]):
        problem = None
        if written.malformed is not None:
            call = f"The call of {written.name or 'a tool'}"
            problem = f"{call} cannot be read: its arguments must be a JSON object, got {written.malformed}"
        call_id = ids[index] if index < len(ids) and ids[index] else f"s{step + 1:04d}c{index + 1:03d}"
        calls.append(ToolCall(id=call_id, name=written.name, arguments=written.arguments, problem=problem))
    if (more := len(found.calls) - MOST_CALLS) > 0:
        last = found.calls[MOST_CALLS]
        problem = f"At most {MOST_CALLS} calls can be made in one step; this one and {more - 1} more were left out."
        calls.append(ToolCall(id=f"s{step + 1:04d}more", name=last.name, arguments=last.arguments, problem=problem))
    return tuple(calls)


def _cut_short(text: str) -> str:
    more = len(text) - MOST_CHARS
    return text if more <= 0 else f"{text[:MOST_CHARS]} (cut: it went on for {more} more characters)"


def _ending(text: str, *, called: bool) -> tuple[str, str]:
    prefix = _KIND.match(text)
    if prefix and (rest := text[prefix.end() :].strip()):
        return ("clarification" if prefix["kind"].upper() == "CLARIFY" else "refused"), rest
    return ("clarification" if not called and _QUESTION.search(text) else "answered"), text


def _cut_off(reply: ChatReply, context_tokens: int | None) -> PlannerError:
    """Return the error of a reply that was cut off: by a full context where that is certain, otherwise by one of two limits."""
    if context_tokens is not None and reply.input_tokens + reply.output_tokens >= context_tokens * _FULL:
        words = "The planner's reply was cut off because the model's context is full. Serve the model with a longer context."
        return PlannerError(words, kind=FailureKind.CONTEXT_OVERFLOW.value, attempts=_useless(reply))
    words = (
        f"The planner's reply was cut off at a limit of tokens ({reply.output_tokens} were written). "
        "Allow longer replies, or serve the model with a longer context."
    )
    return PlannerError(words, kind=FailureKind.CUT_OFF.value, attempts=_useless(reply))
