"""Bundle adjustment for a capture: find the rotations and fields of view that best explain all matches.

The camera rotates about its optical centre, so matching points in two frames lie in the same direction. The unknowns are a small
rotation per frame and a correction factor for the focal length at each zoom level. The matches determine the relative poses, and
the reported poses determine the absolute orientation. Reported poses are assumed to have an independent error per frame and a
slow drift that starts at zero. This is rotation-only bundle adjustment (Brown and Lowe, "Automatic panoramic image stitching using
invariant features", 2007), solved by Gauss-Newton iteration with Huber weights.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scope_ptz.camera.capture.matching import MIN_INLIERS, PairMatches
from scope_ptz.geometry import Perspective
from scope_ptz.geometry.sphere import camera_axes

POSE_SIGMA_DEG = 0.5
"""Assumed standard error of a reported pose, in degrees."""

DRIFT_SIGMA_DEG = 3.0
"""Assumed standard deviation of the pan or tilt drift over the whole capture, in degrees."""

SIGNIFICANCE_FACTOR = 3.0
"""A drift counts as significant if it exceeds this multiple of its standard error."""

FOCAL_SIGMA = 0.05
"""Assumed relative standard error of the reported focal length."""

MATCH_SIGMA_PX = 0.7
"""Assumed standard error of a feature position, in pixels."""

MAX_MATCH_ERROR_PX = 2.5
"""Maximum error of a match in pixels; matches with larger errors are treated as outliers."""

MAX_PAUSE_S = 60.0
"""Maximum drift time in seconds between two frames. Longer gaps, such as interruptions, are truncated to this value."""

SAME_FOCAL_TOLERANCE = 0.004
"""Frames whose focal lengths differ by less than this fraction share one correction factor."""

MAX_STEPS = 6
"""Maximum number of Gauss-Newton steps per solution."""

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Adjustment:
    """The result of an adjustment.

    Attributes:
        axes: The right, up and forward axes of each frame, as the rows of a (3, 3) matrix.
        focal_px: Focal length of each frame in pixels.
        registered: Whether each frame has enough matches to determine its pose.
        residual_px: Root mean square error of the matches, in pixels of the coarser frame of each pair; None if there are no
            matches.
        matches: Number of matches used.
    """

    axes: tuple[Floats, ...]
    focal_px: tuple[float, ...]
    registered: tuple[bool, ...]
    residual_px: float | None
    matches: int


def adjust(views: Sequence[Perspective], matches: Sequence[PairMatches], times_s: Sequence[float] | None = None) -> Adjustment:
    """Return the poses and focal lengths that best explain the matches.

    Args:
        views: The frames at their reported poses, in the order in which they were taken.
        matches: Matches between pairs of frames.
        times_s: The time at which each frame was taken, used to model the drift; None for equal intervals.
    """
    problem = _Problem(views, _progress(np.array(range(len(views)) if times_s is None else times_s, np.float64)))
    inliers = list(matches)
    for _ in range(2):
        for _ in range(MAX_STEPS):
            if problem.step(inliers) < 1e-7:
                break
        inliers = problem.exclude_outliers(inliers)
    problem.drop_insignificant_drift()
    for _ in range(2):
        problem.step(inliers)
    counts = np.zeros(len(views))
    for pair in inliers:
        counts[[pair.first, pair.second]] += len(pair.first_px)
    registered = tuple(bool(count >= MIN_INLIERS) for count in counts)
    residual = problem.residual_px(inliers)
    return Adjustment(tuple(problem.axes), tuple(map(float, problem.focals())), registered, residual, int(counts.sum() // 2))


class _Problem:
    """The least-squares problem and its current solution.

    The unknowns are:

    - three numbers per frame: a rotation vector in world coordinates;
    - one number per group of frames with the same field of view: the logarithm of the focal-length correction factor;
    - two numbers for the pan and tilt drift over the whole capture, in radians.
    """

    def __init__(self, views: Sequence[Perspective], progress: Floats) -> None:
        self.views = list(views)
        self.axes = [camera_axes(view.pan_deg, view.tilt_deg) for view in views]
        self.groups, count = _focal_groups([view.focal_px for view in views])
        self.log_factor = np.zeros(count)
        self.turns = np.zeros((len(views), 3))
        self.drift = np.zeros(2)
        self.drift_sigma = np.full(2, math.radians(DRIFT_SIGMA_DEG))
        # Pan drift rotates the frame about the vertical axis, clockwise seen from above; tilt drift rotates it about its right
        # axis.
        self._progress = progress
        self._full_drift_bases = [np.column_stack([(0.0, 0.0, -1.0), axes[0]]) for axes in self.axes]
        self.drift_bases = [part * basis for part, basis in zip(progress, self._full_drift_bases, strict=True)]

    def focals(self) -> Floats:
        """Return the focal length of each frame in pixels."""
        return np.array([view.focal_px for view in self.views]) * np.exp(self.log_factor[self.groups])

    def step(self, matches: Sequence[PairMatches]) -> float:
        """Take one Gauss-Newton step and return the largest component of its rotation vectors, in radians."""
        n, g = len(self.views), len(self.log_factor)
        size = 3 * n + g + 2
        normal, rhs = np.zeros((size, size)), np.zeros(size)
        focals = self.focals()
        for pair in matches:
            self._add_pair(normal, rhs, pair, focals)
        self._add_priors(normal, rhs)
        change = np.linalg.solve(normal, rhs)
        turns = change[: 3 * n].reshape(n, 3)
        for k in range(n):
            self.axes[k] = self.axes[k] @ rotation_matrix(turns[k]).T
        self.turns += turns  # exact to first order, which suffices for small corrections
        self.log_factor += change[3 * n : 3 * n + g]
        self.drift += change[3 * n + g :]
        return float(np.abs(turns).max(initial=0.0))

    def _add_pair(self, normal: Floats, rhs: Floats, pair: PairMatches, focals: Floats) -> None:
        """Add a pair's matches to the normal equations."""
        i, j, n = pair.first, pair.second, len(self.views)
        (rays_i, slopes_i), (rays_j, slopes_j) = (
            _rays(points, float(focals[k]), self.axes[k]) for k, points in ((i, pair.first_px), (j, pair.second_px))
        )
        residuals = rays_i - rays_j
        weight = (min(focals[i], focals[j]) / MATCH_SIGMA_PX) ** 2
        distance = np.linalg.norm(residuals, axis=1) * math.sqrt(weight)
        weights = weight * np.minimum(1.0, 2.0 / np.maximum(distance, 1e-9))  # Huber
        # d(ray) = turn x ray, so the derivative with respect to the turn is minus the cross-product matrix of the ray.
        jacobian = np.concatenate([-_cross(rays_i), _cross(rays_j), slopes_i[..., None], -slopes_j[..., None]], axis=2)
        columns = np.array(
            [*range(3 * i, 3 * i + 3), *range(3 * j, 3 * j + 3), 3 * n + self.groups[i], 3 * n + self.groups[j]], dtype=np.int64
        )
        weighted = jacobian * weights[:, None, None]
        np.add.at(normal, (columns[:, None], columns[None, :]), np.einsum("nki,nkj->ij", weighted, jacobian))
        np.add.at(rhs, columns, -np.einsum("nki,nk->i", weighted, residuals))

    def _add_priors(self, normal: Floats, rhs: Floats) -> None:
        """Add the priors, which keep ``turn - basis @ drift``, the drift and the focal factors small."""
        n, g = len(self.views), len(self.log_factor)
        weight = 1 / math.radians(POSE_SIGMA_DEG) ** 2
        drift_rows = slice(3 * n + g, 3 * n + g + 2)
        for k, basis in enumerate(self.drift_bases):
            frame = slice(3 * k, 3 * k + 3)
            residual = self.turns[k] - basis @ self.drift
            normal[frame, frame] += weight * np.eye(3)
            normal[frame, drift_rows] -= weight * basis
            normal[drift_rows, frame] -= weight * basis.T
            normal[drift_rows, drift_rows] += weight * basis.T @ basis
            rhs[frame] -= weight * residual
            rhs[drift_rows] += weight * basis.T @ residual
        normal[drift_rows, drift_rows] += np.diag(1 / self.drift_sigma**2)
        rhs[drift_rows] -= self.drift / self.drift_sigma**2
        focal_rows = slice(3 * n, 3 * n + g)
        normal[focal_rows, focal_rows] += np.eye(g) / FOCAL_SIGMA**2
        rhs[focal_rows] -= self.log_factor / FOCAL_SIGMA**2

    def drop_insignificant_drift(self) -> None:
        """Constrain a drift to zero in later steps if independent pose errors can explain it.

        This makes the absolute orientation more accurate.
        """
        count = len(self.views)
        # The components of each rotation along the full pan drift and the full tilt drift.
        parts = np.array([basis.T @ turn for basis, turn in zip(self._full_drift_bases, self.turns, strict=True)]).reshape(count, 2)
        noise = np.std(parts - self._progress[:, None] * self.drift, axis=0)
        standard_error = noise * math.sqrt(12 / max(count, 1))
        self.drift_sigma[np.abs(self.drift) < SIGNIFICANCE_FACTOR * standard_error] = math.radians(1e-4)

    def _distances_px(self, pair: PairMatches, focals: Floats) -> Floats:
        rays_1, _ = _rays(pair.first_px, float(focals[pair.first]), self.axes[pair.first])
        rays_2, _ = _rays(pair.second_px, float(focals[pair.second]), self.axes[pair.second])
        return np.asarray(np.linalg.norm(rays_1 - rays_2, axis=1) * min(focals[pair.first], focals[pair.second]))

    def exclude_outliers(self, matches: Sequence[PairMatches]) -> list[PairMatches]:
        """Return the matches that agree with the solution, omitting pairs with too few of them."""
        focals, inliers = self.focals(), []
        for pair in matches:
            agreeing = self._distances_px(pair, focals) < MAX_MATCH_ERROR_PX
            if agreeing.sum() >= MIN_INLIERS // 2:
                inliers.append(PairMatches(pair.first, pair.second, pair.first_px[agreeing], pair.second_px[agreeing]))
        return inliers

    def residual_px(self, matches: Sequence[PairMatches]) -> float | None:
        """Return the root mean square error of the matches in pixels; None if there are no matches."""
        if not matches:
            return None
        focals = self.focals()
        squares = np.concatenate([self._distances_px(pair, focals) ** 2 for pair in matches])
        return float(np.sqrt(squares.mean()))


