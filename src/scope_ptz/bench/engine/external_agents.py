"""The interface for external agents, which replace the built-in agent loop.

An external agent runs on the same tasks, with the same tools, traces and checks. This is a minimal agent:

    class Agent:
        sees = False

        async def run(self, session: AgentSession) -> str:
            result = await session.call("count_objects", {"description": "cars", "view": "full"})
            return f"I count {result['count']} cars."

Every run creates a new instance of the class in a new process. ``run`` returns the answer, or an ``AgentReply`` for a clarifying
question or a refusal.
"""

from __future__ import annotations

from typing import Protocol

from scope_ptz.bench.agents.runner import AgentReply
from scope_ptz.bench.agents.runner import Session as AgentSession

__all__ = ["AgentReply", "AgentSession", "ExternalAgent"]


class ExternalAgent(Protocol):
    """The interface of an external agent. Set the optional class attribute ``sees`` to True if the agent needs frames."""

    async def run(self, session: AgentSession) -> str | AgentReply: ...
