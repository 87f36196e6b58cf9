"""The ground truth of a view: the only definition of "visible" and "legible", shared by perception and checks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.errors import PackError
from scope_ptz.geometry import Equirectangular, Projection, angle_between_deg, direction, pan_tilt_deg
from scope_ptz.simulator.actors import TOLERANCE_M, TOLERANCE_SHARE, composited, extent
from scope_ptz.simulator.models import Extent, SceneActor, SceneInstance, SceneText
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.reproject import distances_m
from scope_ptz.simulator.runs import measure
from scope_ptz.simulator.viewpoint import Viewpoint
from scope_ptz.simulator.views import instance_numbers

MIN_VISIBLE_PX = 100
"""A visible instance covers at least this many pixels of the frame. A person can name an object of about 10 x 10 pixels."""

MIN_VISIBLE_SHARE = 0.3
"""At least this share of a visible instance's silhouette is neither hidden nor cut off by the frame."""

MIN_CAP_HEIGHT_PX = 14.0
"""Capitals of a legible text are at least this high in the frame."""

MAX_READING_ANGLE_DEG = 55.0
"""A legible text is seen at most this far from its normal."""

MIN_UNHIDDEN_SHARE = 0.9
"""At least this share of a legible text is inside the frame and not hidden."""

UNOCCLUDED_SHARE = 0.95
"""An instance that shows at least this share of its silhouette inside the frame counts as not occluded, because boundaries are
never measured exactly."""

BoxTuple = tuple[float, float, float, float]
"""``(x_min, y_min, x_max, y_max)``, normalised to [0, 1], with the origin at the top left."""


@dataclass(frozen=True, slots=True)
class Sighting:
    """One instance or actor with at least one pixel in the view.

    Attributes:
        box: Encloses the instance's own pixels.
        point: A point on one of these pixels, near their centre.
        share: Solid angle that shows divided by the solid angle of the whole silhouette.
        pan_deg: Pan of the centre of what shows.
        tilt_deg: Tilt of the centre of what shows.
        distance_m: Distance to the nearest point.
        cut: The instance reaches beyond the frame.
        occluded: Something hides part of the instance.
    """

    instance: SceneInstance | SceneActor
    box: BoxTuple
    point: tuple[float, float]
    pixels: int
    share: float
    pan_deg: float
    tilt_deg: float
    distance_m: float
    cut: bool
    occluded: bool

    @property
    def visible(self) -> bool:
        return self.pixels >= MIN_VISIBLE_PX and self.share >= MIN_VISIBLE_SHARE


@dataclass(frozen=True, slots=True)
class TextSighting:
    """One text that lies at least partly in the frame, with the measurements that decide whether it is legible."""

    text: SceneText
    box: BoxTuple
    cap_height_px: float
    angle_deg: float
    unhidden_share: float

    @property
    def legible(self) -> bool:
        return (
            self.cap_height_px >= MIN_CAP_HEIGHT_PX
            and self.angle_deg <= MAX_READING_ANGLE_DEG
            and self.unhidden_share >= MIN_UNHIDDEN_SHARE
        )


@dataclass(frozen=True, slots=True)
class ViewTruth:
    """Everything that shows in a view, nearest first. Answers may use only what is ``visible`` or ``legible``."""

    sightings: tuple[Sighting, ...]
    texts: tuple[TextSighting, ...]

    @property
    def visible(self) -> tuple[Sighting, ...]:
        return tuple(s for s in self.sightings if s.visible)

    @property
    def legible(self) -> tuple[TextSighting, ...]:
        return tuple(t for t in self.texts if t.legible)


def view_truth(scene: Scene, viewpoint: str, projection: Projection, time_s: float) -> ViewTruth:
    """Return the ground truth of a picture taken from ``viewpoint`` at scene time ``time_s`` through ``projection``."""
    here = scene.viewpoint(viewpoint)
    numbers = instance_numbers(scene, viewpoint, projection, time_s)
    extents = here.extents | {a.actor.number: extent(here, a) for a in composited(scene, here, time_s)}
    return ViewTruth(_sightings(scene, projection, numbers, extents), _texts(scene, here, projection, numbers))


def _sightings(
    scene: Scene, projection: Projection, numbers: NDArray[np.uint16], extents: Mapping[int, Extent]
) -> tuple[Sighting, ...]:
    seen = measure(numbers, projection)
    pan, tilt = pan_tilt_deg(projection.directions(seen.middle))
    found = []
    for k, number in enumerate(seen.numbers.tolist()):
        if number not in scene.by_number:
            raise PackError(
                f"A pixel of scene '{scene.name}' shows instance {number}, which scene.json does not know. Bake it again."
            )
        if number not in extents:
            continue  # it covers less than one pixel of the bake from here, so it can never be visible
        extent = extents[number]
        share = min(1.0, float(seen.solid_angle_sr[k]) / max(extent.solid_angle_sr, 1e-12))
        inside = _share_inside(extent, projection)
        found.append(
            Sighting(
                instance=scene.by_number[number],
                box=_box(seen.box[k]),
                point=(float(seen.point[k, 0]), float(seen.point[k, 1])),
                pixels=int(seen.pixels[k]),
                share=share,
                pan_deg=float(pan[k]),
                tilt_deg=float(tilt[k]),
                distance_m=extent.distance_m,
                cut=inside < 1.0,
                occluded=share < UNOCCLUDED_SHARE * inside,
            )
        )
    return tuple(sorted(found, key=lambda s: (s.distance_m, s.instance.number)))


