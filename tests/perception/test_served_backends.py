"""Moondream and OpenAI-compatible vision models behind HTTP servers, including misbehaving ones."""

from __future__ import annotations

import base64
import json
import math
from collections.abc import AsyncIterator, Iterable
from contextlib import asynccontextmanager
from typing import Any

import cv2
import numpy as np
import pytest

from scope_ptz.camera.base import Frame
from scope_ptz.endpoints.endpoint import Endpoint, Timeouts
from scope_ptz.errors import ConfigError, PerceptionError
from scope_ptz.perception.backends import make_backend
from scope_ptz.perception.backends.spec import BackendSpec
from scope_ptz.perception.base import Perception
from scope_ptz.perception.conformance import PerceptionConformance
from scope_ptz.perception.models.coordinates import CONVENTIONS, get_convention
from tests.perception import pictures
from tests.perception.test_coordinates import written
from tests.support import misbehaving as bad
from tests.support.misbehaving import Behaviour, Misbehaving, Request, Say

BACKENDS = ("moondream", "openai_vision")
KEY = "very-secret-key-0123456789"


# Long enough for a busy machine, and short for the servers that never answer.
PATIENT = Timeouts(connect_s=20.0, first_byte_s=20.0, total_s=40.0)
IMPATIENT = Timeouts(connect_s=20.0, first_byte_s=0.4, total_s=1.5)


def spec(url: str, backend: str, timeouts: Timeouts = PATIENT, **more: Any) -> BackendSpec:
    endpoint = Endpoint(url=url, model="a-model", key=KEY, timeouts=timeouts, retries=0)  # type: ignore[arg-type]
    return BackendSpec(name="eyes", backend=backend, endpoint=endpoint, **more)


@asynccontextmanager
async def opened(url: str, backend: str, **more: Any) -> AsyncIterator[Perception]:
    perception = make_backend(spec(url, backend, **more))
    try:
        yield perception
    finally:
        await perception.close()


def reply(backend: str, things: Any) -> Behaviour:
    """Return replies in both formats with the same objects, for detect and point."""
    if backend == "moondream":
        return bad.good(moondream={"detect": {"objects": things}, "point": {"points": things}})
    return bad.say(json.dumps(things))


def sent_image(request: Request) -> Any:
    """The picture (H, W, 3) that a request carries."""
    data = request.data
    url = data["image_url"] if "image_url" in data else data["messages"][0]["content"][0]["image_url"]["url"]
    head, _, body = url.partition(",")
    assert head == "data:image/jpeg;base64"
    return cv2.imdecode(np.frombuffer(base64.b64decode(body), np.uint8), cv2.IMREAD_COLOR_RGB)


def chat_model(convention: str) -> Any:
    """A model that finds an orange square in the second eighth of any picture and replies in one coordinate convention."""
    box = (0.25, 0.25, 0.5, 0.5)
    there = get_convention(convention)

    def scaled(numbers: tuple[float, ...], size: tuple[int, int]) -> list[float]:
        scale = {"unit": 1, "percent": 100}.get(there.space, 1000)
        factors = [*size, *size] if there.space == "pixels" else [scale] * 4
        values = [n * f for n, f in zip(numbers, factors, strict=False)]
        return [v for i in range(0, len(values), 2) for v in (values[i + 1], values[i])] if there.y_first else values

    def mind(request: Request) -> Say:
        image = sent_image(request)
        prompt = request.data["messages"][0]["content"][1]["text"]
        size = (image.shape[1], image.shape[0])
        if "unicorn" in prompt:
            return Say('```json\n{"objects": []}\n```')
        if prompt.startswith("Locate"):
            return Say("Sure!\n```json\n" + json.dumps([{there.box_key: scaled(box, size), "label": "thing"}]) + "\n```")
        if prompt.startswith("Point"):
            return Say(json.dumps({"objects": [{there.point_key: scaled((0.375, 0.375), size), "label": "thing"}]}))
        return Say("<think>hm</think>Yes, an orange one.")

    return mind


