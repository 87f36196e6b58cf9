"""The tool ``track_object``: detect an object, correct the aim, and repeat for the requested time."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Annotated

from pydantic import BaseModel, ConfigDict, Field

from scope_ptz import geometry
from scope_ptz.camera.base import Frame
from scope_ptz.errors import CameraError
from scope_ptz.geometry import Axis
from scope_ptz.perception.base import Box
from scope_ptz.tools.aiming import extrapolate, pose_towards, sort_axes
from scope_ptz.tools.arguments import Arguments, Phrase
from scope_ptz.tools.context import ToolContext
from scope_ptz.tools.results import PerceptionResult, PoseData
from scope_ptz.tools.tool import Tool

if TYPE_CHECKING:
    from scope_ptz.tools.aiming import Floats

PERIOD_S = 0.5
"""Time between detections in seconds. The paper's control loop runs at 2 Hz."""

DEAD_ZONE = 0.06
"""Maximum offset, as a fraction of the frame, that is left uncorrected to reduce wear on the motors."""

FILL_RANGE = (0.12, 0.5)
TRACKING_FILL = 0.28
"""If the target fills a fraction of the frame outside ``FILL_RANGE``, the zoom is changed so that it fills ``TRACKING_FILL``.

This leaves room for motion, and enough pixels to recognise the target.
"""

MAX_RATE_UNKNOWN_MOTION_DEG_S = 25.0
MAX_RATE_KNOWN_MOTION_DEG_S = 10.0
"""Maximum rates of deviation from a target's expected direction, in degrees per second, before and after its motion is known.

A match that deviates faster is assumed to be a different object.
"""

LOST_DETECTIONS = 2
LOST_ZOOM_FACTOR = 0.6
"""After ``LOST_DETECTIONS`` consecutive detections without the target, the zoom is multiplied by ``LOST_ZOOM_FACTOR``.

This is repeated after each further detection without the target, because a wider view is more likely to show it.
"""


class TrackObject(Arguments):
    """Keep a moving object in the middle of the view for some time."""

    description: Phrase = Field(description="What to follow, for example 'the white van'.")
    duration_s: Annotated[float, Field(gt=0, le=600, allow_inf_nan=False)] = Field(10.0, description="For how many seconds.")


class TrackPoint(BaseModel):
    """The camera's pose at one moment during tracking, and whether the target was seen."""

    model_config = ConfigDict(frozen=True)

    time_s: float
    pose: PoseData
    seen: bool


class TrackResult(PerceptionResult):
    """The result of ``track_object``.

    Attributes:
        description: The description of the followed object.
        found: Whether anything in view matches the description.
        duration_s: The requested time.
        held_share: Fraction of that time during which the target was in view.
        path: The poses of the camera while it followed the target.
    """

    description: str
    found: bool
    duration_s: float
    held_share: float
    path: tuple[TrackPoint, ...] = ()


class _Target:
    """The state of a tracked target: its size, and the directions of its centre in the last two detections."""

    def __init__(self, frame: Frame, box: Box) -> None:
        self.size_deg = _size_deg(frame, box)
        self.centre = _centre_direction(frame, box)
        self.time_s = frame.time_s
        self.previous: tuple[Floats, float] | None = None

    def update(self, frame: Frame, box: Box) -> None:
        """Add a detection."""
        self.previous = (self.centre, self.time_s)
        self.size_deg, self.centre, self.time_s = _size_deg(frame, box), _centre_direction(frame, box), frame.time_s

    def at(self, time_s: float) -> Floats:
        """Return the expected direction at a time, extrapolated from the last two detections by at most two periods."""
        if self.previous is None or self.time_s <= self.previous[1]:
            return self.centre
        ahead = min(max(time_s - self.time_s, 0.0), 2 * PERIOD_S)
        return extrapolate(self.previous[0], self.centre, ahead / (self.time_s - self.previous[1]))

    def find(self, frame: Frame, boxes: tuple[Box, ...]) -> Box | None:
        """Return the box nearest to the expected direction; None if the target cannot have moved that far."""
        expected = self.at(frame.time_s)
        angles = [float(geometry.angle_between_deg(_centre_direction(frame, box), expected)) for box in boxes]
        if not angles:
            return None
        best = min(range(len(boxes)), key=angles.__getitem__)
        rate = MAX_RATE_UNKNOWN_MOTION_DEG_S if self.previous is None else MAX_RATE_KNOWN_MOTION_DEG_S
        return boxes[best] if angles[best] <= self.size_deg + rate * (frame.time_s - self.time_s) else None


def _centre_direction(frame: Frame, box: Box) -> Floats:
    import numpy as np

    return frame.projection.directions(np.array(box.centre))


def _size_deg(frame: Frame, box: Box) -> float:
    import numpy as np

    corners = frame.projection.directions(np.array([[box.x_min, box.y_min], [box.x_max, box.y_max]]))
    return float(geometry.angle_between_deg(corners[0], corners[1]))


