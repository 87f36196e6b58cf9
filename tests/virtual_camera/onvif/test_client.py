"""onvif-zeep-async, unmodified, with a virtual camera."""

from __future__ import annotations

import pytest
from onvif import ONVIFCamera

from scope_ptz.geometry import Pose
from scope_ptz.virtual_camera.device import VirtualDevice
from tests.virtual_camera.onvif.server import Serving

pytestmark = pytest.mark.anyio


async def test_services_and_device_information(camera: ONVIFCamera, serving: Serving) -> None:
    device = await camera.create_devicemgmt_service()
    services = await device.GetServices({"IncludeCapability": True})
    assert {service.XAddr.removeprefix(serving.url) for service in services} == {
        "/onvif/device_service",
        "/onvif/media_service",
        "/onvif/media2_service",
        "/onvif/ptz_service",
    }
    about = await device.GetDeviceInformation()
    assert about.Manufacturer == "AXIS"
    assert len(about.SerialNumber) == 12


async def test_absolute_move(camera: ONVIFCamera, device: VirtualDevice) -> None:
    ptz = await camera.create_ptz_service()
    await ptz.AbsoluteMove({"ProfileToken": "profile-1", "Position": {"PanTilt": {"x": 0.5, "y": -1.0}, "Zoom": {"x": 1.0}}})
    assert device.destination == Pose(89.5, -60.0, 5.0)
