"""The parts of a run that a judge sees: the instruction, the calls with their results, and the final answer."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from scope_ptz.agent.trace import Trace
from scope_ptz.bench.scoring.episode import CameraPosition, Episode, PresetViewpoints
from scope_ptz.geometry import Pose
from scope_ptz.planner.base import ToolOutcome


@dataclass(frozen=True, slots=True)
class CaseCall:
    """A tool call in a run to be judged.

    Attributes:
        name: Name of the tool.
        arguments: Arguments of the call.
        result: Result of the call; None if it failed.
        error: Error message of the call; None if it succeeded.
        pose: Pose of the camera after the call.
        viewpoint: Viewpoint of the camera after the call; None if unknown.
    """

    name: str
    arguments: Mapping[str, Any]
    result: Mapping[str, Any] | None
    error: str | None
    pose: Pose
    viewpoint: str | None = None


@dataclass(frozen=True, slots=True)
class JudgeCase:
    """A run to be judged.

    Attributes:
        instruction: The instruction to the agent.
        start: Pose of the camera at the start of the run.
        viewpoint: Viewpoint of the camera at the start of the run; None if unknown.
        presets: Names of the presets.
        calls: The tool calls in order.
        final: Pose of the camera at the end of the run.
        answer: The agent's final answer.
        outcome: How the run ended; None if it was interrupted.
        agent_saw_pictures: Whether the agent was shown pictures, so that it could answer without a perception call.
        preset_viewpoints: The viewpoints of the presets; None if unknown.
    """

    instruction: str
    start: Pose
    viewpoint: str | None
    presets: tuple[str, ...]
    calls: tuple[CaseCall, ...]
    final: Pose
    answer: str
    outcome: str | None
    agent_saw_pictures: bool = False
    preset_viewpoints: PresetViewpoints | None = None


def case_of(trace: Trace, preset_viewpoints: PresetViewpoints | None = None) -> JudgeCase:
    """Build a case from a trace.

    Args:
        trace: The recorded run.
        preset_viewpoints: The viewpoints of the presets. Without them, the viewpoint is unknown after a move to a preset.
    """
    started, ended = trace.started, trace.ended
    viewpoint, calls = started.viewpoint, list[CaseCall]()
    for called in trace.calls:
        outcome = called.outcome
        viewpoint = _viewpoint_after(outcome, viewpoint, preset_viewpoints, started.labels.home_viewpoint)
        calls.append(
            CaseCall(
                name=outcome.call.name,
                arguments=outcome.call.arguments,
                result=outcome.result,
                error=outcome.error,
                pose=called.pose.pose(),
                viewpoint=viewpoint,
            )
        )
    last = calls[-1].pose if calls else started.pose.pose()
    return JudgeCase(
        instruction=started.instruction,
        start=started.pose.pose(),
        viewpoint=started.viewpoint,
        presets=started.presets,
        calls=tuple(calls),
        final=ended.pose.pose() if ended else last,
        answer=ended.text if ended else "",
        outcome=ended.outcome if ended else None,
        agent_saw_pictures=any(decided.view is not None for decided in trace.decisions),
        preset_viewpoints=preset_viewpoints,
    )


def case_of_episode(episode: Episode, preset_viewpoints: PresetViewpoints) -> JudgeCase:
    """Build a case from a run without a trace, such as a gold run."""
    return JudgeCase(
        instruction=episode.instruction,
        start=episode.start.pose,
        viewpoint=episode.start.viewpoint,
        presets=tuple(preset_viewpoints.presets),
        calls=tuple(_case_call(call.name, call.arguments, call.result, call.error, call.after) for call in episode.calls),
        final=episode.final.pose,
        answer=episode.answer,
        outcome=episode.outcome,
        agent_saw_pictures=bool(episode.planner_views),
        preset_viewpoints=preset_viewpoints,
    )


def _case_call(
    name: str, arguments: Mapping[str, Any], result: Mapping[str, Any] | None, error: str | None, after: CameraPosition
) -> CaseCall:
    return CaseCall(name=name, arguments=arguments, result=result, error=error, pose=after.pose, viewpoint=after.viewpoint)


def _viewpoint_after(
    outcome: ToolOutcome, before: str | None, preset_viewpoints: PresetViewpoints | None, home: str | None
) -> str | None:
    name = outcome.call.name
    if outcome.error is not None or name not in ("go_to_preset", "go_home"):
        return before
    if name == "go_home":
        return home or (preset_viewpoints.home if preset_viewpoints else None)
    return preset_viewpoints.presets.get(str(outcome.call.arguments.get("name"))) if preset_viewpoints else None
