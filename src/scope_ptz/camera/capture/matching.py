"""Match image features between overlapping frames, near the positions that the reported poses predict."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import Perspective, angle_between_deg
from scope_ptz.geometry.sphere import camera_axes

GATE_DEG = 3.0
"""Maximum angle in degrees between matching features, according to the reported poses.

If the reported poses of two frames are off by more, their features are not matched.
"""

MAX_FEATURES = 1000  # per frame
RATIO = 0.85  # maximum ratio of the best to the second-best distance (Lowe's ratio test), among the features within the gate
MIN_INLIERS = 12
"""Minimum number of matches between two frames. Fewer may agree by chance."""

AGREEMENT_PX = 4.0
"""Maximum distance in pixels at which a match agrees with a rotation. It is large enough for errors of the field of view."""

MAX_MATCHES = 80  # per pair; more matches do not improve the precision
MIN_OVERLAP = 0.15  # minimum overlap of a pair, as a fraction of the smaller frame
_HYPOTHESES = 96  # rotations that RANSAC tries per pair of frames

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Features:
    """Features of a frame: points (n, 2) in pixels from its centre, with right and up positive, and SIFT descriptors (n, 128)."""

    points: Floats
    descriptors: NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class PairMatches:
    """Matching points of the frames ``first`` and ``second``, as (n, 2) pixels from their centres."""

    first: int
    second: int
    first_px: Floats
    second_px: Floats


def find_features(image: NDArray[np.uint8], hidden: NDArray[np.bool_] | None = None) -> Features:
    """Return the features of a frame, (H, W, 3) RGB, outside its hidden pixels (H, W)."""
    sift = cv2.SIFT_create(nfeatures=MAX_FEATURES)  # type: ignore[attr-defined]
    mask = None if hidden is None else np.where(hidden, 0, 255).astype(np.uint8)
    points, descriptors = sift.detectAndCompute(cv2.cvtColor(image, cv2.COLOR_RGB2GRAY), mask)
    if not points:
        return Features(np.zeros((0, 2)), np.zeros((0, 128), np.float32))
    height, width = image.shape[:2]
    places = np.array([point.pt for point in points], np.float64)
    centred = (places - ((width - 1) / 2, (height - 1) / 2)) * (1.0, -1.0)
    # Square roots of normalised descriptors compare better (Arandjelovic and Zisserman, "Three things everyone should know").
    rooted = np.sqrt(descriptors / np.maximum(descriptors.sum(axis=1, keepdims=True), 1e-9))
    return Features(centred, np.asarray(rooted, np.float32))


def overlapping_pairs(views: Sequence[Perspective]) -> list[tuple[int, int]]:
    """Return the pairs of frames that overlap by at least ``MIN_OVERLAP``."""
    grid = np.stack(np.meshgrid((np.arange(12) + 0.5) / 12, (np.arange(8) + 0.5) / 8), axis=-1)
    rays = [view.directions(grid) for view in views]
    middles = np.array([view.directions((0.5, 0.5)) for view in views]).reshape(-1, 3)
    pairs = []
    for i, view in enumerate(views):
        apart = angle_between_deg(middles[i + 1 :], middles[i])
        for j in (
            i + 1 + np.flatnonzero(apart < view.max_off_axis_deg + np.array([v.max_off_axis_deg for v in views[i + 1 :]]))
        ).tolist():
            small, large = (i, j) if view.hfov_deg <= views[j].hfov_deg else (j, i)
            points = views[large].points(rays[small])
            if np.mean(np.all((points > 0) & (points < 1), axis=-1)) >= MIN_OVERLAP:
                pairs.append((i, j))
    return pairs


def match_frames(
    views: Sequence[Perspective], features: Callable[[int], Features], progress: Callable[[int, int], None] = lambda *_: None
) -> list[PairMatches]:
    """Return the matches of all overlapping pairs that have at least ``MIN_INLIERS``.

    Args:
        views: The frames, at their reported poses.
        features: A function that returns the features of frame ``i``.
        progress: Called with the number of finished pairs and the total number of pairs.
    """
    pairs = overlapping_pairs(views)
    result = []
    for number, (i, j) in enumerate(pairs):
        matches = _match(views, features, i, j)
        if matches is not None:
            result.append(matches)
        progress(number + 1, len(pairs))
    return result


def world_directions(view: Perspective, points_px: Floats) -> Floats:
    """Return the directions (n, 3) of pixels of a frame at its reported pose. Pixels are relative to the frame's centre."""
    rays = np.column_stack([points_px, np.full(len(points_px), view.focal_px)])
    return np.asarray((rays / np.linalg.norm(rays, axis=1, keepdims=True)) @ camera_axes(view.pan_deg, view.tilt_deg))


