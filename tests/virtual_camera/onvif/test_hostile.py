"""Requests that no well-behaved client sends: hostile XML, forged and replayed tokens, commands that come too late."""

from __future__ import annotations

import contextlib
import socket
from collections.abc import Callable
from pathlib import Path

import httpx2
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from scope_ptz.camera.capabilities import Velocity
from scope_ptz.errors import ConfigError
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.http.server import ServedCamera, listen
from scope_ptz.virtual_camera.onvif import wsdl
from scope_ptz.virtual_camera.onvif.app import OnvifApp, RequestTarget
from scope_ptz.virtual_camera.onvif.soap import MAX_REQUEST_BYTES, SoapFault
from scope_ptz.virtual_camera.onvif.username_tokens import CLOCK_TOLERANCE_S
from tests.virtual_camera.onvif.conftest import HandClock
from tests.virtual_camera.onvif.envelopes import DEVICE, MEDIA, PTZ, ago, envelope, post, ptz_request, token

pytestmark = pytest.mark.anyio

PROFILES = f'<GetProfiles xmlns="{MEDIA}"/>'
STATUS = ptz_request("GetStatus")
MOVE = ptz_request("ContinuousMove", '<Velocity><tt:PanTilt x="1" y="0"/></Velocity>')
STOP = ptz_request("Stop")
TARGET = RequestTarget("127.0.0.1", "http://127.0.0.1")


def laughs() -> bytes:
    entities = "".join(f'<!ENTITY l{k} "{f"&l{k - 1};" * 10}">' for k in range(1, 10))
    return f'<!DOCTYPE x [<!ENTITY l0 "ha">{entities}]>{envelope("<a>&l9;</a>").decode()}'.encode()


def external(secret: Path) -> bytes:
    body = f'<GetPresets xmlns="{PTZ}"><ProfileToken>&secret;</ProfileToken></GetPresets>'
    return f'<!DOCTYPE x [<!ENTITY secret SYSTEM "file://{secret}">]>{envelope(body).decode()}'.encode()


async def test_entities_are_refused_and_no_file_is_read(served: ServedCamera, tmp_path: Path) -> None:
    secret = tmp_path / "secret.txt"
    secret.write_text("the-secret")
    for attack in (laughs(), external(secret)):
        answer = await post(served.url, attack)
        assert (answer.status, answer.codes) == (400, ["Sender", "WellFormed"])
        assert "secret" not in answer.reason


@pytest.mark.parametrize(
    "content",
    [b"", b"\x00\xff<<<", envelope(PROFILES)[:-20], b"<a>" * 5000, envelope("<a>" * 400 + "</a>" * 400), b"{}", envelope("")],
)
async def test_broken_requests_are_faults(served: ServedCamera, content: bytes) -> None:
    answer = await post(served.url, content)
    assert answer.status == 400
    assert answer.codes[0] == "Sender"


async def test_a_huge_request_is_refused_before_it_is_read(served: ServedCamera) -> None:
    answer = await post(served.url, envelope(PROFILES) + b" " * 10 * MAX_REQUEST_BYTES)
    assert (answer.status, answer.codes) == (413, ["Sender", "WellFormed"])


async def test_other_soap_versions_and_mandatory_headers_are_refused(served: ServedCamera) -> None:
    old = envelope(PROFILES).replace(b"http://www.w3.org/2003/05/soap-envelope", b"http://schemas.xmlsoap.org/soap/envelope/")
    assert (await post(served.url, old)).codes == ["VersionMismatch"]
    header = '<x:Transaction xmlns:x="urn:x" s:mustUnderstand="true"/>'
    assert (await post(served.url, envelope(PROFILES, header))).codes == ["MustUnderstand"]


async def test_unknown_operations_paths_and_methods(served: ServedCamera) -> None:
    assert (await post(served.url, envelope('<Sing xmlns="urn:x"/>'))).codes == ["Sender", "ActionNotSupported"]
    offered = envelope(f'<GetRelayOutputs xmlns="{DEVICE}"/>')
    assert (await post(served.url, offered)).codes == ["Receiver", "ActionNotSupported"]
    assert (await post(served.url, b"", path="/onvif/elsewhere")).status == 404
    async with httpx2.AsyncClient(base_url=served.url) as client:
        reply = await client.get("/onvif/device_service")
    assert (reply.status_code, reply.headers["allow"]) == (405, "POST")


@given(content=st.binary(max_size=300) | st.text(max_size=300).map(lambda text: envelope(text)))
@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_bytes_end_in_a_fault(device: VirtualDevice, content: bytes) -> None:
    with pytest.raises(SoapFault) as refused:
        OnvifApp(device).answer(content, TARGET)
    assert b"Fault" in refused.value.envelope()


