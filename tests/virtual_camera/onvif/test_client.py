"""onvif-zeep-async, unmodified, with a virtual camera: services, media, moves, presets, and sign-in."""

from __future__ import annotations

import re
from datetime import timedelta
from typing import Any

import cv2
import numpy as np
import pytest
from onvif.exceptions import ONVIFError
from onvif.util import is_auth_error
from zeep.exceptions import Fault

from scope_ptz.geometry import Perspective, Pose
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.faults import Faults
from scope_ptz.virtual_camera.http.server import ServedCamera
from tests.virtual_camera.onvif.conftest import PROFILE, RTSP_PORT, HandClock, connect

pytestmark = pytest.mark.anyio

DEGREES = "http://www.onvif.org/ver10/tptz/PanTiltSpaces/SphericalPositionSpaceDegrees"
TRANSLATION_DEGREES = "http://www.onvif.org/ver10/tptz/PanTiltSpaces/SphericalTranslationSpaceDegrees"
FOV = "http://www.onvif.org/ver10/tptz/PanTiltSpaces/TranslationSpaceFov"


def subcodes(fault: Fault) -> list[str]:
    return [re.sub(r"^.*[:}]", "", str(getattr(code, "text", code))) for code in fault.subcodes]


async def test_services_and_what_the_device_is(client: Any, served: ServedCamera) -> None:
    device = await client.create_devicemgmt_service()
    services = await device.GetServices({"IncludeCapability": True})
    found = {service.XAddr.removeprefix(served.url): service.Capabilities for service in services}
    assert list(found) == [
        "/onvif/device_service",
        "/onvif/media_service",
        "/onvif/media2_service",
        "/onvif/ptz_service",
        "/onvif/imaging_service",
    ]
    assert found["/onvif/ptz_service"]._value_1.get("MoveStatus") == "true"
    about = await device.GetDeviceInformation()
    assert (about.Manufacturer, about.Model) == ("AXIS", "M5075-G")
    assert about.SerialNumber == served.vapix.serial  # the same in VAPIX
    interface = (await device.GetNetworkInterfaces())[0]
    assert interface.Info.HwAddress.replace(":", "") == about.SerialNumber
    assert interface.IPv4.Config.Manual[0].Address == "127.0.0.1"
    assert (await device.GetHostname()).Name
    assert (await device.GetServiceCapabilities()).Security.UsernameToken
    capabilities = await device.GetCapabilities({"Category": "All"})
    assert capabilities.PTZ.XAddr == f"{served.url}/onvif/ptz_service"
    protocols = {protocol.Name: protocol.Port for protocol in await device.GetNetworkProtocols()}
    assert protocols == {"HTTP": [served.port], "RTSP": [RTSP_PORT]}
    users = {user.Username: (user.UserLevel, user.Password) for user in await device.GetUsers()}
    assert users["viewer"] == ("User", None)  # passwords are not told
    assert (await device.GetDNS()).FromDHCP is False
    assert (await device.GetNTP()).FromDHCP is False
    await device.GetNetworkDefaultGateway()
    scopes = [scope.ScopeItem for scope in await device.GetScopes()]
    assert "onvif://www.onvif.org/hardware/M5075-G" in scopes


async def test_media_profile_stream_and_snapshot(client: Any, media: Any, device: VirtualDevice, served: ServedCamera) -> None:
    profile, small = await media.GetProfiles()
    assert profile.VideoEncoderConfiguration.Encoding == "H264"
    size = profile.VideoEncoderConfiguration.Resolution
    assert (size.Width, size.Height) == (device.width, device.height)
    assert (await media.GetProfile({"ProfileToken": profile.token})).Name == profile.Name
    (source,) = await media.GetVideoSources()
    assert source.token == profile.VideoSourceConfiguration.SourceToken
    options = await media.GetVideoEncoderConfigurationOptions({"ProfileToken": profile.token})
    assert options.H264.ResolutionsAvailable[0].Width == device.width
    setup = {"Stream": "RTP-Unicast", "Transport": {"Protocol": "RTSP"}}
    stream = await media.GetStreamUri({"StreamSetup": setup, "ProfileToken": profile.token})
    assert stream.Uri == f"rtsp://127.0.0.1:{RTSP_PORT}/axis-media/media.amp"
    stream = await media.GetStreamUri({"StreamSetup": setup, "ProfileToken": small.token})
    assert stream.Uri == f"rtsp://127.0.0.1:{RTSP_PORT}/axis-media/media.amp?resolution=160x90"
    setup = {"Stream": "RTP-Unicast", "Transport": {"Protocol": "HTTP"}}
    stream = await media.GetStreamUri({"StreamSetup": setup, "ProfileToken": profile.token})
    assert stream.Uri == f"http://127.0.0.1:{RTSP_PORT}/axis-media/media.amp"
    configuration = {"ConfigurationToken": small.VideoEncoderConfiguration.token}
    assert (await media.GetVideoEncoderConfiguration(configuration)).Resolution.Width == device.width // 2
    assert len(await media.GetVideoEncoderConfigurations()) == 2
    assert (await client.get_snapshot_uri(profile.token)).startswith(f"{served.url}/axis-cgi/jpg/image.cgi")
    jpeg = await client.get_snapshot(profile.token)
    picture = cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR)
    assert picture is not None
    assert picture.shape == (device.height, device.width, 3)


