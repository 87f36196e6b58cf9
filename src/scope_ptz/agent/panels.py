"""The panels of a filmstrip: one captioned picture per step. A move and the perception call after it share a panel."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from pydantic import ValidationError

from scope_ptz.agent.records import Called
from scope_ptz.agent.trace import Trace
from scope_ptz.english import counted, singular
from scope_ptz.geometry import Pose
from scope_ptz.perception.base import Box
from scope_ptz.planner.base import ToolOutcome

_MOVES = ("adjust_ptz", "go_to_preset", "go_home")


@dataclass(frozen=True, slots=True)
class Panel:
    """One picture of a filmstrip with its caption.

    Attributes:
        number: Number of the panel; 0 for the view at the start.
        action: The action; the first half of the caption.
        file: Name of the picture in the run folder.
        finding: The result; the second half of the caption.
        badge: A count in words ("4 cones"), drawn in a corner.
        is_panorama: Whether the picture is a panorama of the full scene.
        failed: Whether the finding is an error.
    """

    number: int
    action: str
    pose: Pose
    file: str | None
    finding: str = ""
    boxes: tuple[Box, ...] = ()
    badge: str = ""
    is_panorama: bool = False
    failed: bool = False


def panels_of(trace: Trace) -> list[Panel]:
    """Return the panels of a run in order. A run without steps has one panel, the view at the start of the run."""
    panels: list[Panel] = []
    mergeable = False
    for call in trace.calls:
        name = call.outcome.call.name
        if name == "get_presets" and call.outcome.error is None:
            continue
        panel = _panel(call)
        reads_view = name not in _MOVES and call.outcome.error is None and not panel.is_panorama and name != "zoom_to_object"
        if mergeable and reads_view:
            panels[-1] = replace(panel, number=panels[-1].number, action=_join_actions(panels[-1], panel))
        else:
            panels.append(replace(panel, number=len(panels) + 1))
        mergeable = name in _MOVES and call.outcome.error is None
    if not panels:
        panels.append(Panel(0, "start", trace.started.pose.pose(), trace.started.frame))
    return _fill_missing_pictures(panels, trace.started.frame)


def _join_actions(move: Panel, call: Panel) -> str:
    action = f"{move.action} ({move.finding})" if move.finding else move.action
    return action if call.badge else f"{action}, {call.action}"


def _fill_missing_pictures(panels: list[Panel], first: str | None) -> list[Panel]:
    """Give each panel without a picture, such as that of a failed call, the previous view."""
    shown, last = [], first
    for panel in panels:
        shown.append(panel if panel.file else replace(panel, file=last))
        last = last if panel.is_panorama or not panel.file else panel.file
    return shown


def _panel(call: Called) -> Panel:
    outcome, pose = call.outcome, call.pose.pose()
    if outcome.error is not None or outcome.result is None:
        return Panel(0, action_of(outcome), pose, None, finding=outcome.error or "", failed=True)
    result = outcome.result
    frames = result.get("frames") or [None]
    return Panel(
        number=0,
        action=action_of(outcome),
        pose=pose,
        file=call.frame or frames[-1] or result.get("file"),
        finding=_finding(outcome.call.name, result),
        boxes=_boxes(result),
        badge=_count(result) if outcome.call.name == "count_objects" else "",
        is_panorama=result.get("view") == "full",
    )


def _boxes(result: dict[str, Any]) -> tuple[Box, ...]:
    raw_boxes = result.get("boxes") or ([result["box"]] if result.get("box") else [])
    try:
        return tuple(Box.model_validate(box) for box in raw_boxes)
    except ValidationError:
        return ()


def _count(result: dict[str, Any]) -> str:
    words = str(result["description"]).split()
    return counted(int(result["count"]), " ".join([*words[:-1], singular(words[-1])])) if words else str(result["count"])


def _finding(name: str, result: dict[str, Any]) -> str:
    match name:
        case "count_objects":
            return _count(result)
        case "query_answer":
            return str(result["answer"])
        case "zoom_to_object":
            return f"fills {result['fill']:.0%} of the frame" if result.get("found") else "nothing found"
        case "track_object":
            return f"in view {result['held_share']:.0%} of the time" if result.get("found") else "nothing found"
    clamped = result.get("clamped") or ()
    return f"at the {' and '.join(clamped)} limit" if clamped else ""


def action_of(outcome: ToolOutcome) -> str:
    """Return a short description of a call."""
    name, arguments = outcome.call.name, outcome.call.arguments
    full = "sweep, " if arguments.get("view") == "full" else ""
    match name:
        case "adjust_ptz":
            return ", ".join(_adjustments(arguments)) or "stay"
        case "go_to_preset":
            return f"go to {arguments.get('name', '?')}"
        case "go_home":
            return "go home"
        case "take_image":
            return "take a picture"
        case "count_objects":
            return f"{full}count {arguments.get('description', '?')}"
        case "query_answer":
            return f"{full}{arguments.get('question', '?')}"
        case "zoom_to_object":
            return f"zoom to {arguments.get('description', '?')}"
        case "track_object":
            return f"track {arguments.get('description', '?')} for {_number(arguments.get('duration_s', 10))} s"
    return name.replace("_", " ")


def _adjustments(arguments: dict[str, Any]) -> list[str]:
    parts = []
    for key, negative, positive in (("pan_deg", "pan left", "pan right"), ("tilt_deg", "tilt down", "tilt up")):
        angle = arguments.get(key)
        if isinstance(angle, int | float) and angle:
            parts.append(f"{positive if angle > 0 else negative} {abs(angle):g}°")
    if arguments.get("zoom_factor") is not None:
        parts.append(f"zoom {_number(arguments['zoom_factor'])}x")
    if arguments.get("zoom_percent") is not None:
        parts.append(f"zoom {_number(arguments['zoom_percent'])}%")
    if arguments.get("zoom_limit") is not None:
        parts.append(f"zoom all the way {arguments['zoom_limit']}")
    return parts


def _number(value: Any) -> str:
    """Format a number without trailing zeros. Values of other types, from invalid calls, are shown unchanged."""
    return f"{value:g}" if isinstance(value, int | float) else str(value)
