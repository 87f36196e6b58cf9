"""Clients whose authorisation ends, joint limits of all clients of a name, secrets in URLs, and presets of idle cameras."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import httpx2
import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from scope_ptz.errors import ConfigError
from scope_ptz.serve.security.access import Access
from scope_ptz.serve.security.rate_limits import NAME_FACTOR, Rate, RateLimits
from scope_ptz.serve.security.tokens import TokenFile
from scope_ptz.serve.site.errors import TooManyRequestsError
from scope_ptz.serve.site.site import SiteOptions, idle_returns
from scope_ptz.serve.site.station import IdleReturn
from tests.serve.conftest import SPEC
from tests.serve.serving import CAMERA, OTHER, Served, serving

LIMIT_S = 30.0  # for busy machines; normally, each operation takes a fraction of a second


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Shorten the time between checks of tokens."""
    monkeypatch.setattr("scope_ptz.serve.security.access.AUTHORISATION_CHECK_INTERVAL_S", 0.1)


@pytest.fixture
def carl(guarded: Served, tokens: dict[str, str], quick: None) -> Iterator[tuple[str, TokenFile]]:
    """The secret of a token for one test, and the token file."""
    file = TokenFile(Path(tokens["path"]))
    yield file.add("carl", "operator"), file
    if any(token.name == "carl" for token in file.tokens):
        file.remove("carl")


def live(served: Served, headers: dict[str, str]) -> ClientConnection:
    """Open the WebSocket of the live video."""
    address = f"ws://127.0.0.1:{served.port}/api/v1/cameras/{CAMERA}/live?width=160"
    return connect(address, additional_headers=headers, proxy=None, max_size=2**24)


def watch_until_closed(socket: ClientConnection) -> ConnectionClosed:
    """Acknowledge frames until the server closes the stream, and return the close event."""
    deadline = time.monotonic() + LIMIT_S
    while time.monotonic() < deadline:
        try:
            if isinstance(socket.recv(timeout=LIMIT_S), bytes):
                socket.send("drawn")
        except ConnectionClosed as closed:
            return closed
    raise AssertionError("the stream did not end")


def until(condition: Callable[[], bool]) -> None:
    deadline = time.monotonic() + LIMIT_S
    while not condition():
        assert time.monotonic() < deadline, "the condition did not become true"
        time.sleep(0.02)


def test_a_removed_token_closes_its_sockets(guarded: Served, carl: tuple[str, TokenFile], tokens: dict[str, str]) -> None:
    secret, file = carl
    with live(guarded, {"Authorization": f"Bearer {tokens['vera']}"}) as other, live(
        guarded, {"Authorization": f"Bearer {secret}"}
    ) as socket:  # fmt: skip
        socket.recv(timeout=LIMIT_S)
        file.remove("carl")
        closed = watch_until_closed(socket)
        assert closed.rcvd is not None and closed.rcvd.code == 1008
        assert "removed" in closed.rcvd.reason
        other.recv(timeout=LIMIT_S)
        other.send("drawn")
        other.recv(timeout=LIMIT_S)


def test_a_removed_token_ends_its_streams(guarded: Served, carl: tuple[str, TokenFile]) -> None:
    secret, file = carl
    with guarded.client(secret) as client:
        client.post(f"/cameras/{CAMERA}/control")
        run = client.post("/runs", json={"camera": CAMERA, "instruction": "track the ball for 300 seconds"}).json()["id"]
        ended: list[str] = []

        def read(path: str) -> None:
            with guarded.client(secret) as other, other.stream("GET", path) as stream:
                for _ in stream.iter_raw():
                    pass
            ended.append(path)

        paths = [f"/cameras/{CAMERA}/live.mjpeg?width=160", f"/runs/{run}/events"]
        threads = [threading.Thread(target=read, args=(path,), daemon=True) for path in paths]
        for thread in threads:
            thread.start()
        until(lambda: guarded.site.stations[CAMERA].live.watchers > 0)
        file.remove("carl")
        for thread in threads:
            thread.join(LIMIT_S)
        assert sorted(ended) == sorted(paths)
        assert client.get("/me").status_code == 401
    until(lambda: guarded.site.stations[CAMERA].live.watchers == 0)
    guarded.call(guarded.site.stations[CAMERA].stop)
    until(lambda: guarded.site.stations[CAMERA].current_run is None)
    guarded.call(guarded.site.stations[CAMERA].control.clear)


def test_signing_out_ends_the_streams_of_the_browser(guarded: Served, carl: tuple[str, TokenFile]) -> None:
    with httpx2.Client(base_url=guarded.url, trust_env=False) as browser:
        browser.post("/session", json={"token": carl[0]})
        cookie = "; ".join(f"{name}={value}" for name, value in browser.cookies.items())
        with live(guarded, {"Cookie": cookie}) as socket:
            socket.recv(timeout=LIMIT_S)
            browser.delete("/session")
            closed = watch_until_closed(socket)
            assert closed.rcvd is not None and closed.rcvd.code == 1008


def test_a_waiting_request_of_a_removed_token_is_refused(guarded: Served, carl: tuple[str, TokenFile]) -> None:
    secret, file = carl
    with guarded.client(secret) as client:
        replies: list[httpx2.Response] = []
        body = {"camera": OTHER, "instruction": "track the ball for 300 seconds"}
        asking = threading.Thread(target=lambda: replies.append(client.post("/ask", json=body)), daemon=True)
        asking.start()
        until(lambda: guarded.site.stations[OTHER].current_run is not None)
        file.remove("carl")
        asking.join(LIMIT_S)
    assert (replies[0].status_code, replies[0].json()["error"]["code"]) == (401, "sign_in")
    guarded.call(guarded.site.stations[OTHER].stop)
    until(lambda: guarded.site.stations[OTHER].current_run is None)
    guarded.call(guarded.site.stations[OTHER].control.clear)