@pytest.mark.parametrize(
    ("position", "expected"),
    [
        ({"PanTilt": {"x": 0.5, "y": -1.0}, "Zoom": {"x": 1.0}}, Pose(89.5, -60.0, 5.0)),
        ({"PanTilt": {"x": -1.0, "y": 1.0}}, Pose(-179.0, 30.0, 1.5)),
        ({"PanTilt": {"x": 33.25, "y": -12.5, "space": DEGREES}}, Pose(33.25, -12.5, 1.5)),
        ({"Zoom": {"x": 0.5}}, Pose(10.0, 5.0, 3.0)),
    ],
)
async def test_absolute_moves(ptz: Any, device: VirtualDevice, time: HandClock, position: dict[str, Any], expected: Pose) -> None:
    device.move(Pose(10.0, 5.0, 1.5))
    time.pass_(60)
    await ptz.AbsoluteMove({"ProfileToken": PROFILE, "Position": position})
    assert device.destination == expected


async def test_relative_moves(ptz: Any, device: VirtualDevice, time: HandClock) -> None:
    async def turn(pan_tilt: dict[str, Any] | None = None, zoom: float | None = None) -> Pose:
        vector = {"PanTilt": pan_tilt} if pan_tilt else {"Zoom": {"x": zoom}}
        await ptz.RelativeMove({"ProfileToken": PROFILE, "Translation": vector})
        time.pass_(60)
        return device.pose()

    device.move(Pose(0.0, 0.0, 1.0))
    time.pass_(60)
    assert near(await turn({"x": 0.1, "y": -0.2}), Pose(17.9, -9.0, 1.0))
    assert near(await turn({"x": -20.0, "y": 4.0, "space": TRANSLATION_DEGREES}), Pose(-2.1, -5.0, 1.0))
    assert near(await turn(zoom=0.25), Pose(-2.1, -5.0, 2.0))
    assert near(await turn(zoom=-1.0), Pose(-2.1, -5.0, 1.0))  # ends at its limit


@pytest.mark.parametrize(("tilt_deg", "zoom"), [(0.0, 1.0), (-40.0, 1.0), (-20.0, 3.0)])
async def test_a_move_in_the_field_of_view_centres_the_point(
    ptz: Any, device: VirtualDevice, time: HandClock, tilt_deg: float, zoom: float
) -> None:
    device.move(Pose(20.0, tilt_deg, zoom))
    time.pass_(60)
    before = Perspective(20.0, tilt_deg, device.optics.hfov_deg(zoom), device.width, device.height)
    wanted = before.directions([0.5 + 0.6 / 2, 0.5 - 0.4 / 2])
    await ptz.RelativeMove({"ProfileToken": PROFILE, "Translation": {"PanTilt": {"x": 0.6, "y": 0.4, "space": FOV}}})
    time.pass_(60)
    pose = device.pose()
    after = Perspective(pose.pan_deg, pose.tilt_deg, device.optics.hfov_deg(pose.zoom), device.width, device.height)
    assert after.points(wanted) == pytest.approx([0.5, 0.5], abs=2e-3)


