"""Connect a judge to an OpenAI-compatible server. If the server supports it, replies are constrained to the JSON schema."""

from __future__ import annotations

import re
from copy import copy
from dataclasses import dataclass, field
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from scope_ptz.bench.judging.judge import Completion, JudgeMessage, NoReplyError
from scope_ptz.endpoints.chat import ChatClient
from scope_ptz.endpoints.chat_replies import ChatReply
from scope_ptz.endpoints.endpoint import Endpoint
from scope_ptz.endpoints.failures import FailureKind, ServerFailure
from scope_ptz.planner.chat.dialect import Dialect
from scope_ptz.planner.chat.reasoning_text import separate_reasoning

ResponseFormat = Literal["json_schema", "json_object", "free"]
_RESPONSE_FORMATS: tuple[ResponseFormat, ...] = ("json_schema", "json_object", "free")
"""Response formats in the order in which they are tried."""
_REJECTION_KINDS = (FailureKind.BAD_REQUEST, FailureKind.SERVER_ERROR, FailureKind.NOT_FOUND, FailureKind.ERROR_BODY)
"""Kinds of failures by which servers reject an unsupported response format."""
_FORMAT_WORDS = re.compile(
    r"response_format|json_?(schema|object)|schema|grammar|guided|structured|xgrammar|outlines", re.IGNORECASE
)
"""Words which show that an error message concerns the response format."""
_MAX_REQUESTS = 6
"""Maximum number of requests for one reply. Each retry leaves out an option that the server rejected."""


class JudgeModelOptions(BaseModel):
    """Options for requests to a judge's model. Temperature 0 and a seed make replies reproducible if the server supports this.

    Attributes:
        temperature: Sampling temperature.
        seed: Sampling seed.
        max_tokens: Maximum number of tokens in a reply, including reasoning.
        reasoning_effort: Reasoning effort, for models that support it.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    temperature: float = Field(default=0.0, ge=0, le=2, allow_inf_nan=False)
    seed: int = 1
    max_tokens: int = Field(default=8192, ge=64)
    reasoning_effort: Literal["low", "medium", "high"] | None = None


@dataclass
class _ServerSupport:
    """The options that a server has been found to accept. Copies of a ``JudgeServer`` share this object.

    Attributes:
        dialect: The request fields and roles that the server accepts.
        format_index: Index of the first response format that was not rejected.
    """

    dialect: Dialect = field(default_factory=lambda: Dialect("native", fixed=True))
    format_index: int = 0


class JudgeServer:
    """Sends a judge's messages to a server.

    Several judgements can use it concurrently. It remembers the options that the server rejects.
    """

    def __init__(self, endpoint: Endpoint, options: JudgeModelOptions | None = None) -> None:
        self.options, self.client, self._support = options or JudgeModelOptions(), ChatClient(endpoint), _ServerSupport()

    def for_repeat(self, repeat: int) -> JudgeServer:
        """Return a copy with the seed for the judgement with index ``repeat``. The copy shares the connections."""
        server = copy(self)
        server.options = self.options.model_copy(update={"seed": self.options.seed + repeat})
        return server

    async def __call__(self, messages: list[JudgeMessage], schema: dict[str, Any]) -> Completion:
        """Complete messages with a reply that follows a JSON schema.

        Raises:
            NoReplyError: The server failed, or it rejected every response format.
        """
        format_index, had_empty_reply, dialect = self._support.format_index, False, self._support.dialect
        for _ in range(_MAX_REQUESTS):
            fields = dialect.fields(self.options.model_dump())
            try:
                reply = await self.client.complete(
                    dialect.messages(messages), extra={**fields, **_format_fields(_RESPONSE_FORMATS[format_index], schema)}
                )
            except ServerFailure as failure:
                if dialect.adapt(failure, fields, with_tools=False):
                    continue
                is_empty = failure.kind is FailureKind.EMPTY
                if format_index + 1 < len(_RESPONSE_FORMATS) and (is_empty or _rejects_format(failure)):
                    format_index, had_empty_reply = format_index + 1, had_empty_reply or is_empty
                    continue
                if is_empty:
                    return Completion(text="")
                raise NoReplyError(str(failure), overflow=failure.kind is FailureKind.CONTEXT_OVERFLOW) from None
            if not had_empty_reply:  # A rejection is permanent, but an empty reply may be temporary.
                self._support.format_index = max(self._support.format_index, format_index)
            return _completion(reply)
        raise NoReplyError(
            f"The judge's server at {self.client.endpoint.url} rejected {_MAX_REQUESTS} requests with different options. "
            "Use another server or model."
        )

    async def close(self) -> None:
        """Close all connections."""
        await self.client.close()


def _rejects_format(failure: ServerFailure) -> bool:
    """Return whether a failure may be a rejection of the response format: it mentions the format, or is a bad request."""
    is_about_format = failure.kind is FailureKind.BAD_REQUEST or _FORMAT_WORDS.search(failure.detail) is not None
    return failure.kind in _REJECTION_KINDS and is_about_format


def _format_fields(response_format: ResponseFormat, schema: dict[str, Any]) -> dict[str, Any]:
    """Return the fields of a request that select a response format."""
    if response_format == "free":
        return {}
    if response_format == "json_object":
        return {"response_format": {"type": "json_object"}}
    return {"response_format": {"type": "json_schema", "json_schema": {"name": "verdict", "strict": True, "schema": schema}}}


def _completion(reply: ChatReply) -> Completion:
    return Completion(
        text=separate_reasoning(reply.text, reply.reasoning).text,
        input_tokens=reply.input_tokens,
        output_tokens=reply.output_tokens,
        cut_off=reply.finish_reason == "length",
    )
