"""What a server turned out not to take. Servers differ in the fields that they know; one that refuses a field says so once and
is not sent it again. This is knowledge about the server, not about a run.
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
"""Also of templates that know no role but user and assistant."""
_SYSTEM = re.compile(r"system (role|message|prompt)s? (is |are )?not supported|does not support system", re.IGNORECASE)
_OPTIONAL = ("chat_template_kwargs", "reasoning_effort", "temperature", "seed")


class Dialect:
    """``notation``: how tools are offered; ``fixed``: the user chose it."""

    def __init__(self, notation: Notation, *, fixed: bool) -> None:
        self.notation: Notation = notation
        self._fixed = fixed
        self._refused: set[str] = set()
        self._system = True
        self._limit = "max_tokens"

    def fields(self, wanted: dict[str, Any]) -> dict[str, Any]:
        """Of the fields wanted those that the server takes, under the names that it knows."""
        return {self._limit if k == "max_tokens" else k: v for k, v in wanted.items() if v is not None and k not in self._refused}

    def messages(self, messages: list[Message]) -> list[Message]:
        """The messages for templates without a system role: what the system says then begins the first user message."""
        if self._system or not messages or messages[0]["role"] != "system":
            return messages
        system, first, *rest = messages
        head = {"type": "text", "text": system["content"] + "\n\n"}
        content = first["content"]
        joined = head["text"] + content if isinstance(content, str) else [head, *content]
        return [{"role": "user", "content": joined}, *rest]

    def learn(self, failure: ServerFailure, sent: dict[str, Any], *, with_tools: bool) -> bool:
        """Whether a refusal was about something that can be left out. Then the next request goes without it."""
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
