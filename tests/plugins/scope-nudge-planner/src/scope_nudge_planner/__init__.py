"""A planner that pans right once and asks perception to count: ``--planner nudge``."""

from __future__ import annotations

from scope_ptz.planner.base import CallTools, Decision, Finish, Planner, State, ToolCall
from scope_ptz.planner.spec import PlannerSpec


class NudgePlanner(Planner):
    """Pans, counts, and reports the count."""

    def __init__(self, name: str, pan_deg: float) -> None:
        self.name, self.pan_deg = name, pan_deg

    async def step(self, state: State) -> Decision:
        if not state.history:
            return CallTools(calls=(ToolCall(id="1", name="adjust_ptz", arguments={"pan_deg": self.pan_deg}),))
        if len(state.history) == 1:
            return CallTools(calls=(ToolCall(id="2", name="count_objects", arguments={"description": "lamp"}),))
        outcome = state.history[-1].outcomes[0]
        return Finish(kind="answered", text=outcome.error or f"Nudged. {(outcome.result or {})['message']}")


def make(spec: PlannerSpec) -> Planner:
    """Make the planner; ``--planner-option pan_deg=10`` sets how far it turns."""
    return NudgePlanner(spec.name, float(spec.options.get("pan_deg", 5.0)))
