"""Detect when a camera has settled: its reported position no longer changes, and neither does its picture."""

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
class Settling:
    """The criteria for when a camera counts as settled.

    Attributes:
        angle_tolerance_deg: Allowed difference between the requested and the reached angle, in degrees.
        zoom_tolerance: Allowed relative difference between the requested and the reached zoom.
        poll_s: Seconds between two readings of the position.
        start_s: Seconds to wait for a motion to start before assuming that the camera will not move.
        timeout_s: Seconds after which a move has failed.
        picture_interval_s: Seconds between the pictures that are compared.
        picture_timeout_s: Seconds after which a picture that keeps moving is an error.
    """

    angle_tolerance_deg: float = 0.15
    zoom_tolerance: float = 0.01
    poll_s: float = 0.05
    start_s: float = 1.0
    timeout_s: float = 30.0
    picture_interval_s: float = 0.12
    picture_timeout_s: float = 4.0

    def near(self, pose: Pose, target: Pose) -> bool:
        """Return whether a pose equals the target within the tolerances."""
        return (
            abs(wrap_pan_deg(pose.pan_deg - target.pan_deg)) <= self.angle_tolerance_deg
            and abs(pose.tilt_deg - target.tilt_deg) <= self.angle_tolerance_deg
            and abs(pose.zoom / target.zoom - 1) <= self.zoom_tolerance
        )

    def farthest(self, pose: Pose, target: Pose) -> Axis:
        """Return the axis that is farthest from its target, measured in multiples of its tolerance."""
        off: dict[Axis, float] = {
            "pan": abs(wrap_pan_deg(pose.pan_deg - target.pan_deg)) / self.angle_tolerance_deg,
            "tilt": abs(pose.tilt_deg - target.tilt_deg) / self.angle_tolerance_deg,
            "zoom": abs(pose.zoom / target.zoom - 1) / self.zoom_tolerance,
        }
        return max(off, key=lambda axis: off[axis])


def is_stationary(before: Pose, now: Pose) -> bool:
    """Return whether two successive readings show no motion."""
    return (
        abs(wrap_pan_deg(now.pan_deg - before.pan_deg)) < 0.011
        and abs(now.tilt_deg - before.tilt_deg) < 0.011
        and abs(now.zoom / before.zoom - 1) < 0.0015
    )


async def wait_until_stationary(
    read_pose: Callable[[], Awaitable[Pose]],
    settling: Settling,
    target: Pose | None = None,
    superseded: Callable[[], bool] = lambda: False,
) -> Pose:
    """Wait until the camera is stationary, at the target or elsewhere, and return its position.

    Elsewhere, it must stay still for ``start_s`` seconds, or for two readings if there is no target and it has moved.

    Args:
        read_pose: Reads the position.
        settling: The intervals, tolerances and time limits.
        target: The pose to reach; None if it is unknown, as for a preset.
        superseded: Returns whether another command has replaced this one. If so, any stationary position counts.

    Raises:
        PositionNotReachedError: The camera is still moving at the time limit.
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
            arrived = superseded() or (target is not None and settling.near(now, target))
            patience_s = settling.start_s if target is not None or not has_moved else 2 * settling.poll_s
            if arrived or now_s - still_since_s >= patience_s:
                return now
        if now_s - started_s > settling.timeout_s:
            raise PositionNotReachedError(
                f"The camera still moves after {settling.timeout_s:g} s. Check that nobody else is moving it and that no tour is "
                "running."
            )
        before = now


GRID = (320, 180)
"""Width and height in pixels at which pictures are compared."""

_TILE = 20  # edge of a tile in pixels
_TEXTURE = 1.5  # minimum mean gradient of a textured tile, in grey levels (of 255) per pixel
_NOISE = 1.5  # mean change that noise may cause, in grey levels
_SHIFT_PX = 0.25  # shift of the picture that does not count as motion, in pixels


def moving_fraction(first: NDArray[np.uint8], second: NDArray[np.uint8]) -> float | None:
    """Return the fraction of the textured tiles that moved between two pictures.

    A tile has moved if its mean change exceeds the noise level plus the change that a shift by a quarter of a pixel would cause in
    its texture, at a picture width of 320. Changes of the overall brightness do not count. People and vehicles cover few tiles, but
    a turning camera moves all of them.

    Args:
        first: A picture, ``(H, W, 3)`` uint8 RGB.
        second: A picture of the same size.

    Returns:
        The fraction, from 0 to 1; None if there is too little texture to tell.
    """
    one, two = _reduced(first), _reduced(second)
    difference = _tiles(two - one)
    difference = difference - difference.mean(axis=(1, 2), keepdims=True)
    gradient = np.hypot(*np.gradient(one))
    texture = _tiles(gradient).mean(axis=(1, 2))
    change = np.abs(difference).mean(axis=(1, 2))
    textured = texture > _TEXTURE
    if textured.sum() < 6:
        return None
    moved = change > _NOISE + _SHIFT_PX * texture
    return float((moved & textured).sum() / textured.sum())


async def wait_for_still_picture(
    take: Callable[[], Awaitable[NDArray[np.uint8]]], settling: Settling, superseded: Callable[[], bool] = lambda: False
) -> None:
    """Wait until two successive pictures show the same view, or have too little texture to tell.

    Raises:
        PictureNotStillError: The picture keeps moving.
    """
    started_s = monotonic()
    before = await take()
    while not superseded():
        await anyio.sleep(settling.picture_interval_s)
        now = await take()
        fraction = moving_fraction(before, now)
        if fraction is None or fraction < 0.5:
            return
        if monotonic() - started_s > settling.picture_timeout_s:
            raise PictureNotStillError(
                "The camera reports that it has arrived, but its picture keeps moving. Check its mounting and its motors."
            )
        before = now


def _reduced(image: NDArray[np.uint8]) -> NDArray[np.float32]:
    import cv2

    small = cv2.resize(image, GRID, interpolation=cv2.INTER_AREA)
    return np.asarray(cv2.cvtColor(small, cv2.COLOR_RGB2GRAY), np.float32)


def _tiles(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """Split values into tiles. Return an array of shape ``(tiles, 20, 20)``."""
    rows, columns = GRID[1] // _TILE, GRID[0] // _TILE
    return values.reshape(rows, _TILE, columns, _TILE).swapaxes(1, 2).reshape(-1, _TILE, _TILE)
