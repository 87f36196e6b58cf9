"""Randomly damaged replies: a run ends with a typed outcome that blames the server, not the camera."""

from __future__ import annotations

import json
import random
from typing import Any

import pytest

from scope_ptz.agent.loop import Agent
from scope_ptz.agent.records import Called, RunResult
from scope_ptz.agent.store import NoImages
from scope_ptz.endpoints.endpoint import Endpoint
from scope_ptz.perception.backends import make_backend
from scope_ptz.perception.backends.spec import BackendSpec
from scope_ptz.perception.base import Perception
from scope_ptz.planner.base import Planner
from scope_ptz.planner.chat.planner import ChatOptions, ChatPlanner
from tests.agent.scripted import ScriptedCamera, ScriptedPerception, ScriptedPlanner, answer, calls
from tests.support.misbehaving import MOONDREAM, Behaviour, Exchange, Misbehaving, Say, body, completion, pieces

pytestmark = pytest.mark.anyio

ROUNDS = 60
ODD: list[Any] = [
    None,
    True,
    -1,
    0,
    10**30,
    1e308,
    float("nan"),
    float("-inf"),
    "",
    "\ud800",
    "NaN",
    "\x00",
    [],
    {},
    [[]],
    [None],
    {"a": 1},
]
SPOKEN = Say("Turning.", "hm", (("adjust_ptz", {"pan_deg": 15.0}), ("count_objects", {"description": "cones"})))
PLACES = Say(json.dumps([{"bbox_2d": [10, 10, 20, 30], "label": "cone"}, {"bbox_2d": [40, 10, 60, 30], "label": "cone"}]))


def damaged(value: Any, rng: random.Random) -> Any:
    """Return the JSON with one value replaced, removed or duplicated."""
    if not isinstance(value, dict | list) or not value or rng.random() < 0.15:
        return rng.choice(ODD)
    spots: list[Any] = list(value) if isinstance(value, dict) else list(range(len(value)))
    spot, copy = rng.choice(spots), value.copy()
    what = rng.random()
    if what < 0.1:
        del copy[spot]
    elif what < 0.2 and isinstance(copy, list):
        copy.extend(copy * 40)
    else:
        copy[spot] = damaged(copy[spot], rng)
    return copy


def damage_bytes(data: bytes, rng: random.Random) -> bytes:
    """Return the bytes truncated or with some of them changed."""
    if rng.random() < 0.4:
        return data[: rng.randrange(len(data))]
    changed = bytearray(data)
    for _ in range(rng.randrange(1, 6)):
        changed[rng.randrange(len(changed))] = rng.randrange(256)
    return bytes(changed)


def damage_body(data: Any, rng: random.Random) -> bytes:
    if rng.random() < 0.7:
        return json.dumps(damaged(data, rng)).encode()
    return damage_bytes(json.dumps(data).encode(), rng)


def damaged_chat(say: Say, rng: random.Random) -> Behaviour:
    """A damaged completion, or a stream with one damaged chunk."""

    async def behave(x: Exchange) -> None:
        if not x.request.streaming:
            await x.whole(damage_body(completion(say), rng))
            return
        chunks = [json.dumps(piece).encode() for piece in pieces(say)]
        index = rng.randrange(len(chunks))
        chunks[index] = damage_body(json.loads(chunks[index]), rng).replace(b"\n", b" ")
        await x.whole(b"".join(b"data: %s\n\n" % chunk for chunk in [*chunks, b"[DONE]"]), content_type="text/event-stream")

    return behave


async def run(planner: Planner, perception: Perception) -> tuple[RunResult, list[Called]]:
    records: list[Any] = []
    try:
        done = await Agent(planner, ScriptedCamera(), perception, NoImages()).run("count the cones", listener=records.append)
    finally:
        await planner.close()
        await perception.close()
    for record in records:
        record.model_dump_json().encode()
    return done, [record for record in records if isinstance(record, Called)]


@pytest.mark.parametrize("stream", [False, True], ids=["whole", "streaming"])
async def test_planners(stream: bool) -> None:
    rng = random.Random(5)
    with Misbehaving(then=damaged_chat(SPOKEN, rng)) as server:
        for _ in range(ROUNDS):
            at = Endpoint(url=server.url, model="m", retries=0)
            planner = ChatPlanner(at, ChatOptions(stream=stream))
            done, made = await run(planner, ScriptedPerception(2))
            assert done.ended.outcome in ("answered", "clarification", "planner_error", "step_limit")
            assert done.ended.outcome != "planner_error" or done.ended.kind is not None, done.ended.text
            assert all(call.fault in (None, "bad_call", "skipped") for call in made)


@pytest.mark.parametrize("tool", ["count_objects", "zoom_to_object", "query_answer"])
@pytest.mark.parametrize("backend", ["moondream", "openai_vision"])
async def test_perception_backends(backend: str, tool: str) -> None:
    rng = random.Random(6)
    call = (tool, {"question": "what is it?"} if tool == "query_answer" else {"description": "cones"})

    async def moondream(x: Exchange) -> None:
        await body(damage_body(MOONDREAM[x.request.path.rpartition("/")[2]], rng))(x)

    async def chat(x: Exchange) -> None:
        words = PLACES.text if rng.random() < 0.3 else damage_body(json.loads(PLACES.text), rng).decode("utf-8", "replace")
        await (damaged_chat(PLACES, rng) if rng.random() < 0.4 else body(json.dumps(completion(Say(words)))))(x)

    with Misbehaving(then=moondream if backend == "moondream" else chat) as server:
        spec = BackendSpec(name="eyes", backend=backend, model="m", endpoint=Endpoint(url=server.url, retries=0))
        for _ in range(ROUNDS):
            planner = ScriptedPlanner(calls(call), answer("So."))
            done, made = await run(planner, make_backend(spec))
            assert done.ended.outcome == "answered", done.ended.detail
            (made_call,) = made
            assert made_call.fault in (None, "perception")
            assert (made_call.outcome.error is None) == (made_call.fault is None)
            assert made_call.fault is None or done.ended.server_events, made_call.outcome.error
