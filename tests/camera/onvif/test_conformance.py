"""The ONVIF driver keeps the camera contract against the virtual camera, which is written from the protocol and not from it."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import pytest

from scope_ptz.camera.base import Camera
from scope_ptz.camera.conformance import CameraConformance
from scope_ptz.simulator.pack import Scene
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.http.server import serve
from scope_ptz.virtual_camera.onvif.app import OnvifApp
from tests.camera.onvif.opening import ACCOUNTS, opened

pytestmark = pytest.mark.anyio


class TestVirtualCamera(CameraConformance):
    driving_s = 0.1
    angle_tolerance_deg = 0.1
    same_picture_mean_difference = 6.0  # actors go on walking

    @pytest.fixture(autouse=True)
    def _scene(self, analytic_scene: Scene) -> None:
        self.scene = analytic_scene

    @asynccontextmanager
    async def camera(self) -> AsyncIterator[Camera]:
        device = VirtualDevice(self.scene, accounts=ACCOUNTS, width=320, height=180, time_scale=30)
        async with serve([device], onvif=OnvifApp) as (served,), opened(served.port) as camera:
            yield camera
