"""Authentication, origins of requests, rate limits, and security headers of replies."""

from __future__ import annotations

import base64
import json
import stat
from collections.abc import Iterator
from pathlib import Path

import httpx2
import pytest
from hypothesis import given
from hypothesis import strategies as st
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from scope_ptz.errors import ConfigError, UnknownNameError
from scope_ptz.serve.security.access import MAX_BODY_BYTES, Access
from scope_ptz.serve.security.origins import Origins
from scope_ptz.serve.security.rate_limits import Rate, RateLimits
from scope_ptz.serve.security.sessions import COOKIE, Sessions
from scope_ptz.serve.security.tokens import Token, TokenFile
from scope_ptz.serve.site.errors import TooManyRequestsError
from scope_ptz.serve.site.site import SiteOptions
from tests.serve.conftest import SPEC
from tests.serve.serving import CAMERA, Served, serving

READS = (
    "/server",
    "/cameras",
    f"/cameras/{CAMERA}",
    f"/cameras/{CAMERA}/frame",
    f"/cameras/{CAMERA}/live.mjpeg",
    "/runs",
    "/openapi.json",
)
ANYWHERE = "0.0.0.0"  # noqa: S104 - nothing listens there
COMMANDS: tuple[tuple[str, str, dict[str, object] | None], ...] = (
    ("POST", f"/cameras/{CAMERA}/move", {"zoom": 2.0}),
    ("POST", f"/cameras/{CAMERA}/stop", None),
    ("POST", f"/cameras/{CAMERA}/control", None),
    ("POST", f"/cameras/{CAMERA}/tools/go_home", {}),
    ("PUT", f"/cameras/{CAMERA}/presets/x", {}),
    ("POST", "/runs", {"camera": CAMERA, "instruction": "go home"}),
    ("POST", "/ask", {"camera": CAMERA, "instruction": "go home"}),
    ("POST", "/conversations", {"camera": CAMERA}),
    ("POST", "/runs/x/feedback", {"rating": 1}),
)


@pytest.fixture
def browser(guarded: Served) -> Iterator[httpx2.Client]:
    """A client that keeps cookies and has no token."""
    with httpx2.Client(base_url=guarded.root, timeout=30.0, trust_env=False) as opened:
        yield opened


@pytest.mark.parametrize("path", READS)
def test_nothing_is_shown_without_a_token(guarded: Served, path: str) -> None:
    for token in (None, "", "scope_wrong", "x" * 10_000):
        with guarded.client(token) as client:
            reply = client.get(path)
            assert (reply.status_code, reply.json()["error"]["code"]) == (401, "sign_in")
            assert reply.headers["www-authenticate"] == "Bearer"


def test_the_page_and_sockets_need_a_token_too(guarded: Served, tokens: dict[str, str]) -> None:
    with httpx2.Client(base_url=guarded.root, trust_env=False) as client:
        assert client.get("/").status_code == 401
        page = client.get("/", headers={"Accept": "text/html"})
        assert (page.status_code, page.headers["location"]) == (303, "/sign-in")
    address = f"ws://127.0.0.1:{guarded.port}/api/v1/cameras/{CAMERA}/live"
    with pytest.raises(InvalidStatus) as refused:
        connect(address, proxy=None)
    assert refused.value.response.status_code == 403
    with connect(address, additional_headers={"Authorization": f"Bearer {tokens['vera']}"}, proxy=None) as socket:
        assert socket.recv(timeout=30)


def test_a_token_is_also_accepted_as_the_password_of_basic_authentication(guarded: Served, tokens: dict[str, str]) -> None:
    with guarded.client() as client:
        me = client.get("/me", auth=("any name", tokens["vera"])).json()
        assert (me["name"], me["role"]) == ("vera", "viewer")
        assert client.get("/me", auth=("any name", tokens["anna"]), headers={"Origin": "http://evil.example"}).status_code == 403
        for wrong in ("", "Basic", "Basic !", "Basic /w==", "Basic " + base64.b64encode(tokens["vera"].encode()).decode()):
            assert client.get("/me", headers={"Authorization": wrong}).status_code == 401
        for user, password in (("vera", ""), ("vera", "scope_wrong"), (tokens["vera"], "")):
            assert client.get("/me", auth=(user, password)).status_code == 401


