"""Tool calls that a client makes directly, without a planner model. Each is recorded as a run with one step."""

from __future__ import annotations

from typing import Any

from scope_ptz.planner.base import CallTools, Decision, Finish, Planner, State, ToolCall

DIRECT_CALL_PLANNER = "by-hand"
"""The name of ``SingleCallPlanner`` in traces. Stored traces contain it, so it must not change."""


class SingleCallPlanner(Planner):
    """A planner that makes one tool call and answers with its result.

    Args:
        name: The tool's name.
        arguments: The tool's arguments.
    """

    name = DIRECT_CALL_PLANNER

    def __init__(self, name: str, arguments: dict[str, Any]) -> None:
        self._call = ToolCall(id="call1", name=name, arguments=arguments)

    async def step(self, state: State) -> Decision:
        if not state.history:
            return CallTools(calls=(self._call,))
        outcome = state.history[-1].outcomes[0]
        if outcome.error is not None:
            return Finish(kind="refused", text=outcome.error)
        return Finish(kind="answered", text=str((outcome.result or {}).get("message") or "Done."))


def call_text(name: str, arguments: dict[str, Any]) -> str:
    """Return a call as text: ``count_objects(description='cones')``."""
    return f"{name}({', '.join(f'{key}={value!r}' for key, value in arguments.items())})"