class _Served(PerceptionConformance):
    backend = "moondream"
    convention = "unit"

    @asynccontextmanager
    async def perception(self) -> AsyncIterator[Perception]:
        with Misbehaving(then=self.behave()) as server:
            async with opened(server.url, self.backend, coordinates=self.convention) as perception:
                yield perception

    def behave(self) -> Behaviour:
        return bad.good(chat_model(self.convention))

    def frame(self) -> Frame:
        return pictures.frame()


@pytest.mark.anyio
class TestMoondream(_Served):
    def behave(self) -> Behaviour:
        async def behave(x: bad.Exchange) -> None:
            nothing: dict[str, dict[str, Any]] = {"detect": {"objects": []}, "point": {"points": []}}
            await bad.good(moondream=nothing if "unicorn" in x.request.data.get("object", "") else bad.MOONDREAM)(x)

        return behave


@pytest.mark.anyio
class TestUnit(_Served):
    backend, convention = "openai-vision", "unit"


@pytest.mark.anyio
class TestQwen25(_Served):
    backend, convention = "openai-vision", "qwen2.5-vl"


@pytest.mark.anyio
class TestQwen3(_Served):
    backend, convention = "openai-vision", "qwen3-vl"


@pytest.mark.anyio
class TestGemini(_Served):
    backend, convention = "openai-vision", "gemini"


@pytest.mark.anyio
class TestGeneric(_Served):
    backend, convention = "openai-vision", "generic"


@pytest.mark.anyio
@pytest.mark.parametrize("convention", sorted(CONVENTIONS))
@pytest.mark.parametrize("size", [(640, 360), (1280, 720), (1921, 1081)])
async def test_boxes_of_every_convention_and_frame_size(convention: str, size: tuple[int, int]) -> None:
    with Misbehaving(then=bad.good(chat_model(convention))) as server:
        async with opened(server.url, "openai_vision", coordinates=convention) as perception:
            frame = pictures.frame(width=size[0], height=size[1])
            (box,) = (await perception.detect(frame, "thing")).boxes
            assert (box.x_min, box.y_min, box.x_max, box.y_max) == pytest.approx((0.25, 0.25, 0.5, 0.5), abs=1e-6)
            (point,) = (await perception.point(frame, "thing")).points
            assert (point.x, point.y) == pytest.approx((0.375, 0.375), abs=1e-6)


@pytest.mark.anyio
async def test_qwen_receives_a_size_that_it_keeps_and_the_prompt_states() -> None:
    with Misbehaving(then=bad.good(chat_model("qwen2.5-vl"))) as server:
        async with opened(server.url, "openai_vision", coordinates="qwen2.5-vl") as perception:
            await perception.detect(pictures.frame(width=1280, height=720), "thing")
        (request,) = server.requests
    assert sent_image(request).shape[:2] == (728, 1288)
    assert "1288x728" in request.data["messages"][0]["content"][1]["text"]


@pytest.mark.anyio
async def test_the_content_of_a_chat_request() -> None:
    with Misbehaving(then=bad.good(chat_model("generic"))) as server:
        async with opened(
            server.url, "openai_vision", options={"extra": {"chat_template_kwargs": {"enable_thinking": False}}}
        ) as perception:
            await perception.detect(pictures.frame(), 'cone "by" the\nroad')
        (request,) = server.requests
    assert request.data["model"] == "a-model" and request.data["temperature"] == 0
    assert request.data["chat_template_kwargs"] == {"enable_thinking": False}
    assert request.data["response_format"]["json_schema"]["schema"]["properties"]["objects"]["type"] == "array"
    assert "\"cone 'by' the road\"" in request.data["messages"][0]["content"][1]["text"]
    assert "tool_choice" not in request.data


