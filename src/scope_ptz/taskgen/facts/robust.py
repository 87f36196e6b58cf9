"""Robust ground truth: facts about a view that remain true if the pose, time and visibility thresholds change slightly.

A view's ground truth is read at the view's own pose, and at eight nearby poses at later times. A sweep is read at its start and at
three later times. A fact is reported only if it holds in all of these samples, and also with visibility thresholds that are 30%
lower and 30% higher. This module does not process language.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from itertools import pairwise, product

import numpy as np
from numpy.typing import NDArray

from scope_ptz.bench.scoring.coverage import MIN_CAP_PX, box_directions
from scope_ptz.bench.scoring.episode import CameraPosition, FrameGeometry
from scope_ptz.bench.tasks.task import Item
from scope_ptz.geometry import Equirectangular, Perspective, Pose, pan_tilt_deg
from scope_ptz.simulator.actors import Appearance, appearances, may_be_visible
from scope_ptz.simulator.models import SceneText
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.truth import (
    MIN_UNHIDDEN_FRACTION,
    MIN_VISIBLE_FRACTION,
    MIN_VISIBLE_PX,
    Sighting,
    TextSighting,
    ViewTruth,
    view_truth,
)
from scope_ptz.taskgen.facts.kinds import INCOMPLETE_CATEGORIES, TEXT_CATEGORIES, UNRECOGNISABLE_CATEGORIES, Kind, SceneThing

_MAX_READING_ANGLE_DEG = 55.0
"""Text that a task is about is larger (``MIN_CAP_PX``), and seen less from the side, than some text that ground truth reads."""

TASK_CAMERA = FrameGeometry(1280, 720)
"""The camera for which tasks are created and validated."""

JITTER_DEG, JITTER_ZOOM = 0.5, 0.03  # offset of the nearby poses in pan and tilt (degrees) and in zoom (fraction)
THRESHOLDS = (0.7, 1.0, 1.3)
"""Factors by which the visibility thresholds are multiplied. A fact must be true with each of them."""

TRACE_PX = 20
"""An object with at most this many visible pixels counts as absent, because people do not notice it."""

FAINT_PX = 40
"""An object with at most this many visible pixels is too small for anyone to count.

