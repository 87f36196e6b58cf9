"""Every fault ends in a typed error that says what to do, with the camera stopped and the password kept."""

from __future__ import annotations

import logging
from collections.abc import Callable

import anyio
import pytest

from scope_ptz.camera.axis.camera import AxisCamera
from scope_ptz.camera.axis.requests import mjpeg
from scope_ptz.camera.control import ControlHeldError
from scope_ptz.camera.network.errors import (
    CameraReplyError,
    CameraSignInError,
    CameraUnreachableError,
    ForeignAddressError,
    NotACameraError,
    PictureError,
    PictureNotStillError,
)
from scope_ptz.camera.network.streams import MjpegStream
from scope_ptz.errors import CameraError, InputError, UnknownNameError
from scope_ptz.geometry import Pose
from tests.camera.axis.fake_vapix import PASSWORD, FakeVapix
from tests.camera.axis.opening import device_http, opened
from tests.support.loopback import Loopback

pytestmark = pytest.mark.anyio

THERE = Pose(40.0, -10.0, 2.0)


async def _until(condition: Callable[[], object], timeout_s: float = 5.0) -> None:
    with anyio.fail_after(timeout_s):
        while not condition():  # noqa: ASYNC110 - the fake lives in another thread
            await anyio.sleep(0.01)


# --- at the start


async def test_wrong_password_is_named_and_not_shown(fake: FakeVapix, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.DEBUG)
    with pytest.raises(CameraSignInError, match="rejected the user name or the password") as caught:
        async with opened(fake.loopback.port, password="not-the-password"):
            pass
    shown = f"{caught.value!r} {caught.value.__cause__!r} {caplog.text}"
    assert "not-the-password" not in shown
    assert caught.value.__suppress_context__ or caught.value.__context__ is None
    sent = [request.headers.get("authorization", "") for request in fake.loopback.requests]
    assert sent
    assert all("not-the-password" not in each for each in sent)


async def test_password_in_clear_text_is_refused(fake: FakeVapix) -> None:
    fake.basic_only = True
    with pytest.raises(CameraSignInError, match="clear text"):
        async with opened(fake.loopback.port):
            pass
    assert not [r for r in fake.loopback.requests if "authorization" in r.headers]


async def test_something_else_answers(fake: FakeVapix) -> None:
    fake.cloak = frozenset({"limits"})
    with pytest.raises(NotACameraError, match="not an AXIS camera"):
        async with opened(fake.loopback.port):
            pass


async def test_no_field_of_view_is_asked_for(fake: FakeVapix) -> None:
    fake.cloak = frozenset({"fields"})
    with pytest.raises(CameraError, match="hfov_wide"):
        async with opened(fake.loopback.port):
            pass
    async with opened(fake.loopback.port, fields_deg=(60.0, 12.0)) as camera:
        assert camera.info.optics.hfov_deg(1.0) == pytest.approx(60.0)


async def test_old_firmware_without_tables_works(fake: FakeVapix) -> None:
    fake.cloak = frozenset({"zoom", "speed"})
    async with opened(fake.loopback.port) as camera:
        arrival = await camera.move(Pose(10.0, 0.0, 3.0))
        assert arrival.pose.zoom == pytest.approx(3.0, rel=0.01)
        # Without a table, the magnification follows from the two fields of view.
        assert camera.info.limits.max_zoom == pytest.approx(5.81, abs=0.01)


# --- redirects


async def test_credentials_do_not_follow_a_redirect(fake: FakeVapix) -> None:
    async def listen(exchange: object) -> None:
        raise AssertionError("nobody may come here")

    with Loopback([], listen) as elsewhere:
        async with opened(fake.loopback.port) as camera:
            fake.redirect = f"{elsewhere.root}/axis-cgi/com/ptz.cgi"
            with pytest.raises(ForeignAddressError, match="no credentials were sent"):
                await camera.pose()
            with pytest.raises(ForeignAddressError):
                await camera.frame()
        assert elsewhere.requests == []


# --- on the way


async def test_reboot_between_commands(fake: FakeVapix) -> None:
    async with opened(fake.loopback.port) as camera:
        await camera.move(THERE)
        fake.status = 503
        with pytest.raises(CameraUnreachableError, match="may be starting"):
            await camera.pose()
        fake.status = 0
        fake.nudge(0.0)  # a reboot goes to home
        assert (await camera.move(THERE)).pose.pan_deg == pytest.approx(THERE.pan_deg, abs=0.1)


async def test_garbage_position(fake: FakeVapix) -> None:
    async with opened(fake.loopback.port) as camera:
        fake.garbage = True
        with pytest.raises(CameraReplyError, match="not VAPIX text"):
            await camera.pose()


# --- pictures


def _live(camera: AxisCamera) -> MjpegStream:
    """A stream that loses its patience within a test."""
    request = mjpeg(1, 640, 360, 25.0)
    http = camera._client.http
    return MjpegStream(http, request.path, request.query, width=640, height=360, stalled_s=0.15, give_up_s=0.6)


async def test_stalled_stream_is_lost(fake: FakeVapix) -> None:
    async with opened(fake.loopback.port) as camera:
        live = _live(camera)
        try:
            await live.next()
            fake.stall_after = 0
            with pytest.raises(PictureError, match="no new picture") as caught:
                while True:
                    await live.next()
            assert caught.value.fault == "stalled"
        finally:
            await live.close()


async def test_stalled_stream_is_opened_again(fake: FakeVapix) -> None:
    fake.stall_after = 2
    async with opened(fake.loopback.port) as camera:
        live = _live(camera)
        try:
            for _ in range(6):
                await live.next()
            assert live.reconnects >= 2
        finally:
            await live.close()