@pytest.mark.anyio
async def test_the_content_of_a_moondream_request() -> None:
    with Misbehaving() as server:
        async with opened(server.url, "moondream", options={"reasoning": True}) as perception:
            await perception.query(pictures.frame(), 'is the door "open"?')
            found = await perception.detect(pictures.frame(), "door")
        asked, locations_in_frame = server.requests
    assert asked.path == "/v1/query" and asked.headers["x-moondream-auth"] == KEY
    assert {k: v for k, v in asked.data.items() if k != "image_url"} == {
        "question": 'is the door "open"?',
        "reasoning": True,
        "stream": False,
    }
    assert sent_image(asked).shape == (360, 640, 3)
    assert locations_in_frame.data["object"] == "door" and locations_in_frame.data["settings"]["max_objects"] >= 100
    assert found.attempts[0].kind is None and found.complete


@pytest.mark.anyio
async def test_a_schema_that_a_server_refuses_is_not_sent_again() -> None:
    mind = bad.good(chat_model("generic"))
    with Misbehaving([bad.status(400, "response_format is not supported")], then=mind) as server:
        async with opened(server.url, "openai_vision") as perception:
            first = await perception.detect(pictures.frame(), "thing")
            await perception.detect(pictures.frame(), "thing")
        assert ["response_format" in r.data for r in server.requests] == [True, False, False]
    assert len(first.boxes) == 1
    assert [a.kind for a in first.attempts] == ["bad-request", None]


@pytest.mark.anyio
async def test_a_wrong_model_name_does_not_drop_the_schema() -> None:
    with Misbehaving(then=bad.status(400, "no such model")) as server:
        async with opened(server.url, "openai_vision") as perception:
            with pytest.raises(PerceptionError, match="no such model"):
                await perception.detect(pictures.frame(), "thing")
        assert ["response_format" in r.data for r in server.requests] == [True, False]


@pytest.mark.anyio
async def test_fields_that_a_server_names_are_left_out() -> None:
    """A hosted model with another token limit field and no temperature, and a server without template arguments."""
    refusals = [
        bad.status(400, "Unsupported parameter: 'max_tokens'. Use 'max_completion_tokens' instead."),
        bad.status(400, "'temperature' does not support 0.0 with this model."),
        bad.status(422, "chat_template_kwargs: extra fields not permitted"),
    ]
    with Misbehaving(refusals, then=bad.good(chat_model("generic"))) as server:
        options = {"extra": {"chat_template_kwargs": {"enable_thinking": False}}}
        async with opened(server.url, "openai_vision", options=options) as perception:
            for _ in range(2):
                assert len((await perception.detect(pictures.frame(), "thing")).boxes) == 1
        last = server.requests[-1].data
    assert len(server.requests) == 5
    assert last["max_completion_tokens"] > 0 and "response_format" in last
    assert not {"max_tokens", "temperature", "chat_template_kwargs"} & last.keys()


@pytest.mark.anyio
async def test_a_schema_that_breaks_a_server_is_dropped() -> None:
    with Misbehaving([bad.status(500, "failed to parse grammar")], then=bad.good(chat_model("generic"))) as server:
        async with opened(server.url, "openai_vision") as perception:
            assert len((await perception.detect(pictures.frame(), "thing")).boxes) == 1


@pytest.mark.anyio
async def test_an_answer_truncated_at_the_token_limit_has_a_note() -> None:
    with Misbehaving(then=bad.good(Say("A road with", finish_reason="length"))) as server:
        async with opened(server.url, "openai_vision") as perception:
            assert "cut off" in (await perception.query(pictures.frame(), "what is it?")).notes[0]


@pytest.mark.anyio
async def test_moondream_without_settings_is_asked_without_them() -> None:
    with Misbehaving([bad.status(422, "unknown field settings")]) as server:
        async with opened(server.url, "moondream") as perception:
            for _ in range(2):
                assert len((await perception.detect(pictures.frame(), "thing")).boxes) == 1
        assert ["settings" in r.data for r in server.requests] == [True, False, False]


@pytest.mark.anyio
async def test_a_reply_truncated_at_the_token_limit_is_not_complete() -> None:
    text = '```json\n[{"bbox_2d": [100, 100, 200, 200], "label": "a"}, {"bbox_2d": [300, 300, 40'
    with Misbehaving(then=bad.good(Say(text, finish_reason="length"))) as server:
        async with opened(server.url, "openai_vision", coordinates="qwen3-vl") as perception:
            found = await perception.detect(pictures.frame(), "thing")
    assert [b.x_max for b in found.boxes] == [0.2] and not found.complete
    assert "cut off" in " ".join(found.notes)


