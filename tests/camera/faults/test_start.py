"""Faults at the start: one line for the person, and nothing moves."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from anyio.from_thread import start_blocking_portal

from scope_ptz.camera.control import ControlLock
from scope_ptz.camera.network.errors import CameraSignInError, CameraTimeoutError, CameraUnreachableError, NotACameraError
from scope_ptz.errors import CameraError
from scope_ptz.simulator.pack import Scene
from scope_ptz.virtual_camera.device import VirtualDevice
from tests.camera.faults.drivers import HEIGHT, PASSWORD, USER, WIDTH, Driver, make_device, served, set_faults
from tests.cli.conftest import CommandResult, Scope, scenes, scope
from tests.support.loopback import nobody_listens
from tests.support.misbehaving import Misbehaving, good

__all__ = ["scenes", "scope"]

WRONG = "not-the-password"

Ask = Callable[[Driver, int], CommandResult]


@contextmanager
def served_elsewhere(device: VirtualDevice) -> Iterator[int]:
    """Serve a virtual camera in a thread of its own, since a command has an event loop of its own."""
    with start_blocking_portal() as portal, portal.wrap_async_context_manager(served(device)) as camera_server:
        yield camera_server.port


def spec(driver: Driver, port: int) -> str:
    stream = "" if driver.name == "axis" else "&stream=snapshot"
    return f"{driver.name}://{USER}@127.0.0.1:{port}?width={WIDTH}&height={HEIGHT}{stream}"


@pytest.fixture
def ask(scope: Scope, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Ask]:
    """``scope ask`` at a port, with a model server that is well."""
    monkeypatch.setenv("SCOPE_CAMERA_PASSWORD", PASSWORD)
    monkeypatch.setenv("SCOPE_CACHE_DIR", str(tmp_path / "cache"))
    with Misbehaving(then=good(moondream={})) as server:

        def run(driver: Driver, port: int) -> CommandResult:
            model = ("--perception", "moondream2", "--perception-url", server.url)
            return scope("ask", "pan right 40 degrees", "--camera", spec(driver, port), *model)

        yield run


def expect_one_line(done: CommandResult, words: str) -> None:
    assert done.code == 1
    assert done.out == ""
    (line,) = done.err.splitlines()
    assert words in line
    assert PASSWORD not in line
    assert WRONG not in line


def test_unreachable_at_start(driver: Driver, ask: Ask) -> None:
    with nobody_listens() as url:
        done = ask(driver, int(url.rsplit(":", 1)[1].split("/")[0]))
    expect_one_line(done, "Check the address and the cable, and check that the camera is on.")


def test_wrong_password(driver: Driver, device: VirtualDevice, ask: Ask, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SCOPE_CAMERA_PASSWORD", WRONG)
    with served_elsewhere(device) as port:
        expect_one_line(ask(driver, port), "rejected the")
    assert device.destination == device.home


def test_two_controllers_on_one_machine(driver: Driver, device: VirtualDevice, ask: Ask, tmp_path: Path) -> None:
    with served_elsewhere(device) as port:
        lock = ControlLock("camera", f"127.0.0.1:{port}/1", tmp_path / "cache" / "control")
        lock.acquire("the night shift")
        try:
            expect_one_line(ask(driver, port), "is controlled by the night shift")
        finally:
            lock.release()
    assert device.destination == device.home


@pytest.mark.anyio
@pytest.mark.parametrize(
    ("faults", "error"),
    [
        ({"down": True}, CameraUnreachableError),
        ({"drop": 1.0}, CameraUnreachableError),
        ({"stall_s": 60.0}, CameraTimeoutError),
        ({"unauthorized": True}, CameraSignInError),
    ],
    ids=["rebooting", "drops", "slow", "account refused"],
)
async def test_faulty_at_start(driver: Driver, device: VirtualDevice, faults: dict[str, object], error: type[CameraError]) -> None:
    set_faults(device, **faults)
    async with served(device) as camera_server:
        with pytest.raises(error):
            async with driver.opened(camera_server.port, reply_s=0.3 if device.faults.stall_s else 5.0):
                pass
        set_faults(device)
        async with driver.opened(camera_server.port) as camera:
            await camera.frame()


@pytest.mark.anyio
async def test_garbage_at_start(driver: Driver, device: VirtualDevice) -> None:
    set_faults(device, garbage=True)
    async with served(device) as camera_server:
        with pytest.raises(CameraError) as caught:
            async with driver.opened(camera_server.port):
                pass
    assert driver.name != "axis" or isinstance(caught.value, NotACameraError)
    assert caught.value.__suppress_context__ or caught.value.__context__ is None


@pytest.mark.anyio
async def test_password_is_shown_nowhere(driver: Driver, analytic_scene: Scene, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.DEBUG)
    async with served(make_device(analytic_scene)) as camera_server:
        with pytest.raises(CameraSignInError) as caught:
            async with driver.opened(camera_server.port, password=WRONG):
                pass
    assert WRONG not in f"{caught.value!r} {caught.value.__cause__!r} {caplog.text}"
    assert caught.value.__suppress_context__ or caught.value.__context__ is None
