"""A scripted camera for planner tests. It keeps its pose and answers perception calls from a script."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Iterable
from typing import Any

from scope_ptz.geometry import Limits, Pose
from scope_ptz.planner.base import Briefing, CallTools, Exchange, Finish, PastTurn, State, ToolOutcome, Viewpoints
from scope_ptz.planner.grammar import GrammarPlanner

LIMITS = Limits()
PRESETS = ("gate", "highway")
_START = Pose()


class Stage:
    """``looks``: what counting, asking, zooming to and tracking give back, in order; the last one is repeated. ``fail``: tools
    that fail, with how often, and ``error``: what they report.
    ``lands``: the pose that zooming to a thing ends at; where the camera is, when not said.
    ``after_tracking``: the same for following a thing, whose path then has these two poses.
    ``simulated``: whether the camera is simulated. ``places``: the viewpoint and pose of each preset; the first is home's. Without
    them, the camera has a single viewpoint, and presets and home are straight ahead."""

    def __init__(
        self,
        looks: Iterable[Any] = (),
        fail: dict[str, int] | None = None,
        pose: Pose = _START,
        lands: Pose | None = None,
        after_tracking: Pose | None = None,
        simulated: bool = False,
        places: dict[str, tuple[str, Pose]] | None = None,
        error: str = "",
    ) -> None:
        self.places = places or {}
        self.viewpoint = next((viewpoint for viewpoint, _ in self.places.values()), None)
        self.simulated = simulated
        self.lands, self.after_tracking = lands, after_tracking
        self.looks = list(looks)
        self.fail, self.error = dict(fail or {}), error
        self.pose = pose
        self.calls: list[tuple[str, dict[str, Any]]] = []

    def _look(self) -> Any:
        return self.looks.pop(0) if len(self.looks) > 1 else self.looks[0]

    def _count(self) -> dict[str, Any]:
        """Return a count: the next look, which is a number, or a number with whether the count is complete."""
        count, complete = look if isinstance(look := self._look(), tuple) else (look, True)
        return {"count": count, "complete": complete}

    def do(self, name: str, arguments: dict[str, Any]) -> tuple[dict[str, Any] | None, str | None]:
        self.calls.append((name, arguments))
        if self.fail.get(name, 0) > 0:
            self.fail[name] -= 1
            return None, self.error or f"{name} broke"
        clamped: tuple[str, ...] = ()
        before = self.pose
        seen: dict[str, Any] = {"source": "ground-truth", "view": arguments.get("view", "current"), "frames": ()}
        extra: dict[str, Callable[[], dict[str, Any]]] = {
            "count_objects": lambda: {**seen, "description": arguments["description"], **self._count(), "boxes": ()},
            "query_answer": lambda: {**seen, "question": arguments["question"], **self._look()},
            "zoom_to_object": lambda: {
                **seen,
                "description": "",
                "found": (found := self._look()),
                "matches": int(found),
                "chosen": "",
                "limited_by": (),
            },
            "track_object": lambda: {
                **seen,
                "description": "",
                "found": True,
                "duration_s": arguments["duration_s"],
                "held_share": 0.9,
                "path": tuple(
                    {"time_s": time_s, "pose": pose.as_dict(), "seen": True} for time_s, pose in enumerate((before, self.pose))
                ),
            },
            "get_presets": lambda: {"presets": PRESETS},
            "take_image": lambda: {"file": f"image-{len(self.calls)}.png"},
        }
        if name == "adjust_ptz":
            factor = arguments.get("zoom_factor", 1 + arguments.get("zoom_percent", 0) / 100)
            wanted = self.pose.turned(arguments.get("pan_deg", 0), arguments.get("tilt_deg", 0)).zoomed(factor)
            self.pose, clamped = LIMITS.clamp(wanted)
        elif name == "zoom_to_object" and self.lands:
            self.pose = self.lands
        elif name == "track_object" and self.after_tracking:
            self.pose = self.after_tracking
        elif name in {"go_home", "go_to_preset"}:
            self.viewpoint, self.pose = self.places.get(arguments.get("name", PRESETS[0]), (self.viewpoint, Pose()))
        result = {"message": "", "pose": self.pose.as_dict(), "clamped": clamped, **extra.get(name, dict)()}
        return result, None

    def run(self, instruction: str, conversation: tuple[PastTurn, ...] = ()) -> Finish:
        """The loop of the agent, without its budgets."""
        return asyncio.run(self._run(instruction, conversation))[0]

    def turn(self, instruction: str, conversation: tuple[PastTurn, ...] = ()) -> PastTurn:
        """The same, as a turn to look back on."""
        start, viewpoint = self.pose, self.viewpoint
        finish, history = asyncio.run(self._run(instruction, conversation))
        return PastTurn(instruction=instruction, exchanges=history, reply=finish.text, start=start, viewpoint=viewpoint)

    async def _run(self, instruction: str, conversation: tuple[PastTurn, ...]) -> tuple[Finish, tuple[Exchange, ...]]:
        planner = GrammarPlanner()
        viewpoints = None
        if self.viewpoint is not None:
            of_presets = {name: viewpoint for name, (viewpoint, _) in self.places.items()}
            viewpoints = Viewpoints(current=self.viewpoint, of_presets=of_presets, home=of_presets.get(PRESETS[0]))
        briefing = Briefing(
            presets=PRESETS, pose=self.pose, limits=LIMITS, simulated=self.simulated, viewpoints=viewpoints
        )  # fmt: skip
        state = State(instruction=instruction, briefing=briefing, conversation=conversation)
        for _ in range(300):
            decision = await planner.step(state)
            if isinstance(decision, Finish):
                return decision, state.history
            assert isinstance(decision, CallTools)
            outcomes = []
            for call in decision.calls:
                result, error = self.do(call.name, call.arguments)
                outcomes.append(ToolOutcome(call=call, result=result, error=error))
            state = state.model_copy(update={"history": (*state.history, Exchange(outcomes=tuple(outcomes)))})
        raise AssertionError("the planner never ends")