def _share_inside(extent: Extent, projection: Projection) -> float:
    """Return the share of an outline's area that lies inside the frame, 1 when nothing is cut off."""
    hull = np.array(extent.hull, dtype=np.float64).reshape(-1, 2)
    points = projection.points(direction(hull[:, 0], hull[:, 1]))
    if isinstance(projection, Equirectangular) and projection.pan_span_deg >= 360.0:
        # A full panorama cuts nothing at its left and right edges.
        points[:, 0] = 0.5
        return float(np.mean((points[:, 1] >= 0) & (points[:, 1] <= 1))) if len(points) else 1.0
    points = points[~np.isnan(points).any(axis=-1)]
    if np.all((points >= 0) & (points <= 1)):
        return 1.0
    outline = cv2.convexHull(points.astype(np.float32))
    frame = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=np.float32)
    whole = abs(float(cv2.contourArea(outline)))
    shared, _ = cv2.intersectConvexConvex(outline, frame)
    return min(1.0 - 1e-9, float(shared) / whole) if whole > 0 else 1.0 - 1e-9


def _texts(scene: Scene, viewpoint: Viewpoint, projection: Projection, numbers: NDArray[np.uint16]) -> tuple[TextSighting, ...]:
    families, texts = scene.families, scene.file.texts
    near = np.flatnonzero(_may_show(texts, viewpoint, projection)) if texts else ()
    seen = (_text(texts[k], families[texts[k].parent], viewpoint, projection, numbers) for k in near)
    return tuple(s for s in seen if s is not None)


def _may_show(texts: Sequence[SceneText], viewpoint: Viewpoint, projection: Projection) -> NDArray[np.bool_]:
    """Return the texts that face the viewpoint and whose corners do not all lie beyond one edge of the frame."""
    centre, right, up = (np.array([getattr(t, name) for t in texts], dtype=np.float64) for name in ("centre_m", "right", "up"))
    half = np.array([(t.width_m / 2, t.height_m / 2) for t in texts])
    facing = np.sum(np.cross(right, up) * (viewpoint.position_m - centre), axis=-1) > 0
    across, along = right * half[:, :1], up * half[:, 1:]
    corners = np.stack([centre + a * across + b * along for a in (-1, 1) for b in (-1, 1)], axis=1)
    points = projection.points(viewpoint.offset(corners.reshape(-1, 3))).reshape(len(texts), 4, 2)
    with np.errstate(invalid="ignore"):
        beyond = np.any(np.all(points < 0, axis=1) | np.all(points > 1, axis=1), axis=-1)
    behind = np.isnan(points).all(axis=(1, 2))
    return np.asarray(facing & ~beyond & ~behind)


def _text(
    text: SceneText, family: frozenset[int], viewpoint: Viewpoint, projection: Projection, numbers: NDArray[np.uint16]
) -> TextSighting | None:
    """Return the sighting of a text, or None when no part of its front is in the frame."""
    centre, right, up = (np.array(v, dtype=np.float64) for v in (text.centre_m, text.right, text.up))
    towards = viewpoint.position_m - centre
    angle_deg = float(angle_between_deg(np.cross(right, up), towards))
    if angle_deg >= 90.0:
        return None
    # Sample the cells of a grid over the letters; the corners give the box.
    across, along = np.meshgrid((np.arange(24) + 0.5) / 24 - 0.5, (np.arange(8) + 0.5) / 8 - 0.5)
    cells = centre + across[..., None] * text.width_m * right + along[..., None] * text.height_m * up
    rays = viewpoint.offset(cells.reshape(-1, 3))
    points = projection.points(rays)
    inside = np.all((points >= 0) & (points < 1), axis=-1)
    if not inside.any():
        return None
    height, width = numbers.shape
    pixels = (points[inside] * (width, height)).astype(int)
    shown = numbers[pixels[:, 1], pixels[:, 0]]
    own = np.isin(shown, list(family)) & ~_behind_its_own(viewpoint, rays[inside], shown)
    cap = projection.points(viewpoint.offset(centre + np.array([[-0.5], [0.5]]) * text.cap_height_m * up))
    cap_height_px = float(np.linalg.norm((cap[1] - cap[0]) * (width, height)))
    low, high = points[inside].min(axis=0), points[inside].max(axis=0)
    return TextSighting(
        text=text,
        box=_box(np.concatenate([low, high])),
        cap_height_px=0.0 if np.isnan(cap_height_px) else cap_height_px,
        angle_deg=angle_deg,
        unhidden_share=float(own.sum() / len(points)),
    )


def _behind_its_own(viewpoint: Viewpoint, rays: NDArray[np.float64], shown: NDArray[np.uint16]) -> NDArray[np.bool_]:
    """Return which points of a text, as vectors (n, 3) from the optical centre, lie behind what their pixels show.

    Instance numbers reveal other objects that hide a text. Distances reveal parts of the same object that do, such as a shop's
    awning in front of the name on its door.
    """
    still_m, owners = distances_m(viewpoint, rays)
    away_m = np.linalg.norm(rays, axis=-1)
    return np.asarray((owners == shown) & (still_m * (1 + TOLERANCE_SHARE) + TOLERANCE_M < away_m))


def _box(box: NDArray[np.float64]) -> BoxTuple:
    x_min, y_min, x_max, y_max = (float(v) for v in np.clip(box, 0.0, 1.0))
    return x_min, y_min, x_max, y_max
