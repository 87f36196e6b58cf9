"""Both transports with both versions of the protocol, and the checks of requests over HTTP."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx2
import pytest
from mcp import Client
from mcp.client.stdio import StdioServerParameters

from tests.serve.mcp.agents import MODES, OLDER, PRESENT, agent, pictures_of, text_of
from tests.serve.serving import CAMERA, Served

SCENE = "analytic-yard"
INITIALIZE: dict[str, Any] = {
    "jsonrpc": "2.0",
    "id": 1,
    "method": "initialize",
    "params": {"protocolVersion": OLDER, "capabilities": {}, "clientInfo": {"name": "test", "version": "1"}},
}
DISCOVER: dict[str, Any] = {
    "jsonrpc": "2.0",
    "id": 1,
    "method": "server/discover",
    "params": {
        "_meta": {"io.modelcontextprotocol/protocolVersion": PRESENT, "io.modelcontextprotocol/clientCapabilities": {}},
    },
}
HEADERS = {"Accept": "application/json, text/event-stream", "Content-Type": "application/json"}


def command(folder: Path, *options: str, name: str = "mcp") -> list[str]:
    return ["-m", "scope_ptz.cli", name, "--camera", SCENE, "--runs-dir", str(folder / "runs"), *options]


@pytest.mark.anyio
@pytest.mark.parametrize("version", [PRESENT, OLDER])
async def test_over_streamable_http(free: Served, version: str) -> None:
    async with agent(free, version) as client:
        assert client.protocol_version == version
        assert client.server_info is not None and client.server_info.name == "scope-ptz"
        await check(client, CAMERA)


@pytest.mark.anyio
@pytest.mark.parametrize("version", [PRESENT, pytest.param(OLDER, marks=pytest.mark.full)])
async def test_over_stdio(scenes: None, tmp_path: Path, version: str) -> None:
    program = StdioServerParameters(command=sys.executable, args=command(tmp_path), env=dict(os.environ))
    async with Client(program, mode=MODES[version], read_timeout_seconds=120.0) as client:
        assert client.protocol_version == version
        await check(client, SCENE)


async def check(client: Client, camera: str) -> None:
    """Use each part of the protocol once."""
    heard: list[str] = []

    async def listen(progress: float, total: float | None, message: str | None) -> None:
        heard.append(message or "")

    moved = await client.call_tool("adjust_ptz", {"camera": camera, "pan_deg": 5}, progress_callback=listen)
    assert not moved.is_error, text_of(moved)
    assert heard[0] == "The run has started."
    assert pictures_of(moved)[0].shape[2] == 3
    asked = await client.call_tool("ask", {"camera": camera, "instruction": "go home"})
    assert asked.structured_content["outcome"] == "answered"
    assert len((await client.list_tools()).tools) == 19
    assert (await client.list_resources()).resources
    assert len((await client.list_resource_templates()).resource_templates) == 8
    assert (await client.read_resource(f"scope://runs/{asked.structured_content['run']}")).contents
    (prompt,) = (await client.list_prompts()).prompts
    assert (await client.get_prompt(prompt.name)).messages


def post(url: str, message: dict[str, Any], **headers: str) -> httpx2.Response:
    """Send a message without the client library."""
    version = {"Mcp-Protocol-Version": PRESENT, "Mcp-Method": message["method"]} if message is DISCOVER else {}
    with httpx2.Client(timeout=60.0, trust_env=False) as client:
        return client.post(url, json=message, headers={**HEADERS, **version, **headers})


@pytest.mark.parametrize("message", [INITIALIZE, DISCOVER], ids=[OLDER, PRESENT])
def test_requests_from_pages_of_other_sites_are_refused(served: Served, message: dict[str, Any]) -> None:
    url = f"{served.root}/mcp"
    assert post(url, message).status_code == 200
    assert post(url, message, Origin=served.root).status_code == 200, "its own page"
    for headers in (
        {"Origin": "https://evil.example"},
        {"Origin": "null"},
        {"Host": "evil.example"},
        {"Host": "evil.example", "Origin": "http://evil.example"},
        {"Sec-Fetch-Site": "cross-site"},
    ):
        refused = post(url, message, **headers)
        assert (refused.status_code, refused.json()["error"]["code"]) == (403, "refused"), headers


@pytest.mark.parametrize("message", [INITIALIZE, DISCOVER], ids=[OLDER, PRESENT])
def test_a_token_is_needed_where_the_http_api_needs_one(guarded: Served, tokens: dict[str, str], message: dict[str, Any]) -> None:
    url = f"{guarded.root}/mcp"
    for headers in ({}, {"Authorization": "Bearer scope_wrong"}):
        refused = post(url, message, **headers)
        assert (refused.status_code, refused.headers["www-authenticate"]) == (401, "Bearer")
    admitted = post(url, message, Authorization=f"Bearer {tokens['vera']}")
    assert admitted.status_code == 200
    assert admitted.headers["x-content-type-options"] == "nosniff"
    too_large = post(url, {**message, "padding": "x" * 300_000}, Authorization=f"Bearer {tokens['vera']}")
    assert too_large.status_code == 413


def test_a_session_of_the_older_protocol_belongs_to_its_token(guarded: Served, tokens: dict[str, str]) -> None:
    url = f"{guarded.root}/mcp"
    begun = post(url, INITIALIZE, Authorization=f"Bearer {tokens['anna']}")
    session = {"Mcp-Session-Id": begun.headers["mcp-session-id"], "Mcp-Protocol-Version": OLDER}
    listing = {"jsonrpc": "2.0", "id": 2, "method": "tools/list"}
    assert post(url, listing, Authorization=f"Bearer {tokens['ben']}", **session).status_code == 404
    assert post(url, listing, Authorization=f"Bearer {tokens['anna']}", **session).status_code == 200


HOSTILE_ARGUMENTS = (
    '{"camera": "yard", "description": "\\ud800"}',
    '{"camera": "\\ud800"}',
    '{"\\udfff": 1}',
    '{"camera": "yard", "pan_deg": NaN}',
    '{"camera": "yard", "pan_deg": 1' + "0" * 400 + "}",
    '{"camera": "yard", "pan_deg": 1e999}',
    '{"camera": "yard", "wait_s": -1, "run": "\\u0000"}',
    '{"camera": ["yard"], "run": {"a": []}, "instruction": 7}',
    '{"camera": "yard", "arguments": ' + "[" * 500 + "]" * 500 + "}",
    "null",
    "{}",
)


def test_hostile_arguments_are_answered_with_an_error_of_the_call(free: Served) -> None:
    version = {"Mcp-Protocol-Version": PRESENT, "Mcp-Method": "tools/call"}
    meta = json.dumps(DISCOVER["params"]["_meta"])
    with httpx2.Client(timeout=60.0, trust_env=False) as client:
        for tool in ("count_objects", "adjust_ptz", "ask", "start_run", "run_status", "camera_state", "start_conversation"):
            for arguments in HOSTILE_ARGUMENTS:
                params = f'{{"name": "{tool}", "arguments": {arguments}, "_meta": {meta}}}'
                body = f'{{"jsonrpc": "2.0", "id": 1, "method": "tools/call", "params": {params}}}'
                reply = client.post(f"{free.root}/mcp", content=body, headers={**HEADERS, **version, "Mcp-Name": tool})
                answer = reply.json()
                failed = answer["error"]["message"] if "error" in answer else answer["result"]["content"][0]["text"]
                assert "error" in answer or answer["result"]["isError"], (tool, arguments)
                assert "unexpectedly" not in failed and "Internal" not in failed, (tool, arguments, failed)


@contextmanager
def started(folder: Path, *options: str, name: str = "mcp") -> Iterator[subprocess.Popen[str]]:
    """Run ``scope mcp``, or another command, with pipes."""
    with (folder / "errors").open("w") as errors:
        program = subprocess.Popen(
            [sys.executable, *command(folder, *options, name=name)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=errors,
            text=True,
        )
        killer = threading.Timer(120.0, program.kill)
        killer.start()
        try:
            yield program
        finally:
            killer.cancel()
            program.kill()
            program.wait(60)
            for pipe in (program.stdin, program.stdout):
                assert pipe is not None
                pipe.close()


def exchange(program: subprocess.Popen[str], message: dict[str, Any]) -> dict[str, Any]:
    """Send a message to a program, and return the reply. Every line that the program prints must be a message."""
    assert program.stdin is not None and program.stdout is not None
    program.stdin.write(json.dumps(message) + "\n")
    program.stdin.flush()
    while True:
        reply: dict[str, Any] = json.loads(program.stdout.readline())
        if reply.get("id") == message["id"]:
            return reply


def call(number: int, name: str, /, **arguments: Any) -> dict[str, Any]:
    """Return the message that calls a tool."""
    return {"jsonrpc": "2.0", "id": number, "method": "tools/call", "params": {"name": name, "arguments": arguments}}


@pytest.mark.full
def test_stdout_carries_only_messages_and_the_program_ends_with_its_input(scenes: None, tmp_path: Path) -> None:
    with started(tmp_path) as program:
        assert exchange(program, INITIALIZE)["result"]["protocolVersion"] == OLDER
        assert program.stdin is not None and program.stdout is not None
        program.stdin.write('{"jsonrpc": "2.0", "method": "notifications/initialized"}\nnot a message\n')
        state = exchange(program, call(2, "camera_state", camera=SCENE))["result"]["structuredContent"]
        exchange(
            program, call(3, "start_run", camera=SCENE, tool="track_object", arguments={"description": "ball", "duration_s": 300})
        )
        program.stdin.close()
        rest = program.stdout.read()
        assert program.wait(60) == 0
    assert state["name"] == SCENE
    assert all(json.loads(line)["jsonrpc"] == "2.0" for line in rest.splitlines())
    (trace,) = (tmp_path / "runs").glob("*track*/trace.jsonl")
    assert json.loads(trace.read_text().splitlines()[-1])["outcome"] == "cancelled", "the run ends with the program"
    assert "Traceback" not in (tmp_path / "errors").read_text()


@pytest.mark.full
def test_a_signal_ends_the_program_although_its_input_is_open(scenes: None, tmp_path: Path) -> None:
    with started(tmp_path, "--role", "viewer") as program:
        exchange(program, INITIALIZE)
        refused = exchange(program, call(2, "go_home", camera=SCENE))["result"]
        assert refused["isError"] and "needs the operator role" in refused["content"][0]["text"]
        program.send_signal(signal.SIGTERM)
        assert program.wait(60) == 130
    assert "Traceback" not in (tmp_path / "errors").read_text()


@pytest.mark.full
def test_only_mcp_is_served_by_the_command_over_http(scenes: None, tmp_path: Path) -> None:
    with started(tmp_path, "--transport", "http", "--port", "0", "--json") as program:
        assert program.stdout is not None
        url = json.loads(program.stdout.readline())["url"]
        assert post(f"{url}/mcp", DISCOVER).status_code == 200
        with httpx2.Client(base_url=url, timeout=60.0, trust_env=False) as client:
            assert "/mcp" in client.get("/").text
            assert client.get("/api/v1/cameras").status_code == 404
        program.send_signal(signal.SIGINT)
        assert program.wait(60) == 130


@pytest.mark.full
def test_streams_end_when_the_server_stops(scenes: None, tmp_path: Path) -> None:
    with started(tmp_path, "--transport", "http", "--port", "0", "--json") as program:
        assert program.stdout is not None
        url = json.loads(program.stdout.readline())["url"]
        begun = post(f"{url}/mcp", INITIALIZE)
        session = {"Mcp-Session-Id": begun.headers["mcp-session-id"], "Mcp-Protocol-Version": OLDER}
        with (
            httpx2.Client(timeout=60.0, trust_env=False) as client,
            client.stream("GET", f"{url}/mcp", headers={**HEADERS, **session}) as stream,
        ):
            assert stream.status_code == 200
            program.send_signal(signal.SIGTERM)
            assert program.wait(60) == 130
    assert (tmp_path / "errors").read_text() == "scope: cancelled.\n"


@pytest.mark.full
def test_the_console_serves_mcp_too(scenes: None, tmp_path: Path) -> None:
    with started(tmp_path, "--port", "0", "--json", name="console") as program:
        assert program.stdout is not None
        url = json.loads(program.stdout.readline())["url"]
        assert post(f"{url}/mcp", DISCOVER).json()["result"]["capabilities"]["tools"] is not None
        assert post(f"{url}/mcp", INITIALIZE).status_code == 200
        assert post(f"{url}/mcp", DISCOVER, Origin="https://evil.example").status_code == 403


MISSING = "import sys\nsys.modules['mcp'] = None\nsys.argv = ['scope', {options}]\nfrom scope_ptz.cli import main\nmain()"


@pytest.mark.full
@pytest.mark.parametrize("options", ["'mcp'", "'mcp', '--transport', 'http'"])
def test_a_missing_package_is_named_with_its_extra(options: str) -> None:
    program = [sys.executable, "-c", MISSING.format(options=options)]
    done = subprocess.run(program, capture_output=True, text=True, check=False, stdin=subprocess.DEVNULL)
    assert done.returncode == 2
    assert done.stderr == "scope: The server requires the package mcp. Install it with: pip install 'scope-ptz[serve]'.\n"


@pytest.mark.full
def test_the_server_works_without_mcp_and_reports_it(served: Served, tmp_path: Path) -> None:
    options = f"'serve', '--port', '0', '--json', '--runs-dir', {str(tmp_path)!r}"
    with subprocess.Popen([sys.executable, "-c", MISSING.format(options=options)], stdout=subprocess.PIPE, text=True) as program:
        try:
            assert program.stdout is not None
            url = json.loads(program.stdout.readline())["url"]
            refused = post(f"{url}/mcp", DISCOVER)
            assert (refused.status_code, refused.json()["error"]["code"]) == (501, "not_installed")
            assert "pip install 'scope-ptz[serve]'" in refused.json()["error"]["message"]
        finally:
            program.terminate()
