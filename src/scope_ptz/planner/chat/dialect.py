"""The features that a server turned out not to support.

Servers differ in the request fields that they know. A field that a server refuses is not sent to it again. This
knowledge belongs to the server, not to a run.
"""

from __future__ import annotations

import re
from typing import Any

from scope_ptz.endpoints.failures import FailureKind, ServerFailure
from scope_ptz.planner.chat.chat_messages import Message, Notation

_REFUSALS = (FailureKind.BAD_REQUEST, FailureKind.SERVER_ERROR, FailureKind.NOT_FOUND, FailureKind.ERROR_BODY)
_TOOLS = re.compile(
    r"\btools?\b|tool_|tool[- ]|function[- ]call|--jinja|roles? must alternate|(unknown|unexpected|unsupported|invalid) role",
    re.IGNORECASE,
)
"""Refusals of tools, also by chat templates that know no roles but user and assistant."""
_SYSTEM = re.compile(r"system (role|message|prompt)s? (is |are )?not supported|does not support system", re.IGNORECASE)
_OPTIONAL = ("chat_template_kwargs", "reasoning_effort", "temperature", "seed")


class Dialect:
    """The features to leave out of requests to a server."""

    def __init__(self, notation: Notation, *, fixed: bool) -> None:
        self.notation: Notation = notation
        self._fixed = fixed
        self._refused: set[str] = set()
        self._system = True
        self._limit = "max_tokens"

    def fields(self, wanted: dict[str, Any]) -> dict[str, Any]:
        """Return the requested fields that the server supports, under the names that it knows."""
        return {self._limit if k == "max_tokens" else k: v for k, v in wanted.items() if v is not None and k not in self._refused}

    def messages(self, messages: list[Message]) -> list[Message]:
        """Return the messages as the server takes them. Without a system role, the system text begins the first user message."""
        if self._system or not messages or messages[0]["role"] != "system":
            return messages
        system, first, *rest = messages
        head = {"type": "text", "text": system["content"] + "\n\n"}
        content = first["content"]
        joined = head["text"] + content if isinstance(content, str) else [head, *content]
        return [{"role": "user", "content": joined}, *rest]

    def learn(self, failure: ServerFailure, sent: dict[str, Any], *, with_tools: bool) -> bool:
        """Adapt to a refusal. Return whether it was about something that the next request can leave out."""
        if failure.kind not in _REFUSALS:
            return False
        for name in _OPTIONAL:
            if name in sent and name in failure.detail:
                self._refused.add(name)
                return True
        if "max_tokens" in sent and "max_tokens" in failure.detail:
            self._limit = "max_completion_tokens"
            return True
        if self._system and _SYSTEM.search(failure.detail):
            self._system = False
            return True
        if with_tools and not self._fixed and _TOOLS.search(failure.detail):
            self.notation = "text"
            return True
        return False
