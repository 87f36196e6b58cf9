"""Every misbehaviour of a server has its own failure kind, with both clients, streaming or not, and never shows the key."""

from __future__ import annotations

import json
import traceback
from collections.abc import Awaitable, Callable
from typing import Any

import pytest

from scope_ptz.endpoints.chat import ChatClient
from scope_ptz.endpoints.endpoint import Endpoint, Timeouts
from scope_ptz.endpoints.failures import Attempt, FailureKind, ServerFailure, count_failures
from scope_ptz.endpoints.http import JsonClient
from scope_ptz.endpoints.retries import Caller
from tests.support.faults import FAULTS, LONG_TIMEOUTS, Fault
from tests.support.misbehaving import Misbehaving, body, never_accepts, nobody_listens, speaks_no_tls, status

pytestmark = pytest.mark.anyio

KEY = "sk-very-secret-0123456789"
MESSAGES = [{"role": "user", "content": "hello"}]


def endpoint(url: str, **changes: Any) -> Endpoint:
    defaults = {"url": url, "model": "m", "key": KEY, "timeouts": LONG_TIMEOUTS, "retries": 0}
    return Endpoint.model_validate(defaults | changes)


async def ask(at: Endpoint, how: str, caller: Caller | None = None) -> tuple[Attempt, ...]:
    client = JsonClient(at, key_header="X-Moondream-Auth", caller=caller) if how == "json" else ChatClient(at, caller=caller)
    try:
        if isinstance(client, JsonClient):
            return (await client.post("query", {"question": "what?"}))[1]
        return (await client.complete(MESSAGES, stream=how == "streaming")).attempts
    finally:
        await client.close()


async def failure_of(work: Callable[[], Awaitable[object]]) -> ServerFailure:
    with pytest.raises(ServerFailure) as caught:
        await work()
    told = "".join(traceback.format_exception(caught.value)) + repr(caught.value) + repr(vars(caught.value))
    assert KEY not in told
    return caught.value


@pytest.mark.parametrize(
    ("fault", "how"),
    [(fault, how) for fault in FAULTS for how in ("whole", "streaming", "json") if how != "json" or not fault.chat_only],
    ids=lambda value: value.name if isinstance(value, Fault) else value,
)
async def test_each_misbehaviour_has_its_kind(fault: Fault, how: str) -> None:
    with Misbehaving(then=fault.make()) as server:
        failure = await failure_of(lambda: ask(endpoint(server.url, timeouts=fault.timeouts), how))
    assert failure.kind is fault.expected(how == "streaming")
    assert {attempt.kind for attempt in failure.history} == {failure.kind}
    assert count_failures(failure.history) == {failure.kind.value: len(server.requests)}
    assert server.url in str(failure)
    assert len(str(failure)) < 700
    assert "\n" not in str(failure)


@pytest.mark.parametrize("how", ["whole", "streaming", "json"])
async def test_refused(how: str) -> None:
    with nobody_listens() as url:
        failure = await failure_of(lambda: ask(endpoint(url), how))
    assert failure.kind is FailureKind.REFUSED


@pytest.mark.parametrize("how", ["whole", "json"])
async def test_connect_timeout(how: str) -> None:
    with never_accepts() as url:
        failure = await failure_of(lambda: ask(endpoint(url, timeouts=Timeouts(connect_s=0.2, total_s=5)), how))
    assert failure.kind is FailureKind.CONNECT_TIMEOUT


@pytest.mark.parametrize("how", ["whole", "json"])
async def test_unknown_hosts(how: str) -> None:
    failure = await failure_of(lambda: ask(endpoint("http://model-server.invalid/v1"), how))
    assert failure.kind is FailureKind.DNS
    assert "model-server.invalid" in str(failure)


@pytest.mark.parametrize("how", ["whole", "json"])
async def test_https_to_a_server_without_tls(how: str) -> None:
    with speaks_no_tls() as url:
        failure = await failure_of(lambda: ask(endpoint(url), how))
    assert failure.kind is FailureKind.TLS


@pytest.mark.parametrize("how", ["whole", "streaming", "json"])
async def test_retries_repair_temporary_failures(how: str) -> None:
    for fault in FAULTS:
        if fault.name not in ("429", "503", "connection reset", "cut off", "invalid JSON", "200 with an error body"):
            continue
        with Misbehaving([fault.make()]) as server:
            at = endpoint(server.url, retries=1)
            attempts = await ask(at, how, Caller(at, sleep=_no_sleep))
        assert [attempt.kind for attempt in attempts] == [fault.expected(how == "streaming"), None]
        assert count_failures(attempts) == {fault.expected(how == "streaming").value: 1}


async def _no_sleep(_: float) -> None:
    return None


@pytest.mark.parametrize(
    "words",
    [
        "This model's maximum context length is 4096 tokens. However, you requested 5000 tokens.",
        "The input (5000 tokens) is longer than the model's context length (4096 tokens).",
        "the request exceeds the available context size. try increasing the context size or enable context shift",
        "Trying to keep the first 5000 tokens when context the overflows. However, the model has a context length of only 4096",
        "`inputs` must have less than 4096 tokens. The prompt is too long",
        {"error": {"message": "Too big.", "code": "context_length_exceeded"}},
        {"error": {"message": "No.", "type": "exceed_context_size_error"}},
    ],
)
async def test_context_overflow_is_recognised_for_every_server(words: Any) -> None:

    inside = json.dumps(words if isinstance(words, dict) else {"error": words})
    with Misbehaving([status(400, words), body(inside)]) as server:
        for _ in range(2):
            failure = await failure_of(lambda: ask(endpoint(server.url), "whole"))
            assert failure.kind is FailureKind.CONTEXT_OVERFLOW
