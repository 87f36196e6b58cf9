"""Match image features between overlapping frames, near the positions predicted by the reported poses."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import Perspective, angle_between_deg
from scope_ptz.geometry.sphere import camera_axes

GATE_DEG = 3.0
"""Maximum angle in degrees between matching features, computed from the reported poses.

If the reported poses are off by more than this, the features are not matched.
"""

MAX_FEATURES = 1000  # per frame
MAX_DISTANCE_RATIO = 0.85  # maximum ratio of the best to the second-best distance within the gate (Lowe's ratio test)
MIN_INLIERS = 12
"""Minimum number of matches between two frames. A smaller number could agree by chance."""

AGREEMENT_PX = 4.0
"""Maximum distance in pixels between matching points after a rotation. It allows for errors in the field of view."""

MAX_MATCHES = 80  # per pair; more matches do not improve the precision
MIN_OVERLAP = 0.15  # minimum overlap of a pair, as a fraction of the narrower frame
_HYPOTHESES = 96  # number of rotations that RANSAC tries per pair

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Features:
    """Features of a frame: points (n, 2) in pixels from its centre, with right and up positive, and SIFT descriptors (n, 128)."""

    points: Floats
    descriptors: NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class PairMatches:
    """Matching points in the frames ``first`` and ``second``: (n, 2) arrays of offsets in pixels from the frame centres."""

    first: int
    second: int
    first_px: Floats
    second_px: Floats


def find_features(image: NDArray[np.uint8], hidden: NDArray[np.bool_] | None = None) -> Features:
    """Return the features of a frame, (H, W, 3) RGB, outside the hidden pixels. ``hidden`` is a mask (H, W)."""
    sift = cv2.SIFT_create(nfeatures=MAX_FEATURES)  # type: ignore[attr-defined]
    mask = None if hidden is None else np.where(hidden, 0, 255).astype(np.uint8)
    points, descriptors = sift.detectAndCompute(cv2.cvtColor(image, cv2.COLOR_RGB2GRAY), mask)
    if not points:
        return Features(np.zeros((0, 2)), np.zeros((0, 128), np.float32))
    height, width = image.shape[:2]
    keypoints = np.array([point.pt for point in points], np.float64)
    centred = (keypoints - ((width - 1) / 2, (height - 1) / 2)) * (1.0, -1.0)
    # RootSIFT: square roots of normalised descriptors match better (Arandjelovic and Zisserman, "Three things everyone should know
    # to improve object retrieval", 2012).
    root_descriptors = np.sqrt(descriptors / np.maximum(descriptors.sum(axis=1, keepdims=True), 1e-9))
    return Features(centred, np.asarray(root_descriptors, np.float32))


def overlapping_pairs(views: Sequence[Perspective]) -> list[tuple[int, int]]:
    """Return the pairs of frames that overlap by at least ``MIN_OVERLAP``."""
    grid = np.stack(np.meshgrid((np.arange(12) + 0.5) / 12, (np.arange(8) + 0.5) / 8), axis=-1)
    rays = [view.directions(grid) for view in views]
    centres = np.array([view.directions((0.5, 0.5)) for view in views]).reshape(-1, 3)
    pairs = []
    for i, view in enumerate(views):
        separations_deg = angle_between_deg(centres[i + 1 :], centres[i])
        for j in (
            i + 1 + np.flatnonzero(separations_deg < view.max_off_axis_deg + np.array([v.max_off_axis_deg for v in views[i + 1 :]]))
        ).tolist():
            small, large = (i, j) if view.hfov_deg <= views[j].hfov_deg else (j, i)
            points = views[large].points(rays[small])
            if np.mean(np.all((points > 0) & (points < 1), axis=-1)) >= MIN_OVERLAP:
                pairs.append((i, j))
    return pairs


def match_frames(
    views: Sequence[Perspective], features: Callable[[int], Features], progress: Callable[[int, int], None] = lambda *_: None
) -> list[PairMatches]:
    """Return the matches of each overlapping pair that has at least ``MIN_INLIERS`` matches.

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
    """Return the directions (n, 3) of points in a frame at its reported pose. Points are pixel offsets from the frame's centre."""
    rays = np.column_stack([points_px, np.full(len(points_px), view.focal_px)])
    return np.asarray((rays / np.linalg.norm(rays, axis=1, keepdims=True)) @ camera_axes(view.pan_deg, view.tilt_deg))


