"""HTTPS with certificates that a camera signs itself: pinned by fingerprint, the right one, a wrong one, and a changed one."""

from __future__ import annotations

import json
import ssl
from contextlib import AsyncExitStack
from pathlib import Path

import pytest
from anyio import to_thread

from scope_ptz.camera.network.address import DeviceAddress
from scope_ptz.camera.network.errors import CameraUnreachableError
from scope_ptz.camera.network.trust import CertificateError, trust_fingerprint
from scope_ptz.errors import CameraError
from scope_ptz.factory.cameras import open_camera
from scope_ptz.geometry import Pose
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.http.certificate import Certificate, create_certificate
from tests.camera.faults.drivers import HEIGHT, ONVIF, PASSWORD, USER, WIDTH, Driver, served
from tests.camera.faults.runs import ask, expect_answer

pytestmark = pytest.mark.anyio

THERE = Pose(40.0, -12.0, 2.0)


@pytest.fixture(scope="module")
def certificate() -> Certificate:
    return create_certificate("yard", ("127.0.0.1", "localhost"))


async def _trust(port: int, fingerprint: str) -> ssl.SSLContext:
    return await to_thread.run_sync(trust_fingerprint, DeviceAddress("127.0.0.1", port, tls=True), fingerprint)


async def test_right_certificate(driver: Driver, device: VirtualDevice, certificate: Certificate, tmp_path: Path) -> None:
    async with served(device, certificate=certificate) as camera_server:
        assert camera_server.url.startswith("https://")
        trust = await _trust(camera_server.port, certificate.fingerprint)
        async with driver.opened(camera_server.port, tls=trust) as camera:
            run = await ask(camera, "pan right 30 degrees, then take a picture", tmp_path)
            await expect_answer(run)
            assert device.pose().pan_deg == pytest.approx(30.0, abs=0.1)
            await camera.drive(5.0, timeout_s=5.0)  # the dead man's switch has a connection of its own
            camera._dead_mans_switch.stop_now()
            await to_thread.run_sync(camera._dead_mans_switch.join)
            assert not camera._dead_mans_switch.is_armed


async def test_wrong_certificate(driver: Driver, device: VirtualDevice, certificate: Certificate) -> None:
    other = create_certificate("intruder", ("127.0.0.1",))
    async with served(device, certificate=certificate) as camera_server:
        with pytest.raises(
            CertificateError, match=r"does not match the configured fingerprint\. No credentials were sent"
        ) as caught:
            await _trust(camera_server.port, other.fingerprint)
        assert certificate.fingerprint in str(caught.value)
        # A certificate that nobody vouches for is refused if no fingerprint is configured.
        with pytest.raises(CameraUnreachableError, match="certificate is not trusted"):
            async with driver.opened(camera_server.port, tls=ssl.create_default_context()):
                pass


@pytest.mark.full
async def test_changed_certificate(driver: Driver, device: VirtualDevice, certificate: Certificate) -> None:
    """Another device takes the camera's place while it is connected: the handshake fails before anything is sent."""
    intruder = VirtualDevice(device.scene, width=WIDTH, height=HEIGHT)  # asks nobody for a password
    async with AsyncExitStack() as first:
        camera_server = await first.enter_async_context(served(device, certificate=certificate))
        port = camera_server.port
        trust = await _trust(port, certificate.fingerprint)
        async with driver.opened(port, tls=trust) as camera:
            await camera.pose()
            await first.aclose()
            async with served(intruder, port=port, certificate=create_certificate("intruder", ("127.0.0.1",))):
                with pytest.raises(CameraUnreachableError, match="certificate is not trusted"):
                    await camera.move(THERE)
                with pytest.raises(CertificateError, match="renewed"):
                    await _trust(port, certificate.fingerprint)
    assert intruder.destination == intruder.home


async def test_fingerprint_in_the_camera_file(
    driver: Driver, device: VirtualDevice, certificate: Certificate, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SCOPE_CAMERA_PASSWORD", PASSWORD)
    monkeypatch.setenv("SCOPE_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setenv("SCOPE_CONFIG", str(tmp_path / "scope.yaml"))
    async with served(device, certificate=certificate) as camera_server:
        stream = "" if driver.name == "axis" else "&stream=snapshot"
        spec = f"{driver.name}://{USER}@127.0.0.1:{camera_server.port}?tls=on&width={WIDTH}&height={HEIGHT}{stream}"
        camera = {"camera": spec, "fingerprint": certificate.fingerprint}
        _write(tmp_path, camera)
        async with await open_camera("yard-gate") as opened:
            assert (await opened.camera.pose()).pan_deg == pytest.approx(device.home.pan_deg, abs=0.1)
        _write(tmp_path, camera | {"fingerprint": "00" * 32})
        with pytest.raises(CertificateError, match="does not match the configured fingerprint"):
            await open_camera("yard-gate")
        _write(tmp_path, {"camera": spec})
        with pytest.raises(CameraUnreachableError, match="certificate is not trusted"):
            await open_camera("yard-gate")


def _write(folder: Path, camera: dict[str, str]) -> None:
    (folder / "scope.yaml").write_text(json.dumps({"version": 1, "cameras": {"yard-gate": camera}}))


async def test_credentials_wait_for_the_handshake(driver: Driver, device: VirtualDevice, certificate: Certificate) -> None:
    """A driver without TLS at the port of HTTPS, and the other way round, is told in one sentence."""
    async with served(device, certificate=certificate) as camera_server:
        with pytest.raises(CameraError, match=str(camera_server.port)):
            async with driver.opened(camera_server.port):
                pass
    async with served(device) as camera_server:
        with pytest.raises(CameraUnreachableError, match="TLS"):
            async with driver.opened(camera_server.port, tls=ssl.create_default_context()):
                pass


async def test_addresses_that_the_camera_states_begin_with_https(device: VirtualDevice, certificate: Certificate) -> None:
    async with served(device, certificate=certificate) as camera_server:
        trust = await _trust(camera_server.port, certificate.fingerprint)
        async with ONVIF.opened(camera_server.port, tls=trust) as camera:
            reply = await camera._client.call("devicemgmt", "GetServices", IncludeCapability=False)  # type: ignore[union-attr]
            assert {each.XAddr.partition("://")[0] for each in reply} == {"https"}


def test_the_key_is_kept(certificate: Certificate) -> None:
    assert "PRIVATE" not in repr(certificate)
    assert certificate.fingerprint != create_certificate("yard", ("127.0.0.1", "localhost")).fingerprint
