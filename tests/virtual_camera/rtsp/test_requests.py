"""The conversation: methods, states, accounts, addresses, and requests that nobody should send."""

from __future__ import annotations

import socket
from contextlib import suppress

import pytest

from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.rtsp import sessions
from tests.support.rtsp_client import RtpPacket, RtspClient, SenderReport
from tests.virtual_camera.conftest import ACCOUNTS
from tests.virtual_camera.rtsp.serving import serving, until

pytestmark = pytest.mark.anyio

ROOT, _, VISITOR = ACCOUNTS
TCP = "RTP/AVP/TCP;unicast;interleaved=0-1"


async def test_a_whole_conversation(open_device: VirtualDevice) -> None:
    async with serving(open_device) as served, RtspClient(served.port) as client:
        options = await client.request("OPTIONS", "*")
        assert {"DESCRIBE", "SETUP", "PLAY", "PAUSE", "TEARDOWN", "GET_PARAMETER"} <= set(options["public"].split(", "))
        played = await client.play()
        info = dict(part.partition("=")[::2] for part in played["rtp-info"].split(";"))
        assert played["range"] == "npt=now-"
        first = RtpPacket.parse(await client.packet(0))
        assert 0 <= (first.sequence - int(info["seq"])) % 2**16 < 1000  # a busy server drops frames that are late
        assert 0 <= (first.timestamp - int(info["rtptime"])) % 2**32 < 10 * 90_000
        assert f"ssrc={first.ssrc:08X}" in client.set_up["transport"]
        assert first.payload[0] & 0x1F == 7  # parameter sets come first
        report = SenderReport.parse(await client.packet(1))
        assert report.ssrc == first.ssrc

        session = client.set_up.session
        assert (await client.request("GET_PARAMETER", Session=session)).status == 200
        assert (await client.request("SETUP", Session=session, Transport=TCP)).status == 455
        assert (await client.request("PAUSE", Session=session)).status == 200
        await until(lambda: served.source.subscribers == 0)
        again = await client.request("PLAY", Session=session)
        expected = int(again["rtp-info"].partition("seq=")[2].partition(";")[0])
        packet = RtpPacket.parse(await client.packet(0))
        while (packet.sequence - expected) % 2**16 >= 2**15:  # packets from before the pause
            packet = RtpPacket.parse(await client.packet(0))
        assert packet.payload[0] & 0x1F == 7
        assert (await client.request("TEARDOWN", Session=session)).status == 200
        assert (await client.request("PLAY", Session=session)).status == 454
        assert served.server.sessions == 0


async def test_the_description(open_device: VirtualDevice) -> None:
    async with (
        serving(open_device, rate_hz=25) as served,
        RtspClient(served.port, path="/axis-media/media.amp?resolution=160x90&fps=5") as client,
    ):
        described = await client.request("DESCRIBE", Accept="application/sdp")
        lines = described.body.decode().split("\r\n")
        assert (described["content-type"], lines[0], lines[-1]) == ("application/sdp", "v=0", "")
        base = f"rtsp://127.0.0.1:{served.port}/axis-media/media.amp/"
        assert described["content-base"] == base + "?resolution=160x90&fps=5"
        assert f"a=control:{base}stream=0?resolution=160x90&fps=5" in lines
        assert "a=framerate:5.000000" in lines
        assert "a=framesize:96 160-90" in lines
        (fmtp,) = (line for line in lines if line.startswith("a=fmtp:96 "))
        assert "packetization-mode=1;profile-level-id=42c0" in fmtp


@pytest.mark.parametrize(
    ("url", "status"),
    [
        ("rtsp://127.0.0.1/axis-media/media.amp", 200),
        ("rtsp://127.0.0.1/axis-media/media.amp/", 200),
        ("RTSP://root:pw@127.0.0.1:554/axis-media/media.amp?videocodec=h264&audio=0&camera=1&fps=0&resolution=", 200),
        ("rtsp://[::1]:554/onvif-media/media.amp?profile=profile-1", 200),
        ("rtsp://127.0.0.1/", 404),
        ("rtsp://127.0.0.1/etc/../axis-media/media.amp", 404),
        ("rtsp://127.0.0.1/axis-media/media.amp?camera=2", 404),
        ("rtsp://127.0.0.1/axis-media/media.amp?resolution=1920x1080", 400),
        ("rtsp://127.0.0.1/axis-media/media.amp?resolution=161x90", 400),
        ("rtsp://127.0.0.1/axis-media/media.amp?resolution=axb", 400),
        ("rtsp://127.0.0.1/axis-media/media.amp?fps=-1", 400),
        ("rtsp://127.0.0.1/axis-media/media.amp?fps=nan", 400),
        ("rtsp://127.0.0.1/axis-media/media.amp?fps=0.0000001", 400),
        ("rtsp://127.0.0.1/axis-media/media.amp?videocodec=h265", 400),
        ("rtsp://127.0.0.1/axis-media/media.amp?" + "a=1&" * 60, 400),
        ('rtsp://a"b<c>/axis-media/media.amp', 400),
        ("rtsp://[::1/axis-media/media.amp", 400),
        ("http://127.0.0.1/axis-media/media.amp", 400),
        ("*", 400),
    ],
)
async def test_addresses(open_device: VirtualDevice, url: str, status: int) -> None:
    async with serving(open_device) as served, RtspClient(served.port) as client:
        answer = await client.request("DESCRIBE", url)
        assert answer.status == status
        assert "root:pw" not in str(answer)
        assert (await client.request("OPTIONS")).status == 200


