"""Faults of vendors that the ONVIF driver lives with, and devices that it must not trust."""

from __future__ import annotations

import logging
import os
import re
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from types import SimpleNamespace
from typing import Any

import anyio
import pytest

from scope_ptz.camera.network.errors import (
    CameraReplyError,
    ForeignAddressError,
    PositionNotReachedError,
)
from scope_ptz.camera.onvif.camera import OnvifCamera
from scope_ptz.camera.onvif.device import choose_profiles
from scope_ptz.camera.onvif.mapping import OnvifMapping
from scope_ptz.camera.onvif.presets import readable_name
from scope_ptz.errors import CameraError, UnknownNameError
from scope_ptz.geometry import Pose
from scope_ptz.simulator.pack import Scene
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.http.server import serve
from tests.camera.onvif.opening import ACCOUNTS, PASSWORD, opened
from tests.camera.onvif.vendor import Vendor, without

pytestmark = pytest.mark.anyio

THERE = Pose(40.0, -12.0, 2.0)
MEASURED = OnvifMapping(pan_deg=(-179.0, 179.0), tilt_deg=(-60.0, 30.0), fields=((0.0, 71.0), (1.0, 14.0)))


@pytest.fixture
def device(analytic_scene: Scene) -> VirtualDevice:
    return VirtualDevice(analytic_scene, accounts=ACCOUNTS, width=320, height=180, time_scale=100)


@asynccontextmanager
async def driver(device: VirtualDevice, vendor: Vendor | None = None, **options: Any) -> AsyncIterator[OnvifCamera]:
    async with serve([device], onvif=vendor or Vendor()) as (served,), opened(served.port, **options) as camera:
        yield camera


@pytest.mark.full
@pytest.mark.parametrize("status", ["missing", "lying"])
async def test_move_status_is_not_needed(device: VirtualDevice, status: str) -> None:
    device.faults = device.faults.model_copy(update={"move_status": status})
    async with driver(device) as camera:
        assert (await camera.move(THERE)).pose.pan_deg == pytest.approx(40.0, abs=0.1)
        assert not device.is_moving()


async def test_move_status_that_never_updates(device: VirtualDevice) -> None:
    async with driver(device, Vendor(change=lambda _, reply: reply.replace(b">IDLE<", b">MOVING<"))) as camera:
        assert (await camera.move(THERE)).pose.zoom == pytest.approx(2.0, rel=0.01)


async def test_speed_is_never_sent_and_relative_moves_are_not_used(device: VirtualDevice) -> None:
    vendor = Vendor(refuse=lambda name, request: "InvalidArgVal" if b"Speed" in request or name == "RelativeMove" else "")
    async with driver(device, vendor) as camera:
        name = (await camera.presets())[0].name
        await camera.go_to_preset(name)
        await camera.move(THERE)
        await camera.go_home()
    assert {"GotoPreset", "AbsoluteMove", "GotoHomePosition"} <= set(vendor.seen)


@pytest.mark.parametrize("broken", [b"T\xfcr", "Tür".encode().decode("latin-1").encode(), b"a\xff\xfeb", b""])
async def test_preset_names_with_broken_encoding(device: VirtualDevice, broken: bytes) -> None:
    first = device.presets()[0]

    def change(name: str, reply: bytes) -> bytes:
        return reply.replace(f">{first.name}<".encode(), b">" + broken + b"<") if name == "GetPresets" else reply

    async with driver(device, Vendor(change=change)) as camera:
        names = [preset.name for preset in await camera.presets()]
        assert len(names) == len(set(names)) == len(device.presets())
        assert all(name.isprintable() and name for name in names)
        assert (await camera.go_to_preset(names[0])).pose.pan_deg == pytest.approx(first.pose.pan_deg, abs=0.1)


def test_readable_names() -> None:
    assert readable_name("Tür".encode().decode("latin-1")) == "Tür"
    assert readable_name("Tür") == "Tür"
    assert readable_name("a\x00b\n c") == "a b c"


