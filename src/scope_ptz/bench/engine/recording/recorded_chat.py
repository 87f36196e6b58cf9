"""Recording of the exchanges with a planner's server, for the log."""

from __future__ import annotations

from copy import copy
from typing import Any

from scope_ptz.endpoints.chat import ChatClient
from scope_ptz.endpoints.chat_replies import ChatReply
from scope_ptz.endpoints.failures import ServerFailure
from scope_ptz.planner.base import Planner
from scope_ptz.planner.chat import ChatPlanner


class Exchanges:
    """Requests and replies of one step of a planner, as JSON data."""

    def __init__(self) -> None:
        self.requests: list[dict[str, Any]] = []
        self.replies: list[dict[str, Any]] = []

    def add(self, request: dict[str, Any], reply: dict[str, Any]) -> None:
        self.requests.append(request)
        self.replies.append(reply)


def recorded(planner: Planner, exchanges: Exchanges) -> Planner:
    """Return a planner whose exchanges with its server are recorded; connections and what it learned are shared with it."""
    if not isinstance(planner, ChatPlanner):
        return planner
    recording = copy(planner)
    recording.client = RecordedChat(planner.client, exchanges)
    return recording


class RecordedChat(ChatClient):
    """A view of a chat client that records each exchange. Keys are sent in headers, which are not recorded."""

    def __init__(self, client: ChatClient, exchanges: Exchanges) -> None:
        # ``super().__init__`` is not called: this object shares the connections of ``client`` and opens none.
        self.endpoint, self.caller = client.endpoint, client.caller
        self._client_behind, self._exchanges = client, exchanges

    async def complete(
        self,
        messages: list[dict[str, Any]],
        *,
        tools: list[dict[str, Any]] | None = None,
        stream: bool = False,
        extra: dict[str, Any] | None = None,
        **options: Any,
    ) -> ChatReply:
        model = self.endpoint.model
        request = {"model": model, "messages": messages, "tools": tools, "stream": stream, **options, **(extra or {})}
        try:
            reply = await self._client_behind.complete(messages, tools=tools, stream=stream, extra=extra, **options)
        except ServerFailure as failure:
            self._exchanges.add(request, {"error": str(failure), "kind": failure.kind.value})
            raise
        self._exchanges.add(request, reply.model_dump(mode="json"))
        return reply

    async def close(self) -> None:
        """Close nothing: the connections belong to the client behind."""
