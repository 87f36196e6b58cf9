"""Check the coverage of evidence: whether a run observed the views on which its answer depends.

A run passes only if successful observations cover the evidence.
"""

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
"""Width of the margin on each side of a view that need not be covered, as a fraction of the view."""

MIN_CAP_PX = 14.0
"""Minimum height of capital letters in pixels. Smaller text does not count as evidence, although ground truth reads some of it."""

_GRID = 9
"""Number of reference directions along each dimension of a view."""
_TOLERANCE = 1e-6
"""Relative tolerance of all comparisons."""
Floats = NDArray[np.float64]


def uncovered_part(view: EvidenceView, observations: Sequence[Observation]) -> str | None:
    """Describe the part of an evidence view that observations do not cover.

    Args:
        view: A view on which the answer depends.
        observations: The observations of the run.

    Returns:
        A description of the uncovered part, or None if the observations cover the view.
    """
    matching = [observation for observation in observations if observation.known and matches_view(view, observation)]
    if not matching:
        return f"nothing looked from {view.aim.viewpoint}{' at what was asked' if view.about else ''}"
    if view.whole:
        points = reference_directions(view)
        seen = np.zeros(len(points), dtype=bool)
        for observation in matching:
            if density_px_per_deg(observation) >= view.min_density_px_deg * (1 - _TOLERANCE):
                seen |= are_inside(observation, points)
        if not seen.all():
            return f"{1 - seen.mean():.0%} of the view from {view.aim.viewpoint} was not looked at closely enough"
    for item in view.items:
        if not any(is_clearly_shown(item, observation) for observation in matching):
            return f"{item.instance} was in no look large enough"
    return None


def matches_view(view: EvidenceView, observation: Observation) -> bool:
    """Return whether an observation matches the viewpoint, time window and subject of an evidence view."""
    if observation.viewpoint != view.aim.viewpoint:
        return False
    if view.window_s is not None and not view.window_s[0] <= observation.time_s <= view.window_s[1]:
        return False
    return not view.about or observation.kind == "planner" or names_any(observation.request, view.about)


def reference_directions(view: EvidenceView) -> Floats:
    """Return directions on a regular grid over the reference frame of an evidence view, without its margin.

    If the scope is full, the directions cover all pan angles within the view's tilt range.

    Returns:
        Unit vectors of shape ``(n, 3)``.
    """
    steps = np.linspace(INSET, 1 - INSET, _GRID)
    if view.scope == "full" and view.band_deg is not None:
        bottom, top = view.band_deg
        pans, tilts = np.meshgrid(np.linspace(-180, 165, 24), bottom + steps * (top - bottom))
        return direction(pans.ravel(), tilts.ravel())
    frame = Perspective(view.aim.pan_deg, view.aim.tilt_deg, view.hfov_deg, 1600, round(1600 / view.aspect))
    xs, ys = np.meshgrid(steps, steps)
    return frame.directions(np.stack([xs.ravel(), ys.ravel()], axis=-1))


def are_inside(observation: Observation, directions: Floats) -> NDArray[np.bool_]:
    """Return, for each direction in an array of shape ``(n, 3)``, whether it is inside the image of an observation."""
    points = observation.projection.points(directions)
    with np.errstate(invalid="ignore"):
        return np.asarray(np.all((points >= -_TOLERANCE) & (points <= 1 + _TOLERANCE), axis=-1))


def is_within(item: Item, observation: Observation) -> bool:
    """Return whether a piece of evidence is completely inside the image, at any size."""
    return bool(are_inside(observation, box_directions(item.box_deg)).all())


def is_clearly_shown(item: Item, observation: Observation) -> bool:
    """Return whether a piece of evidence is completely inside the image and large enough."""
    if not is_within(item, observation):
        return False
    outline = box_directions(item.box_deg)
    points = observation.projection.points(outline) * (observation.projection.width, observation.projection.height)
    size = points.max(axis=0) - points.min(axis=0)
    if isinstance(observation.projection, Equirectangular) and size[0] > observation.projection.width / 2:
        size[0] = observation.projection.width - size[0]
    if item.cap_height_deg is not None and item.cap_height_deg * density_px_per_deg(observation) < MIN_CAP_PX * (1 - _TOLERANCE):
        return False
    return bool(size.max() >= item.min_px * (1 - _TOLERANCE))


def box_directions(box_deg: tuple[float, float, float, float], per_side: int = 5) -> Floats:
    """Return directions along the border of a box in pan and tilt, as an array of shape ``(4 * per_side, 3)``."""
    left, bottom, right, top = box_deg
    width = right - left if right >= left else right - left + 360.0
    t = np.linspace(0.0, 1.0, per_side)
    pans = np.concatenate([left + t * width, left + t * width, np.full(per_side, left), np.full(per_side, left + width)])
    low, high = np.full(per_side, bottom), np.full(per_side, top)
    tilts = np.concatenate([low, high, bottom + t * (top - bottom), bottom + t * (top - bottom)])
    return direction(pans, tilts)


def density_px_per_deg(observation: Observation) -> float:
    """Return the resolution at the centre of the image, in pixels per degree."""
    return observation.projection.pixels_per_radian * math.pi / 180
