"""Resources: cameras, presets, scenes, runs, frames and panoramas. Their URIs contain names, never specs or paths."""

from __future__ import annotations

import pytest
from mcp import MCPError
from mcp_types import PromptReference, ResourceTemplateReference

from tests.serve.mcp.agents import OLDER, PRESENT, agent, links_of, read_json, read_picture, text_of
from tests.serve.serving import CAMERA, OTHER, Served


@pytest.mark.anyio
@pytest.mark.parametrize("version", [PRESENT, OLDER])
async def test_every_listed_resource_can_be_read(free: Served, version: str) -> None:
    async with agent(free, version) as client:
        moved = await client.call_tool("adjust_ptz", {"camera": CAMERA, "pan_deg": 5})
        listed = (await client.list_resources()).resources
        uris = [each.uri for each in listed]
        assert f"scope://runs/{moved.structured_content['run']}" in uris
        assert {f"scope://cameras/{name}{part}" for name in (CAMERA, OTHER) for part in ("", "/presets", "/picture")} <= set(uris)
        for each in listed:
            if each.mime_type == "application/json":
                assert await read_json(client, each.uri)
            else:
                assert (await read_picture(client, each.uri)).shape == (180, 320, 3)


@pytest.mark.anyio
async def test_cameras_presets_and_scenes_are_those_of_the_http_api(free: Served) -> None:
    with free.client() as http:
        presets = http.get(f"/cameras/{CAMERA}/presets").json()
        cameras = http.get("/cameras").json()
        state = http.get(f"/cameras/{CAMERA}").json()
    async with agent(free) as client:
        assert await read_json(client, f"scope://cameras/{CAMERA}/presets") == presets
        assert await read_json(client, "scope://cameras") == cameras
        ours = await read_json(client, f"scope://cameras/{CAMERA}")
        assert {**ours, "time_s": 0.0} == {**state, "time_s": 0.0}
        scene = await read_json(client, "scope://scenes/analytic-yard")
    assert scene["cameras"] == [CAMERA, OTHER]
    assert [each["name"] for each in scene["presets"]] == [each["name"] for each in presets]
    assert "instances" not in scene, "what there is to see is not part of it"


@pytest.mark.anyio
async def test_the_pictures_and_the_filmstrip_of_a_run(free: Served) -> None:
    async with agent(free) as client:
        asked = await client.call_tool("ask", {"camera": CAMERA, "instruction": "take a picture, then count the balls"})
        assert not asked.is_error, text_of(asked)
        report = asked.structured_content
        run = report["run"]
        assert [uri.rpartition("/")[2] for uri in report["pictures"]] == ["001.png", "002-view.jpg"]
        for uri in report["pictures"]:
            assert (await read_picture(client, uri)).shape == (180, 320, 3)
        assert f"scope://runs/{run}" in links_of(asked)
        assert await read_json(client, f"scope://runs/{run}") == report
        assert (await read_picture(client, f"scope://runs/{run}/filmstrip")).shape[1] > 320


UNKNOWN = (
    "scope://cameras/nowhere",
    "scope://cameras/sim:analytic-yard/picture",
    "scope://cameras/yard/secrets",
    "scope://scenes/..",
    "scope://scenes/highway-works",
    "scope://runs/..%2F..%2Fetc",
    "scope://runs/x/frames/..%2F..%2Ftrace.jsonl",
    "scope://runs/x/trace.jsonl",
    "file:///etc/passwd",
    "scope://" + "x" * 5_000,
)


@pytest.mark.anyio
async def test_nothing_else_can_be_read(free: Served) -> None:
    async with agent(free) as client:
        for uri in UNKNOWN:
            with pytest.raises(MCPError, match="There is no") as refused:
                await client.read_resource(uri)
            assert str(free.site.library.root) not in str(refused.value), "errors show no paths of the server"


@pytest.mark.anyio
async def test_a_trace_is_not_a_picture(free: Served) -> None:
    async with agent(free) as client:
        run = (await client.call_tool("take_image", {"camera": CAMERA})).structured_content["run"]
        for name in ("frames/trace.jsonl", "pictures/..%2Ftrace.jsonl", "pictures/002.png"):
            with pytest.raises(MCPError, match="There is no picture"):
                await client.read_resource(f"scope://runs/{run}/{name}")


@pytest.mark.anyio
async def test_names_are_completed(free: Served) -> None:
    async with agent(free) as client:
        prompt = await client.complete(
            PromptReference(type="ref/prompt", name="operate_cameras"), {"name": "camera", "value": "ya"}
        )
        assert prompt.completion.values == [CAMERA, OTHER]
        template = ResourceTemplateReference(type="ref/resource", uri="scope://scenes/{scene}")
        assert (await client.complete(template, {"name": "scene", "value": "an"})).completion.values == ["analytic-yard"]


@pytest.mark.anyio
async def test_wrong_prompts_are_refused(free: Served) -> None:
    name = "operate_cameras"
    async with agent(free) as client:
        for prompt, arguments in (("other", {}), (name, {"camera": "sim:x"}), (name, {"x": "y"}), (name, {"task": "x" * 5000})):
            with pytest.raises(MCPError):
                await client.get_prompt(prompt, arguments)
