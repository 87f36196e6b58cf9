"""The worker's channel, which both HTTP and MCP use, passes the suite of all channels."""

from __future__ import annotations

import asyncio
from typing import Any

import pytest

from scope_ptz.bench.agents.messages import MAX_MESSAGE_BYTES
from scope_ptz.serve.bench_host.channel import HostedChannel
from scope_ptz.serve.bench_host.wire import AgentGone, Deliver, Event, MessageToAgent, RunEnded
from tests.bench.agents.conformance import ChannelConformance, Connection

pytestmark = pytest.mark.anyio
RUN = "run"


class _Host:
    """The host's side of a channel: it passes messages on in both directions."""

    def __init__(self) -> None:
        self.events: asyncio.Queue[Event] = asyncio.Queue()
        self.channel = HostedChannel(RUN, self.events.put)

    async def send(self, message: bytes) -> None:
        self.channel.accept(Deliver(run=RUN, line=message[: MAX_MESSAGE_BYTES + 1].decode("utf-8", "replace")))

    async def receive(self) -> dict[str, Any]:
        event = await self.events.get()
        if isinstance(event, RunEnded):
            return {"type": "end", "reason": event.reason}
        assert isinstance(event, MessageToAgent)
        return event.message.model_dump(mode="json")

    async def leave(self) -> None:
        self.channel.accept(AgentGone(run=RUN, reason="The agent has gone."))


class TestHostedChannel(ChannelConformance):
    @pytest.fixture
    def connection(self) -> Connection:
        host = _Host()
        return Connection(host.channel, host)
