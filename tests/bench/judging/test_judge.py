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
from tests.bench.judging.runs import CORRECT, MISCOUNTED, facts_and_case, long_case, written
from tests.support import misbehaving as m

IMPATIENT = Timeouts(connect_s=5.0, first_byte_s=0.4, total_s=1.0)
KEY = "sk-judge-0123456789"


def judged(url: str, *, timeouts: Timeouts | None = None, retries: int = 0, **options: Any) -> Judgement:
    """Return the judgement of the server at a URL on a run that passes."""
    endpoint = Endpoint(url=url, model="gpt-oss-120b", key=SecretStr(KEY), timeouts=timeouts or Timeouts(), retries=retries)

    async def ask() -> Judgement:
        port = JudgeServer(endpoint, JudgeModelOptions.model_validate(options))
        try:
            return await Judge("gpt-oss-120b", port).judge_case(*facts_and_case())
        finally:
            await port.close()

    return anyio.run(ask)


def says(content: Any) -> m.Behaviour:
    return m.good(m.Say(content if isinstance(content, str) else written(content)))


def test_a_verdict_in_the_requested_format() -> None:
    with m.Misbehaving([says(MISCOUNTED)]) as server:
        made = judged(server.url)
    assert (made.verdict, made.error_mode, made.attempts) == ("incorrect", ErrorMode.VLM_COUNTING, 1)
    assert (made.judge, made.prompt) == ("gpt-oss-120b", prompt_version())
    assert (made.input_tokens, made.output_tokens) == (11, 7)
    assert made.latency_s > 0
    (request,) = server.requests
    assert request.data["temperature"] == 0
    assert request.data["seed"] == 1
    assert request.data["response_format"]["type"] == "json_schema"
    assert request.data["response_format"]["json_schema"]["schema"]["required"] == ["reason", "verdict", "error_mode"]
    assert request.headers["authorization"] == f"Bearer {KEY}"
    assert [message["role"] for message in request.data["messages"]] == ["system", "user"]
    assert "reasoning_effort" not in request.data


def test_an_invalid_reply_is_returned_with_the_error_and_the_next_one_counts() -> None:
    with m.Misbehaving([says({**CORRECT, "error_mode": "scope"}), says("Correct!"), says(CORRECT)]) as server:
        made = judged(server.url)
    assert (made.verdict, made.error_mode, made.attempts) == ("correct", None, 3)
    assert made.input_tokens == 33
    second = server.requests[1].data["messages"]
    assert [message["role"] for message in second] == ["system", "user", "assistant", "user"]
    assert "a correct run has no error mode" in second[3]["content"]
    assert len(server.requests[2].data["messages"]) == 4


GARBAGE: list[tuple[str, Callable[[], m.Behaviour]]] = [
    ("words", lambda: says("The agent did well.")),
    ("half a verdict", lambda: says(written(CORRECT)[:40])),
    ("nothing", m.empty_choices),
    ("an empty message", lambda: m.say("")),
    ("thoughts alone", lambda: m.good(m.Say("", reasoning=written(CORRECT)))),
    ("verdict while thinking", lambda: says(f"<think>{written(CORRECT)}</think>I am not sure.")),
    ("a reply without end", lambda: m.good(m.Say(written(CORRECT), finish_reason="length"))),
    ("a correct run with an error mode", lambda: says({**CORRECT, "error_mode": "scope"})),
    ("an incorrect run without one", lambda: says({**MISCOUNTED, "error_mode": "none"})),
]


@pytest.mark.parametrize("name", [name for name, _ in GARBAGE])
def test_replies_that_stay_invalid_are_unparseable(name: str) -> None:
    with m.Misbehaving(then=dict(GARBAGE)[name]()) as server:
        made = judged(server.url)
    assert (made.verdict, made.error_mode) == ("unparseable", None)
    assert made.attempts == 3
    assert made.reason


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
    ("no JSON", m.malformed),
    ("another protocol", m.not_http),
    ("elsewhere", lambda: m.redirect("http://127.0.0.1:9/v1")),
]


@pytest.mark.parametrize("name", [name for name, _ in BROKEN])
def test_a_server_that_never_answers_is_failed(name: str) -> None:
    with m.Misbehaving(then=dict(BROKEN)[name]()) as server:
        made = judged(server.url, timeouts=IMPATIENT)
    assert (made.verdict, made.error_mode) == ("failed", None)
    assert "The model server at" in made.reason
    assert KEY not in made.model_dump_json()


def test_an_unreachable_server() -> None:
    with m.nobody_listens() as url:
        assert judged(url).verdict == "failed"


