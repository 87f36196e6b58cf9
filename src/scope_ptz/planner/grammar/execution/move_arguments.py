"""Compute the arguments of ``adjust_ptz`` for a requested move, given the camera's pose."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from scope_ptz.geometry import Limits, Pose, wrap_pan_deg
from scope_ptz.planner.grammar.execution.camera_history import ANGLE_TOLERANCE_DEG, ZOOM_TOLERANCE
from scope_ptz.planner.grammar.instruction_tree import Aim, Amount, Move, Turn, Zoom

_DEFAULT_DEG, _LITTLE_DEG = 10.0, 5.0  # turns of unspecified size, and "a little"
_LOT_DEG = {"pan": 45.0, "tilt": 20.0}
_LIMIT_DEG = {"pan": 360.0, "tilt": 90.0}  # turns "all the way", which reach the limit from any pose
_LOOP_PAN_DEG = 15.0  # a loop makes 24 steps by default, which is one full turn
_LOOP_ZOOM_FACTOR = 1.5
_TOLERANCE = 1e-6  # smaller changes that the instruction asks for count as no move


def arguments_of(move: Move, pose: Pose, limits: Limits, in_loop: bool = False) -> dict[str, Any]:
    """Return the arguments of the call that makes a move; empty if the camera is already at the target.

    Whole numbers are returned as integers. In a loop, moves of unspecified size have their own default sizes.
    """
    arguments: dict[str, Any] = {}
    for part in move.parts:
        if isinstance(part, Turn):
            key = f"{part.axis}_deg"
            arguments[key] = arguments.get(key, 0.0) + part.sign * _degrees(part, in_loop)
        elif isinstance(part, Zoom):
            arguments.update(_zoom(part, in_loop))
        else:
            arguments.update(_aim(part, pose, limits))
    return {
        key: without_rounding_noise(value)
        for key, value in arguments.items()
        if isinstance(value, str) or not _has_no_effect(key, value)
    }


def return_arguments(to: Pose, pose: Pose, limits: Limits) -> dict[str, Any]:
    """Return the arguments of the relative move from ``pose`` back to ``to``.

    Differences that come from the rounding of poses in tool results are left out.
    """
    pan = to.pan_deg - pose.pan_deg
    arguments = {
        "pan_deg": wrap_pan_deg(pan) if limits.pan_endless else pan,
        "tilt_deg": to.tilt_deg - pose.tilt_deg,
        "zoom_factor": to.zoom / pose.zoom,
    }
    return {key: without_rounding_noise(value) for key, value in arguments.items() if not _is_rounding(key, value)}


def unlimited_pose_after(arguments: Mapping[str, Any], start: Pose, limits: Limits) -> Pose:
    """Return the pose to which a call of ``adjust_ptz`` would lead if only zooming all the way were limited."""
    factor = arguments.get("zoom_factor", 1 + arguments.get("zoom_percent", 0) / 100)
    if limit := arguments.get("zoom_limit"):
        factor = (limits.max_zoom if limit == "in" else limits.min_zoom) / start.zoom
    return start.turned(arguments.get("pan_deg", 0), arguments.get("tilt_deg", 0)).zoomed(factor)


def _is_rounding(key: str, value: float) -> bool:
    """Return whether the difference of two poses about one axis comes from the rounding of poses in tool results."""
    return abs(value - 1) < ZOOM_TOLERANCE if key == "zoom_factor" else abs(value) < ANGLE_TOLERANCE_DEG


def _has_no_effect(key: str, value: float) -> bool:
    """Return whether an argument's value has no effect: a zoom factor of 1, or 0 for other arguments."""
    return abs(value - (1.0 if key == "zoom_factor" else 0.0)) < _TOLERANCE


def without_rounding_noise(value: Any) -> Any:
    """Return a number without rounding noise and without a trailing ".0"."""
    if not isinstance(value, float):
        return value
    rounded = round(value, 6)
    return int(rounded) if rounded.is_integer() else rounded


def _degrees(turn: Turn, in_loop: bool) -> float:
    amount = turn.amount or Amount()
    return amount.factor * _degrees_of(amount, turn, in_loop)


def _degrees_of(amount: Amount, turn: Turn, in_loop: bool) -> float:
    if amount.kind == "degrees":
        return amount.degrees
    if amount.kind == "unspecified":
        return _LOOP_PAN_DEG if in_loop and turn.axis == "pan" else _DEFAULT_DEG
    if amount.kind == "little":
        return _LITTLE_DEG
    return (_LOT_DEG if amount.kind == "lot" else _LIMIT_DEG)[turn.axis]


def _zoom(zoom: Zoom, in_loop: bool) -> dict[str, Any]:
    if zoom.kind in {"in", "out"}:
        return {"zoom_limit": zoom.kind}
    if zoom.kind == "percent":
        return {"zoom_percent": max(zoom.value, -99.0)}
    unspecified = in_loop and zoom.value in {2.0, 0.5}  # the parser's factors for a zoom without an amount
    return {"zoom_factor": (_LOOP_ZOOM_FACTOR if zoom.value > 1 else 1 / _LOOP_ZOOM_FACTOR) if unspecified else zoom.value}


def _aim(aim: Aim, pose: Pose, limits: Limits) -> dict[str, Any]:
    if aim.axis == "zoom":
        key, change = "zoom_factor", max(aim.value, 0.01) / pose.zoom
    elif aim.axis == "tilt":
        key, change = "tilt_deg", aim.value - pose.tilt_deg
    else:
        turn = limits.aim_pan_deg(aim.value) - pose.pan_deg
        key, change = "pan_deg", wrap_pan_deg(turn) if limits.pan_endless else turn
    return {} if _is_rounding(key, change) else {key: change}
