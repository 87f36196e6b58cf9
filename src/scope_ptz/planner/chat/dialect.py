"""Adapt requests to the features that a server supports.

OpenAI-compatible servers differ in the request fields, roles and tool interface that they support. When a server rejects one of
these, later requests to that server omit it.
"""

from __future__ import annotations

import re
from typing import Any

from scope_ptz.endpoints.failures import FailureKind, ServerFailure
from scope_ptz.planner.chat.chat_messages import Message, Notation

_REJECTION_KINDS = (FailureKind.BAD_REQUEST, FailureKind.SERVER_ERROR, FailureKind.NOT_FOUND, FailureKind.ERROR_BODY)
"""Failure kinds that can mean that the server rejects a request feature."""

_TOOLS_REJECTED = re.compile(
    r"\btools?\b|tool_|tool[- ]|function[- ]call|--jinja|roles? must alternate|(unknown|unexpected|unsupported|invalid) role",
    re.IGNORECASE,
)
"""Pattern for error messages that reject tools, including those from chat templates that lack the role "tool"."""

_SYSTEM_ROLE_REJECTED = re.compile(
    r"system (role|message|prompt)s? (is |are )?not supported|does not support system", re.IGNORECASE
)
_OPTIONAL_FIELDS = ("chat_template_kwargs", "reasoning_effort", "temperature", "seed")


class Dialect:
    """The request fields, roles and tool notation that a server accepts, as learned from its rejections.

    Attributes:
        notation: How tool calls are exchanged with the server.
    """

    def __init__(self, notation: Notation, *, fixed: bool) -> None:
        """Create a dialect that supports everything.

        Args:
            notation: How to exchange tool calls initially.
            fixed: Whether to keep the notation even if the server rejects tools.
        """
        self.notation: Notation = notation
        self._notation_fixed = fixed
        self._rejected_fields: set[str] = set()
        self._system_role = True
        self._max_tokens_field = "max_tokens"

    def fields(self, requested: dict[str, Any]) -> dict[str, Any]:
        """Return the request fields, without those that are None or rejected, under the names that the server uses."""
        return {
            self._max_tokens_field if name == "max_tokens" else name: value
            for name, value in requested.items()
            if value is not None and name not in self._rejected_fields
        }

    def messages(self, messages: list[Message]) -> list[Message]:
        """Return the messages, using only roles that the server accepts.

        If the server rejects the system role, the system text becomes the beginning of the first user message.
        """
        if self._system_role or not messages or messages[0]["role"] != "system":
            return messages
        system, first, *rest = messages
        head = {"type": "text", "text": system["content"] + "\n\n"}
        content = first["content"]
        joined = head["text"] + content if isinstance(content, str) else [head, *content]
        return [{"role": "user", "content": joined}, *rest]

    def adapt(self, failure: ServerFailure, sent: dict[str, Any], *, with_tools: bool) -> bool:
        """Adapt to a failed request.

        Args:
            failure: How the request failed.
            sent: The request's optional fields.
            with_tools: Whether the request contained tools.

        Returns:
            True if the server rejected a feature that the next request will omit; False if a retry would fail in the same way.
        """
        if failure.kind not in _REJECTION_KINDS:
            return False
        for name in _OPTIONAL_FIELDS:
            if name in sent and name in failure.detail:
                self._rejected_fields.add(name)
                return True
        if "max_tokens" in sent and "max_tokens" in failure.detail:
            self._max_tokens_field = "max_completion_tokens"
            return True
        if self._system_role and _SYSTEM_ROLE_REJECTED.search(failure.detail):
            self._system_role = False
            return True
        if with_tools and not self._notation_fixed and _TOOLS_REJECTED.search(failure.detail):
            self.notation = "text"
            return True
        return False
