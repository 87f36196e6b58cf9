"""Media2. No client of the test environment knows it, so requests are written by hand, and onvif-python asks from outside."""

from __future__ import annotations

import asyncio
import json
import os
import shutil
import sys
from contextlib import AsyncExitStack
from pathlib import Path
from typing import Any

import httpx2
import pytest

from scope_ptz.simulator.pack import Scene
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.http.server import ServedCamera, serve
from scope_ptz.virtual_camera.identity import device_uuid
from scope_ptz.virtual_camera.onvif.app import OnvifApp
from scope_ptz.virtual_camera.onvif.discovery import DiscoverableCamera, serve_discovery
from tests.virtual_camera.onvif.conftest import ACCOUNTS, RTSP_PORT, HandClock
from tests.virtual_camera.onvif.envelopes import MEDIA2, Answer, envelope, post, ptz_request, token

pytestmark = pytest.mark.anyio

TT = "http://www.onvif.org/ver10/schema"
SIGN_IN = httpx2.DigestAuth("admin", "s3cret")


async def ask(served: ServedCamera, name: str, inner: str = "") -> Answer:
    body = f'<{name} xmlns="{MEDIA2}">{inner}</{name}>'
    return await post(served.url, envelope(body, token("admin", "s3cret")), "/onvif/media2_service")


def text(answer: Answer, path: str) -> str:
    return str(answer.root.findtext(path, namespaces={"m": MEDIA2, "t": TT}))


async def test_a_profile_has_the_configurations_that_are_asked_for(served: ServedCamera, device: VirtualDevice) -> None:
    everything = await ask(served, "GetProfiles", "<Type>All</Type>")
    assert text(everything, ".//m:VideoEncoder/t:Encoding") == "H264"
    assert text(everything, ".//m:VideoEncoder/t:Resolution/t:Width") == str(device.width)
    assert everything.root.find(f".//{{{MEDIA2}}}PTZ").get("token") == "ptz-configuration"
    only = await ask(served, "GetProfiles", "<Type>VideoSource</Type>")
    assert only.root.find(f".//{{{MEDIA2}}}VideoSource") is not None
    assert only.root.find(f".//{{{MEDIA2}}}PTZ") is None
    bare = await ask(served, "GetProfiles")
    assert bare.root.find(f".//{{{MEDIA2}}}Configurations") is None
    assert (await ask(served, "GetProfiles", "<Token>elsewhere</Token>")).codes == ["Sender", "InvalidArgVal", "NoProfile"]


async def test_addresses_and_options(served: ServedCamera) -> None:
    profile = "<ProfileToken>profile-1</ProfileToken>"
    stream = await ask(served, "GetStreamUri", f"<Protocol>RtspUnicast</Protocol>{profile}")
    assert text(stream, ".//m:Uri") == f"rtsp://127.0.0.1:{RTSP_PORT}/axis-media/media.amp"
    tunnelled = await ask(served, "GetStreamUri", f"<Protocol>RtspOverHttp</Protocol>{profile}")
    assert text(tunnelled, ".//m:Uri") == f"http://127.0.0.1:{RTSP_PORT}/axis-media/media.amp"
    snapshot = await ask(served, "GetSnapshotUri", profile)
    assert text(snapshot, ".//m:Uri").startswith(f"{served.url}/axis-cgi/jpg/image.cgi")
    multicast = await ask(served, "GetStreamUri", f"<Protocol>RtspMulticast</Protocol>{profile}")
    assert multicast.codes == ["Sender", "InvalidArgVal", "InvalidStreamSetup"]
    options = await ask(served, "GetVideoEncoderConfigurationOptions", profile)
    assert options.root.find(f".//{{{MEDIA2}}}Options").get("FrameRatesSupported") == "25"
    bounds = await ask(served, "GetVideoSourceConfigurationOptions")
    assert text(bounds, ".//t:VideoSourceTokensAvailable") == "video-source"
    unknown = "<ConfigurationToken>elsewhere</ConfigurationToken>"
    for name in ("GetVideoSourceConfigurations", "GetVideoEncoderConfigurations", "GetVideoEncoderInstances"):
        assert (await ask(served, name, unknown)).codes == ["Sender", "InvalidArgVal", "NoConfig"]


