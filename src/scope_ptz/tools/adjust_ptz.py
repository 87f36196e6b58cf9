"""The tool ``adjust_ptz``: turn and zoom relative to the current pose."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Literal

from pydantic import Field, model_validator

from scope_ptz.geometry import Limits, Pose
from scope_ptz.tools.arguments import Arguments, Degrees
from scope_ptz.tools.context import ToolContext, move_result
from scope_ptz.tools.results import MoveResult
from scope_ptz.tools.tool import Tool

MAX_REQUESTED_ZOOM = 1e6
"""Maximum magnification that a call can request, far beyond any camera. It prevents overflow from huge zoom factors."""


class AdjustPtz(Arguments):
    """Turn and zoom the camera relative to where it looks now. Pan: positive = right. Tilt: positive = up."""

    pan_deg: Degrees = Field(0.0, description="Degrees to turn right (negative: left).")
    tilt_deg: Degrees = Field(0.0, description="Degrees to turn up (negative: down).")
    zoom_factor: Annotated[float, Field(gt=0, allow_inf_nan=False)] | None = Field(
        None, description="Times the present magnification: 2.0 = twice as close, 0.5 = half as close."
    )
    zoom_percent: Annotated[float, Field(gt=-100, allow_inf_nan=False)] | None = Field(
        None, description="Change of magnification in percent: 50 = 1.5 times as close, -50 = half as close."
    )
    zoom_limit: Literal["in", "out"] | None = Field(None, description="Zoom to the stop: 'in' = closest, 'out' = widest.")

    @model_validator(mode="after")
    def _check_single_zoom(self) -> AdjustPtz:
        if sum(v is not None for v in (self.zoom_factor, self.zoom_percent, self.zoom_limit)) > 1:
            raise ValueError("give at most one of zoom_factor, zoom_percent, zoom_limit")
        return self


def requested_pose(start: Pose, arguments: AdjustPtz, limits: Limits) -> Pose:
    """Return the pose that a relative adjustment requests, before clamping."""
    turned = start.turned(arguments.pan_deg, arguments.tilt_deg)
    if arguments.zoom_factor is not None:
        return replace(turned, zoom=min(start.zoom * arguments.zoom_factor, MAX_REQUESTED_ZOOM))
    if arguments.zoom_percent is not None:
        return replace(turned, zoom=min(start.zoom * (1 + arguments.zoom_percent / 100), MAX_REQUESTED_ZOOM))
    if arguments.zoom_limit is not None:
        return replace(turned, zoom=limits.max_zoom if arguments.zoom_limit == "in" else limits.min_zoom)
    return turned


async def adjust_ptz(context: ToolContext, arguments: AdjustPtz) -> MoveResult:
    """Turn and zoom the camera."""
    start = await context.camera.pose()
    arrival = await context.camera.move(requested_pose(start, arguments, context.camera.info.limits))
    verb = "Moved" if arrival.pose != start else "The camera did not move"
    return move_result(context.camera, verb, arrival)


ADJUST_PTZ = Tool("adjust_ptz", AdjustPtz, adjust_ptz, "Turn and zoom", moves=True)