async def test_continuous_moves_run_until_their_timeout_or_a_stop(ptz: Any, device: VirtualDevice, time: HandClock) -> None:
    start = device.pose()
    velocity = {"PanTilt": {"x": 0.5, "y": 0.0}, "Zoom": {"x": 0.2}}
    await ptz.ContinuousMove({"ProfileToken": PROFILE, "Velocity": velocity, "Timeout": timedelta(seconds=2)})
    driven = device.commanded_velocity
    assert (driven.pan_dps, driven.tilt_dps, driven.zoom_rate) == pytest.approx((50.0, 0.0, 0.3))
    time.pass_(1.0)
    assert (await ptz.GetStatus({"ProfileToken": PROFILE})).MoveStatus.PanTilt == "MOVING"
    time.pass_(5.0)
    assert (await ptz.GetStatus({"ProfileToken": PROFILE})).MoveStatus.PanTilt == "IDLE"
    assert device.pose().pan_deg - start.pan_deg == pytest.approx(100.0, abs=1.0)

    await ptz.ContinuousMove({"ProfileToken": PROFILE, "Velocity": {"PanTilt": {"x": -1.0, "y": 0.0}, "Zoom": {"x": -0.1}}})
    await ptz.Stop({"ProfileToken": PROFILE, "PanTilt": True, "Zoom": False})
    time.pass_(0.5)
    assert device.velocity.pan_dps == 0.0
    assert device.velocity.zoom_rate < 0.0
    await ptz.Stop({"ProfileToken": PROFILE})
    time.pass_(1.0)
    assert not device.is_moving()


async def test_a_stop_of_one_axis_lets_an_absolute_move_of_the_other_go_on(
    ptz: Any, device: VirtualDevice, time: HandClock
) -> None:
    device.move(Pose(0.0, 0.0, 1.0))
    time.pass_(60)
    await ptz.AbsoluteMove({"ProfileToken": PROFILE, "Position": {"PanTilt": {"x": 0.9, "y": 0.0}, "Zoom": {"x": 1.0}}})
    time.pass_(0.5)
    await ptz.Stop({"ProfileToken": PROFILE, "PanTilt": True, "Zoom": False})
    stopped_at = device.pose()
    time.pass_(60)
    assert near(device.pose(), Pose(stopped_at.pan_deg, stopped_at.tilt_deg, 5.0))


async def test_speed_is_a_fraction_of_the_top_speed(ptz: Any, device: VirtualDevice, time: HandClock) -> None:
    async def degrees_in_a_second(speed: dict[str, Any] | None) -> float:
        device.move(Pose(0.0, 0.0, 1.0))
        time.pass_(60)
        await ptz.AbsoluteMove({"ProfileToken": PROFILE, "Position": {"PanTilt": {"x": 1.0, "y": 0.0}}, "Speed": speed})
        time.pass_(1.0)
        return device.pose().pan_deg

    fast = await degrees_in_a_second(None)
    assert await degrees_in_a_second({"PanTilt": {"x": 0.2, "y": 0.2}}) == pytest.approx(fast * 0.2, rel=0.3)


async def test_status_reports_the_pose_in_the_default_spaces(ptz: Any, device: VirtualDevice, time: HandClock) -> None:
    device.move(Pose(89.5, -60.0, 3.0))
    time.pass_(60)
    position = (await ptz.GetStatus({"ProfileToken": PROFILE})).Position
    assert (position.PanTilt.x, position.PanTilt.y, position.Zoom.x) == pytest.approx((0.5, -1.0, 0.5))
    (configuration,) = await ptz.GetConfigurations()
    assert position.PanTilt.space == configuration.DefaultAbsolutePantTiltPositionSpace
    configuration.DefaultAbsolutePantTiltPositionSpace = DEGREES
    await ptz.SetConfiguration({"PTZConfiguration": configuration, "ForcePersistence": False})
    position = (await ptz.GetStatus({"ProfileToken": PROFILE})).Position
    assert (position.PanTilt.x, position.PanTilt.y, position.PanTilt.space) == (89.5, -60.0, DEGREES)


@pytest.mark.parametrize(("fault", "expected"), [("", "MOVING"), ("lying", "IDLE"), ("missing", None)])
async def test_move_status_and_its_faults(ptz: Any, device: VirtualDevice, time: HandClock, fault: Any, expected: Any) -> None:
    device.faults = Faults(move_status=fault)
    await ptz.AbsoluteMove({"ProfileToken": PROFILE, "Position": {"Zoom": {"x": 1.0}}})
    time.pass_(0.3)
    status = await ptz.GetStatus({"ProfileToken": PROFILE})
    assert (status.MoveStatus.PanTilt if status.MoveStatus else None) == expected


