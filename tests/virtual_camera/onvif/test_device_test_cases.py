"""Test cases of the ONVIF PTZ Device Test Specification, by their numbers, as onvif-zeep-async can run them.

The official tool runs on Windows only. These tests follow the procedure of each case: what is asked, and what must hold.
"""

from __future__ import annotations

from datetime import timedelta
from typing import Any

import pytest
from zeep.exceptions import Fault
from zeep.helpers import serialize_object

from scope_ptz.virtual_camera.device import VirtualDevice
from tests.virtual_camera.onvif.conftest import PROFILE, HandClock
from tests.virtual_camera.onvif.test_client import subcodes

pytestmark = pytest.mark.anyio

DEFAULTS = {
    "DefaultAbsolutePantTiltPositionSpace": "AbsolutePanTiltPositionSpace",
    "DefaultAbsoluteZoomPositionSpace": "AbsoluteZoomPositionSpace",
    "DefaultRelativePanTiltTranslationSpace": "RelativePanTiltTranslationSpace",
    "DefaultRelativeZoomTranslationSpace": "RelativeZoomTranslationSpace",
    "DefaultContinuousPanTiltVelocitySpace": "ContinuousPanTiltVelocitySpace",
    "DefaultContinuousZoomVelocitySpace": "ContinuousZoomVelocitySpace",
}
"""The default spaces of a configuration, and the lists of spaces that they are from."""

FAR_APART = 4  # minutes: longer than any move


def plain(value: Any) -> Any:
    serialize: Any = serialize_object  # not annotated by zeep
    return serialize(value, dict)


def uris(spaces: Any, name: str) -> set[str]:
    return {space.URI for space in getattr(spaces, name)}


def listed(found: list[Any]) -> list[Any]:
    """Return a list of the device that must not be empty, because no test of its entries could fail."""
    assert found
    return found


async def test_nodes(ptz: Any) -> None:
    """PTZ-1-1-1 PTZ NODES: each node has a token, at least one space, and a description of each space."""
    nodes = await ptz.GetNodes()
    assert nodes
    for node in nodes:
        assert node.token
        for name in DEFAULTS.values():
            for space in getattr(node.SupportedPTZSpaces, name):
                assert space.URI.startswith("http://www.onvif.org/ver10/tptz/")
                assert space.XRange.Min < space.XRange.Max


async def test_node(ptz: Any) -> None:
    """PTZ-1-1-2 PTZ NODE: a node asked for by its token is the one that was listed."""
    for node in listed(await ptz.GetNodes()):
        assert plain(await ptz.GetNode({"NodeToken": node.token})) == plain(node)


async def test_fault_for_an_invalid_node(ptz: Any) -> None:
    """PTZ-1-1-4 SOAP FAULT MESSAGE: a token of no node is env:Sender / ter:InvalidArgVal / ter:NoEntity."""
    with pytest.raises(Fault) as refused:
        await ptz.GetNode({"NodeToken": "no-such-node"})
    assert refused.value.code.endswith("Sender")
    assert subcodes(refused.value) == ["InvalidArgVal", "NoEntity"]


async def test_configurations(ptz: Any) -> None:
    """PTZ-2-1-1 PTZ CONFIGURATIONS: each has a token, a name and a node."""
    configurations = await ptz.GetConfigurations()
    assert configurations
    for each in configurations:
        assert each.token
        assert each.Name
        assert each.NodeToken


async def test_configuration(ptz: Any) -> None:
    """PTZ-2-1-2 PTZ CONFIGURATION: one asked for by its token names a default space for what it supports."""
    for known in listed(await ptz.GetConfigurations()):
        one = await ptz.GetConfiguration({"PTZConfigurationToken": known.token})
        assert one.token == known.token
        assert all(getattr(one, name) for name in DEFAULTS)


async def test_configuration_options(ptz: Any) -> None:
    """PTZ-2-1-3 PTZ CONFIGURATION OPTIONS: spaces, and a range of timeouts in order."""
    for configuration in listed(await ptz.GetConfigurations()):
        options = await ptz.GetConfigurationOptions({"ConfigurationToken": configuration.token})
        assert timedelta(0) < options.PTZTimeout.Min < options.PTZTimeout.Max
        assert all(uris(options.Spaces, name) for name in DEFAULTS.values())


