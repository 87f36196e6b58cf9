"""Derive the camera's earlier positions from the conversation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from scope_ptz.geometry import Pose

if TYPE_CHECKING:
    from scope_ptz.planner.base import PastTurn, ToolOutcome


@dataclass(frozen=True, slots=True)
class VisitedPosition:
    """An earlier position of the camera: a preset, home, or any other pose."""

    pose: Pose
    preset: str | None = None
    home: bool = False


@dataclass(frozen=True, slots=True)
class PositionHistory:
    """The positions of the camera in earlier turns of the conversation.

    Attributes:
        preset: The preset at which the camera is now; None if it is not at a preset.
        before: The position before the last turn that moved the camera.
    """

    preset: str | None = None
    before: VisitedPosition | None = None


def position_history(conversation: Sequence[PastTurn]) -> PositionHistory:
    """Return the camera's positions according to the tool results of earlier turns."""
    if not conversation:
        return PositionHistory()
    from scope_ptz.tools.registry import TOOLS

    current: VisitedPosition | None = None
    before: VisitedPosition | None = None
    for turn in conversation:
        at_start = current
        for outcome in (o for exchange in turn.exchanges for o in exchange.outcomes):
            pose = _pose(outcome.result)
            if outcome.error is not None or pose is None or outcome.call.name not in TOOLS.moving:
                continue
            at_start = at_start or _start_of_move(outcome, pose)
            before = at_start or before
            name = outcome.call.arguments.get("name")
            current = VisitedPosition(
                pose, str(name) if outcome.call.name == "go_to_preset" else None, home=outcome.call.name == "go_home"
            )
    return PositionHistory(current.preset if current else None, before)


def _pose(result: dict[str, Any] | None) -> Pose | None:
    pose = (result or {}).get("pose")
    return Pose(pose["pan_deg"], pose["tilt_deg"], pose["zoom"]) if isinstance(pose, dict) else None


def _start_of_move(outcome: ToolOutcome, after: Pose) -> VisitedPosition | None:
    """Return the position before a relative move, computed from its arguments.

    Return None if they do not determine it: for other tools, clamped moves, and zooming all the way.
    """
    arguments = outcome.call.arguments
    if outcome.call.name != "adjust_ptz" or (outcome.result or {}).get("clamped") or arguments.get("zoom_limit"):
        return None
    factor = arguments.get("zoom_factor", 1 + arguments.get("zoom_percent", 0) / 100)
    return VisitedPosition(after.turned(-arguments.get("pan_deg", 0), -arguments.get("tilt_deg", 0)).zoomed(1 / factor))
