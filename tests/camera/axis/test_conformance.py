"""The AXIS driver keeps the camera contract, against a fake device and against the virtual camera."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import pytest

from scope_ptz.camera.base import Camera
from scope_ptz.camera.conformance import CameraConformance
from scope_ptz.simulator.pack import Scene
from scope_ptz.virtual_camera.accounts import Account, Role
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.http.server import serve
from tests.camera.axis.fake_vapix import PASSWORD, USER, FakeVapix
from tests.camera.axis.opening import opened

pytestmark = pytest.mark.anyio


class TestFakeDevice(CameraConformance):
    driving_s = 0.1
    stopping_s = 0.8  # the stop is a request of its own
    angle_tolerance_deg = 0.1

    @pytest.fixture(autouse=True)
    def _device(self, fake: FakeVapix) -> None:
        self.fake = fake

    @asynccontextmanager
    async def camera(self) -> AsyncIterator[Camera]:
        async with opened(self.fake.loopback.port) as camera:
            yield camera


class TestVirtualCamera(CameraConformance):
    """The device is written from the protocol and not from this driver, so their agreement proves something."""

    driving_s = 0.1
    stopping_s = 0.8  # the stop is a request of its own
    angle_tolerance_deg = 0.1
    same_picture_mean_difference = 6.0  # actors go on walking

    @pytest.fixture(autouse=True)
    def _scene(self, analytic_scene: Scene) -> None:
        self.scene = analytic_scene

    @asynccontextmanager
    async def camera(self) -> AsyncIterator[Camera]:
        device = VirtualDevice(
            self.scene, accounts=[Account(USER, PASSWORD, Role.ADMINISTRATOR)], width=320, height=180, time_scale=30
        )  # fmt: skip
        async with serve([device]) as (served,), opened(served.port, width=320, height=180) as camera:
            yield camera
