"""An independent reading of the ground truth: what is so in a view whatever a doubtful threshold says.

A *sight* holds the truth of one view at its pose, and at eight poses and moments around it. What it tells holds in all of them, and
under visibility thresholds 30% lower and higher; what does not is not told at all. No language is read or made here.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from itertools import pairwise, product

import numpy as np
from numpy.typing import NDArray

from scope_ptz.bench.scoring.coverage import box_directions
from scope_ptz.bench.scoring.episode import CameraPosition, FrameGeometry
from scope_ptz.bench.tasks.task import Item
from scope_ptz.geometry import Equirectangular, Perspective, Pose, pan_tilt_deg
from scope_ptz.simulator.actors import Appearance, appearances, shows
from scope_ptz.simulator.models import SceneText
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.truth import (
    MAX_READING_ANGLE_DEG,
    MIN_CAP_HEIGHT_PX,
    MIN_UNHIDDEN_SHARE,
    MIN_VISIBLE_PX,
    MIN_VISIBLE_SHARE,
    Sighting,
    TextSighting,
    ViewTruth,
    view_truth,
)
from scope_ptz.taskgen.facts.kinds import BACKDROP, FACELESS, KNOWN_BY_THEIR_FACE, Kind, Thing

EYES = FrameGeometry(1280, 720)
"""The frames in which tasks are set."""

JITTER_DEG, JITTER_ZOOM = 0.5, 0.03
THRESHOLDS = (0.7, 1.0, 1.3)
"""Shares of the visibility thresholds under which what is told must hold alike."""

TRACE_PX = 20
"""Less than this shows nothing to a person: a thing is absent when no more of it shows."""

FAINT_PX = 40
"""What is not visible by definition but shows more than this may be counted by somebody: then nothing of its kind is."""

_EDGE = 0.2
"""Cosine of the angle to a surface's normal below which one looks along it rather than at it."""

SOON_S = (0.5, 1.0, 1.5, 2.0, 4.5)
"""Moments at which texts are read too, where somebody may walk by."""

LATER_S = (3.0, 6.0, 10.0, 15.0, 20.0, 27.0, 35.0, 45.0)
"""Moments after the start at which the poses around are read."""