If an object has more pixels but does not meet the definition of visible, no question asks how many objects of its kind there are.
"""

_MIN_FACING_COSINE = 0.2
"""Minimum cosine of the angle between the line of sight and the normal of text. Below it, the text is seen edge-on."""

SOON_S = (0.5, 1.0, 1.5, 2.0, 4.5)
"""Seconds after the start at which text must also be legible if actors pass through the view."""

LATER_S = (3.0, 6.0, 10.0, 15.0, 20.0, 27.0, 35.0, 45.0)
"""Seconds after the start at which the nearby poses are read, one for each pose. A sweep is read at three of these times."""


@dataclass(frozen=True)
class RobustTruth:
    """Facts about a view or a sweep that are certainly true.

    Attributes:
        scene: The scene.
        viewpoint: Name of the viewpoint.
        pose: Pose of the view; None for a sweep.
        time_s: Scene time in seconds.
        read_truth: Reads the ground truth of one view.
    """

    scene: Scene
    viewpoint: str
    pose: Pose | None
    time_s: float
    read_truth: Callable[[Scene, str, Perspective | Equirectangular, float], ViewTruth] = field(default=view_truth, compare=False)

    @cached_property
    def projection(self) -> Perspective | Equirectangular:
        """The projection of the view or of the sweep."""
        return TASK_CAMERA.sweep() if self.pose is None else TASK_CAMERA.view(self.pose)

    @cached_property
    def first_sample(self) -> ViewTruth:
        """The ground truth at the pose itself."""
        return self.read_truth(self.scene, self.viewpoint, self.projection, self.time_s)

    @cached_property
    def samples(self) -> tuple[ViewTruth, ...]:
        """The ground truth at the pose itself, then at eight nearby poses at later times. For a sweep, only the time differs."""
        if self.pose is None:
            later_times_s = LATER_S[1::3]
            return self.first_sample, *(
                self.read_truth(self.scene, self.viewpoint, self.projection, self.time_s + s) for s in later_times_s
            )
        corners = product((-1, 1), repeat=3)
        nearby = [
            Pose(self.pose.pan_deg + a * JITTER_DEG, self.pose.tilt_deg + b * JITTER_DEG, self.pose.zoom * (1 + c * JITTER_ZOOM))
            for a, b, c in corners
        ]
        return self.first_sample, *(
            self.read_truth(self.scene, self.viewpoint, TASK_CAMERA.view(p), self.time_s + s)
            for p, s in zip(nearby, LATER_S, strict=True)
        )

    @cached_property
    def passing_actors(self) -> frozenset[int]:
        """Numbers of the actors that are in view at some time."""
        by_actor = _all_appearances(self.scene, self.viewpoint)
        return frozenset(
            number
            for number, seen_appearances in by_actor.items()
            if any(may_be_visible(a, self.projection) for a in seen_appearances)
        )

    @cached_property
    def _visible(self) -> dict[int, set[bool]]:
        """The outcomes of the visibility test across all samples and thresholds, by object number."""
        results: dict[int, set[bool]] = {}
        numbers = {s.instance.number for truth in self.samples for s in truth.sightings}
        for truth in self.samples:
            by_number = {s.instance.number: s for s in truth.sightings}
            for number in numbers:
                sighting = by_number.get(number)
                results.setdefault(number, set()).update(
                    sighting is not None and is_visible(sighting, scale) for scale in THRESHOLDS
                )
        return results

    def visibility(self, number: int) -> bool | None:
        """Return True if an object is certainly visible, False if it is certainly not, and None if that is uncertain."""
        if number in self.passing_actors:
            return None
        outcomes = self._visible.get(number, {False})
        return next(iter(outcomes)) if len(outcomes) == 1 else None

    @cached_property
    def clear_sightings(self) -> tuple[Sighting, ...]:
        """Objects that are certainly visible and recognisable, nearest first."""
        return tuple(
            s for s in self.samples[0].sightings if self.visibility(s.instance.number) and self.is_recognisable(s.instance)
        )

    def is_recognisable(self, thing: SceneThing) -> bool:
        """Return whether people can recognise an object in a picture from this viewpoint.

        Objects of some categories are recognised only by their lettering, which must face the viewpoint.
        """
        if self.is_unreliable(thing.category) or thing.attributes.get("canopy") == "rolled up":
            return False  # a market stall with a rolled-up canopy looks like a bare frame
        if thing.category not in TEXT_CATEGORIES:
            return True
        camera_position = np.array(self.scene.viewpoint(self.viewpoint).manifest.position_m)
        return any(_is_facing(text, camera_position) for text in texts_of_object(self.scene, thing.id)) or not texts_of_object(
            self.scene, thing.id
        )

    def is_unreliable(self, category: str) -> bool:
        """Return whether objects of a category cannot be recognised, or are missing from the ground truth of this scene."""
        return category in UNRECOGNISABLE_CATEGORIES or category in INCOMPLETE_CATEGORIES.get(self.scene.name, ())

    def all_of(self, kind: Kind) -> tuple[Sighting, ...] | None:
        """Return all visible objects of a kind; None if their number is uncertain or people could disagree about it."""
        if self.is_unreliable(kind.category):
            return None
        members = []
        for sighting in self.samples[0].sightings:
            counts = self._counts_as(kind, sighting)
            if counts is None:
                return None
            if counts:
                members.append(sighting)
        return None if self._may_appear(kind) else tuple(members)

    def _counts_as(self, kind: Kind, sighting: Sighting) -> bool | None:
        """Return whether an object certainly counts as a visible object of a kind; None if people could disagree about it."""
        thing = sighting.instance
        visible = self.visibility(thing.number)
        if not kind.fits(thing):
            return None if visible is not False and kind.is_ambiguous_with(thing) else False
        if visible is False:
            return None if thing.number in self.noticeable_numbers else False
        behind_glass = thing.attributes.get("behind") == "glass"  # people disagree whether objects behind a window count
        if visible is None or behind_glass or not self.is_recognisable(thing) or self.is_split_by_sweep(sighting):
            return None
        return True

    def _may_appear(self, kind: Kind) -> bool:
        """Return whether objects of a kind that are not in the view itself may appear in nearby views or at later times."""
        if any(kind.fits(a) or kind.may_be_driver_of(a) for a in self.scene.file.actors if a.number in self.passing_actors):
            return True
        shown = {s.instance.number for s in self.samples[0].sightings}
        others = (s for truth in self.samples[1:] for s in truth.sightings if s.instance.number not in shown)
        return any(kind.fits(s.instance) and self.visibility(s.instance.number) is not False for s in others)

    def is_split_by_sweep(self, sighting: Sighting) -> bool:
        """Return whether an object extends across both ends of a sweep, so that it has no single position."""
        return self.pose is None and sighting.box[2] - sighting.box[0] > 0.5

    def certainly_lacks(self, kind: Kind) -> bool:
        """Return whether the view certainly shows no object of a kind, nor a similar one, at any time."""
        if self.is_unreliable(kind.category) or any(
            kind.fits(a) or kind.is_ambiguous_with(a) for a in self.scene.file.actors if a.number in self.passing_actors
        ):
            return False
        return not any(kind.fits(thing) or kind.is_ambiguous_with(thing) for thing in self.discernible_objects)

    @cached_property
    def noticeable_numbers(self) -> frozenset[int]:
        """Numbers of the objects that are large enough in some sample for an attentive person to count them."""
        return frozenset(s.instance.number for truth in self.samples for s in truth.sightings if s.pixels > FAINT_PX)

    @cached_property
    def discernible_objects(self) -> tuple[SceneThing, ...]:
        """Objects with more than ``TRACE_PX`` visible pixels in any sample."""
        numbers = {s.instance.number for truth in self.samples for s in truth.sightings if s.pixels > TRACE_PX}
        return tuple(self.scene.by_number[number] for number in sorted(numbers))

    @cached_property
    def _objects_in_any_sample(self) -> tuple[SceneThing, ...]:
        """Objects with more than ``TRACE_PX`` visible pixels in any sample, and the actors that pass through the view."""
        passing = tuple(actor for actor in self.scene.file.actors if actor.number in self.passing_actors)
        return tuple(thing for thing in self.discernible_objects if thing not in passing) + passing

    def other_objects(self, sighting: Sighting) -> tuple[SceneThing, ...]:
        """Return all other objects that are in the view at any time."""
        return tuple(thing for thing in self._objects_in_any_sample if thing.number != sighting.instance.number)

    def centres(self, sighting: Sighting) -> list[tuple[float, float]]:
        """Return the position of an object's centre in the frame (x and y from 0 to 1) in each sample that shows it."""
        number = sighting.instance.number
        boxes = [s.box for truth in self.samples for s in truth.sightings if s.instance.number == number]
        return [((b[0] + b[2]) / 2, (b[1] + b[3]) / 2) for b in boxes]

    def areas(self, sighting: Sighting) -> list[float]:
        """Return an object's number of visible pixels in each sample that shows it."""
        number = sighting.instance.number
        return [float(s.pixels) for truth in self.samples for s in truth.sightings if s.instance.number == number]

    def side(self, sighting: Sighting, axis: int, margin: float = 0.06) -> int | None:
        """Return the half of the frame that certainly contains an object.

        Args:
            sighting: The object.
            axis: 0 for left and right, 1 for upper and lower.
            margin: Minimum distance from the centre line to the object's centre, as a fraction of the frame.

        Returns:
            0 for left or upper, 1 for right or lower; None if the object is too close to the centre line.
        """
        low, high = sighting.box[axis], sighting.box[axis + 2]
        coordinates = [centre[axis] for centre in self.centres(sighting)]
        if max(coordinates) < 0.5 - margin and high < 0.5 + margin / 2:
            return 0
        return 1 if min(coordinates) > 0.5 + margin and low > 0.5 - margin / 2 else None

    def sort_by_position(self, things: Sequence[Sighting], axis: int, margin: float = 0.05) -> tuple[Sighting, ...] | None:
        """Sort objects from left to right (axis 0) or top to bottom (axis 1). Return None if two of them are too close together."""
        centres = {s.instance.number: self.centres(s) for s in things}
        order = sorted(things, key=lambda s: centres[s.instance.number][0][axis])
        for one, two in pairwise(order):
            pairs = zip(centres[one.instance.number], centres[two.instance.number], strict=False)
            if any(b[axis] - a[axis] < margin for a, b in pairs):
                return None
        return tuple(order)

    @cached_property
    def legible(self) -> tuple[TextSighting, ...]:
        """Text that is certainly legible, sorted from top to bottom and left to right."""
        legible_ids = [
            {t.text.id for t in truth.texts if all(is_legible(t, scale) for scale in THRESHOLDS)} for truth in self.samples
        ]
        ids = frozenset.intersection(*(frozenset(names) for names in legible_ids))
        for later_s in SOON_S if ids and self.passing_actors else ():
            later_truth = self.read_truth(self.scene, self.viewpoint, self.projection, self.time_s + later_s)
            ids &= {text.text.id for text in later_truth.texts if is_legible(text)}
        return tuple(sorted((t for t in self.samples[0].texts if t.text.id in ids), key=lambda t: (round(t.box[1], 2), t.box[0])))

    def texts_on(self, thing: SceneThing) -> tuple[TextSighting, ...] | None:
        """Return all text on an object and its parts; None if any of it is only partly legible."""
        part_ids = ids_with_parts(self.scene, thing.id)
        legible_ids = {t.text.id for t in self.legible}
        shown = [t for t in self.samples[0].texts if t.text.parent in part_ids and t.unhidden_fraction > 0.3]
        if any(t.text.id not in legible_ids and t.cap_height_px >= MIN_CAP_PX * 0.35 for t in shown):
            return None
        return tuple(t for t in self.legible if t.text.parent in part_ids)

    def item(self, sighting: Sighting, value: str | bool | float | None = None) -> Item:
        """Return an object as evidence: its position, and its minimum size in a run (70% of its size here)."""
        return self._item(sighting.instance.id, sighting.box, value, None)

    def text_item(self, text: TextSighting) -> Item:
        """Return text as evidence: its position, and the minimum height of its capitals in a run."""
        cap_deg = text.cap_height_px / (self.projection.pixels_per_radian * np.pi / 180)
        return self._item(text.text.id, text.box, text.text.text, float(cap_deg))

    def _item(
        self, name: str, box: tuple[float, float, float, float], value: str | bool | float | None, cap_deg: float | None
    ) -> Item:
        """Return an evidence item for a box. The box is shrunk until its outline in pan and tilt lies inside the frame."""
        x0, y0, x1, y1 = box
        for _ in range(12):
            centre_x, centre_y = (x0 + x1) / 2, (y0 + y1) / 2
            ends = np.array([(x0, centre_y), (x1, centre_y), (centre_x, y1), (centre_x, y0)])
            pans, tilts = pan_tilt_deg(self.projection.directions(ends))
            deg = (round(float(pans[0]), 3), round(float(min(tilts)), 3), round(float(pans[1]), 3), round(float(max(tilts)), 3))
            points = self.projection.points(box_directions(deg))
            if np.all((points > 0.012) & (points < 0.988)):
                break
            x0, x1, y0, y1 = (v + (m - v) * 0.15 for v, m in ((x0, centre_x), (x1, centre_x), (y0, centre_y), (y1, centre_y)))
            x0, x1, y0, y1 = (min(max(v, 0.015), 0.985) for v in (x0, x1, y0, y1))
        size = (points.max(axis=0) - points.min(axis=0)) * (self.projection.width, self.projection.height)
        cap_height_deg = None if cap_deg is None else round(cap_deg * 0.97, 4)
        return Item(
            instance=name, value=value, box_deg=deg, min_px=round(0.7 * float(size.max()), 1), cap_height_deg=cap_height_deg
        )


