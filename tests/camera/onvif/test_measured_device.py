"""A device that states neither degrees nor fields of view: it is calibrated from its pictures, and then used."""

from __future__ import annotations

from pathlib import Path

import pytest

from scope_ptz.errors import CameraError
from scope_ptz.factory.cameras import open_camera
from scope_ptz.factory.cameras.profiles import calibrate_camera, probe_camera
from scope_ptz.factory.scenes import open_scene
from scope_ptz.geometry import Pose
from scope_ptz.simulator.clock import SceneClock
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.http.server import serve
from tests.camera.onvif.opening import ACCOUNTS, PASSWORD, USER
from tests.camera.onvif.test_vendor_faults import generic_only
from tests.camera.onvif.vendor import Vendor

pytestmark = [pytest.mark.anyio, pytest.mark.full]


def _unknown(name: str, reply: bytes) -> bytes:
    return generic_only(name, reply).replace(b"M5075-G", b"DS-2DE")


async def test_calibrated_device_is_used_with_its_profile(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SCOPE_CAMERA_PASSWORD", PASSWORD)
    monkeypatch.setenv("SCOPE_CAMERA_PROFILES_DIR", str(tmp_path / "profiles"))
    monkeypatch.setenv("SCOPE_CACHE_DIR", str(tmp_path / "cache"))
    scene = open_scene("highway-works")
    clock = SceneClock(scene.file.start_s, realtime=True)
    device = VirtualDevice(scene, accounts=ACCOUNTS, width=960, height=540, time_scale=50, clock=clock)
    async with serve([device], onvif=Vendor(change=_unknown)) as (served,):
        spec = f"onvif://{USER}@127.0.0.1:{served.port}?stream=snapshot&latency_ms=1"
        with pytest.raises(CameraError, match="scope camera calibrate"):
            await open_camera(spec)
        probed, _ = await probe_camera(spec)
        assert probed.assumed == ("pan range", "tilt range", "field of view")
        record, path = await calibrate_camera(spec, zooms=5)
        assert record.contradictions == ()
        assert PASSWORD not in path.read_text()
        assert USER not in path.read_text()
        assert "DS-2DE" in path.read_text(), "the calibration does not erase the probe"
        async with await open_camera(spec) as opened:
            camera = opened.camera
            there = (await camera.move(Pose(30.0, -10.0, camera.info.limits.min_zoom))).pose
            assert there.pan_deg == pytest.approx(30.0, abs=0.1)
            assert device.pose().pan_deg == pytest.approx(30.0, abs=0.5)
            assert device.pose().tilt_deg == pytest.approx(-10.0, abs=0.5)
            for share in (0.0, 0.4, 1.0):
                low, high = camera.info.limits.min_zoom, camera.info.limits.max_zoom
                await camera.move(Pose(30.0, -10.0, low + share * (high - low)))
                frame = await camera.frame()
                assert frame.hfov_deg == pytest.approx(device.optics.hfov_deg(device.pose().zoom), rel=0.02)
