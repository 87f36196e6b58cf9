"""Plan an instruction with the grammar planner, without a camera.

The plan assumes that every tool call succeeds and that every condition is met at its first test.
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
from scope_ptz.planner.grammar.execution.run_state import AssumedOutcome
from scope_ptz.planner.grammar.instruction_tree import Reply

_MAX_CALLS = 200  # longer plans are truncated
_OBJECT_ZOOM_FACTOR = 2.0  # assumed effect of zoom_to_object


@dataclass(frozen=True, slots=True)
class PlannedCall:
    """A tool call of a plan."""

    name: str
    arguments: dict[str, Any]


@dataclass(frozen=True, slots=True)
class Plan:
    """The plan for an instruction.

    Attributes:
        understood: Whether the instruction asks for something that was understood, and is not refused. A greeting asks for nothing.
        calls: The calls that the planner makes if every call succeeds and every condition is met at its first test.
        clarification: The question, refusal or reply to a courtesy if ``understood`` is false; otherwise None.
        outline: The calls grouped into loops and conditional branches.
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
        instruction: The user's instruction.
        presets: The camera's presets; without any, preset names are accepted as written.
        pose: The camera's pose at the start.
        preset_poses: Poses of the presets. A preset that is not listed is assumed to have the home pose.
        limits: The camera's limits.
    """
    meaning = understand(instruction, tuple(presets) or None)
    if meaning.refusal or meaning.clarification:
        return Plan(instruction, False, (), meaning.clarification or meaning.refusal)
    if replies := [step.text for step in meaning.steps if isinstance(step, Reply)]:
        return Plan(instruction, False, (), replies[0])
    program = Program(limits, pose, assume_met=True)
    world = _AssumedWorld(pose, limits, preset_poses or {})
    calls: list[PlannedCall] = []
    run = program.run(meaning.steps)
    try:
        name, arguments = next(run)
        while len(calls) < _MAX_CALLS:
            calls.append(PlannedCall(name, arguments))
            name, arguments = run.send(AssumedOutcome(world.result(name, arguments)))
    except StopIteration:
        pass
    world = _AssumedWorld(pose, limits, preset_poses or {})
    return Plan(instruction, True, tuple(calls), None, make_outline(meaning.steps, limits, pose, world.result))


@dataclass(slots=True)
class _AssumedWorld:
    """A fake camera and perception backend for plans, which tracks the pose and finds every object."""

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
            self.pose, _ = self.limits.clamp(self.pose.zoomed(_OBJECT_ZOOM_FACTOR))
        perception_result = {"count": 1, "answer": "yes", "known": True, "found": True, "matches": 1, "held_share": 1.0}
        pose = {"pan_deg": self.pose.pan_deg, "tilt_deg": self.pose.tilt_deg, "zoom": self.pose.zoom}
        return {"pose": pose, "clamped": (), **perception_result}

    def _adjusted(self, arguments: Mapping[str, Any]) -> Pose:
        factor = arguments.get("zoom_factor", 1 + arguments.get("zoom_percent", 0.0) / 100)
        if limit := arguments.get("zoom_limit"):
            factor = (self.limits.max_zoom if limit == "in" else self.limits.min_zoom) / self.pose.zoom
        return self.pose.turned(arguments.get("pan_deg", 0.0), arguments.get("tilt_deg", 0.0)).zoomed(factor)
