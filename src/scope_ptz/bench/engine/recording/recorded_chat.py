"""Record the requests to a planner's server and the replies, for the log."""

from __future__ import annotations

from copy import copy
from typing import Any, cast

from scope_ptz.endpoints.chat import ChatClient
from scope_ptz.endpoints.chat_replies import ChatReply
from scope_ptz.endpoints.failures import ServerFailure
from scope_ptz.planner.base import Planner
from scope_ptz.planner.chat import ChatPlanner


class Exchanges:
    """The server requests and replies in one planner step, as JSON data."""

    def __init__(self) -> None:
        self.requests: list[dict[str, Any]] = []
        self.replies: list[dict[str, Any]] = []

    def add(self, request: dict[str, Any], reply: dict[str, Any]) -> None:
        self.requests.append(request)
        self.replies.append(reply)


def recording_planner(planner: Planner, exchanges: Exchanges) -> Planner:
    """Return a copy of a planner that records its exchanges with the server. The copy shares the original's connections and state.

    A planner without a server is returned unchanged. For a hybrid planner, the exchanges of its ``model`` are recorded.
    """
    if isinstance(model := getattr(planner, "model", None), Planner):
        hybrid: Any = copy(planner)
        hybrid.model = recording_planner(model, exchanges)
        return cast(Planner, hybrid)
    if not isinstance(planner, ChatPlanner):
        return planner
    recording = copy(planner)
    recording.client = RecordedChat(planner.client, exchanges)
    return recording


class RecordedChat(ChatClient):
    """A wrapper around a chat client that records each exchange. Headers are not recorded, because they may contain keys."""

    def __init__(self, client: ChatClient, exchanges: Exchanges) -> None:
        # ``super().__init__`` is not called, because it would open connections. This object uses the connections of ``client``.
        self.endpoint, self.caller = client.endpoint, client.caller
        self._wrapped, self._exchanges = client, exchanges

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
            reply = await self._wrapped.complete(messages, tools=tools, stream=stream, extra=extra, **options)
        except ServerFailure as failure:
            self._exchanges.add(request, {"error": str(failure), "kind": failure.kind.value})
            raise
        self._exchanges.add(request, reply.model_dump(mode="json"))
        return reply

    async def close(self) -> None:
        """Do nothing, because the connections belong to the wrapped client."""
