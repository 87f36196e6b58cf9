"""An independent reading of the ground truth: what is so in a view whatever a doubtful threshold says.

A *sight* holds the truth of one view at its pose, and at eight poses and moments around it. What it tells holds in all of them, and
under visibility thresholds 30% lower and higher; what does not is not told at all. No language is read or made here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise, product

import numpy as np

from scope_ptz.bench.coverage import box_directions
from scope_ptz.bench.episode import Eyes, Standing
from scope_ptz.bench.tasks import Item
from scope_ptz.geometry import Equirectangular, Perspective, Pose, pan_tilt_deg
from scope_ptz.world.actors import appearances, shows
from scope_ptz.world.models import SceneActor, SceneInstance
from scope_ptz.world.pack import Scene
from scope_ptz.world.truth import (
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

EYES = Eyes(1280, 720)
"""The frames in which tasks are set."""

JITTER_DEG, JITTER_ZOOM = 0.5, 0.03
THRESHOLDS = (0.7, 1.0, 1.3)
"""Shares of the visibility thresholds under which what is told must hold alike."""

TRACE_PX = 20
"""Less than this shows nothing to a person: a thing is absent when no more of it shows."""

LATER_S = (3.0, 6.0, 10.0, 15.0, 20.0, 27.0, 35.0, 45.0)
"""Moments after the start at which the poses around are read."""

TWIN_KINDS = (
    frozenset({"person", "worker", "pedestrian", "passenger", "shopper", "cyclist", "driver", "child", "guard", "busker"}),
    frozenset({"lorry", "truck", "pickup truck", "articulated lorry", "trailer"}),
    frozenset({"bicycle", "cargo bike", "motorcycle", "scooter"}),
    frozenset({"sign", "message sign", "arrow board", "board", "notice", "poster", "banner", "a-board"}),
    frozenset({"car", "taxi", "police car"}),
    frozenset({"bus", "coach", "minibus", "tram", "train"}),
    frozenset({"bin", "litter bin", "wheelie bin"}),
)
"""Kinds of which one person says one, and another the other."""

Thing = SceneInstance | SceneActor


@dataclass(frozen=True)
class Kind:
    """Things of a category, of one colour or with one more attribute where these are given."""

    category: str
    colour: str | None = None
    attribute: tuple[str, str] | None = None

    def fits(self, thing: Thing) -> bool:
        facts = thing.attributes
        return (
            thing.category == self.category
            and (self.colour is None or facts.get("colour") == self.colour)
            and (self.attribute is None or str(facts.get(self.attribute[0])) == self.attribute[1])
        )

    def doubtful(self, thing: Thing) -> bool:
        """Whether somebody could call a thing that does not fit by this kind's name."""
        if self.fits(thing):
            return False
        if thing.category != self.category:
            words, name = set(self.category.split()), set(f"{thing.category} {thing.name}".lower().split())
            return words <= name or any({self.category, thing.category} <= group for group in TWIN_KINDS)
        if self.attribute is not None:
            return self.attribute[0] not in thing.attributes
        colour = str(thing.attributes.get("colour", ""))
        return not colour or bool(set((self.colour or "").split()) & set(colour.split())) or near_colours(self.colour, colour)


def near_colours(one: str | None, other: str) -> bool:
    """Whether people disagree on which of two colours a thing has."""
    return one is not None and any({one, *other.split()} >= pair for pair in _NEAR_COLOURS)


