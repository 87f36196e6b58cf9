"""What really went to a planner's server and what came back, for the log."""

from __future__ import annotations

from contextvars import ContextVar
from typing import Any

from scope_ptz.endpoints.chat import ChatClient
from scope_ptz.endpoints.failures import ServerFailure
from scope_ptz.endpoints.replies import ChatReply

WIRE: ContextVar[list[dict[str, Any]] | None] = ContextVar("scope_wire", default=None)
"""Requests and replies of the call of a model that is being logged."""


class LoggedChat(ChatClient):
    """A chat client that puts down each exchange where the model's call is being logged. Keys are in headers, which are not."""

    async def complete(
        self,
        messages: list[dict[str, Any]],
        *,
        tools: list[dict[str, Any]] | None = None,
        stream: bool = False,
        extra: dict[str, Any] | None = None,
        **options: Any,
    ) -> ChatReply:
        request = {"model": self.endpoint.model, "messages": messages, "tools": tools, "stream": stream, **options, **(extra or {})}
        log = WIRE.get()
        try:
            reply = await super().complete(messages, tools=tools, stream=stream, extra=extra, **options)
        except ServerFailure as failure:
            if log is not None:
                log.append({"request": request, "reply": {"error": str(failure), "kind": failure.kind.value}})
            raise
        if log is not None:
            log.append({"request": request, "reply": reply.model_dump(mode="json")})
        return reply
