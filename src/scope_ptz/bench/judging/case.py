"""A run as a judge sees it: what was asked, what was called, what came back, what was said. From a trace, or without one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from scope_ptz.agent.trace import Trace
from scope_ptz.bench.episode import Episode, Standing
from scope_ptz.geometry import Pose


@dataclass(frozen=True, slots=True)
class CaseCall:
    """A tool call. ``error``: why it failed; ``pose``: where the camera looked afterwards."""

    name: str
    arguments: Mapping[str, Any]
    result: Mapping[str, Any] | None
    error: str | None
    pose: Pose


@dataclass(frozen=True, slots=True)
class Case:
    """``outcome``: how the run ended, None when it was cut off. ``viewpoint``: the optical centre that it started from, if known.

    ``sees``: the agent was shown pictures itself, and may answer from them.
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


def case_of(trace: Trace) -> Case:
    """The run of a trace."""
    started, ended = trace.started, trace.ended
    calls = tuple(
        CaseCall(
            name=called.outcome.call.name,
            arguments=called.outcome.call.arguments,
            result=called.outcome.result,
            error=called.outcome.error,
            pose=called.pose.pose(),
        )
        for called in trace.calls
    )
    last = calls[-1].pose if calls else started.pose.pose()
    return Case(
        instruction=started.instruction,
        start=started.pose.pose(),
        viewpoint=started.viewpoint,
        presets=started.presets,
        calls=calls,
        final=ended.pose.pose() if ended else last,
        answer=ended.text if ended else "",
        outcome=ended.outcome if ended else None,
        sees=any(decided.view is not None for decided in trace.decisions),
    )


def case_of_episode(episode: Episode, presets: Sequence[str]) -> Case:
    """A run that was made without a trace, such as a gold run."""
    return Case(
        instruction=episode.instruction,
        start=episode.start.pose,
        viewpoint=episode.start.viewpoint,
        presets=tuple(presets),
        calls=tuple(_call(call.name, call.arguments, call.result, call.error, call.after) for call in episode.calls),
        final=episode.final.pose,
        answer=episode.text,
        outcome=episode.outcome,
        sees=bool(episode.seen),
    )


def _call(
    name: str, arguments: Mapping[str, Any], result: Mapping[str, Any] | None, error: str | None, after: Standing
) -> CaseCall:
    return CaseCall(name=name, arguments=arguments, result=result, error=error, pose=after.pose)
