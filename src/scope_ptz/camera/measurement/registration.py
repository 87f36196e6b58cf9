"""Measure a camera's rotation between two overlapping pictures from matched features.

When a camera turns about its optical centre, its rotation and focal length determine how one picture maps to the other. If the
rotation is large enough, both can be computed from the pictures alone. If the angle is known, the focal length can be computed
from a smaller rotation, and vice versa.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from scope_ptz.errors import CameraError

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

MIN_MATCHES = 24
"""Minimum number of matches for a registration. A smaller number could agree by chance."""

_MAX_DISTANCE_RATIO = 0.75  # Lowe's ratio test
_RANSAC_PX = 2.0  # maximum error of an inlier in pixels
_MAX_FEATURES = 3000  # per picture


class RegistrationError(CameraError):
    """Two pictures cannot be registered."""


@dataclass(frozen=True, slots=True)
class Matches:
    """Points that show the same directions in two pictures, between which the camera turned.

    Attributes:
        first: Array of shape ``(N, 2)``: offsets in pixels from the centre of the first picture, with right and up positive.
        second: The corresponding points in the second picture.
        width: Width of the pictures in pixels.
    """

    first: NDArray[np.float64]
    second: NDArray[np.float64]
    width: int


@dataclass(frozen=True, slots=True)
class Rotation:
    """A camera's rotation between two pictures.

    Attributes:
        right_deg: Degrees to the right, about the camera's own up axis.
        up_deg: Degrees upwards, about its own right axis.
        roll_deg: Degrees about its line of sight.
        residual_px: Root mean square error of the matches in pixels.
    """

    right_deg: float
    up_deg: float
    roll_deg: float
    residual_px: float

    @property
    def angle_deg(self) -> float:
        """The total rotation angle in degrees."""
        return math.hypot(self.right_deg, self.up_deg, self.roll_deg)


def match(first: NDArray[np.uint8], second: NDArray[np.uint8]) -> Matches:
    """Match features between two pictures, rejecting matches on moving objects.

    Args:
        first: A picture, ``(H, W, 3)`` uint8 RGB.
        second: A picture of the same size.

    Raises:
        RegistrationError: The pictures differ in size or have too few matches.
    """
    import cv2

    if first.shape != second.shape:
        raise RegistrationError("Two pictures from the camera have different sizes.")
    sift = cv2.SIFT_create(nfeatures=_MAX_FEATURES)  # type: ignore[attr-defined]
    (points_1, descriptors_1), (points_2, descriptors_2) = (
        sift.detectAndCompute(cv2.cvtColor(image, cv2.COLOR_RGB2GRAY), None) for image in (first, second)
    )
    if min(len(points_1), len(points_2)) < MIN_MATCHES:
        raise _overlap_error()
    pairs = cv2.BFMatcher().knnMatch(descriptors_1, descriptors_2, k=2)
    good_matches = [pair[0] for pair in pairs if len(pair) == 2 and pair[0].distance < _MAX_DISTANCE_RATIO * pair[1].distance]
    if len(good_matches) < MIN_MATCHES:
        raise _overlap_error()
    pixels_1 = np.array([points_1[m.queryIdx].pt for m in good_matches], np.float64)
    pixels_2 = np.array([points_2[m.trainIdx].pt for m in good_matches], np.float64)
    _, mask = cv2.findHomography(pixels_1, pixels_2, cv2.RANSAC, _RANSAC_PX)
    if mask is None or int(mask.sum()) < MIN_MATCHES:
        raise _overlap_error()
    inliers = mask.ravel().astype(bool)
    return Matches(
        _centre_pixels(pixels_1[inliers], first.shape), _centre_pixels(pixels_2[inliers], first.shape), int(first.shape[1])
    )


def rotation(matches: Matches, focal_px: float) -> Rotation:
    """Return the rotation that best maps the matches onto each other, given the focal length in pixels."""
    directions_1, directions_2 = _directions(matches.first, focal_px), _directions(matches.second, focal_px)
    u, _, vt = np.linalg.svd(directions_2.T @ directions_1)
    turn = u @ np.diag([1.0, 1.0, np.linalg.det(u @ vt)]) @ vt  # maps directions from the first picture to the second
    predicted = directions_1 @ turn.T
    back = predicted[:, :2] / predicted[:, 2:] * focal_px
    residual = float(np.sqrt(np.mean(np.sum((back - matches.second) ** 2, axis=1))))
    vector = _rotation_vector(turn)
    # Directions rotate opposite to the camera: when it turns right, the world turns left. The axes are right, up and forward.
    right_deg, up_deg, roll_deg = np.degrees([-vector[1], vector[0], -vector[2]])
    return Rotation(float(right_deg), float(up_deg), float(roll_deg), residual)


def focal_from(pairs: list[Matches]) -> float:
    """Return the focal length in pixels that best explains all pairs.

    The turn between the pictures of each pair must be a large fraction of the field of view, because the focal length is computed
    from perspective effects, which small turns do not show.
    """
    width = pairs[0].width
    fields = np.geomspace(4.0, 130.0, 48)

    def misfit(log_focal: float) -> float:
        return sum(rotation(pair, math.exp(log_focal)).residual_px ** 2 * len(pair.first) for pair in pairs)

    logs = np.log(width / 2 / np.tan(np.radians(fields) / 2))
    best = int(np.argmin([misfit(value) for value in logs]))
    low, high = logs[min(best + 1, len(logs) - 1)], logs[max(best - 1, 0)]
    return math.exp(_minimise(misfit, float(low), float(high)))


def focal_for_angle(matches: Matches, angle_deg: float) -> float:
    """Return the focal length in pixels at which the rotation between two pictures has a known angle.

    Raises:
        RegistrationError: No focal length gives this angle.
    """
    low, high = matches.width / 2 / math.tan(math.radians(160.0) / 2), matches.width / 2 / math.tan(math.radians(0.5) / 2)
    target_deg = abs(angle_deg)
    if not rotation(matches, low).angle_deg > target_deg > rotation(matches, high).angle_deg:
        raise RegistrationError(
            "No focal length explains the motion between the pictures. Check that the camera turned and that the scene has detail."
        )
    for _ in range(60):
        middle = math.sqrt(low * high)
        if rotation(matches, middle).angle_deg > target_deg:
            low = middle
        else:
            high = middle
    return math.sqrt(low * high)


def hfov_deg(focal_px: float, width: int) -> float:
    """Return the horizontal field of view in degrees for a focal length in pixels."""
    return math.degrees(2 * math.atan(width / 2 / focal_px))


def focal_px(hfov: float, width: int) -> float:
    """Return the focal length in pixels for a horizontal field of view in degrees."""
    return width / 2 / math.tan(math.radians(hfov) / 2)


def _centre_pixels(points: NDArray[np.float64], shape: tuple[int, ...]) -> NDArray[np.float64]:
    height, width = shape[:2]
    return (points - [(width - 1) / 2, (height - 1) / 2]) * [1.0, -1.0]


def _directions(points: NDArray[np.float64], focal: float) -> NDArray[np.float64]:
    rays = np.column_stack([points, np.full(len(points), focal)])
    return np.asarray(rays / np.linalg.norm(rays, axis=1, keepdims=True))


def _rotation_vector(turn: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rotation axis scaled by the angle in radians, following the right-hand rule for the axes right, up and forward."""
    axis = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]) / 2
    sine = float(np.linalg.norm(axis))
    angle = math.atan2(sine, (float(np.trace(turn)) - 1) / 2)
    return axis * (angle / sine if sine > 1e-12 else 1.0)


def _minimise(function: Callable[[float], float], low: float, high: float) -> float:
    """Return the argument that minimises a function between two bounds, by golden-section search."""
    golden = (math.sqrt(5) - 1) / 2
    left, right = high - golden * (high - low), low + golden * (high - low)
    at_left, at_right = function(left), function(right)
    for _ in range(40):
        if at_left < at_right:
            high, right, at_right = right, left, at_left
            left = high - golden * (high - low)
            at_left = function(left)
        else:
            low, left, at_left = left, right, at_right
            right = low + golden * (high - low)
            at_right = function(right)
    return (low + high) / 2


def _overlap_error() -> RegistrationError:
    return RegistrationError(
        "Two pictures have too few matching features to measure the turn between them. "
        "Aim the camera at a well-lit scene with plenty of detail."
    )
