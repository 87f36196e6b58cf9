"""The grammar planner's plan for an instruction, without a camera.

The plan is unrolled as if every tool call succeeded and every condition were met at its first test.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from scope_ptz.geometry import Limits, Pose
from scope_ptz.planner.grammar.binding.understand import understand
from scope_ptz.planner.grammar.execution.outline import OutlineBlock
from scope_ptz.planner.grammar.execution.outline import outline as make_outline
from scope_ptz.planner.grammar.execution.program import Program
from scope_ptz.planner.grammar.execution.run_state import ImaginedOutcome

_MOST_CALLS = 200
_ZOOM_ON_OBJECT = 2.0


@dataclass(frozen=True, slots=True)
class PlannedCall:
    """A tool call of a plan."""

    name: str
    arguments: dict[str, Any]


@dataclass(frozen=True, slots=True)
class Plan:
    """The plan for an instruction.

    Attributes:
        instruction: The instruction.
        understood: Whether there is anything to do.
        calls: The calls, as if every tool succeeded and every condition were met at its first test.
        clarification: The question or the refusal when there is nothing to do.
        outline: The calls with loops and conditions as such.
    """

    instruction: str
    understood: bool
    calls: tuple[PlannedCall, ...]
    clarification: str | None
    outline: OutlineBlock = field(default_factory=OutlineBlock)

    def as_dict(self) -> dict[str, Any]:
        return {
            "instruction": self.instruction,
            "understood": self.understood,
            "calls": [asdict(call) for call in self.calls],
            "clarification": self.clarification,
        }


def plan(
    instruction: str,
    presets: Sequence[str] = (),
    pose: Pose = Pose(),  # noqa: B008 - immutable
    preset_poses: Mapping[str, Pose] | None = None,
    limits: Limits = Limits(),  # noqa: B008 - immutable
) -> Plan:
    """Return the plan for an instruction.

    Args:
        instruction: What the user typed.
        presets: The camera's presets; without any, preset names are accepted as written.
        pose: The camera's pose at the start.
        preset_poses: Poses of the presets; unknown ones count as the home pose.
        limits: The camera's limits.
    """
    meaning = understand(instruction, tuple(presets) or None)
    if meaning.refusal or meaning.clarification:
        return Plan(instruction, False, (), meaning.clarification or meaning.refusal)
    program = Program(limits, pose, assume_met=True)
    imagined = _Imagined(pose, limits, preset_poses or {})
    calls: list[PlannedCall] = []
    run = program.run(meaning.steps)
    try:
        name, arguments = next(run)
        while len(calls) < _MOST_CALLS:
            calls.append(PlannedCall(name, arguments))
            name, arguments = run.send(ImaginedOutcome(imagined.result(name, arguments)))
    except StopIteration:
        pass
    imagined = _Imagined(pose, limits, preset_poses or {})
    return Plan(instruction, True, tuple(calls), None, make_outline(meaning.steps, limits, pose, imagined.result))


@dataclass(slots=True)
class _Imagined:
    """A camera that only tracks its pose, in a scene where everything is found."""

    pose: Pose
    limits: Limits
    presets: Mapping[str, Pose]

    def result(self, name: str, arguments: Mapping[str, Any]) -> dict[str, Any]:
        if name == "adjust_ptz":
            self.pose, _ = self.limits.clamp(self._adjusted(arguments))
        elif name == "go_home":
            self.pose = Pose()
        elif name == "go_to_preset":
            self.pose = self.presets.get(arguments["name"], Pose())
        elif name == "zoom_to_object":
            self.pose, _ = self.limits.clamp(self.pose.zoomed(_ZOOM_ON_OBJECT))
        seen = {"count": 1, "answer": "yes", "known": True, "found": True, "matches": 1, "held_share": 1.0}
        pose = {"pan_deg": self.pose.pan_deg, "tilt_deg": self.pose.tilt_deg, "zoom": self.pose.zoom}
        return {"pose": pose, "clamped": (), **seen}

    def _adjusted(self, arguments: Mapping[str, Any]) -> Pose:
        factor = arguments.get("zoom_factor", 1 + arguments.get("zoom_percent", 0.0) / 100)
        if limit := arguments.get("zoom_limit"):
            factor = (self.limits.max_zoom if limit == "in" else self.limits.min_zoom) / self.pose.zoom
        return self.pose.turned(arguments.get("pan_deg", 0.0), arguments.get("tilt_deg", 0.0)).zoomed(factor)
