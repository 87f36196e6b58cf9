"""Failures of external agents. They count against the agent and are never infrastructure failures."""

from __future__ import annotations

import re
from typing import Literal, get_args

from scope_ptz.errors import PlannerError

AgentFault = Literal[
    "agent-exited", "agent-error", "agent-timeout", "agent-memory", "agent-processes", "agent-output", "agent-protocol"
]
"""Kinds of agent failures.

- ``agent-exited``: the agent crashed, disconnected or exited before it replied.
- ``agent-error``: its code raised an exception.
- ``agent-timeout``: it took too long for a step or for the whole run.
- ``agent-memory``: it used more memory than allowed.
- ``agent-processes``: it started more processes than allowed.
- ``agent-output``: it wrote more output than allowed.
- ``agent-protocol``: it sent an invalid message.
"""
AGENT_FAULTS: tuple[str, ...] = get_args(AgentFault)


def agent_failure(fault: AgentFault, message: str) -> PlannerError:
    """Return the error that ends a run in which the agent failed.

    Args:
        fault: The kind of failure.
        message: What happened, and what the user can do, for the trace and the report.
    """
    return PlannerError(message, kind=fault)


def fault_reason(fault: str, message: str) -> str:
    """Return the verdict reason for a run that ended because the agent failed."""
    return f"the agent failed ({fault}): {message}"


def fault_in(reason: str) -> str | None:
    """Return the kind of failure in a verdict reason created by ``fault_reason``; None for other reasons."""
    match = re.match(r"the agent failed \((agent-[a-z]+)\)", reason)
    return match[1] if match else None
