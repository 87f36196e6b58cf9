"""Opens the driver at a served device."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

from scope_ptz.camera.network.address import DeviceAddress
from scope_ptz.camera.network.credentials import Credentials
from scope_ptz.camera.network.http import DeviceHttp, DeviceTimeouts
from scope_ptz.camera.network.settling import SettlingCriteria
from scope_ptz.camera.onvif.camera import OnvifCamera
from scope_ptz.virtual_camera.accounts import Account, Role

USER, PASSWORD = "operator", "hunter-2-secret"
ACCOUNTS = [Account(USER, PASSWORD, Role.ADMINISTRATOR)]

QUICK = SettlingCriteria(poll_s=0.01, start_s=0.15, timeout_s=3.0, picture_interval_s=0.02, picture_timeout_s=1.0)


@asynccontextmanager
async def opened(port: int, *, password: str = PASSWORD, **options: Any) -> AsyncIterator[OnvifCamera]:
    """Open the driver at a port of this machine, and close it afterwards."""
    credentials = Credentials(USER, password)
    http = DeviceHttp(DeviceAddress("127.0.0.1", port), credentials, timeouts=DeviceTimeouts(connect_s=1.0, reply_s=2.0))
    camera = await OnvifCamera.open(
        http, credentials, **{"settling": QUICK, "stream": "snapshot", "latency_s": 0.001, **options}
    )  # fmt: skip
    try:
        yield camera
    finally:
        await camera.close()
