"""The ground truth of a view: the only definition of "visible" and "legible", shared by perception and checks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.errors import PackError
from scope_ptz.geometry import Equirectangular, Projection, direction, pan_tilt_deg
from scope_ptz.simulator.actors import Appearance, actor_extent, composited_appearances
from scope_ptz.simulator.models import Extent, SceneActor, SceneInstance, SceneText
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.runs import measure
from scope_ptz.simulator.text_geometry import CELLS, text_geometry
from scope_ptz.simulator.viewpoint import Viewpoint
from scope_ptz.simulator.views import instance_ids

MIN_VISIBLE_PX = 100
"""A visible instance covers at least this many pixels of the frame. A person can name an object of about 10 x 10 pixels."""

MIN_VISIBLE_FRACTION = 0.3
"""At least this fraction of a visible instance's silhouette is neither hidden nor cut off by the frame."""

MIN_CAP_HEIGHT_PX = 11.0
"""Capitals of a legible text are at least this many pixels high in the frame. Tasks demand larger ones, so that they can also be
solved with a vision model that reads a smaller copy of the frame."""

MAX_READING_ANGLE_DEG = 58.0
"""The line of sight to a legible text is at most this many degrees from the text's normal. Packs store no detail for text that is
seen more from the side."""

MIN_UNHIDDEN_FRACTION = 0.9
"""At least this fraction of a legible text is inside the frame and not hidden."""

UNOCCLUDED_FRACTION = 0.95
"""An instance counts as unoccluded if at least this fraction of its silhouette inside the frame is visible.

The tolerance is needed because boundaries cannot be measured exactly.
"""

BoxTuple = tuple[float, float, float, float]
"""``(x_min, y_min, x_max, y_max)``, normalised to [0, 1], with the origin at the top left."""


@dataclass(frozen=True, slots=True)
class Sighting:
    """An instance or actor with at least one pixel in the view.

    Attributes:
        box: Encloses the instance's own pixels.
        point: A point on one of these pixels, near the centre of all of them.
        visible_fraction: Visible solid angle, divided by the solid angle of the whole silhouette.
        pan_deg: Pan of the centre of the visible part.
        tilt_deg: Tilt of the centre of the visible part.
        distance_m: Distance to the instance's nearest point.
        cut: Whether the instance extends beyond the frame.
        occluded: Whether another object hides part of the instance.
    """

    instance: SceneInstance | SceneActor
    box: BoxTuple
    point: tuple[float, float]
    pixels: int
    visible_fraction: float
    pan_deg: float
    tilt_deg: float
    distance_m: float
    cut: bool
    occluded: bool

    @property
    def visible(self) -> bool:
        return self.pixels >= MIN_VISIBLE_PX and self.visible_fraction >= MIN_VISIBLE_FRACTION


@dataclass(frozen=True, slots=True)
class TextSighting:
    """A text that lies at least partly in the frame, with the measurements that determine whether it is legible."""

    text: SceneText
    box: BoxTuple
    cap_height_px: float
    angle_deg: float
    unhidden_fraction: float

    @property
    def legible(self) -> bool:
        return (
            self.cap_height_px >= MIN_CAP_HEIGHT_PX
            and self.angle_deg <= MAX_READING_ANGLE_DEG
            and self.unhidden_fraction >= MIN_UNHIDDEN_FRACTION
        )


@dataclass(frozen=True, slots=True)
class ViewTruth:
    """The instances and texts in a view, nearest first. Answers may use only ``visible`` instances and ``legible`` texts."""

    sightings: tuple[Sighting, ...]
    texts: tuple[TextSighting, ...]

    @property
    def visible(self) -> tuple[Sighting, ...]:
        return tuple(s for s in self.sightings if s.visible)

    @property
    def legible(self) -> tuple[TextSighting, ...]:
        return tuple(t for t in self.texts if t.legible)


def view_truth(scene: Scene, viewpoint: str, projection: Projection, time_s: float) -> ViewTruth:
    """Return the ground truth of an image taken from ``viewpoint`` at scene time ``time_s`` through ``projection``."""
    opened = scene.viewpoint(viewpoint)
    ids = instance_ids(scene, viewpoint, projection, time_s)
    actors = {a.actor.number: a for a in composited_appearances(scene, opened, time_s)}
    return ViewTruth(_sightings(scene, opened, actors, projection, ids), _texts(scene, opened, projection, ids))


