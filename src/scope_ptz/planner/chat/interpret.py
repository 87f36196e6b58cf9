"""Convert a server's reply to a decision, with fixed rules.

- Calls are taken from the reply's ``tool_calls`` field. If it is empty, they are parsed from the text, in any notation that
``tool_text`` supports.
- A reply without calls ends the run. It is a clarification if it begins with ``CLARIFY:``, or if it ends with a question before
any tool has been called; a refusal if it begins with ``REFUSE:``; and otherwise the answer.
- A reply that was cut off at the token limit is a planner error, unless it contains calls.
"""

from __future__ import annotations

import re

from scope_ptz.endpoints.chat_replies import ChatReply
from scope_ptz.endpoints.failures import Attempt, FailureKind
from scope_ptz.errors import PlannerError
from scope_ptz.planner.base import CallTools, Decision, Finish, Served, State, ToolCall, Usage
from scope_ptz.planner.chat.reasoning_text import separate_reasoning
from scope_ptz.planner.chat.tool_text import FoundCalls, find_calls
from scope_ptz.planner.chat.written_calls import Signatures, WrittenCall, plain_name, read_arguments, unreadable_arguments

MAX_CALLS = 32
"""Maximum number of calls in one step. Further calls are not executed, and the planner receives an error message."""

MAX_CHARS = 20_000
"""Maximum number of characters in an answer, or in the text that accompanies calls. Longer texts are truncated and marked."""

_FULL_FRACTION = 0.98  # a context that is filled to at least this fraction counts as full
_CONTROL_TOKENS = re.compile(r"<\|[\w ]{2,30}\|>|</s>|<(?:end|start)_of_turn>|<turn\|>")
_KIND_PREFIX = re.compile(r"\A[\s*_#>\"']*(?P<kind>CLARIFY|REFUSE)[\s*_]*:[\s*_]*", re.IGNORECASE)
_QUESTION = re.compile(r"\?[\s\"'*_)]*\Z")


def decide(reply: ChatReply, state: State, *, context_tokens: int | None = None) -> Decision:
    """Return the decision in a reply.

    Args:
        reply: The server's reply.
        state: The state that was sent.
        context_tokens: The size of the model's context in tokens; None if it is unknown.

    Raises:
        PlannerError: The reply contains no decision; ``kind`` states why.
    """
    separated = separate_reasoning(reply.text, reply.reasoning)
    parsed = _native_calls(reply, separated.text) or _text_calls(separated.text, separated.reasoning, state)
    usage = Usage(input_tokens=reply.input_tokens, output_tokens=reply.output_tokens, cached_tokens=reply.cached_tokens)
    served = Served(
        model=reply.model,
        finish_reason=reply.finish_reason,
        first_token_s=reply.first_token_s,
        seconds=reply.seconds,
        calls_from=parsed.notation,
        attempts=reply.attempts,
    )
    text = _truncate(_CONTROL_TOKENS.sub("", parsed.rest).strip())
    if parsed.calls:
        calls = _tool_calls(reply, parsed, len(state.history))
        return CallTools(calls=calls, thought=text, usage=usage, reasoning=separated.reasoning, served=served)
    if reply.finish_reason == "length":
        raise _cut_off_error(reply, context_tokens)
    if not text:
        content = "only reasoning and no answer" if separated.reasoning else "nothing"
        raise PlannerError(
            f"The planner's reply contains {content}.", kind=FailureKind.EMPTY.value, attempts=_attempts_with_usage(reply)
        )
    kind, text = _kind_and_text(text, called=any(exchange.outcomes for exchange in state.history))
    return Finish.model_validate({"kind": kind, "text": text, "usage": usage, "reasoning": separated.reasoning, "served": served})


def _attempts_with_usage(reply: ChatReply) -> tuple[Attempt, ...]:
    """Return the attempts that led to a reply without a decision. The last attempt includes the tokens that the reply used."""
    cost = {"input_tokens": reply.input_tokens, "output_tokens": reply.output_tokens}
    return (*reply.attempts[:-1], *(last.model_copy(update=cost) for last in reply.attempts[-1:]))


def _native_calls(reply: ChatReply, text: str) -> FoundCalls | None:
    if not reply.tool_calls:
        return None
    calls = []
    for raw in reply.tool_calls:
        arguments, malformed = read_arguments(raw.arguments_text)
        calls.append(WrittenCall(plain_name(raw.name), arguments, malformed))
    # Some servers leave the calls in the text after they have parsed them.
    return FoundCalls(tuple(calls), find_calls(text, Signatures({}), tagged_only=True).rest, "native")


def _text_calls(text: str, reasoning: str, state: State) -> FoundCalls:
    tools = Signatures.of(state.tools)
    parsed = find_calls(text, tools)
    if not parsed.calls and not text:
        # If a model calls a tool before closing its reasoning, the server returns the call as reasoning.
        inside = find_calls(reasoning, tools, tagged_only=True)
        if inside.calls:
            return FoundCalls(inside.calls, "", inside.notation)
    return parsed


def _tool_calls(reply: ChatReply, parsed: FoundCalls, step: int) -> tuple[ToolCall, ...]:
    ids = [raw.id for raw in reply.tool_calls] if parsed.notation == "native" else []
    calls = []
    for index, written in enumerate(parsed.calls[:MAX_CALLS]):
        problem = None if written.malformed is None else unreadable_arguments(written.name, written.malformed)
        call_id = ids[index] if index < len(ids) and ids[index] else f"s{step + 1:04d}c{index + 1:03d}"
        calls.append(ToolCall(id=call_id, name=written.name, arguments=written.arguments, problem=problem))
    if (excess := len(parsed.calls) - MAX_CALLS) > 0:
        last = parsed.calls[MAX_CALLS]
        problem = f"At most {MAX_CALLS} calls can be made in one step; this one and {excess - 1} more were left out."
        calls.append(ToolCall(id=f"s{step + 1:04d}more", name=last.name, arguments=last.arguments, problem=problem))
    return tuple(calls)


def _truncate(text: str) -> str:
    excess = len(text) - MAX_CHARS
    return text if excess <= 0 else f"{text[:MAX_CHARS]} (cut: it went on for {excess} more characters)"


def _kind_and_text(text: str, *, called: bool) -> tuple[str, str]:
    prefix = _KIND_PREFIX.match(text)
    if prefix and (rest := text[prefix.end() :].strip()):
        return ("clarification" if prefix["kind"].upper() == "CLARIFY" else "refused"), rest
    return ("clarification" if not called and _QUESTION.search(text) else "answered"), text


def _cut_off_error(reply: ChatReply, context_tokens: int | None) -> PlannerError:
    """Return the error for a reply that was cut off at the context's limit or, if that is not certain, at a token limit."""
    if context_tokens is not None and reply.input_tokens + reply.output_tokens >= context_tokens * _FULL_FRACTION:
        message = "The planner's reply was cut off because the model's context is full. Serve the model with a longer context."
        return PlannerError(message, kind=FailureKind.CONTEXT_OVERFLOW.value, attempts=_attempts_with_usage(reply))
    message = (
        f"The planner's reply was cut off at a token limit, after {reply.output_tokens} tokens. "
        "Allow longer replies, or serve the model with a longer context."
    )
    return PlannerError(message, kind=FailureKind.CUT_OFF.value, attempts=_attempts_with_usage(reply))