@pytest.mark.anyio
async def test_a_model_that_gives_no_locations_is_an_error() -> None:
    with Misbehaving() as server:
        async with opened(server.url, "openai_vision", coordinates="none") as perception:
            assert perception.skills == {"caption", "query"}
            with pytest.raises(PerceptionError, match="cannot locate objects"):
                await perception.detect(pictures.frame(), "thing")
            assert (await perception.query(pictures.frame(), "is there a thing?")).text == "All done."


NAN = math.nan


@pytest.mark.anyio
@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    "things",
    [
        [{"x_min": NAN, "y_min": 0.1, "x_max": 0.2, "y_max": 0.2}],
        [{"x_min": 0.1, "y_min": 0.1, "x_max": math.inf, "y_max": 0.2}],
        [{"x_min": 0.1, "y_min": 0.1, "x_max": 0.1, "y_max": 0.1}],
        [{"x_min": 1.5, "y_min": 0.1, "x_max": 1.9, "y_max": 0.2}],
        [{"x_min": "left", "y_min": 0.1, "x_max": 0.5, "y_max": 0.2}],
        [{"x_min": 0.1}],
        [None],
        "a cone",
        {"x": 1},
        None,
        7,
    ],
    ids=["nan", "infinity", "point", "outside", "word", "missing", "null", "text", "object", "nothing", "number"],
)
async def test_invalid_locations_are_errors(backend: str, things: Any) -> None:
    with Misbehaving(then=reply(backend, things)) as server:
        async with opened(server.url, backend, coordinates="unit") as perception:
            for look in (perception.detect, perception.point):
                with pytest.raises(PerceptionError) as caught:
                    await look(pictures.frame(), "cone")
                assert caught.value.kind == "malformed"
                assert [a.kind for a in caught.value.attempts] == ["malformed"]


@pytest.mark.anyio
@pytest.mark.parametrize("backend", BACKENDS)
async def test_boxes_are_clipped_and_500_points_limited(backend: str) -> None:
    over = [{"x_min": -0.2, "y_min": 0.5, "x_max": 0.5, "y_max": 1.7}]
    many = [{"x": x / 25, "y": y / 20} for x in range(25) for y in range(20)]
    with Misbehaving([reply(backend, over), reply(backend, many)]) as server:
        async with opened(server.url, backend, coordinates="unit") as perception:
            found = await perception.detect(pictures.frame(), "cone")
            assert (found.boxes[0].x_min, found.boxes[0].y_max) == (0.0, 1.0) and "cut at the border" in found.notes[0]
            points = await perception.point(pictures.frame(), "cone")
            assert 100 <= len(points.points) < 500 and not points.complete and "500" in points.notes[-1]


@pytest.mark.anyio
@pytest.mark.parametrize("backend", BACKENDS)
async def test_nothing_found_is_empty(backend: str) -> None:
    with Misbehaving(then=reply(backend, [])) as server:
        async with opened(server.url, backend) as perception:
            assert (await perception.detect(pictures.frame(), "cone")).boxes == ()
            assert (await perception.point(pictures.frame(), "cone")).points == ()


@pytest.mark.anyio
async def test_another_language_is_an_answer_but_not_a_list() -> None:
    with Misbehaving(then=bad.say("画面里有三个锥桶。")) as server:
        async with opened(server.url, "openai_vision") as perception:
            assert (await perception.query(pictures.frame(), "how many cones?")).text == "画面里有三个锥桶。"
            with pytest.raises(PerceptionError) as caught:
                await perception.detect(pictures.frame(), "cone")
    assert caught.value.kind == "malformed"


