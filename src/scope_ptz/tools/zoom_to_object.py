"""The tool ``zoom_to_object``: detect an object, centre it, and zoom in on it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from pydantic import Field

from scope_ptz import geometry
from scope_ptz.camera.base import Arrival, CameraInfo, Frame
from scope_ptz.geometry import Axis, Pose
from scope_ptz.perception.base import Box
from scope_ptz.tools.aiming import TARGET_FILL, Aim, aim, aim_at_zoom, measure, nearest_box, outline, touches_border
from scope_ptz.tools.arguments import Arguments, Phrase
from scope_ptz.tools.context import ToolContext, pose_text
from scope_ptz.tools.results import PerceptionResult, PoseData
from scope_ptz.tools.tool import Tool

if TYPE_CHECKING:
    from scope_ptz.tools.aiming import Floats

MAX_DETECTIONS = 3
"""Maximum number of perception calls per tool call."""

SMALL_FILL = 0.05
"""Fraction of the frame below which a target is detected again at a closer zoom, to obtain a better box."""

CLOSER_FILL = 0.45
"""Fraction of the frame that the limiting side of a small target should fill for the next detection."""

CUT_OFF_ZOOM_FACTOR = 0.4
"""Factor by which to change the zoom for the next detection of a target that the frame cuts off, so that all of it fits."""

SETTLED_OFFSET = 0.012
SETTLED_FILL = (0.64, 0.86)
"""Maximum offset of a framed target from the centre, as a fraction of the frame, and range of its fill.

