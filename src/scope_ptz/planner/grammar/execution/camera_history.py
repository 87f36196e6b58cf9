"""Derive the camera's earlier positions from the conversation, so that "undo" and "go back" can return to them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from scope_ptz.geometry import Pose, wrap_pan_deg

if TYPE_CHECKING:
    from scope_ptz.planner.base import PastTurn

Effect = Literal["done", "corrected", "returned", "rejected", "dismissed", "nothing"]
"""What came of a turn: it was carried out; it was carried out in place of the previous command; it put the camera back; it rejected
the previous command; the user dropped the subject ("never mind"), so that no later turn corrects the command; or nothing was done,
because the planner asked a question or every call failed."""

ANGLE_TOLERANCE_DEG = 0.02
ZOOM_TOLERANCE = 0.002
"""Differences of the poses in tool results, which are rounded, from exact poses: an angle, and a share of the magnification."""


@dataclass(frozen=True, slots=True)
class VisitedPosition:
    """An earlier position of the camera: a preset, home, or any other pose.

    Attributes:
        viewpoint: The viewpoint of a simulated camera; empty if it is unknown. None for cameras that have a single one.
    """

    pose: Pose
    preset: str | None = None
    home: bool = False
    viewpoint: str | None = None

    def is_at(self, other: VisitedPosition) -> bool:
        """Return whether another position shows the same view."""
        return self.viewpoint == other.viewpoint != "" and is_same_pose(self.pose, other.pose)


@dataclass(frozen=True, slots=True)
class PositionHistory:
    """The positions of the camera in earlier turns of the conversation.

    Attributes:
        preset: The preset at which the camera is now; None if it is not at a preset.
        earlier: The positions to which "undo" returns, the last one first to be used. Positions that were returned to are left out.
        left: The position that the last move left, if it was a return; "and back again" goes there. Otherwise None.
        corrected: The position before the last command, from which a correction of the command starts; None if it is unknown.
        start: The position at the beginning of the conversation; None if it is unknown.
    """

    preset: str | None = None
    earlier: tuple[VisitedPosition, ...] = ()
    left: VisitedPosition | None = None
    corrected: VisitedPosition | None = None
    start: VisitedPosition | None = None


def is_same_pose(one: Pose, other: Pose) -> bool:
    """Return whether two poses of the same viewpoint differ by no more than the rounding of poses in tool results."""
    return (
        abs(wrap_pan_deg(one.pan_deg - other.pan_deg)) < ANGLE_TOLERANCE_DEG
        and abs(one.tilt_deg - other.tilt_deg) < ANGLE_TOLERANCE_DEG
        and abs(one.zoom / other.zoom - 1) < ZOOM_TOLERANCE
    )


def position_history(conversation: Sequence[PastTurn], effects: Sequence[Effect], viewpoint: str | None) -> PositionHistory:
    """Return the camera's positions in earlier turns.

    Args:
        conversation: The earlier turns.
        effects: What came of the latest of these turns, oldest first. Turns before them are not returned to.
        viewpoint: The camera's viewpoint now; None for a camera that has a single one.
    """
    stack: list[VisitedPosition] = []
    preset, home = None, False  # the place at which the camera is; no longer known once another tool moves it
    left = corrected = start = None
    recent = conversation[len(conversation) - len(effects) :]
    has_viewpoints = viewpoint is not None
    for turn, effect, later in zip(recent, effects, (*recent[1:], None), strict=False):
        begin = None if turn.start is None else VisitedPosition(turn.start, preset, home, _known(turn.viewpoint, has_viewpoints))
        if effect == "done":
            corrected = begin
        end, preset, home = _after(turn, preset, home=home)
        if begin is None or end is None:
            continue
        after = VisitedPosition(end, preset, home, _known(later.viewpoint, has_viewpoints) if later else viewpoint)
        if after.is_at(begin):
            continue
        left = None
        if effect == "returned" and (depth := _depth_of(after, stack)) is not None:
            del stack[depth:]
            left = begin
        elif effect != "corrected" or corrected is None:
            stack.append(begin)
        else:
            stack = [*(stack[:-1] if stack[-1:] == [corrected] else stack), *([] if after.is_at(corrected) else [corrected])]
    if conversation and conversation[0].start is not None:
        start = VisitedPosition(conversation[0].start, viewpoint=_known(conversation[0].viewpoint, has_viewpoints))
    return PositionHistory(preset, tuple(stack), left, corrected, start)


def pose_after(turn: PastTurn) -> Pose | None:
    """Return the camera's pose after a turn; None if no result of the turn states it."""
    return _after(turn, None, home=False)[0]


def _known(viewpoint: str | None, has_viewpoints: bool) -> str | None:
    """Return the viewpoint of an earlier turn: empty if it is unknown, None for a camera that has a single one."""
    return (viewpoint or "") if has_viewpoints else None


def _depth_of(position: VisitedPosition, stack: Sequence[VisitedPosition]) -> int | None:
    """Return the index of the last entry that shows the same view as a position; None if there is none."""
    return next((i for i in reversed(range(len(stack))) if stack[i].is_at(position)), None)


def _after(turn: PastTurn, preset: str | None, *, home: bool) -> tuple[Pose | None, str | None, bool]:
    """Return the pose after a turn (None if the turn reports none), and the place at which the camera then was.

    Args:
        turn: The turn.
        preset: The preset at which the camera was before the turn.
        home: Whether the camera was at home before the turn.
    """
    end, place = None, turn.start
    for outcome in (o for exchange in turn.exchanges for o in exchange.outcomes):
        pose = pose_in(outcome.result)
        if outcome.error is not None or pose is None:
            continue
        end = pose
        if outcome.call.name in {"go_to_preset", "go_home"}:
            preset = str(outcome.call.arguments.get("name")) if outcome.call.name == "go_to_preset" else None
            home, place = outcome.call.name == "go_home", pose
    is_there = end is None or (place is not None and is_same_pose(end, place))
    return end, preset if is_there else None, home and is_there


def pose_in(result: dict[str, Any] | None) -> Pose | None:
    """Return the pose in the result of a tool call; None if it has none."""
    pose = (result or {}).get("pose")
    return Pose(pose["pan_deg"], pose["tilt_deg"], pose["zoom"]) if isinstance(pose, dict) else None