FAILURES: dict[str, tuple[Behaviour, str]] = {
    "401": (bad.status(401), "unauthorised"),
    "key repeated": (bad.echo_key(), "unauthorised"),
    "429": (bad.status(429, headers={"Retry-After": "1"}), "rate-limited"),
    "500": (bad.status(500), "server-error"),
    "503": (bad.status(503), "server-error"),
    "error with success": (bad.error_in_success(), "error-body"),
    "reset": (bad.reset(), "cut-off"),
    "cut off": (bad.cut_off(), "cut-off"),
    "silent": (bad.slow_first_byte(), "first-byte-timeout"),
    "trickle": (bad.trickle(), "total-timeout"),
    "web page": (bad.wrong_type(), "wrong-content-type"),
    "no json": (bad.malformed(), "malformed"),
    "empty": (bad.empty_choices(), "empty or malformed"),
    "huge": (bad.huge(), "too-large"),
    "404": (bad.status(404), "not-found"),
}


@pytest.mark.anyio
@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("case", sorted(FAILURES))
@pytest.mark.parametrize("skill", ["query", "detect"])
async def test_every_failure_is_a_perception_error(backend: str, case: str, skill: str) -> None:
    behaviour, kinds = FAILURES[case]
    timeouts = IMPATIENT if "timeout" in kinds else PATIENT
    with Misbehaving(then=behaviour) as server:
        async with opened(server.url, backend, timeouts=timeouts) as perception:
            with pytest.raises(PerceptionError) as caught:
                await getattr(perception, skill)(pictures.frame(), "a cone?")
    error = caught.value
    assert error.kind in kinds.split(" or ") and error.kind
    assert error.attempts[-1].kind == error.kind
    assert KEY not in str(error) and KEY not in repr(error) and KEY not in repr(error.__cause__)


@pytest.mark.anyio
@pytest.mark.parametrize("backend", BACKENDS)
async def test_an_unreachable_server_is_a_perception_error(backend: str) -> None:
    with bad.nobody_listens() as url:
        async with opened(url, backend) as perception:
            with pytest.raises(PerceptionError) as caught:
                await perception.caption(pictures.frame())
    assert caught.value.kind == "refused"


@pytest.mark.anyio
@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("text", ["", "  \n"])
async def test_empty_questions_are_not_sent(backend: str, text: str) -> None:
    with Misbehaving() as server:
        async with opened(server.url, backend) as perception:
            for ask in (perception.query, perception.detect, perception.point):
                with pytest.raises(PerceptionError, match="empty"):
                    await ask(pictures.frame(), text)
        assert server.requests == []


@pytest.mark.anyio
async def test_empty_answers_are_errors() -> None:
    behaviours: Iterable[tuple[str, Behaviour]] = (
        ("moondream", bad.good(moondream={"query": {"answer": "  "}})),
        ("openai_vision", bad.say("<think>so long</think>")),
    )
    for backend, behaviour in behaviours:
        with Misbehaving(then=behaviour) as server:
            async with opened(server.url, backend) as perception:
                with pytest.raises(PerceptionError) as caught:
                    await perception.query(pictures.frame(), "a cone?")
        assert caught.value.kind == "empty" and [a.kind for a in caught.value.attempts] == ["empty"]


@pytest.mark.anyio
async def test_the_answer_i_cannot_tell_is_marked_as_unknown() -> None:
    with Misbehaving(then=bad.say("I cannot tell.")) as server:
        async with opened(server.url, "openai_vision") as perception:
            assert not (await perception.query(pictures.frame(), "what is behind the wall?")).known


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"endpoint": None}, "--perception-url"),
        ({"coordinates": "furlongs"}, "qwen3-vl"),
        ({"options": {"maxpixels": 1}}, "maxpixels"),
        ({"options": {"max_tokens": "many"}}, "max_tokens"),
        ({"backend": "crystal-ball"}, "openai_vision"),
    ],
)
def test_wrong_specs_are_explained(change: dict[str, Any], message: str) -> None:
    with pytest.raises((ConfigError, Exception), match=message):
        make_backend(spec("http://127.0.0.1:9/v1", "openai_vision").model_copy(update=change))


def test_locations_are_stored_without_loss() -> None:
    assert written((0.1, 0.2, 0.3, 0.4), "gemini") == pytest.approx((200, 100, 400, 300))
