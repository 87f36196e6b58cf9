"""Addresses: what a person may write, and what a device may return."""

from __future__ import annotations

import httpx2
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.camera.network.address import DeviceAddress, parse_address
from scope_ptz.camera.network.credentials import Credentials
from scope_ptz.camera.network.errors import ForeignAddressError
from scope_ptz.camera.network.sign_in import PinnedSignIn
from scope_ptz.errors import InputError

HERE = DeviceAddress("10.0.0.7", 8080)


@pytest.mark.parametrize(
    ("text", "user", "url"),
    [
        ("op@10.0.0.7", "op", "http://10.0.0.7:80"),
        ("op@cam-1.example:8080/", "op", "http://cam-1.example:8080"),
        ("op@[fe80::1]:81", "op", "http://[fe80::1]:81"),
        ("op@[fe80::1]", "op", "http://[fe80::1]:80"),
        ("cam", "", "http://cam:80"),
    ],
)
def test_addresses_that_a_person_writes(text: str, user: str, url: str) -> None:
    found, address = parse_address(text)
    assert (found, address.base_url) == (user, url)
    assert parse_address(text, tls=True)[1].base_url.startswith("https://")


@pytest.mark.parametrize(
    "text", ["", "op@", "op@a b", "op@host:", "op@host:0", "op@host:99999", "op@host:x", "op@host/path", "op@http://h"]
)
def test_wrong_addresses_are_refused(text: str) -> None:
    with pytest.raises(InputError):
        parse_address(text)


def test_a_password_is_refused_and_not_repeated() -> None:
    with pytest.raises(InputError) as caught:
        parse_address("op:hunter2@host")
    assert "hunter2" not in str(caught.value)


@given(host=st.from_regex(r"[a-z0-9.-]{1,30}", fullmatch=True), path=st.text("abc/._-", max_size=20), port=st.integers(1, 65535))
def test_whatever_a_device_returns_points_to_the_configured_host(host: str, path: str, port: int) -> None:
    pinned = httpx2.URL(HERE.pin_http(f"http://user:pw@{host}:{port}/{path}?a=1"))
    assert (pinned.scheme, pinned.host, pinned.port, pinned.userinfo) == ("http", "10.0.0.7", 8080, b"")
    assert pinned.query == b"a=1"
    stream = HERE.pin_rtsp(f"rtsp://user:pw@{host}:{port}/{path}")
    assert stream.startswith(f"rtsp://10.0.0.7:{port}/")


@pytest.mark.parametrize("url", ["file:///etc/passwd", "ftp://10.0.0.7/x", "javascript:alert(1)", "relative", ""])
def test_other_schemes_are_refused(url: str) -> None:
    with pytest.raises(ForeignAddressError):
        HERE.pin_http(url)
    with pytest.raises(ForeignAddressError):
        HERE.pin_rtsp(url)


@pytest.mark.parametrize(
    "url", ["http://10.0.0.8:8080/", "http://10.0.0.7:80/", "https://10.0.0.7:8080/", "http://10.0.0.7.evil:8080/"]
)
def test_sign_in_refuses_any_other_origin(url: str) -> None:
    flow = PinnedSignIn(HERE, Credentials("op", "secret")).auth_flow(httpx2.Request("GET", url))
    with pytest.raises(ForeignAddressError):
        next(flow)