def _match(views: Sequence[Perspective], features: Callable[[int], Features], i: int, j: int) -> PairMatches | None:
    """Match two frames, and return the matches that agree on one rotation; None if there are too few."""
    features_1, features_2 = features(i), features(j)
    rays_1, rays_2 = world_directions(views[i], features_1.points), world_directions(views[j], features_2.points)
    visible_1, visible_2 = _visible_indices(views[j], rays_1), _visible_indices(views[i], rays_2)
    if min(len(visible_1), len(visible_2)) < MIN_INLIERS:
        return None
    near = rays_1[visible_1] @ rays_2[visible_2].T > np.cos(np.radians(GATE_DEG))
    similarity = np.where(near, features_1.descriptors[visible_1] @ features_2.descriptors[visible_2].T, -1.0)
    matched = _mutual_best(similarity)
    if len(matched) < MIN_INLIERS:
        return None
    first, second = visible_1[matched[:, 0]], visible_2[matched[:, 1]]
    tolerance = AGREEMENT_PX / min(views[i].focal_px, views[j].focal_px)
    consistent = _consensus(rays_1[first], rays_2[second], tolerance, seed=i * 100_003 + j)
    if len(consistent) < MIN_INLIERS:
        return None
    consistent = consistent[np.linspace(0, len(consistent) - 1, min(len(consistent), MAX_MATCHES)).astype(int)]
    return PairMatches(i, j, features_1.points[first[consistent]], features_2.points[second[consistent]])


def _visible_indices(view: Perspective, rays: Floats) -> NDArray[np.int64]:
    """Return the indices of the rays that may be in a frame, with a margin for pose error."""
    points = view.points(rays)
    margin = GATE_DEG / view.hfov_deg
    return np.flatnonzero(np.all((points > -margin) & (points < 1 + margin), axis=-1))


def _mutual_best(similarity: NDArray[np.float32]) -> NDArray[np.int64]:
    """Return the (row, column) pairs, as an (n, 2) array, that are each other's best match and pass the ratio test."""
    best = similarity.argmax(axis=1)
    rows = np.arange(len(similarity))
    top = similarity[rows, best]
    rest = similarity.copy()
    rest[rows, best] = -1.0
    second = np.maximum(rest.max(axis=1), 0.0)
    # The similarity is the cosine between unit vectors, so their distance is sqrt(2 - 2 * similarity).
    distinct = np.maximum(1 - top, 0.0) < MAX_DISTANCE_RATIO**2 * (1 - second)
    mutual = similarity.argmax(axis=0)[best] == rows
    passing = rows[distinct & mutual & (top > 0)]
    return np.stack([passing, best[passing]], axis=-1)


def _consensus(rays_1: Floats, rays_2: Floats, tolerance_rad: float, seed: int) -> NDArray[np.int64]:
    """Return the indices of the matches that agree with the best-supported rotation (RANSAC with two matches per hypothesis)."""
    rng = np.random.default_rng(seed)
    chosen = rng.integers(0, len(rays_1), (_HYPOTHESES, 2))
    turns = _bases(rays_2[chosen[:, 0]], rays_2[chosen[:, 1]]) @ _bases(rays_1[chosen[:, 0]], rays_1[chosen[:, 1]]).transpose(
        0, 2, 1
    )
    near = np.linalg.norm(np.einsum("hij,nj->hni", turns, rays_1) - rays_2, axis=-1) < tolerance_rad
    small = np.trace(turns, axis1=1, axis2=2) > 1 + 2 * np.cos(np.radians(3 * GATE_DEG))
    votes = np.where(small, near.sum(axis=1), 0)
    return np.flatnonzero(near[int(votes.argmax())]) if votes.max() else np.zeros(0, np.int64)


def _bases(a: Floats, b: Floats) -> Floats:
    """Return (n, 3, 3) orthonormal bases whose columns are a, the unit normal of a and b, and the cross product of these two."""
    normal = np.cross(a, b)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    return np.stack([a, normal, np.cross(a, normal)], axis=-1)
