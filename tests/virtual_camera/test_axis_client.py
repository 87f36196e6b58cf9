"""PyPI ``axis``, the client of Home Assistant, unmodified against the virtual camera."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import anyio
import axis
import axis.errors
import httpx
import pytest
from axis.device import AxisDevice
from axis.models.configuration import Configuration
from axis.models.ptz_cgi import PtzMove, PtzQuery
from axis.rtsp import Signal

from scope_ptz.geometry import Pose
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.http.server import serve
from tests.virtual_camera.rtsp.serving import serving, until

pytestmark = pytest.mark.anyio


@asynccontextmanager
async def connected(device: VirtualDevice, user: str = "root", password: str = "pass word") -> AsyncIterator[AxisDevice]:  # noqa: S107
    """Serve a device and connect to it."""
    async with serve([device]) as (camera,), httpx.AsyncClient() as session:
        yield AxisDevice(Configuration(session, camera.host, port=camera.port, username=user, password=password))


async def arrive(device: VirtualDevice) -> Pose:
    """Wait until the motors stand still."""
    while device.is_moving():  # noqa: ASYNC110 - the device has no event for it
        await anyio.sleep(0.002)
    return device.pose()


async def test_it_loads_everything_that_home_assistant_asks_for(served_device: VirtualDevice) -> None:
    async with connected(served_device) as client:
        vapix = client.vapix
        await vapix.initialize()
        assert vapix.api_discovery.initialized
        assert vapix.basic_device_info.initialized
        assert vapix.product_number == "M5075-G"
        assert vapix.product_type == "PTZ Camera"
        assert vapix.serial_number.startswith("ACCC8E")
        assert len(vapix.serial_number) == 12
        assert vapix.params.property_handler["0"].ptz is True
        assert [profile.name for profile in vapix.streaming_profiles] == ["Quality"]
        ptz = vapix.params.ptz_handler["0"]
        assert (ptz.limits["1"].min_tilt, ptz.limits["1"].max_pan, ptz.limits["1"].max_zoom) == (-60, 179, 9999)
        assert ptz.support["1"].absolute_pan is True
        assert ptz.support["1"].absolute_focus is True
        assert ptz.various["1"].control_queueing is False
        assert ptz.image_source["0"].ptz_enabled is True
        await vapix.load_user_groups()
        assert vapix.access_rights.name == "ADMIN_PTZ"
        await vapix.initialize_param_cgi(preload_data=True)
        assert vapix.params.image_handler.initialized


async def test_moves(served_device: VirtualDevice) -> None:
    device = served_device
    async with connected(device) as client:
        ptz = client.vapix.ptz
        await ptz.control(pan=30.5, tilt=-12.25, zoom=5000)
        pose = await arrive(device)
        assert pose == Pose(30.5, -12.25, 3.0)
        await ptz.control(relative_pan=-10, relative_tilt=5, relative_zoom=-2000)
        moved = await arrive(device)
        assert (moved.pan_deg, moved.tilt_deg) == (20.5, -7.25)
        assert moved.zoom == pytest.approx(3 - 2000 * 4 / 9998)
        await ptz.control(pan=180, tilt=180, zoom=9999)
        assert await arrive(device) == Pose(179, 30, 5)
        await ptz.control(move=PtzMove.HOME)
        assert await arrive(device) == device.home
        await ptz.control(continuous_pantilt_move=(20, 0), continuous_zoom_move=0)
        await anyio.sleep(0.01)
        assert device.is_moving()
        await ptz.control(continuous_pantilt_move=(0, 0))
        stopped = await arrive(device)
        assert stopped.pan_deg > device.home.pan_deg
        assert stopped.tilt_deg == device.home.tilt_deg


async def test_queries(served_device: VirtualDevice) -> None:
    async with connected(served_device) as client:
        ptz = client.vapix.ptz
        position = dict(line.split("=") for line in (await ptz.query(PtzQuery.POSITION)).decode().splitlines())
        home = served_device.home
        assert float(position["pan"]) == pytest.approx(home.pan_deg, abs=1e-4)
        assert float(position["tilt"]) == pytest.approx(home.tilt_deg, abs=1e-4)
        assert b"MaxFieldAngle=710" in await ptz.query(PtzQuery.LIMITS)
        presets = (await ptz.query(PtzQuery.PRESETPOSALL)).decode().splitlines()
        assert presets[0] == "Preset Positions for camera 1"
        assert f"presetposno1={served_device.preset(1).name}" in presets
        assert b"continuouspantiltmove" in await ptz.available_ptz_commands()
        assert b"M5075-G" in await ptz.configured_device_driver()
        assert (await ptz.query(PtzQuery.MODE)).startswith(b"Error:")


async def test_presets(served_device: VirtualDevice) -> None:
    device = served_device
    async with connected(device) as client:
        await client.vapix.ptz.control(pan=-40, tilt=-5, zoom=2500)
        there = await arrive(device)
        saved = await client.vapix.request("post", "/axis-cgi/com/ptzconfig.cgi", data={"setserverpresetname": "back gate"})
        assert saved == b""
        await client.vapix.ptz.control(move=PtzMove.HOME)
        await arrive(device)
        await client.vapix.ptz.control(go_to_server_preset_name="back gate")
        assert await arrive(device) == there
        number = device.find_preset("back gate").number
        await client.vapix.ptz.control(move=PtzMove.HOME)
        await client.vapix.ptz.control(go_to_server_preset_number=number)
        assert await arrive(device) == there


@pytest.mark.parametrize(("user", "password"), [("root", "guess"), ("nobody", "pass word"), ("", "")])
async def test_a_wrong_password(served_device: VirtualDevice, user: str, password: str) -> None:
    async with connected(served_device, user, password) as client:
        with pytest.raises(axis.errors.Unauthorized):
            await client.vapix.ptz.control(pan=10)
        assert not await client.vapix.api_discovery.update()
    assert not served_device.is_moving()


async def test_a_viewer_cannot_move_the_camera(served_device: VirtualDevice) -> None:
    async with connected(served_device, "visitor", "secret-3") as client:
        await client.vapix.initialize()
        with pytest.raises(axis.errors.Forbidden):
            await client.vapix.ptz.control(pan=10)
    async with connected(served_device, "guard", "secret-2") as client:
        await client.vapix.ptz.control(pan=10)
        with pytest.raises(axis.errors.Forbidden):
            await client.vapix.request("post", "/axis-cgi/com/ptzconfig.cgi", data={"setserverpresetname": "mine"})
    assert (await arrive(served_device)).pan_deg == 10


async def test_the_stream_of_events_plays(served_device: VirtualDevice, monkeypatch: pytest.MonkeyPatch) -> None:
    """Home Assistant shows a camera as unavailable if this stream, which the library expects at port 554, does not play."""
    states: list[Signal] = []
    async with serving(served_device) as served:
        monkeypatch.setattr("axis.rtsp.RTSP_PORT", served.port)
        monkeypatch.setattr("axis.rtsp.TIME_OUT_LIMIT", 30)
        async with httpx.AsyncClient() as session:
            client = AxisDevice(Configuration(session, "127.0.0.1", username="root", password="pass word"))
            client.stream.connection_status_callback.append(states.append)
            client.enable_events()
            client.stream.start()
            await until(lambda: bool(states))
            assert served.server.sessions == 1
            assert served.server.encoders == 0
            client.stream.stop()
        await served.until_left()
    assert states == [Signal.PLAYING]