def test_a_temporary_failure_is_retried() -> None:
    script = [m.status(429, headers={"Retry-After": "0"}), m.reset(), says(MISCOUNTED)]
    with m.Misbehaving(script) as server:
        assert judged(server.url, retries=3).error_mode is ErrorMode.VLM_COUNTING


def no_schema(x: m.Exchange) -> Any:
    """A server that supports JSON mode but not schemas."""
    form = x.request.data.get("response_format", {}).get("type")
    return m.status(400, "response_format json_schema is not supported")(x) if form == "json_schema" else says(CORRECT)(x)


def free_only(x: m.Exchange) -> Any:
    """A server that refuses the field ``response_format`` without naming it."""
    return m.status(422, {"detail": "extra"})(x) if "response_format" in x.request.data else says(CORRECT)(x)


def no_seed(x: m.Exchange) -> Any:
    return m.status(400, "Unrecognized request argument: seed")(x) if "seed" in x.request.data else says(CORRECT)(x)


def no_system(x: m.Exchange) -> Any:
    roles = [message["role"] for message in x.request.data["messages"]]
    return m.status(400, "System role not supported")(x) if "system" in roles else says(CORRECT)(x)


def silent_when_bound(x: m.Exchange) -> Any:
    return m.say("")(x) if "response_format" in x.request.data else says(CORRECT)(x)


@pytest.mark.parametrize(
    ("behave", "requests"), [(no_schema, 2), (free_only, 3), (no_seed, 2), (no_system, 2), (silent_when_bound, 3)]
)
def test_servers_that_support_fewer_fields(behave: m.Behaviour, requests: int) -> None:
    with m.Misbehaving(then=behave) as server:
        assert judged(server.url).verdict == "correct"
    assert len(server.requests) == requests


def test_refused_fields_are_not_sent_again() -> None:
    async def twice(url: str) -> None:
        port = JudgeServer(Endpoint(url=url, model="x", retries=0))
        for repeat in range(2):
            made = await Judge("x", port.for_repeat(repeat)).judge_case(*facts_and_case(), repeat=repeat)
            assert (made.verdict, made.repeat) == ("correct", repeat)
            made = await Judge("x", port).judge_case(*facts_and_case())
            assert made.verdict == "correct"
        await port.close()

    with m.Misbehaving(then=no_schema) as server:
        anyio.run(twice, server.url)
    kinds = [request.data["response_format"]["type"] for request in server.requests]
    assert kinds == ["json_schema", "json_object", "json_object", "json_object", "json_object"]
    assert [request.data["seed"] for request in server.requests] == [1, 1, 1, 2, 1]


def test_a_small_context_gets_a_shortened_run() -> None:
    def small_window(x: m.Exchange) -> Any:
        long = len(x.request.data["messages"][1]["content"]) > MIN_CHARS * 2
        return m.status(400, "maximum context length is 4096 tokens")(x) if long else says(CORRECT)(x)

    facts, _ = facts_and_case()

    async def ask(url: str) -> Judgement:
        port = JudgeServer(Endpoint(url=url, model="x", retries=0))
        try:
            return await Judge("x", port).judge_case(facts, long_case(400, 2000))
        finally:
            await port.close()

    with m.Misbehaving(then=small_window) as server:
        made = anyio.run(ask, server.url)
    assert made.verdict == "correct"
    sizes = [len(request.data["messages"][1]["content"]) for request in server.requests]
    assert sizes == sorted(sizes, reverse=True)
    assert made.attempts == len(sizes) > 1


def test_a_context_that_is_too_small_is_a_failure() -> None:
    with m.Misbehaving(then=m.status(400, "maximum context length is 16 tokens")) as server:
        made = judged(server.url)
    assert made.verdict == "failed"
    assert "context" in made.reason


def test_a_custom_judge_client() -> None:
    """The evaluation engine passes judges a client of its own."""

    async def port(messages: list[dict[str, Any]], schema: dict[str, Any]) -> Completion:
        assert schema["type"] == "object"
        return Completion(text=json.dumps(CORRECT), input_tokens=3)

    async def none(messages: list[dict[str, Any]], schema: dict[str, Any]) -> Completion:
        raise NoReplyError("gone")

    async def both() -> tuple[Judgement, Judgement]:
        return await Judge("a", port).judge_case(*facts_and_case()), await Judge("b", none).judge_case(*facts_and_case())

    one, two = anyio.run(both)
    assert (one.verdict, one.input_tokens) == ("correct", 3)
    assert (two.verdict, two.reason, two.attempts) == ("failed", "gone", 1)
