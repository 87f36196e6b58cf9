"""A camera that hangs or leans shows an upright world."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import numpy as np
import pytest

from scope_ptz.camera.base import Camera
from scope_ptz.camera.conformance import CameraConformance
from scope_ptz.camera.guard.mounted_camera import MountedCamera
from scope_ptz.camera.guard.rules import Mounting
from scope_ptz.geometry import Pose
from tests.camera.guard.worlds import HEIGHT, WIDTH, SphereCamera, pixel_points
from tests.support.analytic import colour_of

pytestmark = pytest.mark.anyio

CEILING = np.diag([-1.0, 1.0, -1.0])


def _lean(tilt_deg: float) -> np.ndarray:
    a = np.radians(tilt_deg)
    return np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])


class TestCeilingConformance(CameraConformance):
    same_picture_mean_difference = 0.0

    @asynccontextmanager
    async def camera(self) -> AsyncIterator[Camera]:
        yield MountedCamera(SphereCamera(CEILING), Mounting(position="ceiling"))


class TestLeaningConformance(CameraConformance):
    same_picture_mean_difference = 0.0

    @asynccontextmanager
    async def camera(self) -> AsyncIterator[Camera]:
        yield MountedCamera(SphereCamera(_lean(5.0)), Mounting(tilt_deg=5.0))


@pytest.mark.parametrize(("mounting", "to_world"), [
    (Mounting(position="ceiling"), CEILING),
    (Mounting(tilt_deg=12.0), _lean(12.0)),
    (Mounting(position="ceiling", tilt_deg=-8.0), _lean(-8.0) @ CEILING),
])  # fmt: skip
@pytest.mark.parametrize("pose", [Pose(0.0, -5.0, 1.0), Pose(35.0, -12.0, 1.0), Pose(-70.0, 6.0, 2.0)])
async def test_the_picture_shows_what_its_geometry_says(mounting: Mounting, to_world: np.ndarray, pose: Pose) -> None:
    camera = MountedCamera(SphereCamera(to_world), mounting)
    reached = (await camera.move(pose)).pose
    frame = await camera.frame()
    assert (frame.pose.pan_deg, frame.pose.tilt_deg) == pytest.approx((reached.pan_deg, reached.tilt_deg))
    expected = colour_of(frame.projection.directions(pixel_points())).astype(float)
    # A picture that was turned upright has black corners; its middle is whole.
    rows, columns = slice(HEIGHT // 3, 2 * HEIGHT // 3), slice(WIDTH // 3, 2 * WIDTH // 3)
    assert np.abs(frame.image[rows, columns] - expected[rows, columns]).mean() < 2.0


async def test_moves_reach_their_targets() -> None:
    camera = MountedCamera(SphereCamera(_lean(10.0)), Mounting(tilt_deg=10.0))
    for pose in (Pose(0.0, 0.0, 1.0), Pose(90.0, -10.0, 2.0), Pose(-120.0, 5.0, 1.0)):
        arrival = await camera.move(pose)
        assert (arrival.pose.pan_deg, arrival.pose.tilt_deg) == pytest.approx((pose.pan_deg, pose.tilt_deg))
        assert arrival.clamped == ()
