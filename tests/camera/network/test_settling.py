"""SettlingCriteria: the position stands, and the picture confirms it, with people in it or not."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Iterable

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from scope_ptz.camera.network.errors import PictureNotStillError, PositionNotReachedError
from scope_ptz.camera.network.settling import SettlingCriteria, moving_fraction, wait_for_still_picture, wait_until_stationary
from scope_ptz.geometry import Pose

pytestmark = pytest.mark.anyio

QUICK = SettlingCriteria(poll_s=0.001, start_s=0.03, timeout_s=0.3, picture_interval_s=0.0, picture_timeout_s=0.1)


def _scene(shift_px: float = 0.0, *, zoom: float = 1.0, noise: float = 0.0, seed: int = 0, brighter: int = 0) -> NDArray[np.uint8]:
    rng = np.random.default_rng(3)
    coarse = rng.integers(30, 200, (60, 100, 3), dtype=np.uint8)
    large = cv2.resize(coarse, (1600, 960), interpolation=cv2.INTER_CUBIC).astype(np.float32)
    matrix = np.array([[zoom, 0, -160 + shift_px], [0, zoom, -120]], np.float32)
    view = cv2.warpAffine(large, matrix, (1280, 720), flags=cv2.INTER_LINEAR) + brighter
    view += np.random.default_rng(seed).normal(0, noise, view.shape) if noise else 0
    return np.asarray(np.clip(view, 0, 255), np.uint8)


def _with_actor(image: NDArray[np.uint8], left: int) -> NDArray[np.uint8]:
    image = image.copy()
    image[150:650, left : left + 300] = 255 - image[150:650, left : left + 300]
    return image


@pytest.mark.parametrize("noise", [0.0, 4.0, 8.0])
def test_a_still_camera_is_still(noise: float) -> None:
    share = moving_fraction(_scene(noise=noise, seed=1), _scene(noise=noise, seed=2))
    assert share is not None
    assert share < 0.1


def test_actors_are_not_taken_for_a_turn() -> None:
    share = moving_fraction(_with_actor(_scene(noise=3, seed=1), 100), _with_actor(_scene(noise=3, seed=2), 500))
    assert share is not None
    assert 0.05 < share < 0.5


def test_a_changed_brightness_is_no_motion() -> None:
    share = moving_fraction(_scene(), _scene(brighter=20))
    assert share is not None
    assert share < 0.1


@pytest.mark.parametrize(("shift_px", "zoom"), [(4.0, 1.0), (30.0, 1.0), (0.0, 1.03), (-6.0, 1.0)])
def test_a_turn_and_a_zoom_are_motion(shift_px: float, zoom: float) -> None:
    share = moving_fraction(_scene(noise=3, seed=1), _scene(shift_px, zoom=zoom, noise=3, seed=2))
    assert share is not None
    assert share > 0.5


def test_a_wall_cannot_tell() -> None:
    wall = np.full((720, 1280, 3), 120, np.uint8)
    assert moving_fraction(wall, wall) is None


def _poses(poses: Iterable[Pose]) -> Callable[[], Awaitable[Pose]]:
    iterator, last = iter(poses), [Pose(0, 0, 1)]

    async def read() -> Pose:
        last[0] = next(iterator, last[0])
        return last[0]

    return read


async def test_arrival_is_reported_when_the_position_stands_at_the_target() -> None:
    path = [Pose(pan, 0, 1) for pan in (0, 0, 5, 15, 25, 29, 30)]
    assert await wait_until_stationary(_poses(path), QUICK, Pose(30, 0, 1)) == Pose(30, 0, 1)


async def test_passing_through_the_target_is_no_arrival() -> None:
    path = [Pose(pan, 0, 1) for pan in (28, 30, 32, 34, 36)]
    reached = await wait_until_stationary(_poses(path), QUICK, Pose(30, 0, 1))
    assert reached == Pose(36, 0, 1)


async def test_a_camera_that_never_starts_is_given_time_and_then_returned() -> None:
    assert await wait_until_stationary(_poses([]), QUICK, Pose(30, 0, 1)) == Pose(0, 0, 1)


async def test_a_camera_that_never_stands_is_an_error() -> None:
    def endless() -> Iterable[Pose]:
        pan = 0.0
        while True:
            pan += 1.0
            yield Pose(pan, 0, 1)

    with pytest.raises(PositionNotReachedError, match="is still moving"):
        await wait_until_stationary(_poses(endless()), QUICK, Pose(-10, 0, 1))


async def test_a_picture_that_moves_for_a_while_is_waited_for() -> None:
    taken = [_scene(60), _scene(40), _scene(20), _scene(0), _scene(0)]

    async def take() -> NDArray[np.uint8]:
        return taken.pop(0)

    await wait_for_still_picture(take, SettlingCriteria(picture_interval_s=0.0, picture_timeout_s=30.0))
    assert taken == []


async def test_a_picture_that_always_moves_is_an_error() -> None:
    shift = [0]

    async def take() -> NDArray[np.uint8]:
        shift[0] = (shift[0] + 40) % 150
        return _scene(shift[0])

    with pytest.raises(PictureNotStillError):
        await wait_for_still_picture(take, QUICK)