@pytest.mark.parametrize(("method", "path", "body"), COMMANDS)
def test_a_viewer_can_watch_but_not_command(
    guarded: Served, tokens: dict[str, str], method: str, path: str, body: dict[str, object] | None
) -> None:
    with guarded.client(tokens["vera"]) as client:
        assert client.get("/cameras").status_code == 200
        reply = client.request(method, path, json=body)
        assert (reply.status_code, reply.json()["error"]["code"]) == (403, "not_allowed")


def test_clients_cannot_see_conversations_of_others(guarded: Served, tokens: dict[str, str]) -> None:
    with guarded.client(tokens["anna"]) as anna, guarded.client(tokens["ben"]) as ben:
        key = anna.post("/conversations", json={"camera": CAMERA, "title": "mine"}).json()["id"]
        assert [each["id"] for each in anna.get("/conversations").json()] == [key]
        assert ben.get("/conversations").json() == []
        assert ben.get(f"/conversations/{key}").status_code == 404
        assert ben.patch(f"/conversations/{key}", json={"title": "x"}).status_code == 404
        assert ben.delete(f"/conversations/{key}").status_code == 404
        assert ben.post("/ask", json={"camera": CAMERA, "instruction": "go home", "conversation": key}).status_code == 404


def test_a_browser_signs_in_with_a_cookie_hidden_from_scripts(browser: httpx2.Client, tokens: dict[str, str]) -> None:
    assert browser.post("/api/v1/session", json={"token": "scope_wrong"}).status_code == 401
    reply = browser.post("/api/v1/session", json={"token": tokens["anna"]})
    assert reply.status_code == 204
    cookie = reply.headers["set-cookie"]
    assert "HttpOnly" in cookie and "SameSite=strict" in cookie and "Path=/" in cookie
    assert tokens["anna"] not in cookie
    me = browser.get("/api/v1/me").json()
    assert (me["name"], me["role"], me["signs_in"]) == ("anna", "operator", True)
    kept = browser.cookies[COOKIE]
    assert browser.delete("/api/v1/session").status_code == 204
    assert browser.get("/api/v1/me", headers={"Cookie": f"{COOKIE}={kept}"}).status_code == 401


def test_the_sign_in_page_works_without_scripts(browser: httpx2.Client, tokens: dict[str, str]) -> None:
    page = browser.get("/sign-in")
    assert page.status_code == 200
    assert "<script" not in page.text and "http" not in page.text
    assert "script" not in page.headers["content-security-policy"]
    wrong = browser.post("/sign-in", data={"token": "<b>no</b>"})
    assert wrong.status_code == 401 and "unknown" in wrong.text and "<b>no</b>" not in wrong.text
    reply = browser.post("/sign-in", data={"token": tokens["vera"]}, headers={"Origin": str(browser.base_url).rstrip("/")})
    assert (reply.status_code, reply.headers["location"]) == (303, "/")
    assert browser.get("/api/v1/me").json()["role"] == "viewer"


def test_a_secure_cookie_behind_a_proxy_with_https(browser: httpx2.Client, tokens: dict[str, str]) -> None:
    reply = browser.post("/api/v1/session", json={"token": tokens["anna"]}, headers={"X-Forwarded-Proto": "https"})
    assert "Secure" in reply.headers["set-cookie"]


def test_a_removed_token_is_refused_immediately(guarded: Served, tokens: dict[str, str]) -> None:
    file = TokenFile(Path(tokens["path"]))
    secret = file.add("carl", "operator")
    with guarded.client(secret) as client, httpx2.Client(base_url=guarded.url, trust_env=False) as browser:
        assert client.get("/me").json()["name"] == "carl"
        browser.post("/session", json={"token": secret})
        assert browser.get("/me").status_code == 200
        file.remove("carl")
        assert client.get("/me").status_code == 401
        assert browser.get("/me").status_code == 401


