"""A served device, and onvif-zeep-async unmodified as its client."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import pytest
from onvif import ONVIFCamera

from scope_ptz.simulator.pack import Scene
from scope_ptz.virtual_camera.accounts import Account, Role
from scope_ptz.virtual_camera.device import VirtualDevice
from tests.virtual_camera.onvif.server import Serving, serve

ACCOUNTS = (
    Account("admin", "s3cret", Role.ADMINISTRATOR),
    Account("operator", "0perate", Role.OPERATOR),
    Account("viewer", "v1ew", Role.VIEWER),
)


@pytest.fixture
def device(analytic_scene: Scene) -> VirtualDevice:
    """A camera whose motors are a thousand times faster than real."""
    return VirtualDevice(analytic_scene, accounts=ACCOUNTS, time_scale=1000.0)


@pytest.fixture
async def serving(device: VirtualDevice) -> AsyncIterator[Serving]:
    async with serve(device) as serving:
        yield serving


@asynccontextmanager
async def connect(
    serving: Serving, name: str = "admin", password: str | None = None, *, adjust_time: bool = False
) -> AsyncIterator[ONVIFCamera]:
    """Connect as an account; the default password is the right one."""
    right = {account.name: account.password for account in ACCOUNTS}
    client = ONVIFCamera("127.0.0.1", serving.port, name, right[name] if password is None else password, adjust_time=adjust_time)
    try:
        await client.update_xaddrs()
        yield client
    finally:
        await client.close()


@pytest.fixture
async def camera(serving: Serving) -> AsyncIterator[ONVIFCamera]:
    async with connect(serving) as camera:
        yield camera