A target that meets both criteria is not framed again.
"""


class ZoomToObject(Arguments):
    """Find an object in the current view, centre it and zoom in on it."""

    description: Phrase = Field(description="What to zoom in on, for example 'the white van'.")


class ZoomResult(PerceptionResult):
    """The result of ``zoom_to_object``.

    Attributes:
        description: The description of the target.
        found: Whether anything in view matches the description.
        matches: Number of matches in the first frame.
        chosen: Name of the match on which the camera zoomed in.
        fill: Fraction of the frame that the target's limiting side fills after the move.
        offset: Offset of the target's centre from the frame's centre, as fractions of width and height.
        limited_by: Limits that prevent the target from being centred or from reaching the requested size.
        box: The target in the last frame.
    """

    description: str
    found: bool
    matches: int
    chosen: str = ""
    fill: float | None = None
    offset: tuple[float, float] | None = None
    limited_by: tuple[Axis, ...] = ()
    box: Box | None = None


@dataclass(frozen=True, slots=True)
class _Detection:
    """A detection of the target in a frame."""

    frame: Frame
    box: Box
    matches: int
    source: str

    @property
    def target(self) -> Floats:
        return outline(self.frame, self.box)


async def zoom_to_object(context: ToolContext, arguments: ZoomToObject) -> ZoomResult:
    """Centre an object, and zoom so that its limiting side fills ``TARGET_FILL`` of the frame.

    If several objects match, the first one that perception lists is used; ground truth lists the largest first. After a move, the
    match nearest to the expected position is assumed to be the same object. If nothing is found, the camera does not move.
    """
    start = await context.camera.pose()
    first = await _locate(context, arguments.description, None)
    if isinstance(first, Frame):
        return await _not_found_result(context, arguments.description, first)
    last, detections, target = first, 1, first.target
    frames = [await context.images.save_frame(first.frame)]
    try:
        while True:
            plan = _plan(context.camera.info, await context.camera.pose(), last.box, target, detections)
            is_interim = plan.fill != TARGET_FILL
            if not is_interim and _is_framed(context, await context.camera.pose(), target, plan):
                break
            before = await context.camera.pose()
            arrival = await context.camera.move(plan.pose)
            if detections == MAX_DETECTIONS:
                break
            redetected = await _locate(context, arguments.description, target)
            detections += 1
            if isinstance(redetected, Frame):
                # Perception may not recognise the target in a close-up, but its direction is still known.
                if is_interim:
                    await context.camera.move(aim(context.camera.info, arrival.pose, target).pose)
                break
            if arrival.pose == before and redetected.box == last.box:
                break
            last, target = redetected, redetected.target
    except BaseException:
        await context.camera.move(start)
        raise
    return await _report(context, arguments.description, first, target, tuple(frames))


def _plan(info: CameraInfo, pose: Pose, box: Box, target: Floats, detections: int) -> Aim:
    """Plan the next move: to the final framing if the box shows the whole target, otherwise to a pose for a better detection."""
    if detections < MAX_DETECTIONS and touches_border(box):
        # A large target, or one that is cut off again, may fit only in the widest view.
        large = max(box.width, box.height) > 0.25
        zoom = info.limits.min_zoom if detections > 1 or large else max(pose.zoom * CUT_OFF_ZOOM_FACTOR, info.limits.min_zoom)
        return aim_at_zoom(info, target, zoom)
    small = detections < MAX_DETECTIONS and max(box.width, box.height) < SMALL_FILL
    return aim(info, pose, target, CLOSER_FILL if small else TARGET_FILL)


def _is_framed(context: ToolContext, pose: Pose, target: Floats, plan: Aim) -> bool:
    """Return whether the target is framed well enough, or as well as the limits allow."""
    fill, (dx, dy) = measure(context.camera.info, pose, target)
    if plan.limited_by:
        turn = geometry.angle_between_deg(_view_direction(pose), _view_direction(plan.pose))
        return bool(turn < 0.05) and abs(plan.pose.zoom / pose.zoom - 1) < 0.01
    return max(abs(dx), abs(dy)) <= SETTLED_OFFSET and SETTLED_FILL[0] <= fill <= SETTLED_FILL[1]


def _view_direction(pose: Pose) -> Floats:
    return geometry.direction(pose.pan_deg, pose.tilt_deg)


async def _locate(context: ToolContext, description: str, expected: Floats | None) -> _Detection | Frame:
    """Detect the target in the current view. Return only the frame if the target is not in it.

    Args:
        context: The context of the call.
        description: The description of the target.
        expected: Directions along the target's outline if it has been detected before; None for the first detection.
    """
    frame = await context.camera.frame()
    observation = await context.perception.detect(frame, description)
    box = nearest_box(context.camera.info, frame, observation.boxes, expected) if expected is not None else None
    if expected is None and observation.boxes:
        box = observation.boxes[0]
    return frame if box is None else _Detection(frame, box, len(observation.boxes), observation.source)


async def _not_found_result(context: ToolContext, description: str, frame: Frame) -> ZoomResult:
    """Return the result for a description that nothing in view matches."""
    return ZoomResult(
        message=f"Nothing that fits '{description}' is in view; the camera stayed where it was.",
        pose=PoseData.of(frame.pose),
        source=context.perception.name,
        frames=(await context.images.save_frame(frame),),
        description=description,
        found=False,
        matches=0,
    )


async def _report(context: ToolContext, description: str, first: _Detection, target: Floats, frames: tuple[str, ...]) -> ZoomResult:
    frame = await context.camera.frame()
    info = context.camera.info
    fill, offset = measure(info, frame.pose, target)
    limited_axes = tuple(axis for axis in aim(info, frame.pose, target).limited_by if info.limits.at_stop(frame.pose, axis))
    match_note = f" ({first.matches} match; this is the first that {first.source} names)" if first.matches > 1 else ""
    limit_note = f" The {' and '.join(limited_axes)} limit keeps it from being framed better." if limited_axes else ""
    points = frame.projection.points(target)
    low, high = points.min(axis=0).clip(0, 1), points.max(axis=0).clip(0, 1)
    name = first.box.label or description
    return ZoomResult(
        message=f"Zoomed to {name}{match_note}: it fills {fill:.0%} of the frame; {pose_text(Arrival(frame.pose))}.{limit_note}",
        pose=PoseData.of(frame.pose),
        clamped=limited_axes,
        source=first.source,
        frames=(*frames, await context.images.save_frame(frame)),
        description=description,
        found=True,
        matches=first.matches,
        chosen=name,
        fill=round(fill, 4),
        offset=(round(offset[0], 4), round(offset[1], 4)),
        limited_by=limited_axes,
        box=Box(x_min=low[0], y_min=low[1], x_max=high[0], y_max=high[1], label=first.box.label),
    )


ZOOM_TO_OBJECT = Tool("zoom_to_object", ZoomToObject, zoom_to_object, "Zoom in on an object", moves=True, perceives=True)
