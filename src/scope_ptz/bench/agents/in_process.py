"""A channel to an agent in the scorer's own process, for debugging. The agent can access tasks, ground truth and checks."""

from __future__ import annotations

import asyncio
import json
import threading
from collections.abc import Callable
from typing import Any

import anyio

from scope_ptz.bench.agents.channel import AgentChannel, Isolation
from scope_ptz.bench.agents.faults import agent_failure
from scope_ptz.bench.agents.messages import (
    MAX_QUOTED_CHARS,
    PROTOCOL,
    AgentMessage,
    End,
    HostMessage,
    TaskMessage,
    parse_agent_message,
    printable,
)
from scope_ptz.bench.agents.runner import Message, Session

JOIN_S = 2.0
"""Timeout in seconds for an agent's thread to end after the run. Threads cannot be killed."""


class InProcessChannel(AgentChannel):
    """A channel to an agent in a thread of this process, with its own event loop."""

    isolation: Isolation = "in-process"

    def __init__(self, agent_class: Callable[[], Any], name: str) -> None:
        """Create a channel.

        Args:
            agent_class: The agent's class.
            name: The agent's name.
        """
        self._agent_class = agent_class
        self._sees = bool(getattr(agent_class, "sees", False))
        self._loop = asyncio.get_running_loop()
        self._incoming: asyncio.Queue[Message | BaseException] = asyncio.Queue()
        self._incoming.put_nowait({"type": "hello", "protocol": PROTOCOL, "name": name, "sees": self._sees})
        self._session: Session | None = None
        self._thread: threading.Thread | None = None

    async def send(self, message: HostMessage) -> None:
        """Pass a message to the agent. The task message starts the agent."""
        content = message.model_dump(mode="json")
        if isinstance(message, TaskMessage):
            self._session = Session(content, self._put, self._sees)
            self._thread = threading.Thread(target=self._run, args=(self._session,), name="agent", daemon=True)
            self._thread.start()
        elif self._session is not None:
            self._session.deliver(content)

    async def receive(self) -> AgentMessage:
        """Wait for the agent's next message and return it.

        Raises:
            PlannerError: The agent raised an exception or sent an invalid message.
        """
        message = await self._incoming.get()
        if isinstance(message, BaseException):
            self._incoming.put_nowait(message)
            problem = printable(f"{type(message).__name__}: {message}", MAX_QUOTED_CHARS)
            raise agent_failure("agent-error", f"The agent failed: {problem}") from message
        return parse_agent_message(json.dumps(message))

    async def close(self, reason: str) -> None:
        """Cancel the agent. A thread that does not end is abandoned, because threads cannot be killed."""
        await self.send(End(reason=reason))
        thread = self._thread
        if thread is not None:
            with anyio.CancelScope(shield=True):
                await anyio.to_thread.run_sync(thread.join, JOIN_S)

    def _run(self, session: Session) -> None:
        try:
            self._put(asyncio.run(session.run(self._agent_class)))
        except BaseException as error:
            self._put(error)

    def _put(self, message: Message | BaseException) -> None:
        if not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._incoming.put_nowait, message)
