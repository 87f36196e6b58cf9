"""zoom_to_object: find, aim on the sphere, look again, frame it."""

from __future__ import annotations

from dataclasses import dataclass

from scope_ptz.camera.base import Arrival, CameraInfo, Frame
from scope_ptz.geometry import Pose, angle_between_deg, direction
from scope_ptz.perception.base import Box
from scope_ptz.tools.aiming import TARGET_FILL, Aim, Floats, aim, aim_at_zoom, is_cut, measure, nearest, outline
from scope_ptz.tools.arguments import ZoomToObject
from scope_ptz.tools.context import ToolContext, pose_text
from scope_ptz.tools.results import PoseData, ZoomResult

MAX_LOOKS = 3
"""Localisations per call at most."""

SMALL_SHARE = 0.05
"""A target below this share of its limiting side is localised again from closer: its box is too coarse to frame by."""

CLOSER_FILL = 0.45
"""How large a small target is made for the next look."""

CUT_ZOOM = 0.4
"""Change of magnification for the next look at a target that goes on outside the frame: room for the part not seen yet."""

SETTLED_OFFSET = 0.012
SETTLED_FILL = (0.64, 0.86)


@dataclass(frozen=True, slots=True)
class _Look:
    frame: Frame
    box: Box
    matches: int
    source: str

    @property
    def target(self) -> Floats:
        return outline(self.frame, self.box)


async def zoom_to_object(context: ToolContext, arguments: ZoomToObject) -> ZoomResult:
    """Centre an object and make it fill its share of the frame.

    Of several matches the first that perception names is taken (the ground truth: the largest in view). After a move the same
    object is found again as the match nearest to where it must now be. Nothing found: the camera stays where it was.
    """
    start = await context.camera.pose()
    first = await _locate(context, arguments.description, None)
    if isinstance(first, Frame):
        return await _nothing(context, arguments.description, first)
    seen, looks, target = first, 1, first.target
    frames = [context.images.save_look(first.frame)]
    try:
        while True:
            plan = _plan(context.camera.info, await context.camera.pose(), seen.box, target, looks)
            unsure = plan.fill_wanted != TARGET_FILL
            if not unsure and _framed(context, await context.camera.pose(), target, plan):
                break
            before = await context.camera.pose()
            arrival = await context.camera.move(plan.pose)
            if looks == MAX_LOOKS:
                break
            again = await _locate(context, arguments.description, target)
            looks += 1
            if isinstance(again, Frame):
                # Lost on the second look (a blurred or odd close-up): what is known of the target still holds.
                if unsure:
                    await context.camera.move(aim(context.camera.info, arrival.pose, target).pose)
                break
            if arrival.pose == before and again.box == seen.box:
                break
            seen, target = again, again.target
    except BaseException:
        await context.camera.move(start)
        raise
    return await _report(context, arguments.description, first, target, tuple(frames))


def _plan(info: CameraInfo, pose: Pose, box: Box, target: Floats, looks: int) -> Aim:
    """The next move: to the final framing only when the box can be trusted to be the whole target, else to a better look."""
    if looks < MAX_LOOKS and is_cut(box):
        # When much of it shows already, or a second look cut it again, only the widest view is sure to hold all of it.
        large = max(box.width, box.height) > 0.25
        zoom = info.limits.min_zoom if looks > 1 or large else max(pose.zoom * CUT_ZOOM, info.limits.min_zoom)
        return aim_at_zoom(info, target, zoom)
    small = looks < MAX_LOOKS and max(box.width, box.height) < SMALL_SHARE
    return aim(info, pose, target, CLOSER_FILL if small else TARGET_FILL)


def _framed(context: ToolContext, pose: Pose, target: Floats, plan: Aim) -> bool:
    """Whether the camera already frames the target as well as it can."""
    fill, (dx, dy) = measure(context.camera.info, pose, target)
    if plan.limited_by:
        turn = angle_between_deg(_axis(pose), _axis(plan.pose))
        return bool(turn < 0.05) and abs(plan.pose.zoom / pose.zoom - 1) < 0.01
    return max(abs(dx), abs(dy)) <= SETTLED_OFFSET and SETTLED_FILL[0] <= fill <= SETTLED_FILL[1]


def _axis(pose: Pose) -> Floats:
    return direction(pose.pan_deg, pose.tilt_deg)


async def _locate(context: ToolContext, description: str, known: Floats | None) -> _Look | Frame:
    """Look once. Gives the frame alone when the target is not in it."""
    frame = await context.camera.frame()
    found = await context.perception.detect(frame, description)
    box = nearest(context.camera.info, frame, found.boxes, known) if known is not None else None
    if known is None and found.boxes:
        box = found.boxes[0]
    return frame if box is None else _Look(frame, box, len(found.boxes), found.source)


async def _nothing(context: ToolContext, description: str, frame: Frame) -> ZoomResult:
    return ZoomResult(
        message=f"Nothing that fits '{description}' is in view; the camera stayed where it was.",
        pose=PoseData.of(frame.pose),
        source=context.perception.name,
        frames=(context.images.save_look(frame),),
        description=description,
        found=False,
        matches=0,
    )


async def _report(context: ToolContext, description: str, first: _Look, target: Floats, frames: tuple[str, ...]) -> ZoomResult:
    frame = await context.camera.frame()
    info = context.camera.info
    fill, offset = measure(info, frame.pose, target)
    limited = tuple(axis for axis in aim(info, frame.pose, target).limited_by if info.limits.at_stop(frame.pose, axis))
    several = f" ({first.matches} match; this is the first that {first.source} names)" if first.matches > 1 else ""
    bound = f" The {' and '.join(limited)} limit keeps it from being framed better." if limited else ""
    points = frame.projection.points(target)
    low, high = points.min(axis=0).clip(0, 1), points.max(axis=0).clip(0, 1)
    name = first.box.label or description
    return ZoomResult(
        message=f"Zoomed to {name}{several}: it fills {fill:.0%} of the frame; {pose_text(Arrival(frame.pose))}.{bound}",
        pose=PoseData.of(frame.pose),
        clamped=limited,
        source=first.source,
        frames=(*frames, context.images.save_look(frame)),
        description=description,
        found=True,
        matches=first.matches,
        chosen=name,
        fill=round(fill, 4),
        offset=(round(offset[0], 4), round(offset[1], 4)),
        limited_by=limited,
        box=Box(x_min=low[0], y_min=low[1], x_max=high[0], y_max=high[1], label=first.box.label),
    )