async def test_addresses_that_point_elsewhere_are_pinned(device: VirtualDevice) -> None:
    elsewhere = Vendor(change=lambda _, reply: re.sub(rb"//127\.0\.0\.1(:\d+)?", rb"//evil.example\1", reply))
    async with driver(device, elsewhere) as camera:
        await camera.move(THERE)
        assert (await camera.frame()).width == 320
        assert camera.pictures.stream_url.startswith("rtsp://127.0.0.1")
        assert PASSWORD not in camera.pictures.stream_url
        assert "evil" not in camera.pictures.snapshot_path


async def test_addresses_of_other_schemes_are_refused(device: VirtualDevice) -> None:
    vendor = Vendor(change=lambda name, reply: reply.replace(b"http://127", b"file://127") if "Snapshot" in name else reply)
    with pytest.raises(ForeignAddressError):
        async with driver(device, vendor):
            pass


async def test_redirects_are_refused(device: VirtualDevice) -> None:
    with pytest.raises(ForeignAddressError, match=r"evil\.example") as caught:
        async with driver(device, Vendor(redirect="http://evil.example/onvif")):
            pass
    assert PASSWORD not in str(caught.value)


async def test_library_leaves_process_alone(device: VirtualDevice, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("http_proxy", "http://proxy.example:3128")
    handlers = list(logging.getLogger().handlers)
    async with driver(device) as camera:
        await camera.pose()
    assert os.environ["http_proxy"] == "http://proxy.example:3128"
    assert logging.getLogger().handlers == handlers


async def test_clock_that_cannot_be_read(device: VirtualDevice) -> None:
    def change(name: str, reply: bytes) -> bytes:
        return without("UTCDateTime")(reply) if name == "GetSystemDateAndTime" else reply

    async with driver(device, Vendor(change=change)) as camera:
        await camera.move(THERE)


async def test_garbage_is_a_camera_error(device: VirtualDevice) -> None:
    answer = [b""]
    vendor = Vendor(change=lambda name, reply: answer[0] if name == "GetStatus" else reply)
    async with driver(device, vendor) as camera:
        for garbage in (b"\x00\xff<<", b"<html><body>login</body></html>", b"", b"<!DOCTYPE a [<!ENTITY b 'c'>]><a>&b;</a>"):
            answer[0] = garbage
            with pytest.raises(CameraError):
                await camera.pose()


async def test_device_without_position_says_so(device: VirtualDevice) -> None:
    def change(name: str, reply: bytes) -> bytes:
        return without("Position")(reply) if name == "GetStatus" else reply

    async with driver(device, Vendor(change=change)) as camera:
        with pytest.raises(CameraReplyError, match="does not report its position"):
            await camera.move(THERE)


async def test_preset_deleted_meanwhile(device: VirtualDevice) -> None:
    name = device.presets()[0].name

    def refuse(operation: str, _: bytes) -> str:
        if operation == "GotoPreset":
            device.remove_preset(device.find_preset(name).number)
            return "NoToken"
        return ""

    async with driver(device, Vendor(refuse=refuse)) as camera:
        with pytest.raises(UnknownNameError):
            await camera.go_to_preset(name)


async def test_refused_timeout_is_replaced_by_the_dead_mans_switch(analytic_scene: Scene) -> None:
    device = VirtualDevice(analytic_scene, accounts=ACCOUNTS, width=320, height=180)
    vendor = Vendor(
        refuse=lambda name, request: "TimeoutNotSupported" if name == "ContinuousMove" and b"Timeout" in request else ""
    )
    async with driver(device, vendor) as camera:
        await camera.drive(20.0, timeout_s=0.2)
        with anyio.fail_after(10):
            while "Stop" not in vendor.seen:  # noqa: ASYNC110 - the watch runs in a thread
                await anyio.sleep(0.02)
        before = await camera.pose()
        await anyio.sleep(0.3)
        assert (await camera.pose()).pan_deg == pytest.approx(before.pan_deg, abs=3.0)
        assert device.velocity.pan_dps == 0.0


def generic_only(name: str, reply: bytes) -> bytes:
    """Take the spaces in degrees out of what a device states."""
    if name not in ("GetConfigurationOptions", "GetNode"):
        return reply
    pattern = rb"<((?:[\w-]+:)?)(\w+Space)>(?:(?!</\1\2>).)*SphericalPositionSpaceDegrees.*?</\1\2>"
    return re.sub(pattern, b"", reply, flags=re.DOTALL)


async def test_generic_space_needs_a_mapping(device: VirtualDevice) -> None:
    with pytest.raises(CameraError, match=r"pan range and tilt range.*scope camera calibrate"):
        async with driver(device, Vendor(change=generic_only)):
            pass
    async with driver(device, Vendor(change=generic_only), mapping=MEASURED) as camera:
        await camera.move(THERE)
        assert device.pose().pan_deg == pytest.approx(40.0, abs=0.05)
        assert device.pose().tilt_deg == pytest.approx(-12.0, abs=0.05)


async def test_generic_space_that_counts_the_other_way(device: VirtualDevice) -> None:
    turned = OnvifMapping(pan_deg=(179.0, -179.0), tilt_deg=(-60.0, 30.0), fields=MEASURED.fields)
    async with driver(device, Vendor(change=generic_only), mapping=turned) as camera:
        assert (await camera.move(THERE)).pose.pan_deg == pytest.approx(40.0, abs=0.1)
        assert device.pose().pan_deg == pytest.approx(-40.0, abs=0.05)
        await camera.drive(30.0, timeout_s=5.0)
        await anyio.sleep(0.02)
        assert device.commanded_velocity.pan_dps <= 0.0
        await camera.stop()


async def test_space_without_extent_is_left_out(device: VirtualDevice) -> None:
    def change(name: str, reply: bytes) -> bytes:
        return reply.replace(b"179.0<", b"0.0<").replace(b"-0.0<", b"0.0<") if name == "GetConfigurationOptions" else reply

    async with driver(device, Vendor(change=change), mapping=MEASURED) as camera:
        assert list(camera.device.report_spaces) == [camera.device.move_space.uri, ""]
        await camera.move(THERE)
        assert device.pose().pan_deg == pytest.approx(40.0, abs=0.05)


async def test_unknown_model_has_to_be_measured(device: VirtualDevice) -> None:
    vendor = Vendor(change=lambda _, reply: reply.replace(b"M5075-G", b"DS-2DE"))
    with pytest.raises(CameraError, match="field of view"):
        async with driver(device, vendor):
            pass
    async with driver(device, vendor, assume=True) as camera:
        assert camera.info.assumed == ("field of view",)
    async with driver(device, vendor, mapping=MEASURED) as camera:
        assert camera.info.assumed == ()
        assert camera.info.optics.hfov_deg(camera.info.limits.max_zoom) == pytest.approx(14.0)


def _profile(token: str, width: int, *, ptz: bool) -> Any:
    encoder = SimpleNamespace(Resolution=SimpleNamespace(Width=width, Height=width * 9 // 16))
    source = SimpleNamespace(SourceToken="one")
    return SimpleNamespace(
        token=token, Name=token, PTZConfiguration=SimpleNamespace() if ptz else None, VideoEncoderConfiguration=encoder,
        VideoSourceConfiguration=source,
    )  # fmt: skip


def test_profiles_with_ptz_on_the_sub_stream_only() -> None:
    main, sub = _profile("main", 3840, ptz=False), _profile("sub", 640, ptz=True)
    ptz, picture = choose_profiles([main, sub], "here", 1280)
    assert (ptz.token, picture.token) == ("sub", "main")
    assert choose_profiles([main, sub], "here", 1280, "sub")[1].token == "sub"
    with pytest.raises(CameraError, match=r"no profile 'third'.*main, sub"):
        choose_profiles([main, sub], "here", 1280, "third")
    with pytest.raises(CameraError, match="no ONVIF profile with PTZ"):
        choose_profiles([main], "here", 1280)


async def test_a_point_is_centred_by_a_relative_move_in_shares_of_the_picture(device: VirtualDevice) -> None:
    vendor = Vendor()
    async with driver(device, vendor) as camera:
        await camera.move(Pose(0.0, -10.0, 1.0))
        vendor.seen.clear()
        arrival = await camera.centre_on(0.75, 0.5, zoom_factor=1.5)
        assert "RelativeMove" in vendor.seen
        assert "AbsoluteMove" not in vendor.seen
        assert arrival.pose.pan_deg == pytest.approx(19.9, abs=0.5)
        zoomed = device.optics.focal(device.pose().zoom) / device.optics.focal(1.0)
        assert zoomed == pytest.approx(1.5, rel=0.02)


async def test_a_point_is_centred_without_such_moves(device: VirtualDevice) -> None:
    vendor = Vendor(change=lambda _, reply: reply.replace(b"TranslationSpaceFov", b"TranslationSpaceOfVendor"))
    async with driver(device, vendor) as camera:
        await camera.move(Pose(0.0, -10.0, 1.0))
        assert (await camera.centre_on(0.75, 0.5)).pose.pan_deg == pytest.approx(19.9, abs=0.5)
        assert "RelativeMove" not in vendor.seen


async def test_a_relative_move_that_also_zooms_is_corrected(device: VirtualDevice) -> None:
    def also_zooms(name: str, reply: bytes) -> bytes:
        if name == "RelativeMove":
            device.move(Pose(device.destination.pan_deg, device.destination.tilt_deg, 3.0))
        return reply

    vendor = Vendor(change=also_zooms)
    async with driver(device, vendor) as camera:
        await camera.move(Pose(0.0, -10.0, 1.0))
        arrival = await camera.centre_on(0.75, 0.5)
        assert arrival.pose.zoom == pytest.approx(1.0, rel=0.01)
        assert arrival.pose.pan_deg == pytest.approx(19.9, abs=0.5)


async def test_a_stuck_axis_is_reported_when_a_point_is_centred(device: VirtualDevice) -> None:
    async with driver(device) as camera:
        await camera.move(Pose(0.0, -10.0, 1.0))
        device.faults = device.faults.model_copy(update={"stuck": ("pan",)})
        with pytest.raises(PositionNotReachedError, match="pan motor"):
            await camera.centre_on(0.9, 0.5)


async def test_a_device_without_an_imaging_service_has_no_lens_to_set(device: VirtualDevice) -> None:
    imaging = ("GetOptions", "GetMoveOptions", "GetImagingSettings")
    vendor = Vendor(refuse=lambda name, _: "ActionNotSupported" if name in imaging else "")
    async with driver(device, vendor) as camera:
        assert camera.info.capabilities.focus == camera.info.capabilities.iris == ()
        with pytest.raises(CameraError, match="cannot be set"):
            await camera.set_focus("near")
        with pytest.raises(CameraError, match="cannot be set"):
            await camera.lens()


async def test_a_device_that_lists_no_imaging_service_has_no_lens_to_set(device: VirtualDevice) -> None:
    vendor = Vendor(
        change=lambda name, reply: reply.replace(b"ver20/imaging", b"ver99/imaging") if name == "GetServices" else reply
    )
    async with driver(device, vendor) as camera:
        assert camera.info.capabilities.focus == ()
        assert "GetMoveOptions" not in vendor.seen


async def test_focus_is_moved_to_a_position_where_relative_moves_are_missing(device: VirtualDevice) -> None:
    vendor = Vendor(change=lambda name, reply: without("Relative")(reply) if name == "GetMoveOptions" else reply)
    async with driver(device, vendor) as camera:
        before = (await camera.lens()).focus
        after = (await camera.set_focus("far", step=0.1)).focus
        assert before is not None
        assert after == pytest.approx(before + 0.1, abs=0.01)
