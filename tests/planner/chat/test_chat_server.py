"""The agent with a chat planner over HTTP, streaming and not, with valid and invalid replies."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

import pytest
from pydantic import SecretStr

from scope_ptz.agent.loop import Agent
from scope_ptz.agent.records import Budgets, Decided, RunResult, Started
from scope_ptz.agent.store import NoImages
from scope_ptz.endpoints.endpoint import Endpoint, Timeouts
from scope_ptz.planner.chat import ChatOptions, ChatPlanner
from tests.agent.scripted import ScriptedCamera, ScriptedPerception
from tests.support.misbehaving import Behaviour, Misbehaving, Request, Say, good, nobody_listens, say, status

pytestmark = pytest.mark.anyio

KEY = "sk-very-secret-0123456789"
TURN = ("adjust_ptz", {"pan_deg": 15})
LOOK = ("count_objects", {"description": "cones"})


async def ask(
    url: str, *, instruction: str = "find the cones", counts: Sequence[int] = (4,), records: list[Any] | None = None, **options: Any
) -> RunResult:
    patience = Timeouts(first_byte_s=5, total_s=10)
    endpoint = Endpoint(url=url, model=options.pop("model", "m"), key=SecretStr(KEY), retries=1, timeouts=patience)
    planner = ChatPlanner(endpoint, ChatOptions(**options))
    agent = Agent(planner, ScriptedCamera(), ScriptedPerception(*counts), NoImages(), budgets=Budgets(max_steps=20))
    kept: list[Any] = [] if records is None else records
    try:
        run = await agent.run(instruction, listener=kept.append)
    finally:
        await planner.close()
    written = "".join(record.model_dump_json() for record in kept)
    assert KEY not in written
    json.loads(kept[-1].model_dump_json())
    return run


def by_steps(*says: Say) -> Behaviour:
    """A scripted model that depends on the number of its earlier messages, so that retries do not matter."""

    def scripted_model(request: Request) -> Say:
        spoken = [message["role"] for message in request.data["messages"]].count("assistant")
        return says[min(spoken, len(says) - 1)]

    return good(scripted_model)


@pytest.mark.parametrize("stream", [True, False])
async def test_a_complete_run(stream: bool) -> None:
    records: list[Any] = []
    looking = Say("", "Now I look.", tool_calls=(LOOK, ("get_presets", {})))
    scripted_model = by_steps(Say("I turn.", tool_calls=(TURN,)), looking, Say("<think>4</think>Four cones."))
    with Misbehaving(then=scripted_model) as server:
        run = await ask(server.url, records=records, stream=stream)
        sent = [request.data for request in server.requests]
        assert server.connections == 1
    assert (run.ended.outcome, run.ended.text, run.ended.steps) == ("answered", "Four cones.", 3)
    assert [o.call.name for e in run.exchanges for o in e.outcomes] == ["adjust_ptz", "count_objects", "get_presets"]
    assert run.ended.pose.pan_deg == 15.0
    assert run.ended.server_events == {}
    assert (run.ended.usage.input_tokens, run.ended.usage.output_tokens, run.ended.usage.cached_tokens) == (33, 21, 12)
    assert (0 < run.ended.timings.first_token_s <= run.ended.timings.planner_s) if stream else run.ended.timings.first_token_s == 0
    # Requests are append-only and have no fields that only some servers know.
    for before, after in pairwise(sent):
        assert after["messages"][: len(before["messages"])] == before["messages"]
        assert after["tools"] == before["tools"]
    assert set(sent[0]) <= {"model", "messages", "tools", "stream", "stream_options", "temperature"}
    # Reasoning is stored in the trace only.
    decisions = [r.decision for r in records if isinstance(r, Decided)]
    assert [d.reasoning for d in decisions] == ["", "Now I look.", "4"]
    assert "Now I look." not in json.dumps(sent[-1])
    header = records[0]
    assert isinstance(header, Started)
    assert header.planner_details["prompt"] == "standard-1"


@pytest.mark.parametrize("stream", [True, False])
async def test_tokens_of_unusable_replies_are_counted(stream: bool) -> None:
    with Misbehaving([good(Say(text=""))], then=good(Say("Done."))) as server:
        mended = await ask(server.url, stream=stream)
    with Misbehaving(then=good(Say(text=""))) as server:
        in_vain = await ask(server.url, stream=stream)
    with Misbehaving(then=good(Say(text="<think>so</think>"))) as server:
        thought = await ask(server.url, stream=stream)
    assert (mended.ended.outcome, in_vain.ended.outcome, thought.ended.outcome) == ("answered", "planner_error", "planner_error")
    # Each reply has 11 input and 7 output tokens. An empty reply is requested again once; a reply with only reasoning is not.
    for run, replies in ((mended, 2), (in_vain, 2), (thought, 1)):
        assert (run.ended.usage.input_tokens, run.ended.usage.output_tokens) == (11 * replies, 7 * replies)


@pytest.mark.parametrize("stream", [True, False])
@pytest.mark.parametrize(
    "text",
    [
        '<tool_call>\n{"name": "adjust_ptz", "arguments": {"pan_deg": 15}}\n</tool_call>',
        "<tool_call><function=adjust_ptz><parameter=pan_deg>15</parameter></function></tool_call>",
        '```json\n{"name": "adjust_ptz", "arguments": {"pan_deg": 15}}\n```',
    ],
)
async def test_calls_that_are_sent_as_text(text: str, stream: bool) -> None:
    with Misbehaving(then=by_steps(Say(text), Say("Done."))) as server:
        run = await ask(server.url, stream=stream)
        assert server.requests[-1].data["messages"][2]["tool_calls"][0]["function"]["name"] == "adjust_ptz"
    assert (run.ended.outcome, run.ended.pose.pan_deg, run.ended.bad_calls) == ("answered", 15.0, 0)


@pytest.mark.parametrize("stream", [True, False])
@pytest.mark.parametrize(
    ("call", "words"),
    [
        (("adjust_ptz", '{"pan_deg": 15'), "JSON"),
        (("adjust_ptz", "turn right"), "JSON"),
        (("adjust_ptz", '{"pan_deg": NaN}'), "JSON"),
        (("adjust_ptz", '{"pan_deg": -Infinity}'), "JSON"),
        (("adjust_ptz", {"pan_deg": "15"}), "pan_deg"),
        (("adjust_ptz", {"pan_deg": [15]}), "pan_deg"),
        (("adjust_ptz", {"speed": 15}), "speed"),
        (("turn_head", {}), "no tool"),
        (("go_to_preset", {"name": "../../etc/passwd"}), "no preset"),
    ],
)
async def test_the_planner_is_told_about_wrong_calls(call: tuple[str, Any], words: str, stream: bool) -> None:
    with Misbehaving(then=by_steps(Say(tool_calls=(call,)), Say(tool_calls=(TURN,)), Say("Done."))) as server:
        run = await ask(server.url, stream=stream)
        told = server.requests[1].data["messages"][-1]
    assert (run.ended.outcome, run.ended.bad_calls, run.ended.pose.pan_deg) == ("answered", 1, 15.0)
    assert told["role"] == "tool"
    assert words in json.loads(told["content"])["error"]


async def test_failures_repaired_by_a_retry_are_counted() -> None:
    with Misbehaving([status(503), say("", TURN), status(429, headers={"Retry-After": "0"})], then=say("Done.")) as server:
        run = await ask(server.url)
    assert (run.ended.outcome, run.ended.server_events) == ("answered", {"rate-limited": 1, "server-error": 1})


async def test_an_unreachable_server_is_an_outcome() -> None:
    with nobody_listens() as url:
        run = await ask(url)
    assert (run.ended.outcome, run.ended.kind, run.ended.server_events) == ("planner_error", "refused", {"refused": 2})


async def test_a_server_without_tools_gets_their_descriptions_in_the_text() -> None:
    def scripted_model(request: Request) -> Say:
        last = request.data["messages"][-1]["content"]
        done = "<tool_response>" in last
        return Say("Done.") if done else Say('<tool_call>{"name": "adjust_ptz", "arguments": {"pan_deg": 15}}</tool_call>')

    refusal = status(400, '"auto" tool choice requires --enable-auto-tool-choice and --tool-call-parser to be set')
    with Misbehaving([refusal], then=good(scripted_model)) as server:
        run = await ask(server.url)
        assert ["tools" in request.data for request in server.requests] == [True, False, False]
        assert "<tools>" not in server.requests[0].data["messages"][0]["content"]
        assert '"adjust_ptz"' in server.requests[1].data["messages"][0]["content"]
    assert (run.ended.outcome, run.ended.pose.pan_deg) == ("answered", 15.0)
    assert run.ended.server_events == {"bad-request": 1}


async def test_fields_that_a_server_does_not_know_are_left_out() -> None:
    refusal = status(422, "Unexpected keys in the request: {'chat_template_kwargs'}")

    async def strict(x: Any) -> None:
        await (refusal if "chat_template_kwargs" in x.request.data else say("Done."))(x)

    with Misbehaving(then=strict) as server:
        run = await ask(server.url, model="Qwen/Qwen3-32B", thinking="off")
        first, second = server.requests[0].data, server.requests[-1].data
    assert first["chat_template_kwargs"] == {"enable_thinking": False}
    assert "chat_template_kwargs" not in second
    assert second["messages"][-1]["content"].endswith("/no_think")
    assert run.ended.outcome == "answered"


OVERFLOW = status(400, "This model's maximum context length is 4096 tokens. Please reduce the length of the messages.")


def small_window(chars: int, behaviour: Behaviour) -> Behaviour:
    """A server whose model accepts this many characters of messages."""

    async def behave(x: Any) -> None:
        await (OVERFLOW if len(json.dumps(x.request.data["messages"])) > chars else behaviour)(x)

    return behave


LONG = Say(tool_calls=(("query_answer", {"question": "what is there?"}),))


class Talkative(ScriptedPerception):
    async def query(self, frame: Any, question: str) -> Any:
        answer = await super().query(frame, question)
        return answer.model_copy(update={"text": "a car and " * 150})


@pytest.mark.parametrize("summarise", [False, True])
async def test_a_full_context_is_an_outcome_or_old_observations_are_shortened(
    summarise: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tests.planner.chat.test_chat_server.ScriptedPerception", Talkative)
    scripted_model = by_steps(*[LONG] * 6, Say("A car."))
    with Misbehaving(then=small_window(12_000, scripted_model)) as server:
        run = await ask(server.url, summarise=summarise)
    if summarise:
        assert (run.ended.outcome, run.ended.kind) == ("answered", None)
        assert run.ended.server_events.keys() == {"context-overflow"}
    else:
        assert (run.ended.outcome, run.ended.kind) == ("planner_error", "context-overflow")
        assert "context" in run.ended.text


async def test_a_known_context_size_avoids_failing_requests(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tests.planner.chat.test_chat_server.ScriptedPerception", Talkative)
    with Misbehaving(then=small_window(13_500, by_steps(*[LONG] * 6, Say("A car.")))) as server:
        run = await ask(server.url, summarise=True, context_tokens=4096)
    assert (run.ended.outcome, run.ended.server_events) == ("answered", {})


@pytest.mark.parametrize("stream", [True, False])
async def test_a_planner_with_vision(stream: bool) -> None:
    records: list[Any] = []
    scripted_model = by_steps(Say(tool_calls=(("take_image", {}),)), Say(tool_calls=(TURN,)), Say("A grey wall."))
    with Misbehaving(then=scripted_model) as server:
        run = await ask(server.url, sees=True, stream=stream, records=records)
        sent = [request.data["messages"] for request in server.requests]
    assert run.ended.outcome == "answered"
    # The current view is the last image and the only view; the captured picture stays.
    assert [json.dumps(messages).count("data:image/jpeg;base64,") for messages in sent] == [1, 2, 2]
    assert [messages[-1]["role"] for messages in sent] == ["user"] * 3
    assert "pan 15" in sent[-1][-1]["content"][-2]["text"]
    assert "pan 0" in sent[0][-1]["content"][-2]["text"]
    assert "You see nothing" not in sent[0][0]["content"]
    assert all(r.view for r in records if isinstance(r, Decided))
    assert "base64" not in "".join(r.model_dump_json() for r in records)


@pytest.mark.parametrize(
    ("reply", "outcome"),
    [
        (Say("CLARIFY: Which one?"), "clarification"),
        (Say("REFUSE: It has no legs."), "refused"),
        (Say("Es sind vier Kegel."), "answered"),
    ],
)
async def test_final_replies_are_outcomes(reply: Say, outcome: str) -> None:
    with Misbehaving(then=good(reply)) as server:
        run = await ask(server.url)
    assert run.ended.outcome == outcome


async def test_only_reasoning_is_an_error() -> None:
    with Misbehaving(then=good(Say("", reasoning="I think and think."))) as server:
        run = await ask(server.url)
    assert (run.ended.outcome, run.ended.kind, run.ended.server_events) == ("planner_error", "empty", {"empty": 1})


async def test_unprintable_characters_do_not_break_the_trace() -> None:
    odd: Callable[[Request], Say] = lambda _: Say("\ud83d Four \x00 cones.")  # noqa: E731
    with Misbehaving(then=good(odd)) as server:
        run = await ask(server.url, stream=False)
    assert run.ended.outcome == "answered"