async def test_presets_are_saved_called_renamed_and_removed(ptz: Any, device: VirtualDevice, time: HandClock) -> None:
    before = [preset.Name for preset in await ptz.GetPresets({"ProfileToken": PROFILE})]
    device.move(Pose(12.0, -3.0, 2.0))
    with pytest.raises(Fault) as moving:
        await ptz.SetPreset({"ProfileToken": PROFILE, "PresetName": "gate"})
    assert subcodes(moving.value) == ["Action", "MovingPTZ"]
    time.pass_(60)
    token = await ptz.SetPreset({"ProfileToken": PROFILE, "PresetName": "Tör 2"})
    saved = next(preset for preset in await ptz.GetPresets({"ProfileToken": PROFILE}) if preset.token == token)
    assert saved.Name == "Tör 2"
    assert saved.PTZPosition.Zoom.x == pytest.approx(0.25)
    await ptz.GotoHomePosition({"ProfileToken": PROFILE})
    time.pass_(60)
    assert device.pose() == device.home
    speed = {"PanTilt": {"x": 0.5, "y": 0.5}, "Zoom": {"x": 1.0}}
    await ptz.GotoPreset({"ProfileToken": PROFILE, "PresetToken": token, "Speed": speed})  # as Home Assistant sends it
    time.pass_(60)
    assert near(device.pose(), Pose(12.0, -3.0, 2.0))
    with pytest.raises(Fault) as taken:
        await ptz.SetPreset({"ProfileToken": PROFILE, "PresetName": "Tör 2"})
    assert subcodes(taken.value) == ["InvalidArgVal", "PresetExist"]
    assert await ptz.SetPreset({"ProfileToken": PROFILE, "PresetName": "renamed", "PresetToken": token}) == token
    await ptz.RemovePreset({"ProfileToken": PROFILE, "PresetToken": token})
    assert [preset.Name for preset in await ptz.GetPresets({"ProfileToken": PROFILE})] == before
    unnamed = await ptz.SetPreset({"ProfileToken": PROFILE})
    assert next(p for p in await ptz.GetPresets({"ProfileToken": PROFILE}) if p.token == unnamed).Name == "Preset 1"


async def test_home_can_be_set(ptz: Any, device: VirtualDevice, time: HandClock) -> None:
    device.move(Pose(-40.0, 0.0, 1.0))
    time.pass_(60)
    await ptz.SetHomePosition({"ProfileToken": PROFILE})
    device.move(Pose(0.0, 0.0, 1.0))
    time.pass_(60)
    await ptz.GotoHomePosition({"ProfileToken": PROFILE})
    time.pass_(60)
    assert near(device.pose(), Pose(-40.0, 0.0, 1.0))


async def test_a_wrong_password_is_a_fault(served: ServedCamera) -> None:
    async with connect(served, password="wrong") as client:
        media = await client.create_media_service()
        with pytest.raises(Fault) as refused:
            await media.GetProfiles()
    assert subcodes(refused.value) == ["NotAuthorized"]
    assert is_auth_error(refused.value)


async def test_roles_limit_what_an_account_may_do(served: ServedCamera, device: VirtualDevice, time: HandClock) -> None:
    async def refused(name: str, operation: str, **arguments: Any) -> bool:
        async with connect(served, name) as client:
            ptz = await client.create_ptz_service()
            try:
                await getattr(ptz, operation)({"ProfileToken": PROFILE, **arguments})
            except Fault as fault:
                assert subcodes(fault) == ["NotAuthorized"]
                return True
        return False

    assert not await refused("viewer", "GetStatus")
    assert await refused("viewer", "Stop")
    assert await refused("viewer", "GotoHomePosition")
    assert not await refused("operator", "GotoHomePosition")
    time.pass_(60)
    assert await refused("operator", "SetPreset", PresetName="gate")
    assert not await refused("admin", "SetPreset", PresetName="gate")


