"""The channel between the host of a run and the agent."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Literal, get_args

from scope_ptz.bench.agents.messages import AgentMessage, HostMessage

Isolation = Literal["in-process", "isolated", "sandboxed", "hosted"]
"""How an external agent is separated from the tasks, the ground truth and the checks.

- ``in-process``: it runs in the scorer's process and can access everything.
- ``isolated``: it runs in a separate process on the same machine, and can read the files of its user.
- ``sandboxed``: it runs in a sandbox without access to the network and the dataset's files.
- ``hosted``: it runs elsewhere and is connected over a network.
"""
ISOLATIONS: tuple[Isolation, ...] = get_args(Isolation)
ISOLATION_NOTES: dict[Isolation, str] = {
    "in-process": "it can reach the tasks, the answers and the checks",
    "isolated": "a separate process, which can read files on this machine",
    "sandboxed": "without access to the network and the dataset's files",
    "hosted": "connected over a network",
}
"""The meaning of each label, for command output and reports."""


class AgentChannel(ABC):
    """Carries the messages of one run. A channel cannot be reused for another run.

    A channel validates messages. If the agent or the connection fails, it raises ``PlannerError`` with a kind from
    ``bench.agents.faults``. It has no time limits: a caller that stops waiting cancels ``receive`` and then closes the channel.
    """

    isolation: Isolation

    @abstractmethod
    async def send(self, message: HostMessage) -> None:
        """Send a message to the agent.

        Raises:
            PlannerError: The agent has exited or disconnected.
        """

    @abstractmethod
    async def receive(self) -> AgentMessage:
        """Wait for the agent's next message and return it.

        Raises:
            PlannerError: The agent has exited or disconnected, or it sent an invalid message.
        """

    @abstractmethod
    async def close(self, reason: str) -> None:
        """Stop the agent and release its resources. Calling this method again has no effect.

        Args:
            reason: Why the run ends. It is sent to the agent in an ``end`` message if the agent is still connected.
        """