# --- positions


async def test_limit_that_appears_later_is_reported_as_clamping(fake: FakeVapix) -> None:
    async with opened(fake.loopback.port) as camera:
        fake.clamp_pan = 30.0
        arrival = await camera.move(THERE)
        assert arrival.clamped == ("pan",)
        assert arrival.pose.pan_deg == pytest.approx(30.0, abs=0.1)


async def test_picture_that_keeps_moving(fake: FakeVapix) -> None:
    async with opened(fake.loopback.port) as camera:
        fake.shake = True
        with pytest.raises(PictureNotStillError, match="is still moving"):
            await camera.move(THERE)


async def test_actors_do_not_prevent_settling(fake: FakeVapix) -> None:
    async with opened(fake.loopback.port) as camera:
        fake.actor = True
        assert (await camera.move(THERE)).clamped == ()


# --- presets


async def test_preset_deleted_meanwhile(fake: FakeVapix) -> None:
    async with opened(fake.loopback.port) as camera:
        fake.on_move = lambda device: device.presets.clear()
        with pytest.raises(UnknownNameError, match="gate"):
            await camera.go_to_preset("gate")


async def test_preset_names_that_the_device_refuses(fake: FakeVapix) -> None:
    async with opened(fake.loopback.port) as camera:
        for name in ('a"b', "a<b", "a:b", "a~b"):
            with pytest.raises(InputError, match="may not contain"):
                await camera.save_preset(name)
        assert await camera.presets() == await camera.presets()
        assert not fake.moves


async def test_an_account_that_may_not_save_presets(fake: FakeVapix) -> None:
    async with opened(fake.loopback.port) as camera:
        fake.status = 403
        with pytest.raises(CameraSignInError, match="does not permit this"):
            await camera.save_preset("gate two")
        fake.status = 0


async def test_locked_position(fake: FakeVapix) -> None:
    fake.locked = True
    async with opened(fake.loopback.port) as camera:
        for command in (camera.move(THERE), camera.drive(5.0), camera.go_home()):
            with pytest.raises(CameraError, match="is locked"):
                await command
    assert not fake.moves


# --- control queue


async def test_control_queue_is_respected(fake: FakeVapix) -> None:
    fake.control_queue_on = fake.other_has_control = True
    async with opened(fake.loopback.port) as camera:
        with pytest.raises(ControlHeldError, match=r"control queue.*number 2.*410 s"):
            await camera.move(THERE)
        # It asked once, left the queue, and sent no motion.
        assert [text for _, text in fake.moves if not text.startswith(("move=stop", "continuous"))] == [
            "queue request",
            "queue drop",
        ]
        fake.other_has_control = False
        await camera.move(THERE)
        assert any(text.startswith("pan=") for _, text in fake.moves)
    assert fake.moves[-1][1] == "queue drop"


async def test_no_queue_no_requests(fake: FakeVapix) -> None:
    async with opened(fake.loopback.port) as camera:
        await camera.move(THERE)
    assert not [text for _, text in fake.moves if text.startswith("queue")]


# --- a continuous move never runs away


async def test_drive_whose_reply_is_lost_ends(fake: FakeVapix) -> None:
    async with opened(fake.loopback.port) as camera:
        # The device carries the command out, and its reply is lost.
        original = fake.loopback.then

        async def lose(exchange: object) -> None:
            fake.loopback.then = original
            path = exchange.request.path  # type: ignore[attr-defined]
            fake._command({"continuouspantiltmove": "20,0"} if "continuous" in path else {})
            exchange.hang_up()  # type: ignore[attr-defined]

        fake.loopback.then = lose
        with pytest.raises(CameraUnreachableError):
            await camera.drive(20.0, timeout_s=10.0)
        await _until(lambda: not fake.driving)


async def test_lost_link_is_stopped_when_it_is_back(fake: FakeVapix) -> None:
    async with opened(fake.loopback.port) as camera:
        await camera.drive(5.0, timeout_s=10.0)
        fake.status = 503
        camera._dead_mans_switch.stop_now()
        await anyio.sleep(0.3)
        assert fake.driving
        fake.status = 0
        await _until(lambda: not fake.driving)


# --- lens


async def test_focus_and_iris(fake: FakeVapix) -> None:
    async with opened(fake.loopback.port) as camera:
        assert camera.info.capabilities.focus == ("auto", "manual", "once", "near", "far")
        assert camera.info.capabilities.iris == ("auto", "manual")
        await camera.set_focus("auto")
        await camera.set_focus("near", step=0.025)
        await camera.set_iris("manual")
        assert [text for _, text in fake.moves] == ["autofocus=on", "autofocus=off", "rfocus=-250", "autoiris=off"]
        fake.moves.clear()
        assert (await camera.set_focus("once")).autofocus is False
        assert [text for _, text in fake.moves] == ["autofocus=on", "autofocus=off"]
        with pytest.raises(CameraError, match="Supported actions: auto, manual"):
            await camera.set_iris("open")
        with pytest.raises(InputError, match="at most 1"):
            await camera.set_focus("far", step=100)


async def test_a_step_is_never_sent_twice(fake: FakeVapix) -> None:
    async with opened(fake.loopback.port) as camera:
        fake.on_move = lambda device: setattr(device, "hang_up", 1)
        with pytest.raises(CameraUnreachableError):
            await camera.set_focus("far")
        assert len([text for _, text in fake.moves if text.startswith("rfocus")]) <= 1


# --- nothing is left over


def test_nothing_shows_the_password() -> None:
    http = device_http(1)
    assert PASSWORD not in repr(http) + str(http) + repr(vars(AxisCamera))
