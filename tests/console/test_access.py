"""Access to the page, its files and its WebSockets, and the connections that the server and the page open."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import httpx2
import pytest
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from scope_ptz.serve.security.tokens import TokenFile

pytestmark = pytest.mark.full

PATHS = (
    "/",
    "/console/main.js",
    "/console/page.css",
    "/console/nothing.js",
    "/_stcore/health",
    "/_stcore/host-config",
    "/_stcore/metrics",
    "/static/js/index.js",
    "/media/picture.png",
    "/component/scope/x.js",
    "/api/v1/cameras",
    "/api/v1/openapi.json",
    "/nothing",
)
SOCKETS = ("/_stcore/stream", "/api/v1/cameras/analytic-yard/live")

WATCHED = """
import json, sys
out = open(sys.argv[1], "a", buffering=1)
def note(event, given):
    if event == "socket.connect":
        out.write(json.dumps(["connect", given[1][0] if isinstance(given[1], tuple) else str(given[1])]) + "\\n")
    elif event == "socket.getaddrinfo":
        out.write(json.dumps(["look up", str(given[0])]) + "\\n")
sys.addaudithook(note)
sys.argv = ["scope", *sys.argv[2:]]
from scope_ptz.cli import main
sys.exit(main())
"""
"""A program that runs the console and records every connection that it opens and every host name that it resolves."""


@pytest.fixture(scope="module")
def guarded(analytic_folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, str, Path]]:
    """The address of a console that requires a token, a token, and the file with the records of its connections."""
    folder = tmp_path_factory.mktemp("guarded-console")
    secret = TokenFile(folder / "tokens.json").add("anna", "operator")
    environment = {**os.environ, "SCOPE_SCENES_DIR": str(analytic_folder.parent)}
    options = ["--port", "0", "--json", "--camera", analytic_folder.name, "--tokens", str(folder / "tokens.json")]
    command = [sys.executable, "-c", WATCHED, str(folder / "connections"), "console", *options, "--runs-dir", str(folder / "runs")]
    with (folder / "errors").open("w") as errors:
        program = subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, stderr=errors, text=True)
        try:
            assert program.stdout is not None
            line = program.stdout.readline()
            assert line, (folder / "errors").read_text()
            yield json.loads(line)["url"], secret, folder / "connections"
        finally:
            program.terminate()
            program.wait(60)
            assert program.stdout is not None
            program.stdout.close()
    text = (folder / "errors").read_text()
    assert text == "scope: cancelled.\n", "neither tracebacks nor a line for each connection"
    assert secret not in text


@pytest.mark.parametrize("path", PATHS)
def test_every_path_needs_a_token(guarded: tuple[str, str, Path], path: str) -> None:
    url, secret, _ = guarded
    with httpx2.Client(base_url=url, trust_env=False) as client:
        assert client.get(path).status_code == 401
        if not path.startswith("/api"):
            page = client.get(path, headers={"Accept": "text/html"})
            assert (page.status_code, page.headers["location"]) == (303, "/sign-in")
        for method in ("POST", "PUT", "DELETE", "OPTIONS"):
            assert client.request(method, path).status_code == 401
        known = client.get(path, headers={"Authorization": f"Bearer {secret}"})
        assert known.status_code in (200, 404)
        assert known.headers["x-content-type-options"] == "nosniff"
        assert known.headers["x-frame-options"] == "DENY"
        assert "default-src" in known.headers["content-security-policy"]
        assert not [name for name in known.headers if name.startswith("access-control-")]


@pytest.mark.parametrize(
    "headers", [{"Host": "evil.example"}, {"Origin": "https://evil.example"}, {"Sec-Fetch-Site": "cross-site"}]
)
@pytest.mark.parametrize("path", PATHS)
def test_every_path_is_closed_to_other_sites(guarded: tuple[str, str, Path], path: str, headers: dict[str, str]) -> None:
    url, secret, _ = guarded
    with httpx2.Client(base_url=url, trust_env=False) as client:
        assert client.get(path, headers={**headers, "Authorization": f"Bearer {secret}"}).status_code == 403


@pytest.mark.parametrize("path", SOCKETS)
def test_every_socket_needs_a_token_and_the_pages_own_origin(guarded: tuple[str, str, Path], path: str) -> None:
    url, secret, _ = guarded
    address, known = url.replace("http", "ws", 1) + path, {"Authorization": f"Bearer {secret}"}
    for headers in ({}, {"Authorization": "Bearer scope_wrong"}, {**known, "Origin": "https://evil.example"}):
        with pytest.raises(InvalidStatus) as refused:
            connect(address, additional_headers=headers, proxy=None)
        assert refused.value.response.status_code == 403
    with connect(address, additional_headers={**known, "Origin": url}, proxy=None, max_size=2**24):
        pass


def test_the_server_opens_no_outgoing_connections(guarded: tuple[str, str, Path]) -> None:
    url, secret, notes = guarded
    with httpx2.Client(base_url=url, trust_env=False, timeout=60, headers={"Authorization": f"Bearer {secret}"}) as client:
        client.get("/")
        run = client.post("/api/v1/ask", json={"camera": "analytic-yard", "instruction": "count the balls"}).json()
        assert run["outcome"] == "answered"
    asked = [json.loads(line) for line in notes.read_text().splitlines()] if notes.exists() else []
    assert not [each for each in asked if each[1] not in ("127.0.0.1", "::1", "localhost")]
