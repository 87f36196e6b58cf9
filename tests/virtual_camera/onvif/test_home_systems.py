"""What Frigate and Home Assistant ask of a camera, in their order, with the client that both use."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from scope_ptz.geometry import Pose
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.http.server import ServedCamera
from tests.virtual_camera.onvif.conftest import HandClock

pytestmark = pytest.mark.anyio


def keys_of(value: Any, wanted: str) -> Iterator[Any]:
    """Yield what stands under a key at any depth of dictionaries."""
    if isinstance(value, dict):
        for key, inner in value.items():
            if key == wanted:
                yield inner
            yield from keys_of(inner, wanted)


async def test_frigate_starts_and_tracks(client: Any, device: VirtualDevice, time: HandClock) -> None:
    media, ptz = await client.create_media_service(), await client.create_ptz_service()
    profile = next(
        each
        for each in await media.GetProfiles()
        if each.VideoEncoderConfiguration
        and each.VideoEncoderConfiguration.Encoding == "H264"
        and each.PTZConfiguration
        and each.PTZConfiguration.DefaultContinuousPanTiltVelocitySpace
    )
    assert (await media.GetVideoSources())[0].token
    options = ptz.create_type("GetConfigurationOptions")
    options.ConfigurationToken = profile.PTZConfiguration.token
    spaces = (await ptz.GetConfigurationOptions(options)).Spaces
    fov = next(space.URI for space in spaces.RelativePanTiltTranslationSpace if "TranslationSpaceFov" in space["URI"])
    zoom = next(space.URI for space in spaces.RelativeZoomTranslationSpace if "TranslationGenericSpace" in space["URI"])
    assert spaces.AbsoluteZoomPositionSpace[0].XRange.Max == 1.0
    assert profile.PTZConfiguration.ZoomLimits is not None

    capabilities = await ptz.GetServiceCapabilities(ptz.create_type("GetServiceCapabilities"))
    assert [str(found).lower() for found in keys_of(vars(capabilities)["__values__"], "MoveStatus")] == ["true"]

    request = ptz.create_type("GetStatus")
    request.ProfileToken = profile.token
    status = await ptz.GetStatus(request)
    assert (status.MoveStatus.PanTilt, status.MoveStatus.Zoom) == ("IDLE", "IDLE")

    # The tracker reuses the position of the status as the translation of its moves.
    device.move(Pose(0.0, -10.0, 1.0))
    time.pass_(60)
    move = ptz.create_type("RelativeMove")
    move.ProfileToken = profile.token
    move.Translation = (await ptz.GetStatus(request)).Position
    move.Translation.PanTilt.space, move.Translation.Zoom.space = fov, zoom
    move.Translation.PanTilt.x, move.Translation.PanTilt.y, move.Translation.Zoom.x = 0.5, -0.2, 0
    move.Speed = {"PanTilt": {"x": 1, "y": 1}, "Zoom": {"x": 0}}
    await ptz.RelativeMove(move)
    assert device.destination.pan_deg > 5.0
    assert device.destination.tilt_deg < -10.0
    assert device.destination.zoom == 1.0
    presets = {preset["Name"].lower(): preset["token"] for preset in await ptz.GetPresets({"ProfileToken": profile.token})}
    assert presets
    await ptz.GotoPreset({"ProfileToken": profile.token, "PresetToken": next(iter(presets.values()))})


async def test_home_assistant_sets_a_camera_up(client: Any, served: ServedCamera, device: VirtualDevice) -> None:
    management = await client.create_devicemgmt_service()
    clock = await management.GetSystemDateAndTime()
    assert clock.UTCDateTime.Date.Year > 2000
    (interface,) = await management.GetNetworkInterfaces()
    assert interface.Enabled
    assert interface.Info.HwAddress
    about = await management.GetDeviceInformation()
    assert about.FirmwareVersion
    capabilities = await client.get_capabilities()
    assert capabilities["PTZ"]["XAddr"]
    media = await client.create_media_service()
    assert (await media.GetServiceCapabilities()).SnapshotUri
    profile = (await media.GetProfiles())[0]
    assert profile.VideoEncoderConfiguration.Encoding == "H264"
    ptz = await client.create_ptz_service()
    presets = await ptz.GetPresets(profile.token)
    assert all(preset and preset.token for preset in presets)
    request = media.create_type("GetStreamUri")
    request.ProfileToken = profile.token
    request.StreamSetup = {"Stream": "RTP-Unicast", "Transport": {"Protocol": "RTSP"}}
    assert (await media.GetStreamUri(request)).Uri.startswith("rtsp://127.0.0.1:")
    speed = {"PanTilt": {"x": 0.5, "y": 0.5}, "Zoom": {"x": 0.5}}
    move = ptz.create_type("ContinuousMove")
    move.ProfileToken = profile.token
    move.Velocity = {"PanTilt": {"x": 0.5, "y": 0}}
    await ptz.ContinuousMove(move)
    assert device.commanded_velocity.pan_dps == 50.0
    stop = ptz.create_type("Stop")
    stop.ProfileToken = profile.token
    await ptz.Stop(stop)
    position = {"PanTilt": {"x": 0.1, "y": 0.1}, "Zoom": {"x": 0.1}}
    await ptz.AbsoluteMove({"ProfileToken": profile.token, "Position": position, "Speed": speed})
    await ptz.RelativeMove({"ProfileToken": profile.token, "Translation": position, "Speed": speed})
    await ptz.GotoPreset({"ProfileToken": profile.token, "PresetToken": presets[0].token, "Speed": speed})
