"""Objects that ``zoom_to_object`` can frame: large enough to be detected, entirely in view, and within the zoom range."""

from __future__ import annotations

import numpy as np

from scope_ptz.bench.scoring.episode import CameraPosition
from scope_ptz.bench.tasks.task import Framing
from scope_ptz.geometry import Perspective, Pose, direction, pan_tilt_deg
from scope_ptz.simulator.truth import Sighting
from scope_ptz.taskgen.authoring.task_places import TaskPlace
from scope_ptz.taskgen.facts.kinds import SceneThing
from scope_ptz.taskgen.facts.robust import TASK_CAMERA, RobustTruth

FILL = 0.75
"""Fraction of the frame's width or height that an object fills after ``zoom_to_object``, whichever fraction is larger."""


MIN_TARGET_PX = 150
"""Minimum size of an object in pixels, so that it can be detected reliably."""


def close_up_pose(hull_deg: list[tuple[float, float]], zoom_limits: tuple[float, float]) -> tuple[Pose, float] | None:
    """Return the pose that frames an outline, and the fraction of the frame's width or height that the outline then fills.

    Args:
        hull_deg: Pan and tilt of the points of the outline, in degrees.
        zoom_limits: Minimum and maximum zoom.

    Returns:
        The pose and the fraction; None if no pose shows the whole outline.
    """
    outline = direction(*np.array(hull_deg, dtype=np.float64).T)
    centre = outline.mean(axis=0)
    pose, fill = Pose(), 0.0
    for _ in range(10):
        pan, tilt = (float(v) for v in pan_tilt_deg(centre))
        widest_view = Perspective(pan, tilt, TASK_CAMERA.optics.hfov_deg(1.0), TASK_CAMERA.width, TASK_CAMERA.height)
        points = widest_view.points(outline)
        if np.isnan(points).any():
            return None
        low, high = points.min(axis=0), points.max(axis=0)
        centre = widest_view.directions((low + high) / 2)
        size = float((high - low).max())
        zoom = TASK_CAMERA.optics.zoom_for_focal(TASK_CAMERA.optics.focal(1.0) * FILL / max(size, 1e-6))
        pose = Pose(pan, tilt, min(max(zoom, zoom_limits[0]), zoom_limits[1]))
        fill = size * TASK_CAMERA.optics.focal(pose.zoom) / TASK_CAMERA.optics.focal(1.0)
    return pose, fill


def close_up_place(place: TaskPlace, sighting: Sighting, thing: SceneThing) -> TaskPlace | None:
    """Return the view after zooming in on an object.

    Returns:
        The place; None if the object is too small, cut off or partly hidden, if a limit of the camera prevents the view, or if the
        camera would hardly zoom in.
    """
    if sighting.cut or sighting.occluded or sighting.pixels < MIN_TARGET_PX:
        return None
    extent = place.scene.viewpoint(str(place.at.viewpoint)).extents.get(thing.number)
    limits = TASK_CAMERA.limits
    if extent is None:
        return None
    close_up = close_up_pose(extent.hull, (limits.min_zoom, limits.max_zoom))
    if close_up is None or limits.clamp(close_up[0])[1] or close_up[0].zoom < place.at.pose.zoom * 1.1:
        return None
    return TaskPlace(place.scene, place.start, place.calls, CameraPosition(place.at.viewpoint, close_up[0]))


def target_framing(place: TaskPlace, sighting: Sighting, thing: SceneThing) -> Framing | None:
    """Return the framing that a task requires; None if the object is partly hidden or the zoom range is too small to frame it."""
    close_up = close_up_place(place, sighting, thing)
    extent = place.scene.viewpoint(str(place.at.viewpoint)).extents.get(thing.number)
    if close_up is None or extent is None or sighting.visible_fraction < 0.97:
        return None
    fill = (close_up_pose(extent.hull, (TASK_CAMERA.limits.min_zoom, TASK_CAMERA.limits.max_zoom)) or (Pose(), 0.0))[1]
    close_truth = RobustTruth(place.scene, str(place.at.viewpoint), close_up.at.pose, place.truth.time_s)
    if not 0.7 <= fill <= 0.8 or not close_truth.visibility(thing.number):
        return None
    outline = tuple((round(pan, 3), round(tilt, 3)) for pan, tilt in extent.hull)
    return Framing(instance=thing.id, viewpoint=str(place.at.viewpoint), outline_deg=outline)
