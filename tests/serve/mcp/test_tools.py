"""The tools of the MCP server, called by the official client library over streamable HTTP."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import anyio
import httpx2
import jsonschema  # type: ignore[import-untyped]
import numpy as np
import pytest
from mcp import Client, MCPError

from scope_ptz.serve.mcp.pictures import MAX_PICTURE_BYTES, MAX_RESULT_BYTES, encode_limited_jpeg
from scope_ptz.serve.mcp.tool import wire_bytes
from scope_ptz.serve.security.access import Access
from scope_ptz.serve.security.rate_limits import Rate, RateLimits
from scope_ptz.serve.security.tokens import TokenFile
from scope_ptz.serve.site.errors import TooManyRequestsError
from scope_ptz.serve.site.site import SiteOptions
from scope_ptz.tools.registry import TOOLS
from tests.serve.conftest import SPEC
from tests.serve.mcp.agents import LONG, OLDER, PRESENT, agent, links_of, pictures_of, read_picture, text_of
from tests.serve.serving import CAMERA, OTHER, Served, serving

CALLS: dict[str, dict[str, Any]] = {
    "adjust_ptz": {"pan_deg": 5},
    "go_to_preset": {"name": "yard"},
    "go_home": {},
    "get_presets": {},
    "take_image": {},
    "count_objects": {"description": "balls"},
    "query_answer": {"question": "is there a ball?"},
    "zoom_to_object": {"description": "ball"},
    "track_object": {"description": "ball", "duration_s": 0.6},
}
READS = {"get_presets", "run_status", "list_cameras", "camera_state", "live_picture"}


@pytest.mark.anyio
async def test_the_nine_tools_take_the_handle_of_a_camera(free: Served) -> None:
    async with agent(free) as client:
        listed = {tool.name: tool for tool in (await client.list_tools()).tools}
    assert list(listed)[:9] == list(TOOLS)
    for name, tool in TOOLS.items():
        own = tool.schema()["function"]["parameters"]
        schema = listed[name].input_schema
        assert schema["properties"]["camera"]["enum"] == [CAMERA, OTHER]
        assert schema["required"] == ["camera", *own.get("required", [])]
        assert own["properties"].items() <= schema["properties"].items()
        assert schema["additionalProperties"] is False
    for entry in listed.values():
        jsonschema.Draft202012Validator.check_schema(entry.input_schema)
        assert entry.output_schema is not None and entry.output_schema["type"] == "object"
        jsonschema.Draft202012Validator.check_schema(entry.output_schema)
        assert entry.annotations is not None and entry.annotations.destructive_hint is False
    assert {name for name, each in listed.items() if each.annotations and each.annotations.read_only_hint} == READS
    repeatable = {name for name, each in listed.items() if each.annotations and each.annotations.idempotent_hint}
    assert repeatable == READS | {"go_to_preset", "go_home", "cancel_run", "control_camera", "stop_camera"}
    closed = {name for name, each in listed.items() if each.annotations and not each.annotations.open_world_hint}
    assert closed == {"get_presets", "start_conversation", "list_cameras", "camera_state", "control_camera", "stop_camera"}


@pytest.mark.anyio
async def test_every_tool_can_be_called_and_its_result_fits_its_schema(free: Served) -> None:
    presets = [each.name for each in await free_presets(free)]
    async with agent(free) as client:
        listed = {tool.name: tool for tool in (await client.list_tools()).tools}
        for name, arguments in CALLS.items():
            own = {"name": presets[0]} if name == "go_to_preset" else arguments
            result = await client.call_tool(name, {"camera": CAMERA, **own})
            assert not result.is_error, text_of(result)
            jsonschema.validate(result.structured_content, listed[name].output_schema or {})
            data = result.structured_content
            assert (data["camera"], data["error"], data["fault"]) == (CAMERA, None, None)
            assert len(pictures_of(result)) == (0 if name == "get_presets" else 1), name
            if data["run"] is not None:
                # The call is stored like one that came over the HTTP API.
                with free.client() as http:
                    run = http.get(f"/runs/{data['run']}").json()
                assert (run["kind"], run["camera"], run["actor"], run["outcome"]) == ("tool", CAMERA, "local", "answered")


async def free_presets(served: Served) -> list[Any]:
    return list(await anyio.to_thread.run_sync(lambda: served.call(_presets, served)))


async def _presets(served: Served) -> list[Any]:
    return list(await (await served.site.station(CAMERA).camera()).presets())


@pytest.mark.anyio
async def test_a_result_is_that_of_the_http_api(free: Served) -> None:
    with free.client(tab="mcp-twin") as http:
        call = {"tilt_deg": 100.0}
        theirs = http.post(f"/cameras/{CAMERA}/tools/adjust_ptz", json=call).json()
        http.post(f"/cameras/{CAMERA}/home")
        async with agent(free, name="mcp-twin") as client:
            ours = (await client.call_tool("adjust_ptz", {"camera": CAMERA, **call})).structured_content
    assert (ours["result"], ours["pose"]) == (theirs["result"], theirs["pose"])
    assert ours["result"]["clamped"] == ["tilt"], "the limits of the camera hold"


SPECS = ("sim:analytic-yard", "axis://root@10.0.0.1", "../../etc/passwd", "blender:x.py", "", "x" * 300)


@pytest.mark.anyio
async def test_a_camera_is_a_configured_name_and_never_a_spec(free: Served) -> None:
    async with agent(free) as client:
        for camera in SPECS:
            for name in ("go_home", "get_presets", "camera_state", "ask", "start_run"):
                more = {"instruction": "go home"} if name in ("ask", "start_run") else {}
                result = await client.call_tool(name, {"camera": camera, **more})
                assert result.is_error
                assert CAMERA in text_of(result) or "at most 120 characters" in text_of(result), (camera, name)
            with pytest.raises(MCPError):
                await client.read_resource(f"scope://cameras/{camera}/presets")


WRONG: tuple[tuple[str, dict[str, Any], str], ...] = (
    ("adjust_ptz", {"camera": CAMERA, "pan_deg": "left"}, "pan_deg: Input should be a valid number"),
    ("adjust_ptz", {"camera": CAMERA, "zoom_factor": 2, "zoom_limit": "in"}, "give at most one of"),
    ("adjust_ptz", {"camera": CAMERA, "url": "http://x"}, "url: Extra inputs are not permitted"),
    ("adjust_ptz", {"pan_deg": 1}, "camera: Field required"),
    ("count_objects", {"camera": CAMERA, "description": " "}, "description"),
    ("count_objects", {"camera": CAMERA, "description": "cones", "pair": "gpt"}, "There is no pair 'gpt'"),
    ("start_run", {"camera": CAMERA}, "give either instruction or tool"),
    ("start_run", {"camera": CAMERA, "tool": "rm"}, "There is no tool 'rm'"),
    ("start_run", {"camera": CAMERA, "tool": "go_home", "dry_run": True}, "apply to instructions"),
    ("run_status", {"run": "../../etc"}, "There is no run"),
    ("run_status", {"run": "x", "wait_s": 1e9}, "wait_s"),
    ("ask", {"camera": CAMERA, "instruction": "go home", "conversation": "nobody's"}, "nobody's"),
)


@pytest.mark.anyio
async def test_a_wrong_call_is_answered_with_a_remedy(free: Served) -> None:
    async with agent(free) as client:
        for tool, arguments, message in WRONG:
            result = await client.call_tool(tool, arguments)
            assert result.is_error
            assert message in text_of(result), (tool, arguments)
        state = (await client.call_tool("camera_state", {"camera": CAMERA})).structured_content
    assert (state["run"], state["control"]["holder"]) == (None, None), "nothing was started"


@pytest.mark.anyio
async def test_an_unknown_tool_is_an_error_that_lists_the_tools(free: Served) -> None:
    async with agent(free) as client:
        with pytest.raises(MCPError, match="There is no tool 'shell'"):
            await client.call_tool("shell", {})


@pytest.mark.anyio
async def test_a_panorama_is_a_link_to_a_resource(free: Served) -> None:
    async with agent(free) as client:
        result = await client.call_tool("count_objects", {"camera": CAMERA, "description": "balls", "view": "full"})
        assert not result.is_error, text_of(result)
        assert pictures_of(result) == []
        (uri,) = links_of(result)
        assert uri == f"scope://runs/{result.structured_content['run']}/frames/001-full.jpg"
        panorama = await read_picture(client, uri)
    assert panorama.shape[1] > 2 * panorama.shape[0], "it is a panorama"


@pytest.mark.parametrize("size", [(1080, 1920), (4000, 12000), (3, 5)])
def test_pictures_fit_regardless_of_their_content(size: tuple[int, int]) -> None:
    noise = np.random.default_rng(1).integers(0, 255, (*size, 3), np.uint8)  # the worst case for JPEG
    assert len(encode_limited_jpeg(noise, MAX_PICTURE_BYTES, 1280)) <= MAX_PICTURE_BYTES


@pytest.mark.anyio
async def test_no_result_is_too_large_for_desktop_clients(free: Served) -> None:
    async with agent(free) as client:
        for name, arguments in (("live_picture", {"width": 3840}), ("camera_state", {}), ("take_image", {})):
            assert wire_bytes(await client.call_tool(name, {"camera": CAMERA, **arguments})) <= MAX_RESULT_BYTES


@pytest.mark.anyio
async def test_a_viewer_can_only_read(guarded: Served, tokens: dict[str, str]) -> None:
    async with agent(guarded, token=tokens["vera"]) as viewer, agent(guarded, token=tokens["anna"]) as operator:
        assert {tool.name for tool in (await viewer.list_tools()).tools} == READS
        everything = [tool.name for tool in (await operator.list_tools()).tools]
        moved = await operator.call_tool("adjust_ptz", {"camera": CAMERA, "pan_deg": 5})
        for name in everything:
            arguments = {**CALLS.get(name, {}), "camera": CAMERA}
            if name == "run_status":
                arguments = {"run": moved.structured_content["run"]}
            elif name == "list_cameras":
                arguments = {}
            result = await viewer.call_tool(name, arguments)
            assert result.is_error == (name not in READS), name
            if result.is_error:
                assert text_of(result) == f"{name} needs the operator role, but your token has the viewer role."
        state = (await viewer.call_tool("camera_state", {"camera": CAMERA})).structured_content
    assert state["pose"] == moved.structured_content["pose"], "the viewer has moved nothing"
    assert state["control"]["holder"] == "anna"


@pytest.mark.anyio
async def test_control_is_shared_with_the_http_api(free: Served) -> None:
    with free.client(tab="page") as page:
        page.post(f"/cameras/{CAMERA}/move", json={"zoom": 1.0})
        async with agent(free) as client:
            refused = await client.call_tool("go_home", {"camera": CAMERA})
            assert refused.is_error and "is controlled by another window or program" in text_of(refused)
            assert (refused.meta or {})["scope-ptz/error"] == "not_in_control"
            asked = await client.call_tool("control_camera", {"camera": CAMERA, "action": "take"})
            assert asked.structured_content == {"camera": CAMERA, "holder": "local", "mine": False}
            (request,) = page.get(f"/cameras/{CAMERA}/control").json()["requests"]
            page.post(f"/cameras/{CAMERA}/control/answer", json={"client": request["client"], "grant": True})
            assert not (await client.call_tool("go_home", {"camera": CAMERA})).is_error
            assert page.post(f"/cameras/{CAMERA}/home").json()["error"]["code"] == "not_in_control"
            released = await client.call_tool("control_camera", {"camera": CAMERA, "action": "release"})
            assert released.structured_content == {"camera": CAMERA, "holder": None, "mine": False}
        assert page.post(f"/cameras/{CAMERA}/home").status_code == 200


@pytest.mark.anyio
async def test_rate_limits_are_those_of_the_http_api(scenes: None, tmp_path: Path, tokens: dict[str, str]) -> None:
    limits = RateLimits({"read": Rate(100.0, 1000), "command": Rate(0.001, 2)})
    access = Access("127.0.0.1", TokenFile(Path(tokens["path"])), limits=limits)
    with serving(SiteOptions(tmp_path / "runs"), access, {CAMERA: SPEC}) as server:
        async with agent(server, token=tokens["anna"], name="one") as client:
            for _ in range(2):
                assert not (await client.call_tool("go_home", {"camera": CAMERA, "picture": False})).is_error
            refused = await client.call_tool("go_home", {"camera": CAMERA})
            assert refused.is_error and text_of(refused).startswith("Too many requests.")
            stopped = await client.call_tool("stop_camera", {"camera": CAMERA})
            assert not stopped.is_error, "stopping is always possible"
        with server.client(tokens["anna"], tab="one") as http:
            assert http.post(f"/cameras/{CAMERA}/home").status_code == 429, "both ways in share the limit"
    with pytest.raises(TooManyRequestsError):
        limits.count("anna:one", "command", "anna")


@pytest.mark.anyio
async def test_keep_outs_and_the_audit_log_are_those_of_the_site(
    scenes: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    audit = tmp_path / "audit.jsonl"
    (tmp_path / "scope.yaml").write_text(
        f"""
