"""Whether a run looked where its answer comes from. An answer passes only on successful perception that covers its evidence."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from scope_ptz.bench.answers import names_any
from scope_ptz.bench.scoring.episode import Observation
from scope_ptz.bench.tasks.task import EvidenceView, Item
from scope_ptz.geometry import Equirectangular, Perspective, direction

INSET = 0.02
"""A view is covered when its frame is, but for this share at each border: nothing counted lies there."""

MIN_CAP_PX = 14.0
"""Capitals must be this high to be read; the definition of legible."""

_GRID = 9
_EDGE = 1e-6
Floats = NDArray[np.float64]


def uncovered_part(view: EvidenceView, looks: Sequence[Observation]) -> str | None:
    """What of a view the looks leave uncovered, in words; None when they cover it all."""
    here = [look for look in looks if look.known and counts_for(view, look)]
    if not here:
        return f"nothing looked from {view.aim.viewpoint}{' at what was asked' if view.about else ''}"
    if view.whole:
        points = reference_directions(view)
        seen = np.zeros(len(points), dtype=bool)
        for look in here:
            if density_px_deg(look) >= view.min_density_px_deg * (1 - _EDGE):
                seen |= inside(look, points)
        if not seen.all():
            return f"{1 - seen.mean():.0%} of the view from {view.aim.viewpoint} was not looked at closely enough"
    for item in view.items:
        if not any(shows(item, look) for look in here):
            return f"{item.instance} was in no look large enough"
    return None


def counts_for(view: EvidenceView, look: Observation) -> bool:
    """Whether a look is from the right place, at the right time, and about the right thing."""
    if look.viewpoint != view.aim.viewpoint:
        return False
    if view.window_s is not None and not view.window_s[0] <= look.time_s <= view.window_s[1]:
        return False
    return not view.about or look.how == "planner" or names_any(look.asked, view.about)


def reference_directions(view: EvidenceView) -> Floats:
    """Directions (n, 3) all over the reference frame, its border inset; all around in the band when the scope is full."""
    steps = np.linspace(INSET, 1 - INSET, _GRID)
    if view.scope == "full" and view.band_deg is not None:
        bottom, top = view.band_deg
        pans, tilts = np.meshgrid(np.linspace(-180, 165, 24), bottom + steps * (top - bottom))
        return direction(pans.ravel(), tilts.ravel())
    frame = Perspective(view.aim.pan_deg, view.aim.tilt_deg, view.hfov_deg, 1600, round(1600 / view.aspect))
    xs, ys = np.meshgrid(steps, steps)
    return frame.directions(np.stack([xs.ravel(), ys.ravel()], axis=-1))


def inside(look: Observation, directions: Floats) -> NDArray[np.bool_]:
    """Which of some directions (n, 3) lie in the picture of a look."""
    points = look.projection.points(directions)
    with np.errstate(invalid="ignore"):
        return np.asarray(np.all((points >= -_EDGE) & (points <= 1 + _EDGE), axis=-1))


def is_within(item: Item, look: Observation) -> bool:
    """Whether a piece of evidence is wholly in the picture of a look, of whatever size."""
    return bool(inside(look, box_directions(item.box_deg)).all())


def shows(item: Item, look: Observation) -> bool:
    """Whether a piece of evidence is wholly in the picture of a look and large enough there."""
    if not is_within(item, look):
        return False
    outline = box_directions(item.box_deg)
    points = look.projection.points(outline) * (look.projection.width, look.projection.height)
    size = points.max(axis=0) - points.min(axis=0)
    if isinstance(look.projection, Equirectangular) and size[0] > look.projection.width / 2:
        size[0] = look.projection.width - size[0]
    if item.cap_height_deg is not None and item.cap_height_deg * density_px_deg(look) < MIN_CAP_PX * (1 - _EDGE):
        return False
    return bool(size.max() >= item.min_px * (1 - _EDGE))


def box_directions(box_deg: tuple[float, float, float, float], per_side: int = 5) -> Floats:
    """Directions (4 * per_side, 3) along the border of a box of pans and tilts."""
    left, bottom, right, top = box_deg
    width = right - left if right >= left else right - left + 360.0
    t = np.linspace(0.0, 1.0, per_side)
    pans = np.concatenate([left + t * width, left + t * width, np.full(per_side, left), np.full(per_side, left + width)])
    low, high = np.full(per_side, bottom), np.full(per_side, top)
    tilts = np.concatenate([low, high, bottom + t * (top - bottom), bottom + t * (top - bottom)])
    return direction(pans, tilts)


def density_px_deg(look: Observation) -> float:
    """Pixels per degree in the middle of a look's picture."""
    return look.projection.density * math.pi / 180
