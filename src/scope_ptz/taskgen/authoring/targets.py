"""Targets that zoom_to_object can frame: surely found, whole in view, and within reach of the lens."""

from __future__ import annotations

import numpy as np

from scope_ptz.bench.scoring.episode import CameraPosition
from scope_ptz.bench.tasks.task import Framing
from scope_ptz.geometry import Perspective, Pose, direction, pan_tilt_deg
from scope_ptz.simulator.truth import Sighting
from scope_ptz.taskgen.authoring.places import Place
from scope_ptz.taskgen.facts.kinds import Thing
from scope_ptz.taskgen.facts.robust import EYES, Sight

FILL = 0.75
"""How much of its limiting side a framed target takes up."""


SMALLEST_PX = 150
"""What covers less of the frame is too small to be found for sure."""


def close_pose(hull_deg: list[tuple[float, float]], zoom_limits: tuple[float, float]) -> tuple[Pose, float] | None:
    """The pose that frames an outline of directions, and the fill that it reaches; None when it lies behind the stops."""
    outline = direction(*np.array(hull_deg, dtype=np.float64).T)
    middle = outline.mean(axis=0)
    pose, fill = Pose(), 0.0
    for _ in range(10):
        pan, tilt = (float(v) for v in pan_tilt_deg(middle))
        wide = Perspective(pan, tilt, EYES.optics.hfov_deg(1.0), EYES.width, EYES.height)
        points = wide.points(outline)
        if np.isnan(points).any():
            return None
        low, high = points.min(axis=0), points.max(axis=0)
        middle = wide.directions((low + high) / 2)
        size = float((high - low).max())
        zoom = EYES.optics.zoom_for_focal(EYES.optics.focal(1.0) * FILL / max(size, 1e-6))
        pose = Pose(pan, tilt, min(max(zoom, zoom_limits[0]), zoom_limits[1]))
        fill = size * EYES.optics.focal(pose.zoom) / EYES.optics.focal(1.0)
    return pose, fill


def framed(place: Place, sighting: Sighting, thing: Thing) -> Place | None:
    """The view after zooming in on a thing; None when that cannot be foretold (it is cut or half hidden, or a limit cuts)."""
    if sighting.cut or sighting.occluded or sighting.pixels < SMALLEST_PX:
        return None
    extent = place.scene.viewpoint(str(place.at.viewpoint)).extents.get(thing.number)
    limits = EYES.limits
    if extent is None:
        return None
    found = close_pose(extent.hull, (limits.min_zoom, limits.max_zoom))
    if found is None or limits.clamp(found[0])[1] or found[0].zoom < place.at.pose.zoom * 1.1:
        return None
    return Place(place.scene, place.start, place.calls, CameraPosition(place.at.viewpoint, found[0]))


def framing(place: Place, sighting: Sighting, thing: Thing) -> Framing | None:
    """The demand that a thing be framed, where the lens can do that with room to spare and all of it shows."""
    close = framed(place, sighting, thing)
    extent = place.scene.viewpoint(str(place.at.viewpoint)).extents.get(thing.number)
    if close is None or extent is None or sighting.share < 0.97:
        return None
    fill = (close_pose(extent.hull, (EYES.limits.min_zoom, EYES.limits.max_zoom)) or (Pose(), 0.0))[1]
    boxes = Sight(place.scene, str(place.at.viewpoint), close.at.pose, place.sight.time_s)
    if not 0.7 <= fill <= 0.8 or not boxes.state(thing.number):
        return None
    outline = tuple((round(pan, 3), round(tilt, 3)) for pan, tilt in extent.hull)
    return Framing(instance=thing.id, viewpoint=str(place.at.viewpoint), outline_deg=outline)