def _sightings(
    scene: Scene, viewpoint: Viewpoint, actors: Mapping[int, Appearance], projection: Projection, ids: NDArray[np.uint16]
) -> tuple[Sighting, ...]:
    seen = measure(ids, projection)
    pan, tilt = pan_tilt_deg(projection.directions(seen.centroid))
    extents = dict[int, Extent]()
    for k, instance_id in enumerate(seen.ids.tolist()):
        if instance_id not in scene.by_number:
            raise PackError(
                f"A pixel of scene '{scene.name}' shows instance {instance_id}, which scene.json does not contain. "
                "Bake the scene again."
            )
        if instance_id in actors:
            extents[k] = actor_extent(viewpoint, actors[instance_id])
        # An instance without an extent covers less than one pixel of the bake, so it is never visible.
        elif instance_id in viewpoint.extents:
            extents[k] = viewpoint.extents[instance_id]
    found = []
    for (k, extent), inside in zip(extents.items(), _fractions_inside(list(extents.values()), projection), strict=True):
        visible_fraction = min(1.0, float(seen.solid_angle_sr[k]) / max(extent.solid_angle_sr, 1e-12))
        found.append(
            Sighting(
                instance=scene.by_number[extent.number],
                box=_box(seen.box[k]),
                point=(float(seen.point[k, 0]), float(seen.point[k, 1])),
                pixels=int(seen.pixels[k]),
                visible_fraction=visible_fraction,
                pan_deg=float(pan[k]),
                tilt_deg=float(tilt[k]),
                distance_m=extent.distance_m,
                cut=inside < 1.0,
                occluded=visible_fraction < UNOCCLUDED_FRACTION * inside,
            )
        )
    return tuple(sorted(found, key=lambda s: (s.distance_m, s.instance.number)))


def _fractions_inside(extents: Sequence[Extent], projection: Projection) -> list[float]:
    """Return the fraction of each outline's area that lies inside the frame: 1 if nothing is cut off."""
    hulls = [np.array(extent.hull, dtype=np.float64).reshape(-1, 2) for extent in extents]
    if not hulls:
        return []
    corners = np.concatenate(hulls)
    points = projection.points(direction(corners[:, 0], corners[:, 1]))
    ends = np.cumsum([len(hull) for hull in hulls])[:-1]
    return [_fraction_inside(outline, projection) for outline in np.split(points, ends)]


def _fraction_inside(points: NDArray[np.float64], projection: Projection) -> float:
    if isinstance(projection, Equirectangular) and projection.pan_span_deg >= 360.0:
        # A full panorama cuts off nothing at its left and right edges.
        return float(np.mean((points[:, 1] >= 0) & (points[:, 1] <= 1))) if len(points) else 1.0
    points = points[~np.isnan(points).any(axis=-1)]
    if np.all((points >= 0) & (points <= 1)):
        return 1.0
    outline = cv2.convexHull(points.astype(np.float32))
    frame = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=np.float32)
    whole = abs(float(cv2.contourArea(outline)))
    area_inside, _ = cv2.intersectConvexConvex(outline, frame)
    return min(1.0 - 1e-9, float(area_inside) / whole) if whole > 0 else 1.0 - 1e-9


def _texts(scene: Scene, viewpoint: Viewpoint, projection: Projection, ids: NDArray[np.uint16]) -> tuple[TextSighting, ...]:
    """Return the texts that face the camera and are at least partly in the frame."""
    if not scene.file.texts:
        return ()
    geometry = text_geometry(scene, viewpoint)
    candidates = geometry.may_show(projection)
    points = projection.points(geometry.rays[candidates])
    inside = np.all((points >= 0) & (points < 1), axis=-1)
    in_frame = inside.any(axis=-1)
    candidates, points, inside = candidates[in_frame], points[in_frame], inside[in_frame]
    if not candidates.size:
        return ()
    size = np.array([ids.shape[1], ids.shape[0]])
    texts, cells = np.nonzero(inside)
    pixels = (points[inside] * size).astype(int)
    unhidden = geometry.unhidden_mask(viewpoint, candidates[texts], cells, ids[pixels[:, 1], pixels[:, 0]])
    count = np.bincount(texts[unhidden], minlength=len(candidates))
    low = np.where(inside[..., None], points, np.inf).min(axis=1)
    high = np.where(inside[..., None], points, -np.inf).max(axis=1)
    boxes = np.concatenate([low, high], axis=-1)
    capitals = projection.points(geometry.capitals[candidates])
    found = []
    for k, text in enumerate(candidates.tolist()):
        cap_height_px = float(np.linalg.norm((capitals[k, 1] - capitals[k, 0]) * size))
        found.append(
            TextSighting(
                text=geometry.texts[text],
                box=_box(boxes[k]),
                cap_height_px=0.0 if np.isnan(cap_height_px) else cap_height_px,
                angle_deg=geometry.angle_deg[text],
                unhidden_fraction=float(count[k] / CELLS),
            )
        )
    return tuple(found)


def _box(box: NDArray[np.float64]) -> BoxTuple:
    x_min, y_min, x_max, y_max = (float(v) for v in np.clip(box, 0.0, 1.0))
    return x_min, y_min, x_max, y_max