def _match(views: Sequence[Perspective], features: Callable[[int], Features], i: int, j: int) -> PairMatches | None:
    """Return the matches of two frames that agree with one rotation; None if there are too few."""
    one, two = features(i), features(j)
    rays_1, rays_2 = world_directions(views[i], one.points), world_directions(views[j], two.points)
    here, there = _seen_by(views[j], rays_1), _seen_by(views[i], rays_2)
    if min(len(here), len(there)) < MIN_INLIERS:
        return None
    near = rays_1[here] @ rays_2[there].T > np.cos(np.radians(GATE_DEG))
    likeness = np.where(near, one.descriptors[here] @ two.descriptors[there].T, -1.0)
    matched = _mutual_best(likeness)
    if len(matched) < MIN_INLIERS:
        return None
    first, second = here[matched[:, 0]], there[matched[:, 1]]
    tolerance = AGREEMENT_PX / min(views[i].focal_px, views[j].focal_px)
    agreed = _consensus(rays_1[first], rays_2[second], tolerance, seed=i * 100_003 + j)
    if len(agreed) < MIN_INLIERS:
        return None
    agreed = agreed[np.linspace(0, len(agreed) - 1, min(len(agreed), MAX_MATCHES)).astype(int)]
    return PairMatches(i, j, one.points[first[agreed]], two.points[second[agreed]])


def _seen_by(view: Perspective, rays: Floats) -> NDArray[np.int64]:
    """Return the indices of the rays that a frame may show, with a margin for the error of its pose."""
    points = view.points(rays)
    margin = GATE_DEG / view.hfov_deg
    return np.flatnonzero(np.all((points > -margin) & (points < 1 + margin), axis=-1))


def _mutual_best(likeness: NDArray[np.float32]) -> NDArray[np.int64]:
    """Return the pairs of row and column (n, 2) that are each other's best match and pass the ratio test."""
    best = likeness.argmax(axis=1)
    rows = np.arange(len(likeness))
    top = likeness[rows, best]
    rest = likeness.copy()
    rest[rows, best] = -1.0
    second = np.maximum(rest.max(axis=1), 0.0)
    # Likeness is the cosine of unit vectors: their distance is sqrt(2 - 2 * likeness).
    clear = np.maximum(1 - top, 0.0) < RATIO**2 * (1 - second)
    mutual = likeness.argmax(axis=0)[best] == rows
    passing = rows[clear & mutual & (top > 0)]
    return np.stack([passing, best[passing]], axis=-1)


def _consensus(one: Floats, two: Floats, tolerance_rad: float, seed: int) -> NDArray[np.int64]:
    """Return the indices of the matches that agree with the most common rotation (RANSAC with two matches per hypothesis)."""
    rng = np.random.default_rng(seed)
    chosen = rng.integers(0, len(one), (_HYPOTHESES, 2))
    turns = _frames(two[chosen[:, 0]], two[chosen[:, 1]]) @ _frames(one[chosen[:, 0]], one[chosen[:, 1]]).transpose(0, 2, 1)
    near = np.linalg.norm(np.einsum("hij,nj->hni", turns, one) - two, axis=-1) < tolerance_rad
    small = np.trace(turns, axis1=1, axis2=2) > 1 + 2 * np.cos(np.radians(3 * GATE_DEG))
    votes = np.where(small, near.sum(axis=1), 0)
    return np.flatnonzero(near[int(votes.argmax())]) if votes.max() else np.zeros(0, np.int64)


def _frames(a: Floats, b: Floats) -> Floats:
    """Return (n, 3, 3) orthonormal bases whose columns are a, the normal of a and b, and the cross product of these two."""
    normal = np.cross(a, b)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    return np.stack([a, normal, np.cross(a, normal)], axis=-1)
