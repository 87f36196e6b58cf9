"""A run as a judge sees it: what was asked, what was called, what came back, what was said. From a trace, or without one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from scope_ptz.agent.trace import Trace
from scope_ptz.bench.scoring.episode import CameraState, Episode, PresetViewpoints
from scope_ptz.geometry import Pose
from scope_ptz.planner.base import ToolOutcome


@dataclass(frozen=True, slots=True)
class CaseCall:
    """A tool call. ``error``: why it failed; ``pose``: where the camera looked afterwards, ``viewpoint``: from where, if known."""

    name: str
    arguments: Mapping[str, Any]
    result: Mapping[str, Any] | None
    error: str | None
    pose: Pose
    viewpoint: str | None = None


@dataclass(frozen=True, slots=True)
class JudgeCase:
    """``outcome``: how the run ended, None when it was cut off. ``viewpoint``: the optical centre that it started from, if known.

    ``sees``: the agent was shown pictures itself, and may answer from them. ``places``: the viewpoints of presets, if known.
    """

    instruction: str
    start: Pose
    viewpoint: str | None
    presets: tuple[str, ...]
    calls: tuple[CaseCall, ...]
    final: Pose
    answer: str
    outcome: str | None
    sees: bool = False
    places: PresetViewpoints | None = None


def case_of(trace: Trace, places: PresetViewpoints | None = None) -> JudgeCase:
    """The run of a trace. ``places``: which viewpoint each preset has; without it, it is known only as long as none is gone to."""
    started, ended = trace.started, trace.ended
    at, calls = started.viewpoint, list[CaseCall]()
    for called in trace.calls:
        outcome = called.outcome
        at = _viewpoint_after(outcome, at, places, started.labels.home_viewpoint)
        calls.append(
            CaseCall(
                name=outcome.call.name,
                arguments=outcome.call.arguments,
                result=outcome.result,
                error=outcome.error,
                pose=called.pose.pose(),
                viewpoint=at,
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
        sees=any(decided.view is not None for decided in trace.decisions),
        places=places,
    )


def case_of_episode(episode: Episode, places: PresetViewpoints) -> JudgeCase:
    """A run that was made without a trace, such as a gold run. ``places``: of its scene."""
    return JudgeCase(
        instruction=episode.instruction,
        start=episode.start.pose,
        viewpoint=episode.start.viewpoint,
        presets=tuple(places.presets),
        calls=tuple(_call(call.name, call.arguments, call.result, call.error, call.after) for call in episode.calls),
        final=episode.final.pose,
        answer=episode.text,
        outcome=episode.outcome,
        sees=bool(episode.seen),
        places=places,
    )


def _call(
    name: str, arguments: Mapping[str, Any], result: Mapping[str, Any] | None, error: str | None, after: CameraState
) -> CaseCall:
    return CaseCall(name=name, arguments=arguments, result=result, error=error, pose=after.pose, viewpoint=after.viewpoint)


def _viewpoint_after(outcome: ToolOutcome, before: str | None, places: PresetViewpoints | None, home: str | None) -> str | None:
    name = outcome.call.name
    if outcome.error is not None or name not in ("go_to_preset", "go_home"):
        return before
    if name == "go_home":
        return home or (places.home if places else None)
    return places.presets.get(str(outcome.call.arguments.get("name"))) if places else None
