"""What is really to be seen in a view: the one definition of "visible" and "legible" for perception and for checks."""

from __future__ import annotations

from dataclasses import dataclass

from scope_ptz.geometry import Projection
from scope_ptz.world.models import SceneActor, SceneInstance, SceneText
from scope_ptz.world.pack import Scene

MIN_VISIBLE_PX = 100
"""An instance is visible when it covers at least this many pixels of the frame: about 10 x 10, below which a person sees a speck."""

MIN_VISIBLE_SHARE = 0.3
"""... and when at least this share of its own silhouette is neither hidden nor cut off by the frame."""

MIN_CAP_HEIGHT_PX = 14.0
"""A text is legible when its capitals are at least this high in the frame,"""

MAX_READING_ANGLE_DEG = 55.0
"""... seen at most this far from its normal,"""

MIN_UNHIDDEN_SHARE = 0.9
"""... and at least this share of it is inside the frame and unhidden."""

BoxTuple = tuple[float, float, float, float]
"""``(x_min, y_min, x_max, y_max)``, normalised to [0, 1], origin top-left."""


@dataclass(frozen=True, slots=True)
class Sighting:
    """One instance or actor of which at least one pixel shows.

    ``box`` encloses its own pixels, ``point`` lies on one of them near their middle; ``share`` is the solid angle that shows over
    the solid angle of its whole silhouette; ``pan_deg``/``tilt_deg`` point at the middle of what shows; ``distance_m`` is to its
    nearest point. ``cut``: it reaches beyond the frame. ``occluded``: something hides part of it.
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
    """One text of which at least a part lies in the frame, with the measures that decide whether it can be read."""

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
    """Everything that shows in a view, nearest first; ``visible`` and ``legible`` are what may be counted, described and read."""

    sightings: tuple[Sighting, ...]
    texts: tuple[TextSighting, ...]

    @property
    def visible(self) -> tuple[Sighting, ...]:
        return tuple(s for s in self.sightings if s.visible)

    @property
    def legible(self) -> tuple[TextSighting, ...]:
        return tuple(t for t in self.texts if t.legible)


def view_truth(scene: Scene, viewpoint: str, projection: Projection, time_s: float) -> ViewTruth:
    """The ground truth of a picture taken from ``viewpoint`` at scene time ``time_s`` through ``projection``."""
    raise NotImplementedError