async def test_an_administrator_reboots_the_device(served: ServedCamera, device: VirtualDevice, time: HandClock) -> None:
    device.move(Pose(40.0, -10.0, 2.0))
    time.pass_(60)
    async with connect(served, "operator") as client:
        with pytest.raises(Fault):
            await (await client.create_devicemgmt_service()).SystemReboot()
    assert device.pose() != device.home
    async with connect(served, "admin") as client:
        assert "10 seconds" in await (await client.create_devicemgmt_service()).SystemReboot()
    assert device.pose() == device.home
    assert not device.down  # the reply is delivered first
    time.pass_(1)
    assert device.down
    time.pass_(10)
    assert not device.down


@pytest.mark.parametrize("skew_s", [3600.0, -7200.0])
async def test_a_client_can_adjust_to_a_wrong_clock(served: ServedCamera, device: VirtualDevice, skew_s: float) -> None:
    device.faults = Faults(clock_skew_s=skew_s)
    async with connect(served) as client:
        media = await client.create_media_service()
        with pytest.raises(Fault) as refused:
            await media.GetProfiles()
        assert subcodes(refused.value) == ["NotAuthorized"]
    async with connect(served, adjust_time=True) as client:
        media = await client.create_media_service()
        assert len(await media.GetProfiles()) == 2


async def test_services_that_the_device_lacks_are_not_listed(client: Any) -> None:
    with pytest.raises(ONVIFError):
        await client.create_events_service()


@pytest.mark.parametrize(
    ("operation", "arguments", "expected"),
    [
        ("GetStatus", {"ProfileToken": "nowhere"}, ["InvalidArgVal", "NoProfile"]),
        ("GotoPreset", {"ProfileToken": PROFILE, "PresetToken": "999"}, ["InvalidArgVal", "NoToken"]),
        ("RemovePreset", {"ProfileToken": PROFILE, "PresetToken": "one"}, ["InvalidArgVal", "NoToken"]),
        (
            "SetPreset",
            {"ProfileToken": PROFILE, "PresetName": "x" * 40},
            ["InvalidArgVal", "InvalidPresetName"],
        ),
        (
            "AbsoluteMove",
            {"ProfileToken": PROFILE, "Position": {"PanTilt": {"x": 1.5, "y": 0.0}}},
            ["InvalidArgVal", "InvalidPosition"],
        ),
        (
            "AbsoluteMove",
            {"ProfileToken": PROFILE, "Position": {"PanTilt": {"x": 0.0, "y": 0.0, "space": "urn:elsewhere"}}},
            ["InvalidArgVal", "SpaceNotSupported"],
        ),
        (
            "AbsoluteMove",
            {"ProfileToken": PROFILE, "Position": {"Zoom": {"x": float("nan")}}},
            ["InvalidArgVal", "InvalidPosition"],
        ),
        ("AbsoluteMove", {"ProfileToken": PROFILE, "Position": {}}, ["InvalidArgs"]),
        (
            "AbsoluteMove",
            {"ProfileToken": PROFILE, "Position": {"Zoom": {"x": 1.0}}, "Speed": {"Zoom": {"x": 2.0}}},
            ["InvalidArgVal", "InvalidSpeed"],
        ),
        (
            "RelativeMove",
            {"ProfileToken": PROFILE, "Translation": {"PanTilt": {"x": 0.0, "y": -3.0, "space": FOV}}},
            ["InvalidArgVal", "InvalidTranslation"],
        ),
        (
            "ContinuousMove",
            {"ProfileToken": PROFILE, "Velocity": {"PanTilt": {"x": float("inf"), "y": 0.0}}},
            ["InvalidArgVal", "InvalidVelocity"],
        ),
        (
            "ContinuousMove",
            {"ProfileToken": PROFILE, "Velocity": {"Zoom": {"x": 1.0}}, "Timeout": timedelta(hours=1)},
            ["InvalidArgVal", "TimeoutNotSupported"],
        ),
        ("GetPresetTours", {"ProfileToken": PROFILE}, ["ActionNotSupported"]),
    ],
)
async def test_refusals_are_faults_with_their_codes(
    ptz: Any, device: VirtualDevice, operation: str, arguments: dict[str, Any], expected: list[str]
) -> None:
    before = device.destination
    with pytest.raises(Fault) as refused:
        await getattr(ptz, operation)(arguments)
    assert subcodes(refused.value) == expected
    assert device.destination == before


def near(pose: Pose, expected: Pose) -> bool:
    values = (pose.pan_deg, pose.tilt_deg, pose.zoom)
    return values == pytest.approx((expected.pan_deg, expected.tilt_deg, expected.zoom), abs=1e-6)