async def track_object(context: ToolContext, arguments: TrackObject) -> TrackResult:
    """Keep an object in the centre of the view. If several objects match, follow the first one that perception lists."""
    camera, description = context.camera, arguments.description
    frame = await camera.frame()
    detections = await context.perception.detect(frame, description)
    saved = [await context.images.save_frame(frame)]
    if not detections.boxes:
        return TrackResult(
            message=f"Nothing that fits '{description}' is in view; the camera stayed where it was.",
            pose=PoseData.of(frame.pose), source=detections.source, frames=tuple(saved), description=description,
            found=False, duration_s=0.0, held_share=0.0,
        )  # fmt: skip
    target, box = _Target(frame, detections.boxes[0]), detections.boxes[0]
    started, clamped = frame.time_s, set[Axis]()
    path = [TrackPoint(time_s=0.0, pose=PoseData.of(frame.pose), seen=True)]
    seen: Box | None = box
    misses = 0
    while True:
        if seen is not None:
            clamped |= set(await _correct(context, frame, seen, target))
        elif misses >= LOST_DETECTIONS:
            pose = await camera.pose()
            clamped |= set(await _turn(context, target.at(frame.time_s + PERIOD_S), pose.zoom * LOST_ZOOM_FACTOR)) - {"zoom"}
        remaining_s = arguments.duration_s - (camera.clock.now_s() - started)
        if remaining_s <= 1e-6:
            break
        due_s = started + PERIOD_S * len(path)
        now_s = camera.clock.now_s()
        await camera.clock.sleep(min(max(due_s - now_s, 0.05), remaining_s))
        if camera.clock.now_s() <= now_s:  # without this check, the loop would never end
            raise CameraError("Scene time is stopped, so nothing in the scene moves. Start it, and try again.")
        frame = await camera.frame()
        detections = await context.perception.detect(frame, description)
        seen = target.find(frame, detections.boxes)
        if seen is not None:
            target.update(frame, seen)
        misses = 0 if seen is not None else misses + 1
        path.append(TrackPoint(time_s=round(frame.time_s - started, 3), pose=PoseData.of(frame.pose), seen=seen is not None))
    saved.append(await context.images.save_frame(frame))
    return _report(arguments, detections.source, frame, path, clamped, saved)


async def _correct(context: ToolContext, frame: Frame, seen: Box, target: _Target) -> tuple[Axis, ...]:
    """Aim at the target's expected direction at the next detection. If the target is too small or too large, correct the zoom."""
    info = context.camera.info
    fill = max(seen.width, seen.height)
    offset = max(abs(seen.centre[0] - 0.5), abs(seen.centre[1] - 0.5))
    pose = await context.camera.pose()
    if offset <= DEAD_ZONE and FILL_RANGE[0] <= fill <= FILL_RANGE[1]:
        return ()
    zoom = pose.zoom
    # Zooming in before the motion is known would lose a fast target.
    if fill > FILL_RANGE[1] or (fill < FILL_RANGE[0] and target.previous is not None):
        zoom = info.optics.zoom_for_focal(info.optics.focal(pose.zoom) * TRACKING_FILL / max(fill, 1e-3))
    return await _turn(context, target.at(frame.time_s + PERIOD_S), zoom)


async def _turn(context: ToolContext, towards: Floats, zoom: float) -> tuple[Axis, ...]:
    pan, tilt = (float(v) for v in geometry.pan_tilt_deg(towards))
    return (await context.camera.move(pose_towards(context.camera.info, pan, tilt, zoom))).clamped


def _report(
    arguments: TrackObject, source: str, frame: Frame, path: list[TrackPoint], clamped: set[Axis], saved: list[str]
) -> TrackResult:
    share = _held_share(path)
    limited_axes = sort_axes(clamped)
    limit_note = f" The {' and '.join(limited_axes)} limit was reached." if limited_axes else ""
    return TrackResult(
        message=f"Followed '{arguments.description}' for {arguments.duration_s:g} s; "
        f"it was in view {share:.0%} of the time.{limit_note}",
        pose=PoseData.of(frame.pose),
        clamped=limited_axes,
        source=source,
        frames=tuple(saved),
        description=arguments.description,
        found=True,
        duration_s=arguments.duration_s,
        held_share=round(share, 4),
        path=tuple(path),
    )  # fmt: skip


def _held_share(path: list[TrackPoint]) -> float:
    """Return the fraction of the time that the target was in view. Each detection counts for the time since the previous one."""
    visible_s = sum((current.time_s - previous.time_s) for previous, current in pairwise(path) if current.seen)
    span = max(path[-1].time_s, 1e-9)
    return min(visible_s / span, 1.0) if len(path) > 1 else 1.0


TRACK_OBJECT = Tool("track_object", TrackObject, track_object, "Track an object", moves=True, perceives=True)