_NEAR_COLOURS = (
    {"silver", "grey"}, {"silver", "white"}, {"orange", "yellow"}, {"orange", "red"}, {"cream", "white"}, {"buff", "yellow"},
    {"purple", "pink"}, {"beige", "cream"}, {"beige", "brown"}, {"grey", "black"},
)  # fmt: skip


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
    def samples(self) -> tuple[ViewTruth, ...]:
        """The truth at the pose, then at the corners of the box of poses around it, each at another moment."""
        first = self.look(self.scene, self.viewpoint, self.projection, self.time_s)
        if self.pose is None:
            moments = LATER_S[1::3]
            return first, *(self.look(self.scene, self.viewpoint, self.projection, self.time_s + s) for s in moments)
        corners = product((-1, 1), repeat=3)
        around = [
            Pose(self.pose.pan_deg + a * JITTER_DEG, self.pose.tilt_deg + b * JITTER_DEG, self.pose.zoom * (1 + c * JITTER_ZOOM))
            for a, b, c in corners
        ]
        return first, *(
            self.look(self.scene, self.viewpoint, EYES.view(p), self.time_s + s) for p, s in zip(around, LATER_S, strict=True)
        )

    @cached_property
    def passing(self) -> frozenset[int]:
        """Numbers of the actors that come into view at one time or another."""
        here, seen = self.scene.viewpoint(self.viewpoint), set[int]()
        longest = max((actor.period_s for actor in self.scene.file.actors), default=0.0)
        for moment in np.arange(0.0, min(longest, 120.0), 0.5):
            seen |= {a.actor.number for a in appearances(self.scene, here, float(moment)) if shows(a, self.projection)}
        return frozenset(seen)

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
        """What is surely visible, nearest first."""
        return tuple(s for s in self.samples[0].sightings if self.state(s.instance.number))

    def of(self, kind: Kind) -> tuple[Sighting, ...] | None:
        """All things of a kind that are visible; None when that is not sure, or somebody could see it differently."""
        found = []
        for sighting in self.samples[0].sightings:
            thing = sighting.instance
            if kind.fits(thing):
                if self.state(thing.number) is None:
                    return None
                if self.state(thing.number):
                    found.append(sighting)
            elif kind.doubtful(thing) and self.state(thing.number) is not False:
                return None
        if any(kind.fits(a) for a in self.scene.file.actors if a.number in self.passing):
            return None
        shown = {s.instance.number for s in self.samples[0].sightings}
        others = (s for truth in self.samples[1:] for s in truth.sightings if s.instance.number not in shown)
        if any(kind.fits(s.instance) and self.state(s.instance.number) is not False for s in others):
            return None
        return tuple(found)

    def lacks(self, kind: Kind) -> bool:
        """Whether nothing of a kind, nor anything that could be taken for it, shows at all, now or later."""
        if any(kind.fits(a) or kind.doubtful(a) for a in self.scene.file.actors if a.number in self.passing):
            return False
        return not any(kind.fits(thing) or kind.doubtful(thing) for thing in self.traces)

    @cached_property
    def traces(self) -> tuple[Thing, ...]:
        """Everything of which more than a trace shows in any of the samples."""
        numbers = {s.instance.number for truth in self.samples for s in truth.sightings if s.pixels > TRACE_PX}
        return tuple(self.scene.by_number[number] for number in sorted(numbers))

    def spot(self, sighting: Sighting) -> list[tuple[float, float]]:
        """The middle of a thing in the frame (x, y in 0..1), at the pose and around it."""
        number = sighting.instance.number
        boxes = [s.box for truth in self.samples for s in truth.sightings if s.instance.number == number]
        return [((b[0] + b[2]) / 2, (b[1] + b[3]) / 2) for b in boxes]

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
        return tuple(sorted((t for t in self.samples[0].texts if t.text.id in ids), key=lambda t: (round(t.box[1], 2), t.box[0])))

    def texts_on(self, thing: Thing) -> tuple[TextSighting, ...] | None:
        """All texts that show on a thing and its parts; None when one of them can be read only by some."""
        family = {self.scene.by_number[n].id for n in self.scene.families[thing.id]}
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


def sight(scene: Scene, at: Standing, time_s: float, *, swept: bool = False) -> Sight:
    """The sight of a standing, or of everything around it."""
    return Sight(scene, at.viewpoint or "", None if swept else at.pose, time_s)


def kinds_in(things: Iterable[Thing]) -> list[Kind]:
    """Every category, and every category with a colour, in a fixed order."""
    found = {(t.category, c) for t in things for c in (None, t.attributes.get("colour")) if c is None or " and " not in str(c)}
    return [Kind(category, str(colour) if colour else None) for category, colour in sorted(found, key=str)]
