"""The judge's port to an OpenAI-compatible server: bound to the schema where the server can do that, and less where it cannot."""

from __future__ import annotations

import re
from copy import copy
from dataclasses import dataclass, field
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from scope_ptz.bench.judging.judge import Message, NoReplyError, Reply
from scope_ptz.endpoints.chat import ChatClient
from scope_ptz.endpoints.chat_replies import ChatReply
from scope_ptz.endpoints.endpoint import Endpoint
from scope_ptz.endpoints.failures import FailureKind, ServerFailure
from scope_ptz.planner.chat.dialect import Dialect
from scope_ptz.planner.chat.reasoning_text import part

K = FailureKind
Form = Literal["json_schema", "json_object", "free"]
_FORMS: tuple[Form, ...] = ("json_schema", "json_object", "free")
_REFUSALS = (K.BAD_REQUEST, K.SERVER_ERROR, K.NOT_FOUND, K.ERROR_BODY)
_ABOUT_FORM = re.compile(r"response_format|json_?(schema|object)|schema|grammar|guided|structured|xgrammar|outlines", re.IGNORECASE)
_MOST_LESSONS = 6
"""A server that still refuses after so many concessions refuses something else."""


class JudgeOptions(BaseModel):
    """How a judge's model is asked. Temperature 0 and a seed make it repeat itself as far as its server can.

    ``max_tokens``: of a reply, reasoning included. ``reasoning_effort``: "low", "medium" or "high", for models that know it.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    temperature: float = Field(default=0.0, ge=0, le=2, allow_inf_nan=False)
    seed: int = 1
    max_tokens: int = Field(default=8192, ge=64)
    reasoning_effort: Literal["low", "medium", "high"] | None = None


@dataclass
class _Known:
    """What a server turned out to take; shared by all ports to it."""

    dialect: Dialect = field(default_factory=lambda: Dialect("native", fixed=True))
    form: int = 0


class ServerPort:
    """Callable as the judge's port; may be shared by concurrent judgements. It keeps connections, and what the server refuses."""

    def __init__(self, endpoint: Endpoint, options: JudgeOptions | None = None) -> None:
        self.options, self.client, self._known = options or JudgeOptions(), ChatClient(endpoint), _Known()

    def repeated(self, repeat: int) -> ServerPort:
        """The port for a further judgement by the same judge: another seed, the same connections."""
        port = copy(self)
        port.options = self.options.model_copy(update={"seed": self.options.seed + repeat})
        return port

    async def __call__(self, messages: list[Message], schema: dict[str, Any]) -> Reply:
        """Ask. Raises ``NoReplyError``."""
        form, quiet, dialect = self._known.form, False, self._known.dialect
        for _ in range(_MOST_LESSONS):
            fields = dialect.fields(self.options.model_dump())
            try:
                reply = await self.client.complete(
                    dialect.messages(messages), extra={**fields, **_response_format(_FORMS[form], schema)}
                )
            except ServerFailure as failure:
                if dialect.learn(failure, fields, with_tools=False):
                    continue
                if form + 1 < len(_FORMS) and (failure.kind is K.EMPTY or _refuses_form(failure)):
                    form, quiet = form + 1, quiet or failure.kind is K.EMPTY
                    continue
                if failure.kind is K.EMPTY:
                    return Reply(text="")
                raise NoReplyError(str(failure), overflow=failure.kind is K.CONTEXT_OVERFLOW) from None
            if not quiet:  # Silence may pass; a refusal stays.
                self._known.form = max(self._known.form, form)
            return _read(reply)
        raise NoReplyError(f"The judge's server at {self.client.endpoint.url} refuses every form of request.")

    async def close(self) -> None:
        """Close the connections."""
        await self.client.close()


def _refuses_form(failure: ServerFailure) -> bool:
    """Whether a server may have stumbled over the constraint: it says so, or calls the request bad without saying why."""
    return failure.kind in _REFUSALS and (failure.kind is K.BAD_REQUEST or _ABOUT_FORM.search(failure.detail) is not None)


def _response_format(form: Form, schema: dict[str, Any]) -> dict[str, Any]:
    if form == "free":
        return {}
    if form == "json_object":
        return {"response_format": {"type": "json_object"}}
    return {"response_format": {"type": "json_schema", "json_schema": {"name": "verdict", "strict": True, "schema": schema}}}


def _read(reply: ChatReply) -> Reply:
    return Reply(
        text=part(reply.text, reply.reasoning).text,
        input_tokens=reply.input_tokens,
        output_tokens=reply.output_tokens,
        cut_off=reply.finish_reason == "length",
    )