@given(
    name=st.sampled_from(["AbsoluteMove", "RelativeMove", "ContinuousMove", "GotoPreset", "SetPreset", "Stop"]),
    inner=st.lists(
        st.sampled_from(
            [
                '<Position><tt:PanTilt x="{}" y="0"/></Position>',
                '<Translation><tt:Zoom x="{}"/></Translation>',
                '<Velocity><tt:PanTilt x="0" y="{}"/></Velocity>',
                "<Timeout>{}</Timeout>",
                "<PresetToken>{}</PresetToken>",
                "<PanTilt>{}</PanTilt>",
                "<Zoom>{}</Zoom>",
            ]
        ),
        max_size=3,
    ),
    value=st.sampled_from(["0", "1e400", "NaN", "-INF", "", "x", "PT1S", "P1Y", "PT1e9999S", "-PT1S", "P99999999999D", "9" * 500]),
)
@settings(max_examples=200, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_arguments_are_carried_out_or_refused(device: VirtualDevice, name: str, inner: list[str], value: str) -> None:
    app = OnvifApp(VirtualDevice(device.scene, width=320, height=180))
    try:
        app.answer(envelope(ptz_request(name, "".join(inner).format(*[value] * len(inner)))), TARGET)
    except SoapFault as fault:
        assert fault.subcodes


async def test_without_a_login_only_the_first_questions_are_answered(served: ServedCamera) -> None:
    for name in ("GetServices", "GetSystemDateAndTime", "GetHostname", "GetServiceCapabilities"):
        argument = "<IncludeCapability>true</IncludeCapability>" if name == "GetServices" else ""
        assert (await post(served.url, envelope(f'<{name} xmlns="{DEVICE}">{argument}</{name}>'))).codes == []
    answer = await post(served.url, envelope(PROFILES))
    assert (answer.status, answer.codes) == (401, ["Sender", "NotAuthorized"])
    assert "Digest" in answer.headers["www-authenticate"]


async def test_http_digest_signs_in_too(served: ServedCamera) -> None:
    right, wrong = httpx2.DigestAuth("admin", "s3cret"), httpx2.DigestAuth("admin", "wrong")
    assert (await post(served.url, envelope(PROFILES), "/onvif/media_service", auth=right)).status == 200
    assert (await post(served.url, envelope(PROFILES), "/onvif/media_service", auth=wrong)).status == 401


async def test_a_token_is_accepted_once(served: ServedCamera) -> None:
    request = envelope(PROFILES, token("viewer", "v1ew"))
    assert (await post(served.url, request)).codes == []
    assert (await post(served.url, request)).codes == ["Sender", "NotAuthorized"]


@pytest.mark.parametrize("name", ["admin", "nobody", "&lt;script&gt;"])
async def test_wrong_passwords_and_names_look_alike(served: ServedCamera, name: str) -> None:
    answer = await post(served.url, envelope(PROFILES, token(name, "wrong")))
    assert (answer.codes, answer.reason) == (["Sender", "NotAuthorized"], "The user name or the password is wrong.")


@pytest.mark.parametrize(
    "make_header",  # when the test runs: a token is about the present time
    [
        lambda: token("admin", "s3cret", created=ago(10 * CLOCK_TOLERANCE_S)),
        lambda: token("admin", "s3cret", created=ago(-10 * CLOCK_TOLERANCE_S)),
        lambda: token("admin", "s3cret", created="yesterday"),
        lambda: token("admin", "s3cret", created="0001-01-01T00:00:00+23:59"),
        lambda: token("admin", "s3cret", text=True),
        lambda: token("admin", "s3cret").replace("o:Nonce>", "o:Once>"),
        lambda: token("admin", "s3cret").replace("<o:Nonce>", "<o:Nonce>???"),
        lambda: token("", "s3cret"),
        lambda: token("a" * 1000, "s3cret"),
    ],
)
async def test_unusable_tokens_are_refused(served: ServedCamera, make_header: Callable[[], str]) -> None:
    answer = await post(served.url, envelope(PROFILES, make_header()))
    assert (answer.status, answer.codes) == (400, ["Sender", "NotAuthorized"])
    assert "s3cret" not in answer.reason


async def test_a_move_that_a_stop_has_overtaken_is_dropped(served: ServedCamera, device: VirtualDevice, time: HandClock) -> None:
    """A ContinuousMove that arrives after the Stop that followed it must not make the camera run away."""

    async def send(body: str, seconds_ago: float) -> None:
        assert (await post(served.url, envelope(body, token("operator", "0perate", created=ago(seconds_ago))))).codes == []

    await send(STOP, 1.0)
    await send(MOVE, 3.0)
    assert device.commanded_velocity == Velocity()
    await send(MOVE, 0.5)
    assert device.commanded_velocity.pan_dps > 0.0


async def test_whole_seconds_do_not_drop_a_move_in_the_second_of_a_stop(served: ServedCamera, device: VirtualDevice) -> None:
    """Most clients state whole seconds: a move in the same second as a stop may be newer, and is carried out."""
    second = ago(1.0).replace(microsecond=0)
    for body in (STOP, MOVE):
        header = token("operator", "0perate", created=second)
        assert (await post(served.url, envelope(body, header))).codes == []
    assert device.commanded_velocity.pan_dps > 0.0


async def test_a_client_whose_clock_is_ahead_does_not_hold_up_others(served: ServedCamera, device: VirtualDevice) -> None:
    ahead = token("operator", "0perate", created=ago(-30.0))
    assert (await post(served.url, envelope(STOP, ahead))).codes == []
    assert (await post(served.url, envelope(MOVE, token("admin", "s3cret")))).codes == []
    assert device.commanded_velocity.pan_dps > 0.0


async def test_the_host_header_is_reflected_only_if_it_is_a_host(served: ServedCamera) -> None:
    services = envelope(f'<GetServices xmlns="{DEVICE}"><IncludeCapability>false</IncludeCapability></GetServices>')
    for host, expected in (("camera.example:81", "http://camera.example:81/"), ("a b<c>", served.url)):
        async with httpx2.AsyncClient(base_url=served.url) as client:
            reply = await client.post("/onvif/device_service", content=services, headers={"Host": host})
        assert expected in reply.text


def test_missing_wsdl_files_are_an_error_that_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(wsdl, "find_spec", lambda _: None)
    with pytest.raises(ConfigError, match="scope-ptz\\[serve\\]"):
        wsdl.load_document.__wrapped__()


async def test_replies_do_not_wait_for_an_acknowledgement() -> None:
    """asyncio sets TCP_NODELAY only for sockets that name their protocol, which inherited ones do not."""
    with contextlib.closing(listen("127.0.0.1", [0])[0]) as listener:
        assert listener.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)
