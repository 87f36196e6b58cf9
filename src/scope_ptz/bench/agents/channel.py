"""The channel between the host of a run and its agent."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Literal, get_args

from scope_ptz.bench.agents.messages import AgentMessage, HostMessage

Isolation = Literal["in-process", "isolated", "sandboxed", "hosted"]
"""How an external agent is separated from the tasks, the ground truth and the checks.

- ``in-process``: it runs in the scorer's process and can reach everything.
- ``isolated``: it runs in a process of its own on the same machine, and can read the files of its user.
- ``sandboxed``: it runs in a sandbox without the network and without the files of the dataset.
- ``hosted``: it runs elsewhere and is connected over a network.
"""
ISOLATIONS: tuple[Isolation, ...] = get_args(Isolation)
ISOLATION_NOTES: dict[Isolation, str] = {
    "in-process": "it can reach the tasks, the answers and the checks",
    "isolated": "a process of its own, which can read files of this machine",
    "sandboxed": "without the network and without the files of the dataset",
    "hosted": "connected over a network",
}
"""What each label means, for the output of commands and for reports."""


class AgentChannel(ABC):
    """Carries the messages of one run. It belongs to one run and cannot be used again.

    A channel checks messages and reports failures of the agent and its connection as ``PlannerError`` with a kind of
    ``bench.agents.faults``. It sets no time limits: a caller that stops waiting cancels ``receive``, and then closes the channel.
    """

    isolation: Isolation

    @abstractmethod
    async def send(self, message: HostMessage) -> None:
        """Send a message to the agent.

        Raises:
            PlannerError: The agent has gone.
        """

    @abstractmethod
    async def receive(self) -> AgentMessage:
        """Wait for the agent's next message and return it.

        Raises:
            PlannerError: The agent has gone, or sent something that is not a valid message.
        """

    @abstractmethod
    async def close(self, reason: str) -> None:
        """End the agent's part in the run, and release everything that belongs to it. Closing again does nothing.

        Args:
            reason: Why the run ends. An agent that is still connected receives it as the message ``end``.
        """
