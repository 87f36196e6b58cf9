"""The ways in which an external agent can fail. They count against the agent, never as failures of the infrastructure."""

from __future__ import annotations

import re
from typing import Literal, get_args

from scope_ptz.errors import PlannerError

AgentFault = Literal[
    "agent-exited", "agent-error", "agent-timeout", "agent-memory", "agent-processes", "agent-output", "agent-protocol"
]
"""How an external agent failed.

- ``agent-exited``: it crashed, disconnected or ended before it replied.
- ``agent-error``: its code raised an exception.
- ``agent-timeout``: a step, or its whole share of a run, took too long.
- ``agent-memory``: it used more memory than allowed.
- ``agent-processes``: it started more processes than allowed.
- ``agent-output``: it wrote more than allowed.
- ``agent-protocol``: it sent something that is not a valid message.
"""
AGENT_FAULTS: tuple[str, ...] = get_args(AgentFault)


def agent_failed(fault: AgentFault, message: str) -> PlannerError:
    """Return the error that ends a run because of its agent.

    Args:
        fault: How the agent failed.
        message: What happened and what to do, for the trace and the report.
    """
    return PlannerError(message, kind=fault)


def fault_reason(fault: str, message: str) -> str:
    """Return the verdict reason for a run that ended because its agent failed."""
    return f"the agent failed ({fault}): {message}"


def fault_in(reason: str) -> str | None:
    """Return the fault in a verdict reason that ``fault_reason`` wrote; None if there is none."""
    found = re.match(r"the agent failed \((agent-[a-z]+)\)", reason)
    return found[1] if found else None