cameras:
  quiet-yard:
    camera: "{SPEC}"
    rules: {{keep_out: [{{name: windows, pan_deg: [100, 120], tilt_deg: [-90, 90]}}]}}
    audit_log: {audit}
"""
    )
    monkeypatch.setenv("SCOPE_CONFIG", str(tmp_path / "scope.yaml"))
    access = Access("127.0.0.1", limits=RateLimits(None))
    with serving(SiteOptions(tmp_path / "runs"), access, {"quiet-yard": "quiet-yard"}) as server:
        async with agent(server) as client:
            state = (await client.call_tool("camera_state", {"camera": "quiet-yard"})).structured_content
            assert [region["name"] for region in state["keep_out"]] == ["windows"]
            said = text_of(await client.call_tool("camera_state", {"camera": "quiet-yard"}))
            assert "Keep-out regions: windows (pan (100.0, 120.0), tilt (-90.0, 90.0))." in said
            turn = 110.0 - state["pose"]["pan_deg"]
            result = await client.call_tool("adjust_ptz", {"camera": "quiet-yard", "pan_deg": turn})
            assert "windows" in text_of(result)
            assert not 100 < result.structured_content["pose"]["pan_deg"] < 120
    entries = [json.loads(line) for line in audit.read_text().splitlines()]
    assert any("local: adjust_ptz(pan_deg=" in json.dumps(entry) for entry in entries)
    assert any(entry["event"] == "move" for entry in entries)


@pytest.mark.anyio
@pytest.mark.parametrize("version", [PRESENT, OLDER])
async def test_a_cancelled_call_reports_progress_and_stops_the_camera(free: Served, version: str) -> None:
    heard: list[tuple[float, str | None]] = []
    station = free.site.station(CAMERA)
    async with agent(free, version) as client:
        with anyio.CancelScope() as scope:

            async def listen(progress: float, total: float | None, message: str | None) -> None:
                heard.append((progress, message))
                if len(heard) == 3:
                    scope.cancel()

            await client.call_tool("track_object", LONG, progress_callback=listen)
        assert scope.cancelled_caught
        with anyio.fail_after(60):
            while station.current_run is not None:  # noqa: ASYNC110 - it ends in another thread
                await anyio.sleep(0.02)
        runs = (await client.call_tool("camera_state", {"camera": CAMERA})).structured_content
        assert runs["run"] is None
    numbers = [number for number, _ in heard]
    assert numbers == sorted(set(numbers)), "progress increases"
    assert [message for _, message in heard][:2] == ["The run has started.", "Step 1: track_object."]
    with free.client() as http:
        newest = http.get("/runs", params={"camera": CAMERA, "limit": 1}).json()["runs"][0]
    assert (newest["outcome"], newest["kind"]) == ("cancelled", "tool")


@pytest.mark.anyio
async def test_progress_is_reported_while_a_camera_is_being_opened(free: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scope_ptz.serve.mcp.run_progress.HEARTBEAT_S", 0.05)
    opening, heard = free.site.station(CAMERA)._opening, list[str]()
    await anyio.to_thread.run_sync(lambda: free.call(opening.acquire))

    async def listen(progress: float, total: float | None, message: str | None) -> None:
        heard.append(message or "")
        if len(heard) == 3:
            await anyio.to_thread.run_sync(lambda: free.call(opening.release))

    async with agent(free) as client:
        assert not (await client.call_tool("go_home", {"camera": CAMERA}, progress_callback=listen)).is_error
    assert all(message.startswith("In progress for ") for message in heard[:3])
    steps = [message for message in heard if not message.startswith("In progress for ")]
    assert steps[:3] == ["The run has started.", "Step 1: go_home.", "go_home is done."]
    assert steps[3:] == ["The planner has finished.", "The run has ended: answered."]


@pytest.mark.anyio
async def test_long_work_is_started_followed_and_cancelled(free: Served) -> None:
    async with agent(free) as client, agent(free, name="another") as other:
        arguments = {key: value for key, value in LONG.items() if key != "camera"}
        started = await client.call_tool("start_run", {"camera": CAMERA, "tool": "track_object", "arguments": arguments})
        run = started.structured_content["run"]
        assert started.structured_content["running"]
        status = (await other.call_tool("run_status", {"run": run})).structured_content
        assert (status["running"], status["camera"], status["kind"]) == (True, CAMERA, "tool")
        busy = await client.call_tool("go_home", {"camera": CAMERA})
        assert busy.is_error and run in text_of(busy)
        ended = (await other.call_tool("cancel_run", {"run": run})).structured_content
        assert (ended["running"], ended["outcome"]) == (False, "cancelled")
        assert (await client.call_tool("cancel_run", {"run": run})).structured_content == ended, "cancelling again has no effect"


@pytest.mark.anyio
async def test_a_sweep_runs_in_the_background(free: Served) -> None:
    async with agent(free) as client:
        call = {"tool": "count_objects", "arguments": {"description": "balls", "view": "full"}}
        run = (await client.call_tool("start_run", {"camera": CAMERA, **call})).structured_content["run"]
        status = await _ended(client, run)
    assert status["outcome"] == "answered"
    assert status["result"]["view"] == "full"
    assert status["pictures"] == [f"scope://runs/{run}/frames/001-full.jpg"]


async def _ended(client: Client, run: str) -> dict[str, Any]:
    """Wait until a run has ended, and return its state."""
    with anyio.fail_after(120):
        while True:
            status = (await client.call_tool("run_status", {"run": run, "wait_s": 30.0})).structured_content
            if not status["running"]:
                return dict(status)


@pytest.mark.anyio
async def test_instructions_continue_a_conversation(free: Served) -> None:
    async with agent(free) as client:
        talk = (await client.call_tool("start_conversation", {"camera": CAMERA, "title": "balls"})).structured_content
        handle = {"camera": CAMERA, "conversation": talk["conversation"]}
        first = await client.call_tool("ask", {**handle, "instruction": "pan right 20 degrees"})
        assert first.structured_content["outcome"] == "answered"
        assert [step["tool"] for step in first.structured_content["steps"]] == ["adjust_ptz"]
        assert len(pictures_of(first)) == 1
        again = await client.call_tool("start_run", {**handle, "instruction": "do that again"})
        ended = await _ended(client, again.structured_content["run"])
        assert ended["conversation"] == talk["conversation"]
        assert [json.loads(step["arguments"]["untrusted_picture_text"]) for step in ended["steps"]] == [{"pan_deg": 20.0}]
        other = await client.call_tool("ask", {**handle, "camera": OTHER, "instruction": "go home"})
        assert other.is_error and f"This conversation is about {CAMERA}" in text_of(other)


@pytest.mark.anyio
async def test_a_dry_run_moves_nothing(free: Served) -> None:
    async with agent(free) as client:
        before = (await client.call_tool("camera_state", {"camera": CAMERA})).structured_content["pose"]
        call = {"camera": CAMERA, "instruction": "pan right 20 degrees", "dry_run": True}
        report = (await client.call_tool("ask", call)).structured_content
        assert len(report["preview"]) == 1
        after = (await client.call_tool("camera_state", {"camera": CAMERA})).structured_content["pose"]
    assert before == after


@pytest.mark.anyio
async def test_conversations_belong_to_a_token(guarded: Served, tokens: dict[str, str]) -> None:
    async with agent(guarded, token=tokens["anna"]) as anna, agent(guarded, token=tokens["ben"]) as ben:
        talk = (await anna.call_tool("start_conversation", {"camera": OTHER})).structured_content["conversation"]
        call = {"camera": OTHER, "instruction": "go home", "conversation": talk}
        assert (await ben.call_tool("ask", call)).is_error
        assert not (await anna.call_tool("ask", call)).is_error


@pytest.mark.anyio
async def test_a_removed_token_ends_a_call_and_its_run(
    guarded: Served, tokens: dict[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("scope_ptz.serve.security.access.AUTHORISATION_CHECK_INTERVAL_S", 0.1)
    file = TokenFile(Path(tokens["path"]))
    secret, station = file.add("carl", "operator"), guarded.site.station(OTHER)
    await anyio.to_thread.run_sync(lambda: guarded.call(station.control.clear))

    async def listen(progress: float, total: float | None, message: str | None) -> None:
        if progress == 2:
            file.remove("carl")

    with pytest.raises((ExceptionGroup, MCPError, httpx2.HTTPError)), anyio.fail_after(60):
        async with agent(guarded, token=secret) as client:
            await client.call_tool("track_object", {**LONG, "camera": OTHER}, progress_callback=listen)
    with anyio.fail_after(60):
        while station.current_run is not None:  # noqa: ASYNC110 - it ends in another thread
            await anyio.sleep(0.02)