async def test_requests_that_are_refused_leave_the_connection_open(open_device: VirtualDevice) -> None:
    async with serving(open_device) as served, RtspClient(served.port) as client:
        assert (await client.request("RECORD")).status == 501
        refused = await client.request("PLAY", Require="onvif-replay")
        assert (refused.status, refused["unsupported"]) == (551, "onvif-replay")
        assert (await client.request("PLAY")).status == 454
        assert (await client.request("TEARDOWN", Session="0123456789abcdef")).status == 454
        assert (await client.request("DESCRIBE", Accept="text/html")).status == 406
        assert (await client.request("SETUP", Transport="RTP/AVP;multicast;port=5000-5001")).status == 461
        assert (await client.request("SET_PARAMETER", body=b"volume: 3")).status == 451
        assert (await client.request("GET_PARAMETER")).status == 200
        assert served.server.sessions == 0


@pytest.mark.parametrize(
    "content", [b"\x00" * 100, b"PUT / HTTP/1.1\r\n\r\n", b"OPTIONS * RTSP/1.0\r\nCSeq: 1\r\nX: " + b"a" * 100_000]
)
async def test_what_is_no_request_ends_the_connection_and_nothing_else(open_device: VirtualDevice, content: bytes) -> None:
    async with serving(open_device) as served, RtspClient(served.port) as good:
        await good.play()
        async with RtspClient(served.port) as bad:
            await bad.send(content + b"\r\n\r\n")
            # The answer is lost if the connection is reset while bytes are still arriving.
            with suppress(EOFError, ConnectionError):
                assert (await bad.answer()).status in {400, 413, 414, 505}
            await until(lambda: served.server.connections == 1)
        for _ in range(20):
            await good.packet(0)


async def test_only_a_request_of_its_client_reaches_a_session(served_device: VirtualDevice) -> None:
    async with (
        serving(served_device) as served,
        RtspClient(served.port, user="root", password=ROOT.password) as owner,
        RtspClient(served.port, user="visitor", password=VISITOR.password) as other,
    ):
        await owner.play()
        assert (await other.request("TEARDOWN", Session=owner.set_up.session)).status == 454
        assert (await owner.request("GET_PARAMETER", Session=owner.set_up.session)).status == 200


async def test_passwords(served_device: VirtualDevice) -> None:
    async with serving(served_device) as served:
        for user, password in [("root", "wrong"), ("nobody", "pass word"), ("", "")]:
            async with RtspClient(served.port, user=user, password=password) as client:
                assert (await client.request("OPTIONS")).status == 200
                for method in ("DESCRIBE", "SETUP", "PLAY", "TEARDOWN", "GET_PARAMETER"):
                    answer = await client.request(method, Transport=TCP)
                    assert answer.status == 401
                    assert all("Digest" in each and "qop" not in each for each in answer.headers["www-authenticate"])
                basic = await client.request("DESCRIBE", Authorization="Basic cm9vdDpwYXNzIHdvcmQ=")
                assert basic.status == 401
        assert served.server.statistics.sessions == 0
        for account in (ROOT, VISITOR):
            async with RtspClient(served.port, user=account.name, password=account.password) as client:
                await client.play()
                await client.packet(0)


async def test_an_answer_that_was_overheard_is_worth_nothing_on_another_connection(served_device: VirtualDevice) -> None:
    async with serving(served_device) as served:
        async with RtspClient(served.port, user=ROOT.name, password=ROOT.password) as client:
            assert (await client.request("DESCRIBE")).status == 200
            overheard = client.signature("DESCRIBE")
            assert (await client.request("DESCRIBE", Authorization=overheard)).status == 200
        async with RtspClient(served.port) as thief:
            assert (await thief.request("DESCRIBE", Authorization=overheard)).status == 401


async def test_sessions_have_a_limit(open_device: VirtualDevice, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sessions, "MAX_SESSIONS", 2)
    async with serving(open_device) as served, RtspClient(served.port) as client:
        answers = [await client.request("SETUP", Transport="RTP/AVP/TCP;unicast") for _ in range(3)]
        assert [answer.status for answer in answers] == [200, 200, 453]
        assert ["interleaved=0-1" in answers[0]["transport"], "interleaved=2-3" in answers[1]["transport"]] == [True, True]
        assert (await client.request("SETUP", Transport=TCP)).status == 453
        await client.request("TEARDOWN", Session=answers[0].session)
        assert (await client.request("SETUP", Transport=TCP)).status == 200


async def test_a_client_chooses_its_transport_again_before_it_plays(open_device: VirtualDevice) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
        async with serving(open_device) as served, RtspClient(served.port) as client:
            first = await client.request("SETUP", Transport=f"RTP/AVP;unicast;client_port={port}-{port ^ 1}")
            assert f"client_port={port}-{port ^ 1};server_port=" in first["transport"]
            server_port = int(first["transport"].partition("server_port=")[2].partition("-")[0])
            assert server_port % 2 == 0
            second = await client.request("SETUP", Session=first.session, Transport=TCP)
            assert second.session == first.session
            await client.request("PLAY", Session=first.session)
            await client.packet(0)
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
                free.bind(("127.0.0.1", server_port))
