"""The two drivers, each in front of the same virtual camera, and what the tests of faults look at in it."""

from __future__ import annotations

import asyncio
import re
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass, replace
from functools import partial
from ssl import SSLContext
from typing import Any, Literal

import anyio
import httpx2

from scope_ptz.camera.axis.camera import AxisCamera
from scope_ptz.camera.capabilities import Velocity
from scope_ptz.camera.network.address import DeviceAddress
from scope_ptz.camera.network.credentials import Credentials
from scope_ptz.camera.network.http import DeviceHttp, DeviceTimeouts
from scope_ptz.camera.network.settling import SettlingCriteria
from scope_ptz.camera.onvif.camera import OnvifCamera
from scope_ptz.simulator.pack import Scene
from scope_ptz.virtual_camera.accounts import Account, Role
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.http.certificate import Certificate
from scope_ptz.virtual_camera.http.server import ServedCamera, listen, serve
from scope_ptz.virtual_camera.onvif.app import OnvifApp
from scope_ptz.virtual_camera.rtsp.server import RtspServer

NetworkCamera = AxisCamera | OnvifCamera

USER, PASSWORD = "operator", "hunter-2-secret"
VIEWER, VIEWER_PASSWORD = "visitor", "look-but-do-not-touch"
ADMIN, ADMIN_PASSWORD = "root", "all-rights-12"
ACCOUNTS = (
    Account(USER, PASSWORD, Role.OPERATOR),
    Account(VIEWER, VIEWER_PASSWORD, Role.VIEWER),
    Account(ADMIN, ADMIN_PASSWORD, Role.ADMINISTRATOR),
)
"""The drivers use the operator, unless a test says otherwise: rights beyond that are never needed to survive a fault."""

WIDTH, HEIGHT = 320, 180
QUICK = SettlingCriteria(poll_s=0.01, start_s=0.15, timeout_s=3.0, picture_interval_s=0.02, picture_timeout_s=1.0)


@dataclass(frozen=True)
class Driver:
    """A driver.

    Attributes:
        name: Its scheme.
        live: How its live frames are transported in these tests.
    """

    name: Literal["axis", "onvif"]
    live: str

    @asynccontextmanager
    async def opened(
        self,
        port: int,
        *,
        user: str = USER,
        password: str = PASSWORD,
        connect_s: float = 1.0,
        reply_s: float = 5.0,
        tls: SSLContext | None = None,
        settling: dict[str, Any] | None = None,
        **options: Any,
    ) -> AsyncIterator[NetworkCamera]:
        """Open the driver at a port of this machine, and close it afterwards."""
        credentials = Credentials(user, password)
        address = DeviceAddress("127.0.0.1", port, tls=tls is not None)
        timeouts = DeviceTimeouts(connect_s=connect_s, reply_s=reply_s)
        http = DeviceHttp(address, credentials, timeouts=timeouts, verify=True if tls is None else tls)
        options = {"width": WIDTH, "height": HEIGHT, "stream": self.live, "latency_s": 0.0} | options
        options["settling"] = replace(QUICK, **(settling or {}))
        open_driver: Callable[..., Any] = AxisCamera.open if self.name == "axis" else OnvifCamera.open
        camera: NetworkCamera = await open_driver(http, credentials, **options)
        try:
            yield camera
        finally:
            await camera.close()


AXIS, ONVIF = Driver("axis", "mjpeg"), Driver("onvif", "snapshot")


def make_device(scene: Scene, *, time_scale: float = 100.0, accounts: Sequence[Account] = ACCOUNTS) -> VirtualDevice:
    """Return a small virtual camera."""
    return VirtualDevice(scene, accounts=accounts, width=WIDTH, height=HEIGHT, time_scale=time_scale)


@asynccontextmanager
async def served(
    device: VirtualDevice, *, rtsp: bool = False, port: int = 0, certificate: Certificate | None = None
) -> AsyncIterator[ServedCamera]:
    """Serve a virtual camera with VAPIX and ONVIF on one port, and with RTSP on another one."""
    async with AsyncExitStack() as stack:
        listener = listen("127.0.0.1", [0])[0] if rtsp else None
        onvif = partial(OnvifApp, rtsp_port=listener.getsockname()[1]) if listener is not None else OnvifApp
        certificates = [certificate] if certificate is not None else []
        cameras = await stack.enter_async_context(serve([device], onvif=onvif, ports=[port], certificates=certificates))
        if listener is not None:
            await stack.enter_async_context(RtspServer(cameras[0].source, realm=cameras[0].vapix.realm).listen(listener))
            cameras[0].vapix.rtsp_port = listener.getsockname()[1]
        yield cameras[0]


def set_faults(device: VirtualDevice, **faults: Any) -> None:
    """Switch faults on; without any, all are off."""
    device.faults = type(device.faults).model_validate(faults)


def set_timeouts(camera: NetworkCamera, reply_s: float = 5.0) -> None:
    """Change how long an open camera waits for replies. Only what is lost on purpose may be given up early on a busy machine."""
    http = camera._client.http
    http._timeouts = DeviceTimeouts(connect_s=1.0, reply_s=reply_s)
    http._client.timeout = httpx2.Timeout(reply_s, connect=1.0)


def is_stationary(device: VirtualDevice) -> bool:
    """Return whether no motor of a virtual camera turns, whatever it reports."""
    return device.velocity == Velocity() and device.commanded_velocity == Velocity() and not device.is_moving()


def when_moved(device: VirtualDevice, action: Callable[[], object], *, after_s: float = 0.05) -> None:
    """Do something once, shortly after the virtual camera has got its next command to move."""
    move = device.move

    def moved(*arguments: Any, **options: Any) -> None:
        device.move = move  # type: ignore[method-assign]
        move(*arguments, **options)
        asyncio.get_running_loop().call_later(after_s, action)

    device.move = moved  # type: ignore[method-assign]


async def until(condition: Callable[[], object], timeout_s: float = 20.0) -> None:
    """Wait for something that must come true."""
    with anyio.fail_after(timeout_s):
        while not condition():  # noqa: ASYNC110 - the other side has no event
            await anyio.sleep(0.01)


def kind_of(error: BaseException) -> str:
    """Return the name of an error's class, as the table of faults states it."""
    return re.sub(r"^(Axis|Onvif|Device)(?=ControlHeld)", "", type(error).__name__)
