"""Use your own planner: a patrol that visits every preset, counts, and reports the busiest one."""

import scope_ptz
from scope_ptz.contracts import CallTools, Decision, Finish, State, ToolCall


class Patrol(scope_ptz.Planner):
    """A planner that counts objects at all presets. It needs no state of its own, because the history contains all calls."""

    name = "patrol"

    async def step(self, state: State) -> Decision:
        presets = state.briefing.presets
        visited = len(state.history)
        if visited < len(presets):
            go = ToolCall(id=f"go-{visited}", name="go_to_preset", arguments={"name": presets[visited]})
            count = ToolCall(id=f"count-{visited}", name="count_objects", arguments={"description": state.instruction})
            return CallTools(calls=(go, count))
        counts = {}
        for preset, exchange in zip(presets, state.history, strict=True):
            result = exchange.outcomes[-1].result
            counts[preset] = result["count"] if result else 0
        busiest = max(counts, key=lambda preset: counts[preset])
        return Finish(kind="answered", text=f"Most {state.instruction} are at {busiest}: {counts[busiest]}.")


def main() -> None:
    with scope_ptz.open("highway-works", planner=Patrol()) as scope:
        run = scope.ask("cars")
    for call in run.calls:
        if call.name == "count_objects":
            print(f"{call.pose.pan_deg:+7.1f}°  {call.message}")
    print(run.answer)


if __name__ == "__main__":
    main()
