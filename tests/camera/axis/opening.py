"""Opens an AXIS camera at a fake or virtual device, with waiting times for tests."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace
from typing import Any

from scope_ptz.camera.axis.camera import AxisCamera
from scope_ptz.camera.network.address import DeviceAddress
from scope_ptz.camera.network.credentials import Credentials
from scope_ptz.camera.network.http import DeviceHttp, DeviceTimeouts
from scope_ptz.camera.network.settling import SettlingCriteria
from tests.camera.axis.fake_vapix import PASSWORD, USER

QUICK = SettlingCriteria(poll_s=0.005, start_s=0.15, timeout_s=3.0, picture_interval_s=0.0, picture_timeout_s=0.6)


def device_http(port: int, *, password: str = PASSWORD, reply_s: float = 5.0) -> DeviceHttp:
    timeouts = DeviceTimeouts(connect_s=1.0, reply_s=reply_s)
    return DeviceHttp(DeviceAddress("127.0.0.1", port), Credentials(USER, password), timeouts=timeouts)


@asynccontextmanager
async def opened(
    port: int, *, password: str = PASSWORD, reply_s: float = 5.0, settling: dict[str, Any] | None = None, **options: Any
) -> AsyncIterator[AxisCamera]:
    """An open camera, closed afterwards."""
    options = {"width": 640, "height": 360, "latency_s": 0.0} | options
    http = device_http(port, password=password, reply_s=reply_s)
    camera = await AxisCamera.open(http, Credentials(USER, password), settling=replace(QUICK, **(settling or {})), **options)
    try:
        yield camera
    finally:
        await camera.close()