async def test_set_configuration(ptz: Any) -> None:
    """PTZ-2-1-4 PTZ SET CONFIGURATION: a new default timeout from the options is read back."""
    (configuration,) = await ptz.GetConfigurations()
    options = await ptz.GetConfigurationOptions({"ConfigurationToken": configuration.token})
    for timeout in (options.PTZTimeout.Max, options.PTZTimeout.Min):
        configuration.DefaultPTZTimeout = timeout
        await ptz.SetConfiguration({"PTZConfiguration": configuration, "ForcePersistence": False})
        changed = await ptz.GetConfiguration({"PTZConfigurationToken": configuration.token})
        assert changed.DefaultPTZTimeout == timeout
    configuration.DefaultPTZTimeout = options.PTZTimeout.Max * 2
    with pytest.raises(Fault) as refused:
        await ptz.SetConfiguration({"PTZConfiguration": configuration, "ForcePersistence": False})
    assert subcodes(refused.value) == ["InvalidArgVal", "ConfigModify"]


async def test_consistency_of_configurations_and_configuration(ptz: Any) -> None:
    """PTZ-2-1-5 PTZ CONFIGURATIONS AND PTZ CONFIGURATION CONSISTENCY: both ways give the same fields."""
    for each in listed(await ptz.GetConfigurations()):
        assert plain(await ptz.GetConfiguration({"PTZConfigurationToken": each.token})) == plain(each)


async def test_consistency_of_configurations_and_nodes(ptz: Any) -> None:
    """PTZ-2-1-6 PTZ CONFIGURATIONS AND PTZ NODES CONSISTENCY: default spaces are among those of the node."""
    nodes = {node.token: node for node in await ptz.GetNodes()}
    for each in listed(await ptz.GetConfigurations()):
        for default, group in DEFAULTS.items():
            assert getattr(each, default) in uris(nodes[each.NodeToken].SupportedPTZSpaces, group)


async def test_consistency_of_configurations_and_options(ptz: Any) -> None:
    """PTZ-2-1-7 PTZ CONFIGURATIONS AND PTZ CONFIGURATION OPTIONS CONSISTENCY: defaults are among the options."""
    for each in listed(await ptz.GetConfigurations()):
        options = await ptz.GetConfigurationOptions({"ConfigurationToken": each.token})
        assert options.PTZTimeout.Min <= each.DefaultPTZTimeout <= options.PTZTimeout.Max
        for default, group in DEFAULTS.items():
            assert getattr(each, default) in uris(options.Spaces, group)


async def test_fault_for_an_invalid_configuration(ptz: Any) -> None:
    """PTZ-2-1-10 SET CONFIGURATION WITH INVALID TOKEN: env:Sender / ter:InvalidArgVal / ter:NoConfig."""
    (configuration,) = await ptz.GetConfigurations()
    configuration.token = "no-such-configuration"
    with pytest.raises(Fault) as refused:
        await ptz.SetConfiguration({"PTZConfiguration": configuration, "ForcePersistence": False})
    assert subcodes(refused.value) == ["InvalidArgVal", "NoConfig"]
    with pytest.raises(Fault) as refused:
        await ptz.GetConfiguration({"PTZConfigurationToken": "no-such-configuration"})
    assert subcodes(refused.value) == ["InvalidArgVal", "NoConfig"]


async def idle(ptz: Any) -> bool:
    status = await ptz.GetStatus({"ProfileToken": PROFILE})
    return bool(status.MoveStatus.PanTilt == status.MoveStatus.Zoom == "IDLE")


@pytest.mark.parametrize("share", [0.0, 0.25, 1.0])
async def test_absolute_move(ptz: Any, time: HandClock, share: float) -> None:
    """PTZ-3-1-1 PTZ ABSOLUTE MOVE: in every space, the device arrives at what was asked for, and is idle then."""
    (configuration,) = await ptz.GetConfigurations()
    spaces = (await ptz.GetConfigurationOptions({"ConfigurationToken": configuration.token})).Spaces
    zoom = spaces.AbsoluteZoomPositionSpace[0]
    for space in spaces.AbsolutePanTiltPositionSpace:
        x = space.XRange.Min + share * (space.XRange.Max - space.XRange.Min)
        y = space.YRange.Max - share * (space.YRange.Max - space.YRange.Min)
        z = zoom.XRange.Min + share * (zoom.XRange.Max - zoom.XRange.Min)
        position = {"PanTilt": {"x": x, "y": y, "space": space.URI}, "Zoom": {"x": z, "space": zoom.URI}}
        await ptz.AbsoluteMove({"ProfileToken": PROFILE, "Position": position})
        time.pass_(60 * FAR_APART)
        configuration.DefaultAbsolutePantTiltPositionSpace = space.URI
        await ptz.SetConfiguration({"PTZConfiguration": configuration, "ForcePersistence": False})
        status = await ptz.GetStatus({"ProfileToken": PROFILE})
        assert (status.Position.PanTilt.x, status.Position.PanTilt.y) == pytest.approx((x, y))
        assert status.Position.Zoom.x == pytest.approx(z)
        assert await idle(ptz)