@pytest.mark.parametrize(
    ("move", "moved"),
    [
        ('<Position><tt:PanTilt x="0.5" y="0.5"/></Position>', "AbsoluteMove"),
        ('<Translation><tt:PanTilt x="0.1" y="-0.1"/></Translation>', "RelativeMove"),
        ('<Velocity><tt:PanTilt x="0.1" y="0"/></Velocity><Timeout>PT5S</Timeout>', "ContinuousMove"),
    ],
)
async def test_moves_by_the_profile_of_media2(
    served: ServedCamera, device: VirtualDevice, time: HandClock, move: str, moved: str
) -> None:
    """MEDIA2_PTZ-3-1-1, -3-1-3, -3-1-4 and -3-1-5: the PTZ cases, with the profile that Media2 lists for PTZ."""
    listed = await ask(served, "GetProfiles", "<Type>PTZ</Type>")
    profile = listed.root.find(f".//{{{MEDIA2}}}Profiles")
    assert profile.get("token") == "profile-1"
    before = device.pose()
    header = token("admin", "s3cret")
    assert (await post(served.url, envelope(ptz_request(moved, move), header), "/onvif/ptz_service")).codes == []
    time.pass_(1.0)
    assert device.pose() != before
    header = token("admin", "s3cret")
    assert (await post(served.url, envelope(ptz_request("Stop"), header), "/onvif/ptz_service")).codes == []
    time.pass_(1.0)
    assert not device.is_moving()


@pytest.mark.full
async def test_onvif_python(analytic_scene: Scene, tmp_path: Path) -> None:
    """onvif-python, unmodified, in an environment of its own."""
    environment = tmp_path / "environment"
    uv = shutil.which("uv") or shutil.which("uv", path=str(Path(sys.executable).parent))
    assert uv is not None, "uv is needed to make the client's environment; it is one of the development tools"
    python = environment / "bin" / "python"
    await run(uv, "venv", "--quiet", "--python", sys.executable, str(environment))
    await run(uv, "pip", "install", "--quiet", "--python", str(python), "onvif-python==0.4.7")
    device = VirtualDevice(analytic_scene, accounts=ACCOUNTS, width=320, height=180, time_scale=100.0)
    async with AsyncExitStack() as stack:
        (camera,) = await stack.enter_async_context(serve([device], onvif=lambda each: OnvifApp(each, rtsp_port=RTSP_PORT)))
        await stack.enter_async_context(serve_discovery([DiscoverableCamera(device, camera.port)]))
        script = Path(__file__).with_name("media2_client.py")
        heard: dict[str, Any] = json.loads(
            await run(str(python), str(script), str(camera.port), CAMERA_PASSWORD=ACCOUNTS[0].password)
        )
        assert MEDIA2 in heard["services"]
        assert {"VideoEncoder", "PTZ"} <= set(heard["capabilities"])
        assert (heard["encoding"], heard["size"], heard["bounds"]) == ("H264", [320, 180], [320, 180])
        assert heard["rates"] == [25.0]
        assert heard["stream"] == f"rtsp://127.0.0.1:{RTSP_PORT}/axis-media/media.amp"
        assert heard["small_stream"] == f"{heard['stream']}?resolution=160x90"
        assert heard["snapshot"].startswith(f"{camera.url}/axis-cgi/jpg/image.cgi")
        assert heard["instances"] == 2
        assert heard["listed"]
        assert heard["move_status"] is True
        assert heard["presets"] == [preset.name for preset in device.presets()]
        assert heard["zoom"] == pytest.approx(0.5)
        assert "NotAuthorized" in heard["refused"] or "wrong" in heard["refused"]
        assert heard["by_http_digest"] == 2
        assert str(device_uuid(device)) in heard["discovered"][str(camera.port)]


async def run(*command: str, **variables: str) -> str:
    """Run a program and return what it prints."""
    inherited = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    process = await asyncio.create_subprocess_exec(
        *command, stdout=asyncio.subprocess.PIPE, stderr=asyncio.subprocess.PIPE, env=inherited | variables
    )
    output, errors = await process.communicate()
    assert process.returncode == 0, errors.decode()[-2000:]
    return output.decode()
