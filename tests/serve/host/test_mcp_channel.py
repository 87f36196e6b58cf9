"""The MCP channel, with the official client."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from mcp.shared.exceptions import MCPError
from mcp_types import ImageContent

from scope_ptz.serve.bench_host.wire import EvaluationSettings
from scope_ptz.tools.registry import TOOLS
from tests.serve.host.hosting import HELLO, hosting
from tests.serve.host.scripted_worker import ScriptedWorker
from tests.serve.mcp.agents import text_of

pytestmark = pytest.mark.anyio
SETTINGS = EvaluationSettings(tasks="core")


async def test_a_task_over_mcp(tmp_path: Path) -> None:
    fake = ScriptedWorker(1)
    async with hosting(tmp_path / "host", fake.worker, SETTINGS) as hosted, hosted.mcp() as client:
        listed = {tool.name for tool in (await client.list_tools()).tools}
        assert listed == {"begin_task", "view", "answer", *TOOLS}
        task = await client.call_tool("begin_task", {})
        assert text_of(task) == "instruction 0"
        assert isinstance(task.structured_content, dict) and task.structured_content["presets"] == ["yard"]
        seen = await client.call_tool("view", {})
        assert any(isinstance(part, ImageContent) and part.mime_type == "image/jpeg" for part in seen.content)
        assert "done" in text_of(await client.call_tool("go_home", {}))
        counted = await client.call_tool("count_objects", {"description": "cones"})
        assert "untrusted_picture_text" in str(counted.structured_content)
        assert not (await client.call_tool("answer", {"text": "7"})).is_error
        assert "finished" in text_of(await client.call_tool("begin_task", {}))
    assert fake.log["anna-0"] == ["hello", "view", "calls", "calls", "reply"]


async def test_calls_out_of_turn_are_errors(tmp_path: Path) -> None:
    fake = ScriptedWorker(2)
    async with hosting(tmp_path / "host", fake.worker, SETTINGS) as hosted, hosted.mcp() as client:
        for name, arguments in (("go_home", {}), ("view", {}), ("answer", {"text": "7"})):
            early = await client.call_tool(name, arguments)
            assert early.is_error and "No task is in progress" in text_of(early)
        await client.call_tool("begin_task", {})
        await client.call_tool("answer", {"text": "7"})
        late = await client.call_tool("answer", {"text": "8"})
        assert late.is_error
    assert fake.log["anna-0"] == ["hello", "reply"]


@pytest.mark.parametrize(
    ("name", "arguments"),
    [("answer", {}), ("answer", {"text": "7", "kind": "correct"}), ("answer", {"text": 7}),
     ("begin_task", {"task": "scope1-x-001"}), ("view", {"path": "../host.json"})],
)  # fmt: skip
async def test_wrong_arguments_can_be_corrected(tmp_path: Path, name: str, arguments: dict[str, Any]) -> None:
    fake = ScriptedWorker(1)
    async with hosting(tmp_path / "host", fake.worker, SETTINGS) as hosted, hosted.mcp() as client:
        await client.call_tool("begin_task", {})
        with suppress(MCPError):  # the library checks the schema
            assert (await client.call_tool(name, arguments)).is_error
        assert not (await client.call_tool("answer", {"text": "7"})).is_error
    assert fake.log["anna-0"] == ["hello", "reply"]


async def test_parallel_calls_are_carried_out_one_after_another(tmp_path: Path) -> None:
    fake = ScriptedWorker(1)
    async with hosting(tmp_path / "host", fake.worker, SETTINGS) as hosted, hosted.mcp() as client:
        await client.call_tool("begin_task", {})
        results = await asyncio.gather(*(client.call_tool("go_home", {}) for _ in range(5)))
        assert not any(result.is_error for result in results)
    assert fake.log["anna-0"][:6] == ["hello", *["calls"] * 5]


async def test_http_and_mcp_of_one_participant_share_the_task(tmp_path: Path) -> None:
    fake = ScriptedWorker(1)
    async with hosting(tmp_path / "host", fake.worker, SETTINGS) as hosted, hosted.mcp() as client, hosted.agent() as agent:
        task = await client.call_tool("begin_task", {})
        assert isinstance(task.structured_content, dict)
        assert (await agent.say(HELLO))["task"] == task.structured_content["task"]


async def test_the_server_offers_no_resources_and_no_prompts(tmp_path: Path) -> None:
    async with hosting(tmp_path / "host", ScriptedWorker(1).worker, SETTINGS) as hosted, hosted.mcp() as client:
        for request in (client.list_resources, client.list_prompts, client.list_resource_templates):
            with pytest.raises(MCPError):
                await request()
        with pytest.raises(MCPError):
            await client.read_resource("file:///etc/passwd")
        with pytest.raises(MCPError):
            await client.call_tool("get_answers", {})
