"""The worker's channel to an agent that is connected to the host."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable

from scope_ptz.bench.agents.channel import AgentChannel, Isolation
from scope_ptz.bench.agents.faults import agent_failed
from scope_ptz.bench.agents.messages import AgentMessage, HostMessage, parse_agent_message
from scope_ptz.serve.bench_host.wire import Deliver, Event, Gone, Over, Sent

SendEvent = Callable[[Event], Awaitable[None]]


class HostedChannel(AgentChannel):
    """Carries the messages of one run between the engine in the worker and the host, which passes them on.

    Args:
        run: Key of the run.
        send: Sends an event to the host.
    """

    isolation: Isolation = "hosted"

    def __init__(self, run: str, send: SendEvent) -> None:
        self.run, self._send = run, send
        self._arrived: asyncio.Queue[Deliver | Gone] = asyncio.Queue()
        self._gone: str | None = None
        self._closed = False

    def arrived(self, command: Deliver | Gone) -> None:
        """Accept a message from the host."""
        self._arrived.put_nowait(command)

    async def send(self, message: HostMessage) -> None:
        if self._gone is not None or self._closed:
            raise agent_failed("agent-exited", self._gone or "The run has ended.")
        await self._send(Sent(run=self.run, message=message))

    async def receive(self) -> AgentMessage:
        if self._gone is None and not self._closed:
            command = await self._arrived.get()
            if isinstance(command, Deliver):
                return parse_agent_message(command.line)
            self._gone = command.reason
        raise agent_failed("agent-exited", self._gone or "The run has ended.")

    async def close(self, reason: str) -> None:
        if not self._closed:
            self._closed = True
            await self._send(Over(run=self.run, reason=reason))