@lru_cache(maxsize=16)
def _all_appearances(scene: Scene, viewpoint: str) -> dict[int, tuple[Appearance, ...]]:
    """Return each actor's appearances by actor number, every 0.5 s over the longest actor period (at most two minutes)."""
    origin, by_actor = scene.viewpoint(viewpoint), dict[int, list[Appearance]]()
    longest = max((actor.period_s for actor in scene.file.actors), default=0.0)
    for time_s in np.arange(0.0, min(longest, 120.0), 0.5):
        for appearance in appearances(scene, origin, float(time_s)):
            by_actor.setdefault(appearance.actor.number, []).append(appearance)
    return {number: tuple(seen_appearances) for number, seen_appearances in by_actor.items()}


@lru_cache(maxsize=4096)
def ids_with_parts(scene: Scene, object_id: str) -> frozenset[str]:
    """Return the ids of an object and of all its parts, including parts of parts."""
    ids = {object_id}
    while new := {part.id for part in scene.file.instances if part.parent in ids} - ids:
        ids |= new
    return frozenset(ids)


@lru_cache(maxsize=4096)
def texts_of_object(scene: Scene, object_id: str) -> tuple[SceneText, ...]:
    """Return the text on an object and its parts."""
    part_ids = ids_with_parts(scene, object_id)
    return tuple(text for text in scene.file.texts if text.parent in part_ids)


