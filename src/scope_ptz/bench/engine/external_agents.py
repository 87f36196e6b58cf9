"""What an external agent imports from SCOPE. Such an agent replaces the built-in loop.

It runs on the same tasks, with the same tools, traces and checks. A minimal agent:

    class Agent:
        sees = False

        async def run(self, session: AgentSession) -> str:
            seen = await session.call("count_objects", {"description": "cars", "view": "full"})
            return f"I count {seen['count']} cars."

Each run creates a new instance of the class, in a new process. ``run`` returns the answer, or an ``AgentReply`` for a clarifying
question or a refusal.
"""

from __future__ import annotations

from typing import Protocol

from scope_ptz.bench.agents.runner import AgentReply
from scope_ptz.bench.agents.runner import Session as AgentSession

__all__ = ["AgentReply", "AgentSession", "ExternalAgent"]


class ExternalAgent(Protocol):
    """An external agent. Set its optional attribute ``sees`` to True if it needs frames."""

    async def run(self, session: AgentSession) -> str | AgentReply: ...
