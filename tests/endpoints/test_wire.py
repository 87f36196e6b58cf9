"""HTTP traffic: connections are reused, and only the endpoint's own credential is sent."""

from __future__ import annotations

import gzip
import json
from typing import Any

import anyio
import pytest
from pydantic import SecretStr

from scope_ptz.endpoints.chat import ChatClient
from scope_ptz.endpoints.endpoint import Endpoint
from scope_ptz.endpoints.failures import ServerFailure
from scope_ptz.endpoints.http import JsonClient
from tests.support.misbehaving import Misbehaving, Say, body, completion, good, say, status

pytestmark = pytest.mark.anyio
KEY = "sk-very-secret-0123456789"
ELSEWHERE = Endpoint(url="https://model-server.invalid/v1")
MESSAGES = [{"role": "user", "content": "hello"}]


@pytest.mark.parametrize("stream", [False, True])
async def test_chat_connections_are_reused(stream: bool) -> None:
    with Misbehaving() as server:
        client = ChatClient(Endpoint(url=server.url, model="m"))
        for _ in range(5):
            await client.complete(MESSAGES, stream=stream)
        await client.close()
    assert (len(server.requests), server.connections) == (5, 1)


async def test_json_connections_are_reused_and_calls_run_concurrently() -> None:
    with Misbehaving() as server:
        client = JsonClient(Endpoint(url=server.url))
        for _ in range(5):
            await client.post("query", {})
        assert server.connections == 1
        async with anyio.create_task_group() as group:
            for _ in range(4):
                group.start_soon(client.post, "query", {})
        await client.close()
        await client.post("query", {})  # closed clients open anew
        await client.close()
    assert len(server.requests) == 10


async def test_no_other_credentials_are_sent(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OPENAI_API_KEY", "sk-for-openai-only")
    monkeypatch.setenv("OPENAI_ADMIN_KEY", "sk-admin-only")
    monkeypatch.setenv("OPENAI_ORG_ID", "org-of-mine")
    monkeypatch.setenv("OPENAI_PROJECT_ID", "project-of-mine")
    monkeypatch.setenv("OPENAI_CUSTOM_HEADERS", "X-Secret: mine")
    monkeypatch.setenv("OPENAI_BASE_URL", "http://127.0.0.1:9/elsewhere")
    monkeypatch.setenv("HTTP_PROXY", "http://127.0.0.1:9")
    with Misbehaving() as server:
        without, with_key = (
            ChatClient(Endpoint(url=server.url)),
            ChatClient(Endpoint(url=server.url, key=SecretStr("sk-my-own-key"))),
        )
        moondream = JsonClient(Endpoint(url=server.url, key=SecretStr("sk-my-own-key")), key_header="X-Moondream-Auth")
        await without.complete(MESSAGES)
        await with_key.complete(MESSAGES)
        await moondream.post("query", {})
        for client in (without, with_key, moondream):
            await client.close()
    first, second, third = (request.headers for request in server.requests)
    assert "mine" not in str(server.requests)
    assert "only" not in str(server.requests)
    assert "authorization" not in first
    assert second["authorization"] == "Bearer sk-my-own-key"
    assert third["x-moondream-auth"] == "sk-my-own-key"
    assert "authorization" not in third
    assert second["user-agent"].startswith("scope-ptz/")


@pytest.mark.parametrize(("name", "value"), [("HTTPS_PROXY", f"nonsense://me:{KEY}@host"), ("SSL_CERT_FILE", "/no/such/file")])
async def test_unusable_settings_of_the_environment(name: str, value: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(name, value)
    for work in (JsonClient(ELSEWHERE).post("query", {}), ChatClient(ELSEWHERE).complete(MESSAGES)):
        with pytest.raises(ServerFailure, match="environment") as caught:
            await work
        assert KEY not in str(caught.value)


async def test_the_request_has_the_given_content() -> None:
    tools = [{"type": "function", "function": {"name": "go_home", "parameters": {"type": "object"}}}]
    with Misbehaving() as server:
        client = ChatClient(Endpoint(url=server.url, model="m"))
        await client.complete(
            MESSAGES, tools=tools, extra={"chat_template_kwargs": {"enable_thinking": False}}, temperature=0.5, seed=None
        )
        await client.complete(MESSAGES, stream=True)
        await client.close()
    assert all(request.headers["content-type"] == "application/json" for request in server.requests)
    whole, streamed = (request.data for request in server.requests)
    assert whole == {
        "model": "m",
        "messages": MESSAGES,
        "tools": tools,
        "temperature": 0.5,
        "chat_template_kwargs": {"enable_thinking": False},
    }
    assert "tools" not in streamed
    assert streamed["stream_options"] == {"include_usage": True}


async def test_servers_that_refuse_token_counts_are_asked_without() -> None:
    with Misbehaving([status(422, {"detail": "Unexpected fields: stream_options"})]) as server:
        client = ChatClient(Endpoint(url=server.url, retries=0))
        reply = await client.complete(MESSAGES, stream=True)
        await client.complete(MESSAGES, stream=True)
        await client.close()
    assert reply.text == "All done."
    assert ["stream_options" in request.data for request in server.requests] == [True, False, False]


async def test_a_stream_is_the_same_reply() -> None:
    calls: tuple[tuple[str, Any], ...] = (("adjust_ptz", {"pan_deg": 15}), ("go_home", {}))
    with Misbehaving(then=say("Là-haut: \u2600", *calls, reasoning="hm, hm")) as server:
        client = ChatClient(Endpoint(url=server.url))
        whole, streamed = await client.complete(MESSAGES), await client.complete(MESSAGES, stream=True)
        await client.close()
    kept = {"text", "reasoning", "tool_calls", "finish_reason", "input_tokens", "output_tokens", "cached_tokens", "model"}
    assert whole.model_dump(include=kept) == streamed.model_dump(include=kept)
    assert [json.loads(call.arguments_text) for call in whole.tool_calls] == [{"pan_deg": 15}, {}]
    assert (whole.input_tokens, whole.output_tokens, whole.cached_tokens) == (11, 7, 4)
    assert whole.first_token_s is None
    assert streamed.first_token_s is not None
    assert 0 < streamed.first_token_s <= streamed.seconds


async def test_a_server_that_ignores_streaming_or_compresses() -> None:
    whole = json.dumps(completion(Say("Fine."))).encode()
    packed = body(gzip.compress(whole), headers={"Content-Encoding": "gzip"})
    with Misbehaving([body(whole), packed, body(whole, content_type="")]) as server:
        client = ChatClient(Endpoint(url=server.url))
        assert [(await client.complete(MESSAGES, stream=stream)).text for stream in (True, False, False)] == ["Fine."] * 3
        await client.close()


async def test_a_key_that_a_server_repeats_is_hidden() -> None:
    with Misbehaving(then=good(Say(f"Your key is {KEY}.", tool_calls=(("query_answer", {"question": KEY}),)))) as server:
        client = ChatClient(Endpoint(url=server.url, key=SecretStr(KEY)))
        for stream in (False, True):
            assert KEY not in str(await client.complete(MESSAGES, stream=stream))
        await client.close()
