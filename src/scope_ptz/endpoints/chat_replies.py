"""Assemble a ``ChatReply`` from an OpenAI-style completion, streamed or not.

Common deviations from the format are accepted. An empty reply raises ``ServerFailure``.
"""

from __future__ import annotations

import json
from typing import Any

from pydantic import BaseModel, ConfigDict

from scope_ptz.endpoints.bodies import safe_text
from scope_ptz.endpoints.endpoint import Endpoint
from scope_ptz.endpoints.failures import Attempt, FailureKind, ServerFailure, scrub


class RawToolCall(BaseModel):
    """A tool call as the server returned it. ``arguments_text`` may be invalid JSON."""

    model_config = ConfigDict(frozen=True)

    id: str
    name: str
    arguments_text: str


class ChatReply(BaseModel):
    """A chat model's reply.

    Attributes:
        reasoning: The reasoning that the server returned in a separate field.
        first_token_s: Seconds to the first token; None if the reply was not streamed.
    """

    model_config = ConfigDict(frozen=True)

    text: str = ""
    reasoning: str = ""
    tool_calls: tuple[RawToolCall, ...] = ()
    finish_reason: str | None = None
    input_tokens: int = 0
    output_tokens: int = 0
    cached_tokens: int = 0
    first_token_s: float | None = None
    seconds: float = 0.0
    model: str = ""
    attempts: tuple[Attempt, ...] = ()


class ReplyAssembler:
    """Assembles a reply from its chunks. A reply that is not streamed is a single chunk."""

    def __init__(self, endpoint: Endpoint) -> None:
        self.endpoint = endpoint
        self.finish_reason: str | None = None
        self.model = ""
        self.has_choice = False
        self.chunk_count = 0
        self._text: list[str] = []
        self._reasoning: list[str] = []
        self._calls: list[dict[str, str]] = []
        self._slots: dict[Any, int] = {}
        self._usage: dict[str, Any] = {}

    def add(self, data: dict[str, Any]) -> bool:
        """Add a completion or a chunk. Return whether it contained text, reasoning or tool calls."""
        self.chunk_count += 1
        self.model = self.model or _text_of(data.get("model"))
        self._usage = _object_of(data.get("usage")) or self._usage
        choices = data.get("choices")
        if choices is not None and not isinstance(choices, list):
            raise self._malformed_reply("'choices' is not a list")
        choice = choices[0] if choices else None
        if choice is None:
            return False
        if not isinstance(choice, dict):
            raise self._malformed_reply("a choice is not an object")
        self.has_choice = True
        self.finish_reason = _text_of(choice.get("finish_reason")) or self.finish_reason
        delta = choice.get("delta")
        message = delta or choice.get("message")
        return self._add_message(message, whole=not delta) if isinstance(message, dict) else False

    def _add_message(self, message: dict[str, Any], *, whole: bool) -> bool:
        text = self._content(message.get("content")) or _text_of(message.get("refusal"))
        reasoning = _text_of(message.get("reasoning_content")) or _text_of(message.get("reasoning"))
        calls = message.get("tool_calls") or []
        if not isinstance(calls, list):
            raise self._malformed_reply("'tool_calls' is not a list")
        if not calls and message.get("function_call"):  # the predecessor of ``tool_calls``
            calls = [{"index": 0, "function": message["function_call"]}]
        self._text.append(text)
        self._reasoning.append(reasoning)
        for call in calls:
            self._add_call(call, whole=whole)
        return bool(text or reasoning or calls)

    def _content(self, content: Any) -> str:
        if content is None or isinstance(content, str):
            return content or ""
        if isinstance(content, list):  # a list of content parts, as in requests
            return "".join(_text_of(part.get("text")) for part in content if isinstance(part, dict))
        raise self._malformed_reply("'content' is not text")

    def _add_call(self, call: Any, *, whole: bool) -> None:
        function = _object_of(call.get("function")) if isinstance(call, dict) else None
        if function is None:
            raise self._malformed_reply("a tool call is not an object")
        index, call_id, name = call.get("index"), _text_of(call.get("id")), _text_of(function.get("name"))
        raw_arguments = function.get("arguments")
        arguments = raw_arguments if isinstance(raw_arguments, str) else "" if raw_arguments is None else json.dumps(raw_arguments)
        slot = None if whole else self._slot(index, call_id, name, arguments)
        if slot is None:
            slot = len(self._calls)
            self._calls.append({"id": "", "name": "", "arguments": ""})
            if isinstance(index, int):
                self._slots[index] = slot
        stored = self._calls[slot]
        stored["id"] = stored["id"] or call_id
        stored["name"] = stored["name"] or name
        stored["arguments"] += arguments

    def _slot(self, index: Any, call_id: str, name: str, arguments: str) -> int | None:
        """Return the index in ``_calls`` of the call that a chunk continues; None if the chunk starts a new call.

        The chunks of a call should share an index, but some servers send no index, use the same index for every call, or repeat the
        id and name in each chunk.
        """
        slot = self._slots.get(index) if isinstance(index, int) else len(self._calls) - 1 if self._calls else None
        if slot is None or not name:
            return slot
        stored = self._calls[slot]
        is_new_call = (stored["id"] and call_id and stored["id"] != call_id) or (stored["name"] and stored["name"] != name)
        return None if is_new_call or (arguments and _is_object(stored["arguments"])) else slot

    def reply(self) -> ChatReply:
        """Return the complete reply.

        Raises:
            ServerFailure: The reply is empty.
        """
        text, reasoning = self._clean("".join(self._text)), self._clean("".join(self._reasoning))
        tokens_in, tokens_out = (_count_of(self._usage.get(name)) for name in ("prompt_tokens", "completion_tokens"))
        if not (text.strip() or reasoning.strip() or self._calls):
            detail = "a message without content" if self.has_choice else "no choices"
            raise ServerFailure(
                FailureKind.EMPTY, where=self.endpoint.url, status=200, detail=detail, tokens=(tokens_in, tokens_out)
            )
        calls = tuple(
            RawToolCall(id=call["id"], name=self._clean(call["name"]), arguments_text=self._clean(call["arguments"]))
            for call in self._calls
        )
        return ChatReply(
            text=text,
            reasoning=reasoning,
            tool_calls=calls,
            finish_reason=self.finish_reason,
            input_tokens=tokens_in,
            output_tokens=tokens_out,
            cached_tokens=_count_of((_object_of(self._usage.get("prompt_tokens_details")) or {}).get("cached_tokens")),
            model=self._clean(self.model),
        )

    def _clean(self, text: str) -> str:
        return safe_text(scrub(text, self.endpoint.secret))

    def _malformed_reply(self, detail: str) -> ServerFailure:
        return ServerFailure(FailureKind.MALFORMED, where=self.endpoint.url, status=200, detail=detail)


def _text_of(value: Any) -> str:
    return value if isinstance(value, str) else ""


def _object_of(value: Any) -> dict[str, Any] | None:
    return value if isinstance(value, dict) else None


def _is_object(arguments: str) -> bool:
    """Return whether arguments are a complete JSON object. If so, a later chunk with a name starts another call."""
    try:
        return isinstance(json.loads(arguments), dict)
    except (ValueError, RecursionError):
        return False


def _count_of(value: Any) -> int:
    """Return the value as a token count; 0 if it is not a valid count."""
    return value if isinstance(value, int) and not isinstance(value, bool) and 0 <= value < 2**53 else 0
