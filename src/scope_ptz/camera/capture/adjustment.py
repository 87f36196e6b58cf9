"""Bundle adjustment of a capture: find the rotations and fields of view that best explain all matches.

The camera turns about its optical centre, so a match between two frames means that two rays have the same direction. The unknowns
are a small rotation of each frame and a factor on the focal length at each zoom level. The matches determine the poses relative to
each other, and the reported poses determine the absolute orientation. Reported poses are assumed to have an independent error per
frame and a slow drift that starts at zero. This is a bundle adjustment with rotations only (Brown and Lowe,
"Automatic panoramic image stitching using invariant features", 2007), solved by Gauss-Newton steps with Huber weights.
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
"""Assumed standard deviation of the drift of pan or tilt over the whole capture, in degrees."""

SIGNIFICANCE_FACTOR = 3.0
"""A drift is accepted if it exceeds this multiple of its standard error."""

FOCAL_SIGMA = 0.05
"""Assumed relative standard error of the reported focal length."""

MATCH_SIGMA_PX = 0.7
"""Assumed standard error of the position of a feature, in pixels."""

REJECT_PX = 2.5
"""Matches whose error in the first solution exceeds this many pixels are excluded from the second one."""

MAX_PAUSE_S = 60.0
"""Maximum seconds between two frames that count towards the drift. A longer gap, such as an interruption, counts as this many."""

SAME_FOCAL_TOLERANCE = 0.004
"""Frames whose focal lengths differ by less than this fraction share one correction."""

STEPS = 6
"""Maximum number of Gauss-Newton steps per solution."""

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Adjustment:
    """The result of an adjustment.

    Attributes:
        axes: The right, up and forward axes of each frame, as the rows of a (3, 3) matrix.
        focal_px: Focal length of each frame in pixels.
        registered: Whether each frame has enough matches to determine its pose.
        residual_px: Root mean square error of the matches, in pixels of the coarser frame of each pair; None without matches.
        matches: Number of matches that were used.
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
        times_s: The time at which each frame was taken, for the drift; None for equal intervals.
    """
    problem = _Problem(views, _progress(np.array(range(len(views)) if times_s is None else times_s, np.float64)))
    used = list(matches)
    for _ in range(2):
        for _ in range(STEPS):
            if problem.step(used) < 1e-7:
                break
        used = problem.without_outliers(used)
    problem.drop_insignificant_drift()
    for _ in range(2):
        problem.step(used)
    counts = np.zeros(len(views))
    for pair in used:
        counts[[pair.first, pair.second]] += len(pair.first_px)
    registered = tuple(bool(count >= MIN_INLIERS) for count in counts)
    residual = problem.residual_px(used)
    return Adjustment(tuple(problem.axes), tuple(map(float, problem.focals())), registered, residual, int(counts.sum() // 2))


class _Problem:
    """The current solution, and the normal equations that improve it.

    The unknowns are three numbers per frame (a rotation vector in world coordinates), one per group of frames with the same field
    of view (the logarithm of a factor on the focal length), and two for the drift of pan and tilt over the capture, in radians.
    """

    def __init__(self, views: Sequence[Perspective], progress: Floats) -> None:
        self.views = list(views)
        self.axes = [camera_axes(view.pan_deg, view.tilt_deg) for view in views]
        self.groups, count = _focal_groups([view.focal_px for view in views])
        self.log_factor = np.zeros(count)
        self.turns = np.zeros((len(views), 3))
        self.drift = np.zeros(2)
        self.drift_sigma = np.full(2, math.radians(DRIFT_SIGMA_DEG))
        # A drift of pan rotates about the vertical, clockwise as seen from above.
        # A drift of tilt rotates about the frame's right axis.
        self._progress = progress
        self._whole_bases = [np.column_stack([(0.0, 0.0, -1.0), axes[0]]) for axes in self.axes]
        self.drift_bases = [part * basis for part, basis in zip(progress, self._whole_bases, strict=True)]

    def focals(self) -> Floats:
        """Return the focal length of each frame in pixels."""
        return np.array([view.focal_px for view in self.views]) * np.exp(self.log_factor[self.groups])

    def step(self, matches: Sequence[PairMatches]) -> float:
        """Take one Gauss-Newton step and return its largest rotation in radians."""
        n, g = len(self.views), len(self.log_factor)
        size = 3 * n + g + 2
        normal, right = np.zeros((size, size)), np.zeros(size)
        focals = self.focals()
        for pair in matches:
            self._add_pair(normal, right, pair, focals)
        self._add_priors(normal, right)
        change = np.linalg.solve(normal, right)
        turns = change[: 3 * n].reshape(n, 3)
        for k in range(n):
            self.axes[k] = self.axes[k] @ rotation_matrix(turns[k]).T
        self.turns += turns  # exact to first order, which suffices for small corrections
        self.log_factor += change[3 * n : 3 * n + g]
        self.drift += change[3 * n + g :]
        return float(np.abs(turns).max(initial=0.0))

    def _add_pair(self, normal: Floats, right: Floats, pair: PairMatches, focals: Floats) -> None:
        """Add the matches of a pair to the normal equations."""
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
        np.add.at(right, columns, -np.einsum("nki,nk->i", weighted, residuals))

    def _add_priors(self, normal: Floats, right: Floats) -> None:
        """Add the priors, which keep ``turn - basis @ drift``, the drift and the focal factors small."""
        n, g = len(self.views), len(self.log_factor)
        weight = 1 / math.radians(POSE_SIGMA_DEG) ** 2
        last = slice(3 * n + g, 3 * n + g + 2)
        for k, basis in enumerate(self.drift_bases):
            frame = slice(3 * k, 3 * k + 3)
            residual = self.turns[k] - basis @ self.drift
            normal[frame, frame] += weight * np.eye(3)
            normal[frame, last] -= weight * basis
            normal[last, frame] -= weight * basis.T
            normal[last, last] += weight * basis.T @ basis
            right[frame] -= weight * residual
            right[last] += weight * basis.T @ residual
        normal[last, last] += np.diag(1 / self.drift_sigma**2)
        right[last] -= self.drift / self.drift_sigma**2
        middle = slice(3 * n, 3 * n + g)
        normal[middle, middle] += np.eye(g) / FOCAL_SIGMA**2
        right[middle] -= self.log_factor / FOCAL_SIGMA**2

    def drop_insignificant_drift(self) -> None:
        """Make the next steps set a drift to zero if errors of individual poses can explain it.

        This makes the absolute orientation more accurate.
        """
        count = len(self.views)
        # The components of each turn along a drift of pan and a drift of tilt over the whole capture.
        parts = np.array([basis.T @ turn for basis, turn in zip(self._whole_bases, self.turns, strict=True)]).reshape(count, 2)
        noise = np.std(parts - self._progress[:, None] * self.drift, axis=0)
        standard_error = noise * math.sqrt(12 / max(count, 1))
        self.drift_sigma[np.abs(self.drift) < SIGNIFICANCE_FACTOR * standard_error] = math.radians(1e-4)

    def _distances_px(self, pair: PairMatches, focals: Floats) -> Floats:
        one, _ = _rays(pair.first_px, float(focals[pair.first]), self.axes[pair.first])
        two, _ = _rays(pair.second_px, float(focals[pair.second]), self.axes[pair.second])
        return np.asarray(np.linalg.norm(one - two, axis=1) * min(focals[pair.first], focals[pair.second]))

    def without_outliers(self, matches: Sequence[PairMatches]) -> list[PairMatches]:
        """Return the matches that agree with the solution, without pairs that have too few of them."""
        focals, inliers = self.focals(), []
        for pair in matches:
            good = self._distances_px(pair, focals) < REJECT_PX
            if good.sum() >= MIN_INLIERS // 2:
                inliers.append(PairMatches(pair.first, pair.second, pair.first_px[good], pair.second_px[good]))
        return inliers

    def residual_px(self, matches: Sequence[PairMatches]) -> float | None:
        """Return the root mean square error of matches in pixels; None without matches."""
        if not matches:
            return None
        focals = self.focals()
        squares = np.concatenate([self._distances_px(pair, focals) ** 2 for pair in matches])
        return float(np.sqrt(squares.mean()))


def rotation_matrix(vector: Floats) -> Floats:
    """Return the (3, 3) rotation matrix of a rotation vector (3,), whose length is the angle in radians (Rodrigues)."""
    angle = float(np.linalg.norm(vector))
    if angle < 1e-12:
        return np.eye(3)
    x, y, z = vector / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross)


def turn_deg(a: Floats, b: Floats) -> float:
    """Return the angle in degrees of the rotation between two (3, 3) orientations."""
    return math.degrees(2 * math.asin(min(1.0, float(np.linalg.norm(a - b)) / (2 * math.sqrt(2)))))


def _progress(times_s: Floats) -> Floats:
    """Return when each frame was taken, from 0 (start of the capture) to 1 (end). A pause counts as at most ``MAX_PAUSE_S``."""
    steps = np.clip(np.diff(times_s, prepend=times_s[:1]), 0.0, MAX_PAUSE_S)
    passed = np.cumsum(steps)
    return np.asarray(passed / passed[-1] if len(passed) and passed[-1] > 0 else np.zeros(len(passed)), np.float64)


def _rays(points_px: Floats, focal_px: float, axes: Floats) -> tuple[Floats, Floats]:
    """Return unit rays (n, 3) in world coordinates, and their derivatives with respect to the logarithm of the focal length."""
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