def _is_facing(text: SceneText, point: NDArray[np.float64]) -> bool:
    """Return whether the front of text faces a point and is not seen edge-on."""
    normal = np.cross(text.right, text.up)
    direction = point - np.array(text.centre_m)
    return float(normal @ direction) > _MIN_FACING_COSINE * float(np.linalg.norm(direction))


def is_visible(sighting: Sighting, scale: float = 1.0) -> bool:
    """Return whether an object meets the definition of visible, with both thresholds multiplied by ``scale``."""
    return sighting.pixels >= MIN_VISIBLE_PX * scale and sighting.visible_fraction >= MIN_VISIBLE_FRACTION * scale


def is_legible(text: TextSighting, scale: float = 1.0) -> bool:
    """Return whether text is as legible as tasks demand. A ``scale`` above 1 makes all thresholds stricter."""
    return (
        text.cap_height_px >= MIN_CAP_PX * scale
        and text.angle_deg <= min(_MAX_READING_ANGLE_DEG / scale, 85.0)
        and text.unhidden_fraction >= 1 - (1 - MIN_UNHIDDEN_FRACTION) / scale
    )


@lru_cache(maxsize=600)
def robust_truth(scene: Scene, at: CameraPosition, time_s: float, *, swept: bool = False) -> RobustTruth:
    """Return the robust ground truth of a view, or of a sweep from its viewpoint. Recent results are cached."""
    return RobustTruth(scene, at.viewpoint or "", None if swept else at.pose, time_s)
