"""A worker's channel to an agent that is connected to the host."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable

from scope_ptz.bench.agents.channel import AgentChannel, Isolation
from scope_ptz.bench.agents.faults import agent_failure
from scope_ptz.bench.agents.messages import AgentMessage, HostMessage, parse_agent_message
from scope_ptz.serve.bench_host.wire import AgentGone, Deliver, Event, MessageToAgent, RunEnded

SendEvent = Callable[[Event], Awaitable[None]]


class HostedChannel(AgentChannel):
    """Carries the messages of one run between the engine in the worker and the host, which forwards them to the agent.

    Args:
        run: Key of the run.
        send: Sends an event to the host.
    """

    isolation: Isolation = "hosted"

    def __init__(self, run: str, send: SendEvent) -> None:
        self.run, self._send = run, send
        self._commands: asyncio.Queue[Deliver | AgentGone] = asyncio.Queue()
        self._gone_reason: str | None = None
        self._closed = False

    def accept(self, command: Deliver | AgentGone) -> None:
        """Accept a command from the host."""
        self._commands.put_nowait(command)

    async def send(self, message: HostMessage) -> None:
        if self._gone_reason is not None or self._closed:
            raise agent_failure("agent-exited", self._gone_reason or "The run has ended.")
        await self._send(MessageToAgent(run=self.run, message=message))

    async def receive(self) -> AgentMessage:
        if self._gone_reason is None and not self._closed:
            command = await self._commands.get()
            if isinstance(command, Deliver):
                return parse_agent_message(command.line)
            self._gone_reason = command.reason
        raise agent_failure("agent-exited", self._gone_reason or "The run has ended.")

    async def close(self, reason: str) -> None:
        if not self._closed:
            self._closed = True
            await self._send(RunEnded(run=self.run, reason=reason))
