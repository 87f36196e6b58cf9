"""Judges over HTTP: verdicts, retries, servers without schemas, and misbehaving servers."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import anyio
import pytest
from pydantic import SecretStr

from scope_ptz.bench.judging.judge import Completion, Judge, NoReplyError
from scope_ptz.bench.judging.rendering import MIN_CHARS
from scope_ptz.bench.judging.rubrics import prompt_version
from scope_ptz.bench.judging.server import JudgeModelOptions, JudgeServer
from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.bench.scoring.trials import Judgement
from scope_ptz.endpoints.endpoint import Endpoint, Timeouts
from tests.bench.judging.runs import CORRECT, MISCOUNTED, facts_and_case, json_text, long_case
from tests.support import misbehaving as m

SHORT_TIMEOUTS = Timeouts(connect_s=5.0, first_byte_s=0.4, total_s=1.0)
KEY = "sk-judge-0123456789"


def judgement_from(url: str, *, timeouts: Timeouts | None = None, retries: int = 0, **options: Any) -> Judgement:
    """Return the judgement of the server at a URL on a run that passes."""
    endpoint = Endpoint(url=url, model="gpt-oss-120b", key=SecretStr(KEY), timeouts=timeouts or Timeouts(), retries=retries)

    async def ask() -> Judgement:
        port = JudgeServer(endpoint, JudgeModelOptions.model_validate(options))
        try:
            return await Judge("gpt-oss-120b", port).judge_case(*facts_and_case())
        finally:
            await port.close()

    return anyio.run(ask)


def reply_with(content: Any) -> m.Behaviour:
    return m.good(m.Say(content if isinstance(content, str) else json_text(content)))


def test_a_verdict_in_the_requested_format() -> None:
    with m.Misbehaving([reply_with(MISCOUNTED)]) as server:
        judgement = judgement_from(server.url)
    assert (judgement.verdict, judgement.error_mode, judgement.attempts) == ("incorrect", ErrorMode.VLM_COUNTING, 1)
    assert (judgement.judge, judgement.prompt) == ("gpt-oss-120b", prompt_version())
    assert (judgement.input_tokens, judgement.output_tokens) == (11, 7)
    assert judgement.latency_s > 0
    (request,) = server.requests
    assert request.data["temperature"] == 0
    assert request.data["seed"] == 1
    assert request.data["response_format"]["type"] == "json_schema"
    assert request.data["response_format"]["json_schema"]["schema"]["required"] == ["reason", "verdict", "error_mode"]
    assert request.headers["authorization"] == f"Bearer {KEY}"
    assert [message["role"] for message in request.data["messages"]] == ["system", "user"]
    assert "reasoning_effort" not in request.data


def test_an_invalid_reply_is_returned_with_the_error_and_the_next_one_counts() -> None:
    with m.Misbehaving([reply_with({**CORRECT, "error_mode": "scope"}), reply_with("Correct!"), reply_with(CORRECT)]) as server:
        judgement = judgement_from(server.url)
    assert (judgement.verdict, judgement.error_mode, judgement.attempts) == ("correct", None, 3)
    assert judgement.input_tokens == 33
    second = server.requests[1].data["messages"]
    assert [message["role"] for message in second] == ["system", "user", "assistant", "user"]
    assert "a correct run has no error mode" in second[3]["content"]
    assert len(server.requests[2].data["messages"]) == 4


GARBAGE: list[tuple[str, Callable[[], m.Behaviour]]] = [
    ("words", lambda: reply_with("The agent did well.")),
    ("truncated verdict", lambda: reply_with(json_text(CORRECT)[:40])),
    ("nothing", m.empty_choices),
    ("an empty message", lambda: m.say("")),
    ("only reasoning", lambda: m.good(m.Say("", reasoning=json_text(CORRECT)))),
    ("verdict while thinking", lambda: reply_with(f"<think>{json_text(CORRECT)}</think>I am not sure.")),
    ("truncated reply", lambda: m.good(m.Say(json_text(CORRECT), finish_reason="length"))),
    ("a correct run with an error mode", lambda: reply_with({**CORRECT, "error_mode": "scope"})),
    ("an incorrect run without an error mode", lambda: reply_with({**MISCOUNTED, "error_mode": "none"})),
]


@pytest.mark.parametrize("name", [name for name, _ in GARBAGE])
def test_replies_that_stay_invalid_are_unparseable(name: str) -> None:
    with m.Misbehaving(then=dict(GARBAGE)[name]()) as server:
        judgement = judgement_from(server.url)
    assert (judgement.verdict, judgement.error_mode) == ("unparseable", None)
    assert judgement.attempts == 3
    assert judgement.reason


BROKEN: list[tuple[str, Callable[[], m.Behaviour]]] = [
    ("401", m.echo_key),
    ("429", lambda: m.status(429)),
    ("500", lambda: m.status(500)),
    ("error in success", m.error_in_success),
    ("reset", m.reset),
    ("cut off", m.cut_off),
    ("stalls", m.stalls),
    ("silent", m.slow_first_byte),
    ("trickle", m.trickle),
    ("a web page", m.wrong_type),
    ("invalid JSON", m.malformed),
    ("another protocol", m.not_http),
    ("elsewhere", lambda: m.redirect("http://127.0.0.1:9/v1")),
]


@pytest.mark.parametrize("name", [name for name, _ in BROKEN])
def test_a_failing_server_gives_a_failed_judgement(name: str) -> None:
    with m.Misbehaving(then=dict(BROKEN)[name]()) as server:
        judgement = judgement_from(server.url, timeouts=SHORT_TIMEOUTS)
    assert (judgement.verdict, judgement.error_mode) == ("failed", None)
    assert "The model server at" in judgement.reason
    assert KEY not in judgement.model_dump_json()


def test_an_unreachable_server() -> None:
    with m.nobody_listens() as url:
        assert judgement_from(url).verdict == "failed"


def test_a_temporary_failure_is_retried() -> None:
    script = [m.status(429, headers={"Retry-After": "0"}), m.reset(), reply_with(MISCOUNTED)]
    with m.Misbehaving(script) as server:
        assert judgement_from(server.url, retries=3).error_mode is ErrorMode.VLM_COUNTING


def no_schema(x: m.Exchange) -> Any:
    """A server that supports JSON mode but not schemas."""
    form = x.request.data.get("response_format", {}).get("type")
    return m.status(400, "response_format json_schema is not supported")(x) if form == "json_schema" else reply_with(CORRECT)(x)


def no_response_format(x: m.Exchange) -> Any:
    """A server that refuses the field ``response_format`` without naming it."""
    return m.status(422, {"detail": "extra"})(x) if "response_format" in x.request.data else reply_with(CORRECT)(x)


def no_seed(x: m.Exchange) -> Any:
    return m.status(400, "Unrecognized request argument: seed")(x) if "seed" in x.request.data else reply_with(CORRECT)(x)


def no_system(x: m.Exchange) -> Any:
    roles = [message["role"] for message in x.request.data["messages"]]
    return m.status(400, "System role not supported")(x) if "system" in roles else reply_with(CORRECT)(x)


def silent_with_format(x: m.Exchange) -> Any:
    return m.say("")(x) if "response_format" in x.request.data else reply_with(CORRECT)(x)


@pytest.mark.parametrize(
    ("behave", "requests"), [(no_schema, 2), (no_response_format, 3), (no_seed, 2), (no_system, 2), (silent_with_format, 3)]
)
def test_servers_that_support_fewer_fields(behave: m.Behaviour, requests: int) -> None:
    with m.Misbehaving(then=behave) as server:
        assert judgement_from(server.url).verdict == "correct"
    assert len(server.requests) == requests


def test_refused_fields_are_not_sent_again() -> None:
    async def twice(url: str) -> None:
        port = JudgeServer(Endpoint(url=url, model="x", retries=0))
        for repeat in range(2):
            judgement = await Judge("x", port.for_repeat(repeat)).judge_case(*facts_and_case(), repeat=repeat)
            assert (judgement.verdict, judgement.repeat) == ("correct", repeat)
            judgement = await Judge("x", port).judge_case(*facts_and_case())
            assert judgement.verdict == "correct"
        await port.close()

    with m.Misbehaving(then=no_schema) as server:
        anyio.run(twice, server.url)
    kinds = [request.data["response_format"]["type"] for request in server.requests]
    assert kinds == ["json_schema", "json_object", "json_object", "json_object", "json_object"]
    assert [request.data["seed"] for request in server.requests] == [1, 1, 1, 2, 1]


def test_a_small_context_gets_a_shortened_run() -> None:
    def small_window(x: m.Exchange) -> Any:
        long = len(x.request.data["messages"][1]["content"]) > MIN_CHARS * 2
        return m.status(400, "maximum context length is 4096 tokens")(x) if long else reply_with(CORRECT)(x)

    facts, _ = facts_and_case()

    async def ask(url: str) -> Judgement:
        port = JudgeServer(Endpoint(url=url, model="x", retries=0))
        try:
            return await Judge("x", port).judge_case(facts, long_case(400, 2000))
        finally:
            await port.close()

    with m.Misbehaving(then=small_window) as server:
        judgement = anyio.run(ask, server.url)
    assert judgement.verdict == "correct"
    sizes = [len(request.data["messages"][1]["content"]) for request in server.requests]
    assert sizes == sorted(sizes, reverse=True)
    assert judgement.attempts == len(sizes) > 1


def test_a_context_that_is_too_small_is_a_failure() -> None:
    with m.Misbehaving(then=m.status(400, "maximum context length is 16 tokens")) as server:
        judgement = judgement_from(server.url)
    assert judgement.verdict == "failed"
    assert "context" in judgement.reason


def test_a_custom_judge_client() -> None:
    """The evaluation engine passes its own client to judges."""

    async def port(messages: list[dict[str, Any]], schema: dict[str, Any]) -> Completion:
        assert schema["type"] == "object"
        return Completion(text=json.dumps(CORRECT), input_tokens=3)

    async def failing_port(messages: list[dict[str, Any]], schema: dict[str, Any]) -> Completion:
        raise NoReplyError("gone")

    async def both() -> tuple[Judgement, Judgement]:
        return await Judge("a", port).judge_case(*facts_and_case()), await Judge("b", failing_port).judge_case(*facts_and_case())

    one, two = anyio.run(both)
    assert (one.verdict, one.input_tokens) == ("correct", 3)
    assert (two.verdict, two.reason, two.attempts) == ("failed", "gone", 1)