@dataclass(frozen=True)
class Sight:
    """What is surely so in a view. ``pose`` None: everything around, as a sweep shows it."""

    scene: Scene
    viewpoint: str
    pose: Pose | None
    time_s: float
    look: Callable[[Scene, str, Perspective | Equirectangular, float], ViewTruth] = field(default=view_truth, compare=False)

    @cached_property
    def projection(self) -> Perspective | Equirectangular:
        return EYES.sweep() if self.pose is None else EYES.view(self.pose)

    @cached_property
    def first(self) -> ViewTruth:
        """The truth at the pose itself."""
        return self.look(self.scene, self.viewpoint, self.projection, self.time_s)

    @cached_property
    def samples(self) -> tuple[ViewTruth, ...]:
        """The truth at the pose, then at the corners of the box of poses around it, each at another moment."""
        if self.pose is None:
            moments = LATER_S[1::3]
            return self.first, *(self.look(self.scene, self.viewpoint, self.projection, self.time_s + s) for s in moments)
        corners = product((-1, 1), repeat=3)
        around = [
            Pose(self.pose.pan_deg + a * JITTER_DEG, self.pose.tilt_deg + b * JITTER_DEG, self.pose.zoom * (1 + c * JITTER_ZOOM))
            for a, b, c in corners
        ]
        return self.first, *(
            self.look(self.scene, self.viewpoint, EYES.view(p), self.time_s + s) for p, s in zip(around, LATER_S, strict=True)
        )

    @cached_property
    def passing(self) -> frozenset[int]:
        """Numbers of the actors that come into view at one time or another."""
        found = _all_appearances(self.scene, self.viewpoint)
        return frozenset(number for number, seen in found.items() if any(shows(a, self.projection) for a in seen))

    @cached_property
    def _visible(self) -> dict[int, set[bool]]:
        """What the samples and thresholds say of each thing that shows in any of them."""
        told: dict[int, set[bool]] = {}
        numbers = {s.instance.number for truth in self.samples for s in truth.sightings}
        for truth in self.samples:
            by_number = {s.instance.number: s for s in truth.sightings}
            for number in numbers:
                sighting = by_number.get(number)
                told.setdefault(number, set()).update(sighting is not None and visible(sighting, scale) for scale in THRESHOLDS)
        return told

    def state(self, number: int) -> bool | None:
        """Whether a thing is visible: surely, surely not, or (None) it depends."""
        if number in self.passing:
            return None
        said = self._visible.get(number, {False})
        return next(iter(said)) if len(said) == 1 else None

    @cached_property
    def clear(self) -> tuple[Sighting, ...]:
        """What is surely visible and can be told to be what it is, nearest first."""
        return tuple(s for s in self.samples[0].sightings if self.state(s.instance.number) and self.telling(s.instance))

    def telling(self, thing: Thing) -> bool:
        """Whether a picture from here shows what a thing is: its lettered side, where only that tells it."""
        if self.untold(thing.category) or thing.attributes.get("canopy") == "rolled up":
            return False  # a bare frame is hardly a stall
        if thing.category not in KNOWN_BY_THEIR_FACE:
            return True
        from_here = np.array(self.scene.viewpoint(self.viewpoint).manifest.position_m)
        return any(_faces(text, from_here) for text in lettering(self.scene, thing.id)) or not lettering(self.scene, thing.id)

    def untold(self, category: str) -> bool:
        """Whether a picture of this scene does not tell what is of a category, or shows more of it than the ground truth holds."""
        return category in FACELESS or category in BACKDROP.get(self.scene.name, ())

    def of(self, kind: Kind) -> tuple[Sighting, ...] | None:
        """All things of a kind that are visible; None when that is not sure, or somebody could see it differently."""
        found = []
        if self.untold(kind.category):
            return None
        for sighting in self.samples[0].sightings:
            thing = sighting.instance
            if kind.fits(thing):
                if self.state(thing.number) is not False and not self.telling(thing):
                    return None
                if thing.attributes.get("behind") == "glass" and self.state(thing.number) is not False:
                    return None  # whether what is inside a window counts, people do not agree on
                if self.state(thing.number) is None or (not self.state(thing.number) and thing.number in self.faint):
                    return None
                if self.state(thing.number):
                    if self.parted(sighting):
                        return None
                    found.append(sighting)
            elif kind.doubtful(thing) and self.state(thing.number) is not False:
                return None
        if any(kind.fits(a) or kind.rides_on(a) for a in self.scene.file.actors if a.number in self.passing):
            return None
        shown = {s.instance.number for s in self.samples[0].sightings}
        others = (s for truth in self.samples[1:] for s in truth.sightings if s.instance.number not in shown)
        if any(kind.fits(s.instance) and self.state(s.instance.number) is not False for s in others):
            return None
        return tuple(found)

    def parted(self, sighting: Sighting) -> bool:
        """Whether a thing lies across the two ends of a sweep, so that it has no one place in it."""
        return self.pose is None and sighting.box[2] - sighting.box[0] > 0.5

    def lacks(self, kind: Kind) -> bool:
        """Whether nothing of a kind, nor anything that could be taken for it, shows at all, now or later."""
        if self.untold(kind.category) or any(
            kind.fits(a) or kind.doubtful(a) for a in self.scene.file.actors if a.number in self.passing
        ):
            return False
        return not any(kind.fits(thing) or kind.doubtful(thing) for thing in self.traces)

    @cached_property
    def faint(self) -> frozenset[int]:
        """Numbers of the things of which so much shows in some sample that a person with good eyes would count them."""
        return frozenset(s.instance.number for truth in self.samples for s in truth.sightings if s.pixels > FAINT_PX)

    @cached_property
    def traces(self) -> tuple[Thing, ...]:
        """Everything of which more than a trace shows in any of the samples."""
        numbers = {s.instance.number for truth in self.samples for s in truth.sightings if s.pixels > TRACE_PX}
        return tuple(self.scene.by_number[number] for number in sorted(numbers))

    @cached_property
    def _met(self) -> tuple[Thing, ...]:
        """Everything of which more than a trace shows in any sample, and what comes by."""
        passing = tuple(actor for actor in self.scene.file.actors if actor.number in self.passing)
        return tuple(thing for thing in self.traces if thing not in passing) + passing

    def others(self, sighting: Sighting) -> tuple[Thing, ...]:
        """Everything else that could be taken for a thing, now or later."""
        return tuple(thing for thing in self._met if thing.number != sighting.instance.number)

    def spot(self, sighting: Sighting) -> list[tuple[float, float]]:
        """The middle of a thing in the frame (x, y in 0..1), at the pose and around it."""
        number = sighting.instance.number
        boxes = [s.box for truth in self.samples for s in truth.sightings if s.instance.number == number]
        return [((b[0] + b[2]) / 2, (b[1] + b[3]) / 2) for b in boxes]

    def areas(self, sighting: Sighting) -> list[float]:
        """How many pixels a thing covers, at the pose and around it."""
        number = sighting.instance.number
        return [float(s.pixels) for truth in self.samples for s in truth.sightings if s.instance.number == number]

    def side(self, sighting: Sighting, axis: int, margin: float = 0.06) -> int | None:
        """0 or 1: the left or right (axis 0), upper or lower (axis 1) half that holds a thing, well clear of the middle line."""
        low, high = sighting.box[axis], sighting.box[axis + 2]
        middles = [spot[axis] for spot in self.spot(sighting)]
        if max(middles) < 0.5 - margin and high < 0.5 + margin / 2:
            return 0
        return 1 if min(middles) > 0.5 + margin and low > 0.5 - margin / 2 else None

    def in_order(self, things: Sequence[Sighting], axis: int, margin: float = 0.05) -> tuple[Sighting, ...] | None:
        """Things from left to right (or top to bottom); None when two of them are about level."""
        spots = {s.instance.number: self.spot(s) for s in things}
        order = sorted(things, key=lambda s: spots[s.instance.number][0][axis])
        for one, two in pairwise(order):
            pairs = zip(spots[one.instance.number], spots[two.instance.number], strict=False)
            if any(b[axis] - a[axis] < margin for a, b in pairs):
                return None
        return tuple(order)

    @cached_property
    def legible(self) -> tuple[TextSighting, ...]:
        """Texts that can surely be read, top to bottom and left to right."""
        sure = [{t.text.id for t in truth.texts if all(legible(t, scale) for scale in THRESHOLDS)} for truth in self.samples]
        ids = frozenset.intersection(*(frozenset(names) for names in sure))
        for later_s in SOON_S if ids and self.passing else ():
            soon = self.look(self.scene, self.viewpoint, self.projection, self.time_s + later_s)
            ids &= {text.text.id for text in soon.legible}
        return tuple(sorted((t for t in self.samples[0].texts if t.text.id in ids), key=lambda t: (round(t.box[1], 2), t.box[0])))

    def texts_on(self, thing: Thing) -> tuple[TextSighting, ...] | None:
        """All texts that show on a thing and its parts; None when one of them can be read only by some."""
        family = with_parts(self.scene, thing.id)
        legible_ids = {t.text.id for t in self.legible}
        shown = [t for t in self.samples[0].texts if t.text.parent in family and t.unhidden_share > 0.3]
        if any(t.text.id not in legible_ids and t.cap_height_px >= MIN_CAP_HEIGHT_PX * 0.35 for t in shown):
            return None
        return tuple(t for t in self.legible if t.text.parent in family)

    def item(self, sighting: Sighting, value: str | bool | float | None = None) -> Item:
        """A thing as evidence: where it shows, and how large it must be to be told (70% of what it is here)."""
        return self._item(sighting.instance.id, sighting.box, value, None)

    def text_item(self, text: TextSighting) -> Item:
        cap_deg = text.cap_height_px / (self.projection.density * np.pi / 180)
        return self._item(text.text.id, text.box, text.text.text, float(cap_deg))

    def _item(
        self, name: str, box: tuple[float, float, float, float], value: str | bool | float | None, cap_deg: float | None
    ) -> Item:
        x0, y0, x1, y1 = box
        for _ in range(12):
            middle_x, middle_y = (x0 + x1) / 2, (y0 + y1) / 2
            ends = np.array([(x0, middle_y), (x1, middle_y), (middle_x, y1), (middle_x, y0)])
            pans, tilts = pan_tilt_deg(self.projection.directions(ends))
            deg = (round(float(pans[0]), 3), round(float(min(tilts)), 3), round(float(pans[1]), 3), round(float(max(tilts)), 3))
            points = self.projection.points(box_directions(deg))
            if np.all((points > 0.012) & (points < 0.988)):
                break
            x0, x1, y0, y1 = (v + (m - v) * 0.15 for v, m in ((x0, middle_x), (x1, middle_x), (y0, middle_y), (y1, middle_y)))
            x0, x1, y0, y1 = (min(max(v, 0.015), 0.985) for v in (x0, x1, y0, y1))
        size = (points.max(axis=0) - points.min(axis=0)) * (self.projection.width, self.projection.height)
        cap = None if cap_deg is None else round(cap_deg * 0.97, 4)
        return Item(instance=name, value=value, box_deg=deg, min_px=round(0.7 * float(size.max()), 1), cap_height_deg=cap)


