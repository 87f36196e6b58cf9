"""Detect when a camera has settled, which means that neither its reported position nor its picture is changing any more."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from time import monotonic
from typing import TYPE_CHECKING

import anyio
import numpy as np

from scope_ptz.camera.network.errors import PictureNotStillError, PositionNotReachedError
from scope_ptz.geometry import Axis, Pose, wrap_pan_deg

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class SettlingCriteria:
    """The criteria for deciding that a camera has settled.

    Attributes:
        angle_tolerance_deg: Maximum difference in degrees between the requested and the reached angle.
        zoom_tolerance: Maximum relative difference between the requested and the reached zoom.
        poll_s: Seconds between position readings.
        start_s: Seconds to wait for motion before assuming that the camera will not move.
        timeout_s: Seconds after which a camera that is still moving counts as failed.
        picture_interval_s: Seconds between the pictures that are compared.
        picture_timeout_s: Seconds after which a picture that is still moving is an error.
    """

    angle_tolerance_deg: float = 0.15
    zoom_tolerance: float = 0.01
    poll_s: float = 0.05
    start_s: float = 1.0
    timeout_s: float = 30.0
    picture_interval_s: float = 0.12
    picture_timeout_s: float = 4.0

    def is_near(self, pose: Pose, target: Pose) -> bool:
        """Return whether a pose matches the target within the tolerances."""
        return (
            abs(wrap_pan_deg(pose.pan_deg - target.pan_deg)) <= self.angle_tolerance_deg
            and abs(pose.tilt_deg - target.tilt_deg) <= self.angle_tolerance_deg
            and abs(pose.zoom / target.zoom - 1) <= self.zoom_tolerance
        )

    def farthest_axis(self, pose: Pose, target: Pose) -> Axis:
        """Return the axis that is farthest from its target, measured in multiples of its tolerance."""
        deviations: dict[Axis, float] = {
            "pan": abs(wrap_pan_deg(pose.pan_deg - target.pan_deg)) / self.angle_tolerance_deg,
            "tilt": abs(pose.tilt_deg - target.tilt_deg) / self.angle_tolerance_deg,
            "zoom": abs(pose.zoom / target.zoom - 1) / self.zoom_tolerance,
        }
        return max(deviations, key=lambda axis: deviations[axis])


def is_stationary(before: Pose, now: Pose) -> bool:
    """Return whether two successive poses show no motion."""
    return (
        abs(wrap_pan_deg(now.pan_deg - before.pan_deg)) < 0.011
        and abs(now.tilt_deg - before.tilt_deg) < 0.011
        and abs(now.zoom / before.zoom - 1) < 0.0015
    )


async def wait_until_stationary(
    read_pose: Callable[[], Awaitable[Pose]],
    settling: SettlingCriteria,
    target: Pose | None = None,
    is_superseded: Callable[[], bool] = lambda: False,
) -> Pose:
    """Wait until the camera is stationary, and return its position.

    At the target, a single reading without motion is enough. Otherwise, the camera must remain stationary for ``start_s`` seconds,
    or for two polling intervals if it has moved and there is no target.

    Args:
        read_pose: A function that reads the position.
        settling: The intervals, tolerances and timeouts.
        target: The pose to reach; None if it is unknown, as for a preset.
        is_superseded: A function that returns whether another command has replaced this one. If so, any stationary position counts.

    Raises:
        PositionNotReachedError: The camera is still moving after ``settling.timeout_s``.
    """
    started_s = still_since_s = monotonic()
    before = await read_pose()
    has_moved = False
    while True:
        await anyio.sleep(settling.poll_s)
        now, now_s = await read_pose(), monotonic()
        if not is_stationary(before, now):
            still_since_s, has_moved = now_s, True
        else:
            arrived = is_superseded() or (target is not None and settling.is_near(now, target))
            patience_s = settling.start_s if target is not None or not has_moved else 2 * settling.poll_s
            if arrived or now_s - still_since_s >= patience_s:
                return now
        if now_s - started_s > settling.timeout_s:
            raise PositionNotReachedError(
                f"The camera is still moving after {settling.timeout_s:g} s. Check that no one else is moving it and that no guard "
                "tour is running."
            )
        before = now


COMPARISON_SIZE_PX = (320, 180)
"""Width and height in pixels at which pictures are compared."""

_TILE = 20  # width and height of a tile in pixels
_TEXTURE = 1.5  # minimum mean gradient of a textured tile, in grey levels (0 to 255) per pixel
_NOISE = 1.5  # mean change that noise may cause, in grey levels
_SHIFT_PX = 0.25  # maximum shift in pixels that does not count as motion


def moving_fraction(first: NDArray[np.uint8], second: NDArray[np.uint8]) -> float | None:
    """Return the fraction of textured tiles that moved between two pictures.

    Pictures are compared at a width of 320 pixels. A tile has moved if its mean change exceeds the noise level plus the change that
    a quarter-pixel shift would cause in its texture. Changes in a tile's mean brightness are ignored. People and vehicles cover few
    tiles, whereas a turning camera moves all of them.

    Args:
        first: A picture, ``(H, W, 3)`` uint8 RGB.
        second: A picture of the same size.

    Returns:
        The fraction, from 0 to 1; None if there is too little texture.
    """
    first_grey, second_grey = _to_comparison_size(first), _to_comparison_size(second)
    difference = _tiles(second_grey - first_grey)
    difference = difference - difference.mean(axis=(1, 2), keepdims=True)
    gradient = np.hypot(*np.gradient(first_grey))
    texture = _tiles(gradient).mean(axis=(1, 2))
    change = np.abs(difference).mean(axis=(1, 2))
    textured = texture > _TEXTURE
    if textured.sum() < 6:
        return None
    moved = change > _NOISE + _SHIFT_PX * texture
    return float((moved & textured).sum() / textured.sum())


async def wait_for_still_picture(
    take: Callable[[], Awaitable[NDArray[np.uint8]]], settling: SettlingCriteria, is_superseded: Callable[[], bool] = lambda: False
) -> None:
    """Wait until two successive pictures show the same view, or have too little texture for a comparison.

    Raises:
        PictureNotStillError: The picture is still moving after ``settling.picture_timeout_s``.
    """
    started_s = monotonic()
    before = await take()
    while not is_superseded():
        await anyio.sleep(settling.picture_interval_s)
        now = await take()
        fraction = moving_fraction(before, now)
        if fraction is None or fraction < 0.5:
            return
        if monotonic() - started_s > settling.picture_timeout_s:
            raise PictureNotStillError(
                "The camera reports that it has arrived, but its picture is still moving. Check the camera's mounting and motors."
            )
        before = now


def _to_comparison_size(image: NDArray[np.uint8]) -> NDArray[np.float32]:
    import cv2

    small = cv2.resize(image, COMPARISON_SIZE_PX, interpolation=cv2.INTER_AREA)
    return np.asarray(cv2.cvtColor(small, cv2.COLOR_RGB2GRAY), np.float32)


def _tiles(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """Split an array into tiles, and return an array of shape ``(tiles, 20, 20)``."""
    rows, columns = COMPARISON_SIZE_PX[1] // _TILE, COMPARISON_SIZE_PX[0] // _TILE
    return values.reshape(rows, _TILE, columns, _TILE).swapaxes(1, 2).reshape(-1, _TILE, _TILE)
