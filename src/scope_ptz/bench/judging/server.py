"""A judge's connection to an OpenAI-compatible server. Replies are constrained to the schema if the server supports it."""

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

Form = Literal["json_schema", "json_object", "free"]
_FORMS: tuple[Form, ...] = ("json_schema", "json_object", "free")
_REFUSALS = (FailureKind.BAD_REQUEST, FailureKind.SERVER_ERROR, FailureKind.NOT_FOUND, FailureKind.ERROR_BODY)
_ABOUT_FORM = re.compile(r"response_format|json_?(schema|object)|schema|grammar|guided|structured|xgrammar|outlines", re.IGNORECASE)
_MAX_REQUESTS = 6
"""Maximum number of requests for one reply. Each drops an option that the server refused."""


class JudgeModelOptions(BaseModel):
    """Options of requests to a judge's model. Temperature 0 and a seed make replies repeatable if the server supports it.

    Attributes:
        temperature: Sampling temperature.
        seed: Seed of the sampling.
        max_tokens: Maximum number of tokens of a reply, including reasoning.
        reasoning_effort: Reasoning effort, for models that support it.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    temperature: float = Field(default=0.0, ge=0, le=2, allow_inf_nan=False)
    seed: int = 1
    max_tokens: int = Field(default=8192, ge=64)
    reasoning_effort: Literal["low", "medium", "high"] | None = None


@dataclass
class _Known:
    """The options that a server accepts, as learned from its replies. All connections to the server share it."""

    dialect: Dialect = field(default_factory=lambda: Dialect("native", fixed=True))
    form: int = 0


class JudgeServer:
    """Completes a judge's messages on a server.

    Concurrent judgements may share it. It remembers which options the server refuses.
    """

    def __init__(self, endpoint: Endpoint, options: JudgeModelOptions | None = None) -> None:
        self.options, self.client, self._known = options or JudgeModelOptions(), ChatClient(endpoint), _Known()

    def repeated(self, repeat: int) -> JudgeServer:
        """Return the server for another judgement by the same judge, with another seed and the same connections."""
        port = copy(self)
        port.options = self.options.model_copy(update={"seed": self.options.seed + repeat})
        return port

    async def __call__(self, messages: list[JudgeMessage], schema: dict[str, Any]) -> Completion:
        """Complete messages under a JSON schema.

        Raises:
            NoReplyError: The server failed or refuses every form of request.
        """
        form, after_empty, dialect = self._known.form, False, self._known.dialect
        for _ in range(_MAX_REQUESTS):
            fields = dialect.fields(self.options.model_dump())
            try:
                reply = await self.client.complete(
                    dialect.messages(messages), extra={**fields, **_response_format(_FORMS[form], schema)}
                )
            except ServerFailure as failure:
                if dialect.adapt(failure, fields, with_tools=False):
                    continue
                if form + 1 < len(_FORMS) and (failure.kind is FailureKind.EMPTY or _refuses_form(failure)):
                    form, after_empty = form + 1, after_empty or failure.kind is FailureKind.EMPTY
                    continue
                if failure.kind is FailureKind.EMPTY:
                    return Completion(text="")
                raise NoReplyError(str(failure), overflow=failure.kind is FailureKind.CONTEXT_OVERFLOW) from None
            if not after_empty:  # An empty reply may be temporary; a refusal is not.
                self._known.form = max(self._known.form, form)
            return _read(reply)
        raise NoReplyError(f"The judge's server at {self.client.endpoint.url} refuses every form of request.")

    async def close(self) -> None:
        """Close all connections."""
        await self.client.close()


def _refuses_form(failure: ServerFailure) -> bool:
    """Return whether a server may have refused the response format: it names it, or calls the request bad."""
    return failure.kind in _REFUSALS and (failure.kind is FailureKind.BAD_REQUEST or _ABOUT_FORM.search(failure.detail) is not None)


def _response_format(form: Form, schema: dict[str, Any]) -> dict[str, Any]:
    if form == "free":
        return {}
    if form == "json_object":
        return {"response_format": {"type": "json_object"}}
    return {"response_format": {"type": "json_schema", "json_schema": {"name": "verdict", "strict": True, "schema": schema}}}


def _read(reply: ChatReply) -> Completion:
    return Completion(
        text=separate_reasoning(reply.text, reply.reasoning).text,
        input_tokens=reply.input_tokens,
        output_tokens=reply.output_tokens,
        cut_off=reply.finish_reason == "length",
    )