@lru_cache(maxsize=16)
def _all_appearances(scene: Scene, viewpoint: str) -> dict[int, tuple[Appearance, ...]]:
    """Of each actor every place where it is to be seen in the first two minutes, twice a second, by its number."""
    here, found = scene.viewpoint(viewpoint), dict[int, list[Appearance]]()
    longest = max((actor.period_s for actor in scene.file.actors), default=0.0)
    for moment in np.arange(0.0, min(longest, 120.0), 0.5):
        for appearance in appearances(scene, here, float(moment)):
            found.setdefault(appearance.actor.number, []).append(appearance)
    return {number: tuple(seen) for number, seen in found.items()}


@lru_cache(maxsize=4096)
def with_parts(scene: Scene, whole: str) -> frozenset[str]:
    """Ids of a thing, its parts, and theirs."""
    found = {whole}
    while grown := {part.id for part in scene.file.instances if part.parent in found} - found:
        found |= grown
    return frozenset(found)


@lru_cache(maxsize=4096)
def lettering(scene: Scene, whole: str) -> tuple[SceneText, ...]:
    """What is written on a thing and its parts."""
    family = with_parts(scene, whole)
    return tuple(text for text in scene.file.texts if text.parent in family)


def _faces(text: SceneText, eye: NDArray[np.float64]) -> bool:
    """Whether a text turns its written side to a point, and not merely its edge."""
    ahead = np.cross(text.right, text.up)
    towards = eye - np.array(text.centre_m)
    return float(ahead @ towards) > _EDGE * float(np.linalg.norm(towards))


def visible(sighting: Sighting, scale: float = 1.0) -> bool:
    """The definition of visible, with both thresholds scaled."""
    return sighting.pixels >= MIN_VISIBLE_PX * scale and sighting.share >= MIN_VISIBLE_SHARE * scale


def legible(text: TextSighting, scale: float = 1.0) -> bool:
    """The definition of legible, made stricter or laxer."""
    return (
        text.cap_height_px >= MIN_CAP_HEIGHT_PX * scale
        and text.angle_deg <= min(MAX_READING_ANGLE_DEG / scale, 85.0)
        and text.unhidden_share >= 1 - (1 - MIN_UNHIDDEN_SHARE) / scale
    )


@lru_cache(maxsize=600)
def sight(scene: Scene, at: CameraPosition, time_s: float, *, swept: bool = False) -> Sight:
    """The sight of a standing, or of everything around it."""
    return Sight(scene, at.viewpoint or "", None if swept else at.pose, time_s)