def test_secrets_in_urls_are_ignored(guarded: Served, tokens: dict[str, str]) -> None:
    with guarded.client() as client:
        for name in ("token", "access_token", "scope_session", "authorization", "key"):
            assert client.get("/cameras", params={name: tokens["anna"]}).status_code == 401
            assert client.post("/session", params={name: tokens["anna"]}, json={"token": "x"}).status_code == 401
    with guarded.client(tokens["anna"]) as anna:
        operations = [each for path in anna.get("/openapi.json").json()["paths"].values() for each in path.values()]
    names = {field["name"] for each in operations for field in each.get("parameters", []) if field["in"] == "query"}
    assert names and not [name for name in names if "token" in name or "secret" in name or "password" in name]


def test_only_the_owner_lists_the_runs_of_a_conversation(guarded: Served, tokens: dict[str, str]) -> None:
    with guarded.client(tokens["anna"]) as anna, guarded.client(tokens["ben"]) as ben:
        key = anna.post("/conversations", json={"camera": CAMERA}).json()["id"]
        run = anna.post("/ask", json={"camera": CAMERA, "instruction": "go home", "conversation": key}).json()["id"]
        assert [each["id"] for each in anna.get("/runs", params={"conversation": key}).json()["runs"]] == [run]
        for wrong in (key, "nothing"):
            reply = ben.get("/runs", params={"conversation": wrong})
            assert (reply.status_code, reply.json()["error"]["code"]) == (404, "unknown")
        assert run in [each["id"] for each in ben.get("/runs").json()["runs"]], "everybody sees what the camera did"
        anna.delete(f"/cameras/{CAMERA}/control")


def test_the_clients_of_a_name_have_a_joint_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scope_ptz.serve.security.rate_limits.monotonic", lambda: 100.0)
    limits = RateLimits({"run": Rate(1.0, 2)})
    for number in range(2 * NAME_FACTOR):
        limits.count(f"anna:{number}", "run", "anna")
    with pytest.raises(TooManyRequestsError):
        limits.count("anna:new", "run", "anna")
    limits.count("ben:1", "run", "ben")


def test_every_type_of_request_has_its_limit(scenes: None, tokens: dict[str, str], tmp_path: Path) -> None:
    limits = RateLimits({"command": Rate(0.001, 2), "run": Rate(0.001, 1), "sign_in": Rate(0.001, 3)})
    access = Access("127.0.0.1", TokenFile(Path(tokens["path"])), limits=limits)
    with serving(SiteOptions(tmp_path / "runs"), access, {CAMERA: SPEC}) as served:
        with served.client(tokens["anna"]) as anna, served.client(tokens["anna"], "two") as other:
            assert [anna.post(f"/cameras/{CAMERA}/home").status_code for _ in range(3)] == [200, 200, 429]
            body = {"camera": CAMERA, "instruction": "go home"}
            assert [anna.post("/ask", json=body).status_code for _ in range(2)] == [200, 429]
            assert other.delete(f"/cameras/{CAMERA}/control").status_code == 200, "another client has its own limit"
            assert {anna.post(f"/cameras/{CAMERA}/stop").status_code for _ in range(20)} == {204}
        with served.client() as stranger:
            statuses = [stranger.post("/session", json={"token": f"scope_{n}"}).status_code for n in range(5)]
            assert statuses == [401, 401, 401, 429, 429]
            refused = httpx2.post(f"{served.root}/sign-in", data={"token": tokens["anna"]}, trust_env=False)
            assert refused.status_code == 429, "the sign-in page shares the limit"


def test_a_camera_has_its_own_preset_when_idle(
    scenes: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    options = SiteOptions(tmp_path / "runs", idle=IdleReturn(3600.0), idle_by_camera={CAMERA: IdleReturn(0.5, "gate")})
    access = Access("127.0.0.1", limits=RateLimits(None))
    with serving(options, access, {CAMERA: SPEC, OTHER: SPEC}) as served, served.client() as client:
        assert client.post(f"/cameras/{CAMERA}/move", json={"pan_deg": 12.0}).status_code == 200
        with caplog.at_level(logging.WARNING):
            until(lambda: "cannot return to its preset" in caplog.text)
        assert "gate" in caplog.text
        client.post(f"/cameras/{CAMERA}/move", json={"pan_deg": 12.0, "tilt_deg": -3.0})
        client.put(f"/cameras/{CAMERA}/presets/gate", json={})
        client.post(f"/cameras/{OTHER}/move", json={"pan_deg": 12.0})
        client.post(f"/cameras/{CAMERA}/move", json={"pan_deg": 20.0, "tilt_deg": 0.0})
        until(lambda: client.get(f"/cameras/{CAMERA}/pose").json()["tilt_deg"] == -3.0)
        assert client.get(f"/cameras/{OTHER}/pose").json()["pan_deg"] == 12.0


def test_idle_presets_are_read_from_the_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "scope.yaml"
    monkeypatch.setenv("SCOPE_CONFIG", str(path))
    entry = "cameras:\n  gate:\n    camera: sim:highway-works\n    when_idle: {%s}\n  yard:\n    camera: sim:highway-works\n"
    path.write_text(entry % "after_s: 300, preset: north gate")
    assert idle_returns() == {"gate": IdleReturn(300.0, "north gate")}
    path.write_text(entry % "after_s: 60")
    assert idle_returns() == {"gate": IdleReturn(60.0, "")}
    for wrong in ("after_s: 0", "preset: gate", "after_s: .inf", "after_s: 60, view: x"):
        path.write_text(entry % wrong)
        with pytest.raises(ConfigError, match="when_idle"):
            idle_returns()
