"""Faults in an agent's actions: missing calls, wrong tools, wrong scopes and wrong arguments.

Each fault function takes a passing run and returns it with the fault, or None if the fault does not apply to the run. The names
of these functions are stored with gold runs.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from scope_ptz.bench.answers import ParsedValue, parse_answer
from scope_ptz.bench.scoring.episode import CameraPosition, Episode, EpisodeCall, FrameGeometry, observations_of
from scope_ptz.bench.scoring.required_calls import missing_in_order
from scope_ptz.bench.scoring.verdict import MOVING_TOOLS
from scope_ptz.bench.tasks.expected import (
    ActionOnly,
    AnyExpected,
)
from scope_ptz.bench.tasks.task import Task
from scope_ptz.geometry import Pose
from scope_ptz.taskgen.facts.answer_phrasing import wrong_answer

PERCEPTION_TOOLS = frozenset({"count_objects", "query_answer"})
TURN_ARGUMENTS = ("pan_deg", "tilt_deg")


@dataclass(frozen=True, slots=True)
class FaultContext:
    """The presets and the camera that fault functions need to recompute a run."""

    presets: Mapping[str, CameraPosition]
    camera: FrameGeometry


def replay(episode: Episode, calls: Iterable[EpisodeCall], context: FaultContext) -> Episode:
    """Return a run with different calls, and with recomputed poses and observations."""
    position, replayed_calls = episode.start, list[EpisodeCall]()
    for call in calls:
        after = _position_after(call, position, episode, context)
        moved = replace(call, before=position, after=after, observations=())
        replayed_calls.append(replace(moved, observations=observations_of(moved, context.camera) if moved.succeeded else ()))
        position = after
    files = {str((call.result or {}).get("file")) for call in replayed_calls if call.name == "take_image"}
    return replace(
        episode, calls=tuple(replayed_calls), final=position, pictures=tuple(p for p in episode.pictures if p.file in files)
    )


def _position_after(call: EpisodeCall, position: CameraPosition, episode: Episode, context: FaultContext) -> CameraPosition:
    """Return the camera position after a call that starts from a different position than in the original run."""
    if not call.succeeded or call.name not in MOVING_TOOLS:
        return position
    if call.name == "go_to_preset":
        return context.presets[call.arguments["name"]]
    if call.name == "go_home":
        return call.after
    if call.name == "adjust_ptz":
        before, after = call.before.pose, call.after.pose
        pan, tilt, zoom = after.pan_deg - before.pan_deg, after.tilt_deg - before.tilt_deg, after.zoom / before.zoom
        limits = context.camera.limits
        return CameraPosition(position.viewpoint, limits.clamp(position.pose.turned(pan, tilt).zoomed(zoom))[0])
    return CameraPosition(position.viewpoint, call.after.pose)


def change_result(call: EpisodeCall, **changes: Any) -> EpisodeCall:
    """Return a copy of a call with some result fields changed."""
    return replace(call, result={**(call.result or {}), **changes})


def change_calls(episode: Episode, context: FaultContext, change: Callable[[EpisodeCall], EpisodeCall | None]) -> Episode:
    """Return a copy of a run in which ``change`` has replaced every call. Calls for which it returns None are omitted."""
    return replay(episode, [new for call in episode.calls if (new := change(call)) is not None], context)


# Missing tool calls


def drop_all(task: Task, episode: Episode, context: FaultContext, rng: random.Random) -> Episode | None:
    """Omit all calls."""
    return replay(episode, (), context)


def drop_looks(task: Task, episode: Episode, context: FaultContext, rng: random.Random) -> Episode | None:
    """Omit all perception calls."""
    if not any(call.name in PERCEPTION_TOOLS for call in episode.calls):
        return None
    return change_calls(episode, context, lambda call: None if call.name in PERCEPTION_TOOLS else call)


def drop_pictures(task: Task, episode: Episode, context: FaultContext, rng: random.Random) -> Episode | None:
    """Omit all calls that take pictures."""
    if not episode.pictures:
        return None
    return change_calls(episode, context, lambda call: None if call.name == "take_image" else call)


# Wrong tool


_REPLACEMENTS: dict[str, tuple[str, dict[str, Any], dict[str, Any]]] = {
    "take_image": ("query_answer", {"question": "What is in view?"}, {"message": "A view.", "answer": "A view."}),
    "zoom_to_object": ("adjust_ptz", {"zoom_factor": 1.2}, {"message": "Moved."}),
}
"""The tool, arguments and result that replace a call to a tool. Calls to other tools are replaced by ``take_image``."""


def swap_tools(task: Task, episode: Episode, context: FaultContext, rng: random.Random) -> Episode | None:
    """Replace every call to one tool with a call to an unsuitable tool."""
    name = rng.choice([call.name for call in episode.calls])
    other, arguments, result = _REPLACEMENTS.get(name, ("take_image", {}, {"message": "Done.", "file": "pictures/001.png"}))
    if any(call.name == other for call in episode.calls):
        return None

    def swap(call: EpisodeCall) -> EpisodeCall:
        if call.name != name:
            return call
        pose = call.before.pose.zoomed(1.2) if other == "adjust_ptz" else call.before.pose
        return replace(call, name=other, arguments=arguments, after=CameraPosition(call.before.viewpoint, pose), result=result)

    return change_calls(episode, context, swap)


def swap_order(task: Task, episode: Episode, context: FaultContext, rng: random.Random) -> Episode | None:
    """Swap two consecutive calls whose order matters."""
    if len(task.behaviour.calls) < 2 or task.behaviour.order != "ordered":
        return None
    indices = list(range(len(episode.calls) - 1))
    rng.shuffle(indices)
    for index in indices:
        calls = list(episode.calls)
        calls[index], calls[index + 1] = calls[index + 1], calls[index]
        if missing_in_order(task.behaviour.calls, calls) is not None:
            return replay(episode, calls, context)
    return None


# Wrong scope


def flip_scope(task: Task, episode: Episode, context: FaultContext, rng: random.Random) -> Episode | None:
    """Use the full scope instead of the current view, or vice versa, and give a wrong answer."""
    if not any(call.name in PERCEPTION_TOOLS for call in episode.calls) or isinstance(task.expected, ActionOnly):
        return None
    answer = wrong_answer(task.expected, rng)
    if answer is None:
        return None

    def flip(call: EpisodeCall) -> EpisodeCall:
        if call.name not in PERCEPTION_TOOLS:
            return call
        view = "full" if call.arguments.get("view", "current") == "current" else "current"
        result: dict[str, Any] = (
            {"count": wrong_count(task.expected, answer, call)} if call.name == "count_objects" else {"answer": answer}
        )
        return change_result(replace(call, arguments={**call.arguments, "view": view}), view=view, message=answer, **result)

    return replace(change_calls(episode, context, flip), answer=answer)


def wrong_count(expected: AnyExpected, answer: str, call: EpisodeCall) -> int:
    """Return a wrong count that is consistent with a wrong answer."""
    reading, counted = parse_answer(expected, answer), int((call.result or {}).get("count", 0))
    if isinstance(reading, ParsedValue) and isinstance(reading.value, float):
        return round(reading.value)
    return 0 if counted else 2


# Wrong arguments


def other_preset(task: Task, episode: Episode, context: FaultContext, rng: random.Random) -> Episode | None:
    """Go to a wrong preset instead of one of the presets that the run visits."""
    visited = [call.arguments["name"] for call in episode.calls if call.name == "go_to_preset"]
    if not visited:
        return None
    correct = rng.choice(visited)
    wrong = rng.choice([name for name in context.presets if name != correct])

    def go(call: EpisodeCall) -> EpisodeCall:
        if call.name != "go_to_preset" or call.arguments["name"] != correct:
            return call
        return change_result(replace(call, arguments={"name": wrong}), message=f"At preset {wrong}.")

    return change_calls(episode, context, go)


def turned_round(task: Task, episode: Episode, context: FaultContext, rng: random.Random) -> Episode | None:
    """Turn in the opposite direction. The paper's example is "panning left when asked to pan right"."""
    if not any(call.name == "adjust_ptz" and changes_direction(call) for call in episode.calls):
        return None

    def turn(call: EpisodeCall) -> EpisodeCall:
        if call.name != "adjust_ptz":
            return call
        before, after = call.before.pose, call.after.pose
        arguments = {k: -v if k in TURN_ARGUMENTS else v for k, v in call.arguments.items()}
        pose = Pose(2 * before.pan_deg - after.pan_deg, 2 * before.tilt_deg - after.tilt_deg, after.zoom)
        return replace(call, arguments=arguments, after=CameraPosition(call.after.viewpoint, pose))

    return change_calls(episode, context, turn)


def changes_direction(call: EpisodeCall) -> bool:
    """Return whether an adjustment changes the direction, not only the magnification."""
    return any(call.arguments.get(name) for name in TURN_ARGUMENTS)


def other_target(task: Task, episode: Episode, context: FaultContext, rng: random.Random) -> Episode | None:
    """Count or ask about something that the instruction does not mention."""
    answer = wrong_answer(task.expected, rng)
    if (
        answer is None
        or not any(view.about for view in task.evidence)
        or not any(call.name in PERCEPTION_TOOLS for call in episode.calls)
    ):
        return None

    def change_topic(call: EpisodeCall) -> EpisodeCall:
        if call.name == "count_objects":
            arguments = {**call.arguments, "description": "clouds"}
            return change_result(replace(call, arguments=arguments), count=wrong_count(task.expected, answer, call), message=answer)
        if call.name == "query_answer":
            arguments = {**call.arguments, "question": "What is the weather like?"}
            return change_result(replace(call, arguments=arguments), answer=answer, known=True, message=answer)
        return call

    return replace(change_calls(episode, context, change_topic), answer=answer)