async def test_relative_move(ptz: Any, device: VirtualDevice, time: HandClock) -> None:
    """PTZ-3-1-3 PTZ RELATIVE MOVE: in every space, both ways, and the zoom; positive is right, up and in."""
    (configuration,) = await ptz.GetConfigurations()
    spaces = (await ptz.GetConfigurationOptions({"ConfigurationToken": configuration.token})).Spaces
    for space in spaces.RelativePanTiltTranslationSpace:
        for sign in (1, -1):
            await ptz.AbsoluteMove({"ProfileToken": PROFILE, "Position": {"PanTilt": {"x": 0, "y": 0}, "Zoom": {"x": 0.5}}})
            time.pass_(60 * FAR_APART)
            before = device.pose()
            x, y = sign * 0.1 * space.XRange.Max, sign * 0.1 * space.YRange.Max
            await ptz.RelativeMove({"ProfileToken": PROFILE, "Translation": {"PanTilt": {"x": x, "y": y, "space": space.URI}}})
            time.pass_(60 * FAR_APART)
            after = device.pose()
            assert (after.pan_deg - before.pan_deg) * sign > 0.0
            assert (after.tilt_deg - before.tilt_deg) * sign > 0.0
            assert after.zoom == before.zoom  # a move of pan and tilt leaves the zoom
    for sign in (1, -1):
        before = device.pose()
        await ptz.RelativeMove({"ProfileToken": PROFILE, "Translation": {"Zoom": {"x": sign * 0.2}}})
        time.pass_(60 * FAR_APART)
        assert (device.pose().zoom - before.zoom) * sign > 0.0
        assert device.pose().pan_deg == before.pan_deg
    assert await idle(ptz)


@pytest.mark.parametrize("velocity", [{"PanTilt": {"x": 0.1, "y": 0.02}}, {"Zoom": {"x": 0.05}}])
async def test_continuous_move_with_timeout(ptz: Any, device: VirtualDevice, time: HandClock, velocity: dict[str, Any]) -> None:
    """PTZ-3-1-4 PTZ CONTINUOUS MOVE: the device moves until the timeout of 60 s, and is idle after it."""
    await ptz.ContinuousMove({"ProfileToken": PROFILE, "Velocity": velocity, "Timeout": timedelta(seconds=60)})
    time.pass_(1.0)
    early = device.pose()
    assert not await idle(ptz)
    time.pass_(58.0)
    assert device.pose() != early
    assert not await idle(ptz)
    time.pass_(3.0)
    assert await idle(ptz)


@pytest.mark.parametrize("velocity", [{"PanTilt": {"x": -0.5, "y": 0.5}}, {"Zoom": {"x": -1.0}}, {"Zoom": {"x": 1.0}}])
async def test_continuous_move_and_stop(ptz: Any, device: VirtualDevice, time: HandClock, velocity: dict[str, Any]) -> None:
    """PTZ-3-1-5 PTZ CONTINUOUS MOVE & STOP: after Stop the device is idle and stays where it is."""
    await ptz.AbsoluteMove({"ProfileToken": PROFILE, "Position": {"Zoom": {"x": 0.5}}})
    time.pass_(60)
    before = device.pose()
    await ptz.ContinuousMove({"ProfileToken": PROFILE, "Velocity": velocity})
    time.pass_(0.5)
    assert device.pose() != before
    await ptz.Stop({"ProfileToken": PROFILE, "PanTilt": True, "Zoom": True})
    time.pass_(1.0)
    assert await idle(ptz)
    stopped = device.pose()
    time.pass_(30)
    assert device.pose() == stopped


async def test_profile_has_the_configuration(ptz: Any, media: Any) -> None:
    """MEDIA2_PTZ-1-1-1 and PTZ-2-1-x, with the profile of Media: its PTZ configuration is the listed one, and compatible."""
    (listed,) = await ptz.GetConfigurations()
    profiles = await media.GetProfiles()
    assert len(profiles) == listed.UseCount
    for profile in profiles:
        assert plain(profile.PTZConfiguration) == plain(listed)
        compatible = await ptz.GetCompatibleConfigurations({"ProfileToken": profile.token})
        assert [each.token for each in compatible] == [listed.token]