def rotation_matrix(vector: Floats) -> Floats:
    """Return the (3, 3) rotation matrix for a rotation vector (3,), whose length is the angle in radians (Rodrigues)."""
    angle = float(np.linalg.norm(vector))
    if angle < 1e-12:
        return np.eye(3)
    x, y, z = vector / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross)


def rotation_angle_deg(a: Floats, b: Floats) -> float:
    """Return the angle in degrees of the rotation between two (3, 3) orientations."""
    return math.degrees(2 * math.asin(min(1.0, float(np.linalg.norm(a - b)) / (2 * math.sqrt(2)))))


def _progress(times_s: Floats) -> Floats:
    """Return the frame times scaled to 0 (start of the capture) to 1 (end), with gaps truncated to ``MAX_PAUSE_S``."""
    steps = np.clip(np.diff(times_s, prepend=times_s[:1]), 0.0, MAX_PAUSE_S)
    elapsed = np.cumsum(steps)
    return np.asarray(elapsed / elapsed[-1] if len(elapsed) and elapsed[-1] > 0 else np.zeros(len(elapsed)), np.float64)


def _rays(points_px: Floats, focal_px: float, axes: Floats) -> tuple[Floats, Floats]:
    """Return unit rays (n, 3) in world coordinates and their derivatives with respect to the logarithm of the focal length."""
    local = np.column_stack([points_px, np.full(len(points_px), focal_px)])
    length = np.linalg.norm(local, axis=1, keepdims=True)
    unit = local / length
    slope = -unit * (focal_px / length) ** 2
    slope[:, 2] += focal_px / length[:, 0]
    return unit @ axes, slope @ axes


def _cross(vectors: Floats) -> Floats:
    """Return the cross-product matrices (n, 3, 3) of vectors (n, 3)."""
    matrices = np.zeros((len(vectors), 3, 3))
    matrices[:, 0, 1], matrices[:, 0, 2] = -vectors[:, 2], vectors[:, 1]
    matrices[:, 1, 0], matrices[:, 1, 2] = vectors[:, 2], -vectors[:, 0]
    matrices[:, 2, 0], matrices[:, 2, 1] = -vectors[:, 1], vectors[:, 0]
    return matrices


def _focal_groups(focals: Sequence[float]) -> tuple[NDArray[np.int64], int]:
    """Return the focal-length group of each frame, and the number of groups."""
    groups, firsts = np.zeros(len(focals), np.int64), list[float]()
    for k in np.argsort(focals, kind="stable"):
        if not firsts or focals[k] > firsts[-1] * (1 + SAME_FOCAL_TOLERANCE):
            firsts.append(focals[k])
        groups[k] = len(firsts) - 1
    return groups, len(firsts)
