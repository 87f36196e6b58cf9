"""``scope mcp``: wrong options. tests/serve/mcp tests the server."""

from __future__ import annotations

import json
import os
import re
import sys
import tomllib
from pathlib import Path

import pytest
from mcp import Client
from mcp.client.stdio import StdioServerParameters

from tests.cli.conftest import Scope


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--transport", "carrier-pigeon"), "--transport must be stdio or http"),
        (("--role", "king"), "--role must be viewer or operator"),
        (("--json",), "--json requires --transport http"),
        (("--camera", "sim:x"), "sim:x"),
        (("--transport", "http", "--host", "0.0.0.0"), "without tokens"),  # noqa: S104 - refused
    ],
)
def test_wrong_options(scope: Scope, options: tuple[str, ...], message: str) -> None:
    result = scope("mcp", *options)
    assert (result.code, message in result.err) == (2, True), result.err


PAGE = (Path(__file__).parents[2] / "docs" / "mcp.md").read_text(encoding="utf-8")


def documented_commands() -> list[list[str]]:
    """Return the commands in the configurations that docs/mcp.md shows."""
    configurations = [
        json.loads(block)["mcpServers"] for block in re.findall(r"^```json\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE)
    ]
    configurations += [
        tomllib.loads(block)["mcp_servers"] for block in re.findall(r"^```toml\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE)
    ]
    entries = [entry["scope"] for entry in configurations]
    assert [entry["url"] for entry in entries if "url" in entry] == ["http://localhost:8000/mcp"]
    return [[entry["command"], *entry["args"]] for entry in entries if "command" in entry]


@pytest.mark.full
@pytest.mark.anyio
async def test_the_documented_configuration_works(tmp_path: Path) -> None:
    commands = documented_commands()
    assert len(commands) == 2 and commands[0] == commands[1]
    _, *arguments = commands[0]
    empty = tmp_path / "empty"
    empty.mkdir(mode=0o555)
    environment = {**os.environ, "XDG_DATA_HOME": str(tmp_path / "data")}
    environment.pop("SCOPE_RUNS_DIR", None)
    program = StdioServerParameters(command=sys.executable, args=["-m", "scope_ptz.cli", *arguments], env=environment, cwd=empty)
    async with Client(program, read_timeout_seconds=120.0) as client:
        cameras = (await client.call_tool("list_cameras", {})).structured_content["cameras"]
        assert [each["name"] for each in cameras] == ["highway-works"]
        names = {tool.name for tool in (await client.list_tools()).tools}
        templates = {each.uri_template for each in (await client.list_resource_templates()).resource_templates}
    assert list(empty.iterdir()) == [], "nothing must be stored in the working folder"
    if sys.platform == "linux":
        assert (tmp_path / "data" / "scope-ptz" / "runs").is_dir()
    assert names <= set(re.findall(r"`(\w+)`", PAGE)), "the page must list every tool"
    assert templates <= set(re.findall(r"`(scope://[^`]+)`", PAGE)), "the page must list every resource"