FOREIGN = (
    {"Host": "evil.example"},
    {"Host": "evil.example:8000"},
    {"Host": "127.0.0.1.evil.example"},
    {"Host": ""},
    {"Host": "user@127.0.0.1"},
    {"Origin": "https://evil.example"},
    {"Origin": "null"},
    {"Origin": "http://127.0.0.1:1"},
    {"Sec-Fetch-Site": "cross-site"},
    {"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "no-cors", "Sec-Fetch-Dest": "image"},
    {"Sec-Fetch-Site": "same-site"},
)


@pytest.mark.parametrize("headers", FOREIGN)
def test_requests_of_other_sites_are_refused_on_loopback_too(served: Served, headers: dict[str, str]) -> None:
    with served.client() as client:
        for method, path in (("GET", "/cameras"), ("POST", f"/cameras/{CAMERA}/stop"), ("GET", f"/cameras/{CAMERA}/live.mjpeg")):
            reply = client.request(method, path, headers=headers)
            assert reply.status_code in (400, 403), (method, path, reply.text)
    address = f"ws://127.0.0.1:{served.port}/api/v1/cameras/{CAMERA}/live"
    if "Host" not in headers:
        with pytest.raises(InvalidStatus) as refused:
            connect(address, additional_headers=headers, proxy=None)
        assert refused.value.response.status_code == 403


def test_the_servers_own_page_is_admitted(served: Served) -> None:
    own = {"Origin": served.root, "Sec-Fetch-Site": "same-origin"}
    with served.client() as client:
        assert client.get("/cameras", headers=own).status_code == 200
        assert client.post(f"/cameras/{CAMERA}/stop", headers=own).status_code == 204
    address = f"ws://127.0.0.1:{served.port}/api/v1/cameras/{CAMERA}/live"
    with connect(address, additional_headers={"Origin": served.root}, proxy=None) as socket:
        assert socket.recv(timeout=30)


def test_other_origins_cannot_read_replies(served: Served) -> None:
    with served.client() as client:
        asked = client.options("/cameras", headers={"Origin": "https://evil.example", "Access-Control-Request-Method": "GET"})
        assert asked.status_code == 403
        reply = client.get("/cameras")
        for each in (asked, reply):
            assert not [name for name in each.headers if name.startswith("access-control-")]


def test_every_reply_has_the_security_headers(guarded: Served, tokens: dict[str, str]) -> None:
    with guarded.client(tokens["anna"]) as client, guarded.client() as stranger:
        replies = [client.get("/cameras"), client.get(f"/cameras/{CAMERA}/frame"), client.get("/nothing"), stranger.get("/cameras")]
    for reply in replies:
        assert reply.headers["x-content-type-options"] == "nosniff"
        assert reply.headers["x-frame-options"] == "DENY"
        assert "default-src 'none'" in reply.headers["content-security-policy"]
        assert reply.headers["cross-origin-resource-policy"] == "same-origin"
        assert reply.headers["referrer-policy"] == "same-origin"
        assert "server" not in reply.headers
    assert replies[0].headers["cache-control"] == "no-store"


def test_long_bodies_are_refused_even_with_wrong_headers(served: Served) -> None:
    long = b"x" * (MAX_BODY_BYTES + 1)
    with served.client() as client:
        assert client.post("/ask", content=long).status_code == 413
        assert client.post("/ask", content=(long for _ in range(1)), headers={"Content-Type": "application/json"}).status_code in (
            400,
            413,
            422,
        )


def test_a_server_on_the_network_needs_tokens(tmp_path: Path) -> None:
    empty = TokenFile(tmp_path / "tokens.json")
    for host in (ANYWHERE, "192.168.1.7", "::", "cameras.example"):
        for tokens in (None, empty):
            with pytest.raises(ConfigError, match="without tokens"):
                Access(host, tokens)
    with pytest.raises(ConfigError, match="needs tokens"):
        Access("127.0.0.1", hosts=("cameras.example",))
    empty.add("anna", "operator")
    assert Access(ANYWHERE, empty).needs_token
    assert not Access("::1").needs_token


def test_tokens_are_stored_as_hashes_for_their_owner_only(tmp_path: Path) -> None:
    path = tmp_path / "folder" / "tokens.json"
    file = TokenFile(path)
    secret = file.add("anna", "operator")
    assert secret not in path.read_text()
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    found = TokenFile(path).find(secret)
    assert found is not None and (found.name, found.role) == ("anna", "operator")
    for wrong in ("", "scope_", secret[:-1], secret + "x", secret.upper(), found.sha256):
        assert file.find(wrong) is None
    for name in ("anna", "", "a\nb", "x" * 61, "/etc", "ä"):
        with pytest.raises(ConfigError):
            file.add(name, "viewer")
    with pytest.raises(UnknownNameError):
        file.remove("ben")
    path.unlink()
    assert file.find(secret) is None


@pytest.mark.parametrize("content", ["", "[]", '{"tokens": [{"name": "anna"}]}', '{"version": 2}', '{"secret": "scope_abc"}'])
def test_the_message_for_an_invalid_token_file_hides_its_content(tmp_path: Path, content: str) -> None:
    path = tmp_path / "tokens.json"
    path.write_text(content)
    with pytest.raises(ConfigError, match=r"token file .* is invalid") as caught:
        TokenFile(path)
    assert "scope_abc" not in str(caught.value)


def test_sessions_end(tmp_path: Path) -> None:
    file = TokenFile(tmp_path / "tokens.json")
    token = file.find(file.add("anna", "viewer"))
    assert isinstance(token, Token)
    short = Sessions(lifetime_s=-1.0)
    assert short.find(short.begin(token)) is None
    sessions = Sessions()
    secrets = [sessions.begin(token) for _ in range(1_001)]
    assert sessions.find(secrets[0]) is None, "the oldest one has ended"
    assert sessions.find(secrets[-1]) is not None
    sessions.end(secrets[-1])
    assert sessions.find(secrets[-1]) is None


def test_rate_limits_count_each_client_and_kind(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [100.0]
    monkeypatch.setattr("scope_ptz.serve.security.rate_limits.monotonic", lambda: now[0])
    limits = RateLimits({"run": Rate(0.5, 2)})
    limits.count("anna", "run")
    limits.count("anna", "run")
    with pytest.raises(TooManyRequestsError) as caught:
        limits.count("anna", "run")
    assert caught.value.retry_s == pytest.approx(2.0)
    limits.count("ben", "run")
    limits.count("anna", "command")
    now[0] += 2.0
    limits.count("anna", "run")
    with pytest.raises(TooManyRequestsError):
        limits.count("anna", "run")


def test_too_many_requests_are_refused_except_stop(scenes: None, tmp_path: Path) -> None:
    access = Access("127.0.0.1", limits=RateLimits({"read": Rate(0.001, 3), "run": Rate(0.001, 1)}))
    with serving(SiteOptions(tmp_path / "runs"), access, {CAMERA: SPEC}) as served, served.client() as client:
        statuses = [client.get("/cameras").status_code for _ in range(5)]
        assert statuses == [200, 200, 200, 429, 429]
        reply = client.get("/cameras")
        assert (reply.json()["error"]["code"], int(reply.headers["retry-after"]) > 0) == ("too_many_requests", True)
        assert {client.post(f"/cameras/{CAMERA}/stop").status_code for _ in range(20)} == {204}


@given(st.text(max_size=40), st.text(max_size=40))
def test_unknown_hosts_and_origins_are_refused(host: str, origin: str) -> None:
    origins = Origins({"127.0.0.1", "localhost", "::1"})
    known = host.rpartition(":")[0] or host
    if known.lower() not in ("127.0.0.1", "localhost", "[::1]", "127.0.0.1:", "localhost:"):
        assert origins.problem({"host": host}, method="GET") or host.lower().startswith(("localhost", "127.0.0.1", "[::1]"))
    assert origins.problem({"host": "localhost:80", "origin": origin}, method="POST")
    assert not origins.problem({"host": "[::1]:8000", "origin": "http://[::1]:8000"}, method="POST")


def test_replies_and_logs_contain_no_secrets(guarded: Served, tokens: dict[str, str], caplog: pytest.LogCaptureFixture) -> None:
    with guarded.client(tokens["anna"]) as client:
        client.post(f"/cameras/{CAMERA}/home")
        run = client.post("/ask", json={"camera": CAMERA, "instruction": "go home"}).json()["id"]
        replies = [client.get(path).text for path in ("/me", "/cameras", f"/cameras/{CAMERA}", "/runs", f"/runs/{run}/details")]
    folder = guarded.site.library.root / run
    stored = [path.read_text(errors="replace") for path in folder.rglob("*.json*")]
    for text in (*replies, *stored, caplog.text, json.dumps(replies)):
        assert not any(secret in text for name, secret in tokens.items() if name != "path")
