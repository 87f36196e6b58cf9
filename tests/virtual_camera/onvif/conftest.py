"""A served camera, and onvif-zeep-async unmodified as its client."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import Any

import pytest
from onvif import ONVIFCamera

from scope_ptz.simulator.pack import Scene
from scope_ptz.virtual_camera import device as device_module
from scope_ptz.virtual_camera.accounts import Account, Role
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.http.server import ServedCamera, serve
from scope_ptz.virtual_camera.onvif.app import OnvifApp

PROFILE = "profile-1"
RTSP_PORT = 8554

ACCOUNTS = (
    Account("admin", "s3cret", Role.ADMINISTRATOR),
    Account("operator", "0perate", Role.OPERATOR),
    Account("viewer", "v1ew", Role.VIEWER),
)


@dataclass
class HandClock:
    """The time of the motors, so that no test waits for a move."""

    now: float = 100.0

    def __call__(self) -> float:
        return self.now

    def pass_(self, seconds: float) -> None:
        self.now += seconds


@pytest.fixture
def time(monkeypatch: pytest.MonkeyPatch) -> HandClock:
    clock = HandClock()
    monkeypatch.setattr(device_module, "monotonic", clock)
    return clock


@pytest.fixture
def device(analytic_scene: Scene, time: HandClock) -> VirtualDevice:
    return VirtualDevice(analytic_scene, accounts=ACCOUNTS, width=320, height=180)


@pytest.fixture
async def served(device: VirtualDevice) -> AsyncIterator[ServedCamera]:
    async with serve([device], onvif=lambda each: OnvifApp(each, rtsp_port=RTSP_PORT)) as (camera,):
        yield camera


@asynccontextmanager
async def connect(
    served: ServedCamera, name: str = "admin", password: str | None = None, *, adjust_time: bool = False
) -> AsyncIterator[Any]:
    """Connect as an account; the default password is the right one."""
    right = {account.name: account.password for account in ACCOUNTS}
    client = ONVIFCamera("127.0.0.1", served.port, name, right[name] if password is None else password, adjust_time=adjust_time)
    try:
        await client.update_xaddrs()
        yield client
    finally:
        await client.close()


@pytest.fixture
async def client(served: ServedCamera) -> AsyncIterator[Any]:
    async with connect(served) as client:
        yield client


@pytest.fixture
async def ptz(client: Any) -> Any:
    return await client.create_ptz_service()


@pytest.fixture
async def media(client: Any) -> Any:
    return await client.create_media_service()
