"""The programs in ``examples/`` that let a model operate a camera run against a scripted model server."""

from __future__ import annotations

import base64
import json
import runpy
import sys
from collections.abc import Callable, Iterator
from io import BytesIO
from pathlib import Path
from typing import Any

import pytest
from openai.types.chat import ChatCompletionContentPartParam
from openai.types.chat.completion_create_params import CompletionCreateParamsNonStreaming
from openai.types.responses import ResponseFunctionCallOutputItemListParam
from openai.types.responses.response_create_params import ResponseCreateParamsNonStreaming
from PIL import Image
from pydantic import TypeAdapter, ValidationError
from pydantic_core import PydanticSerializationError

from scope_ptz.tools.registry import TOOLS
from tests.api.test_examples import EXAMPLES, FUNCTION_CALLING
from tests.support.misbehaving import MODEL, Misbehaving, Request, Say, good

CAMERA = "sim:analytic-yard?width=320&height=180"
BALLS = 2  # in the home view of the scene
CHAT: TypeAdapter[Any] = TypeAdapter(CompletionCreateParamsNonStreaming)
CHAT_PARTS: TypeAdapter[Any] = TypeAdapter(list[ChatCompletionContentPartParam])
RESPONSES: TypeAdapter[Any] = TypeAdapter(ResponseCreateParamsNonStreaming)
RESPONSE_PARTS: TypeAdapter[Any] = TypeAdapter(ResponseFunctionCallOutputItemListParam)


def texts_of_results(request: Request) -> list[str]:
    """Return the texts of all tool results in a request of either API."""
    chat = [message["content"] for message in request.data.get("messages", ()) if message["role"] == "tool"]
    items = request.data.get("input", ())
    outputs = [item["output"] for item in items if item.get("type") == "function_call_output"]
    return [text if isinstance(text, str) else text[0]["text"] for text in [*chat, *outputs]]


def scripted_model(request: Request) -> Say:
    """Reply as a scripted model: call two tools at once, then one with wrong arguments, then report the count."""
    results = [json.loads(text) for text in texts_of_results(request)]
    if not results:
        return Say(text="", tool_calls=(("count_objects", {"description": "balls"}), ("take_image", {})))
    if len(results) == 2:
        return Say(text="", tool_calls=(("adjust_ptz", {"pan_deg": "left"}),))
    count, picture, failed = results
    assert picture["file"] == "pictures/001.png"
    return Say(text=f"There are {count['count']} balls. Then: {failed['error']}")


def pictures_in(data: Any) -> Iterator[Image.Image]:
    """Yield the pictures in the body of a request."""
    if isinstance(data, str) and data.startswith("data:image/jpeg;base64,"):
        yield Image.open(BytesIO(base64.b64decode(data.partition(",")[2])))
    for each in data.values() if isinstance(data, dict) else data if isinstance(data, list) else ():
        yield from pictures_in(each)


def check_request(data: dict[str, Any]) -> None:
    """Check the body of a request against the types of the API. Pydantic validates parts lazily; these are checked separately."""
    chat = "messages" in data
    adapter = CHAT if chat else RESPONSES
    adapter.dump_json(adapter.validate_python(data))
    for entry in data["messages" if chat else "input"]:
        content = entry.get("content" if chat else "output")
        if isinstance(content, list):
            (CHAT_PARTS if chat else RESPONSE_PARTS).validate_python(content)


@pytest.mark.parametrize(
    "data",
    [
        {"messages": [{"role": "user", "content": [{"type": "image_url", "image_url": "data:"}]}]},
        {"messages": [{"role": "tool", "content": "x"}]},
        {"input": [{"type": "function_call_output", "call_id": "1", "output": [{"type": "image_url"}]}]},
    ],
)
def test_the_check_of_requests_finds_mistakes(data: dict[str, Any]) -> None:
    with pytest.raises((ValidationError, PydanticSerializationError)):
        check_request({"model": MODEL, **data})


@pytest.fixture
def run(analytic_folder: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., list[Request]]:
    """Return a function that runs a program with a scripted model, and returns the requests that the model server received."""
    monkeypatch.setenv("SCOPE_SCENES_DIR", str(analytic_folder.parent))
    monkeypatch.setenv("OPENAI_API_KEY", "sk-secret")

    def run_program(name: str, *options: str) -> list[Request]:
        with Misbehaving([], then=good(scripted_model)) as server:
            arguments = ["--url", server.url, "--model", MODEL, "--camera", CAMERA, *options, "count the balls"]
            monkeypatch.setattr(sys, "argv", [name, *arguments])
            runpy.run_path(str(EXAMPLES / name), run_name="__main__")
        return server.requests

    return run_program


@pytest.mark.parametrize("name", FUNCTION_CALLING)
def test_a_program_lets_a_model_operate_the_camera(
    name: str, run: Callable[..., list[Request]], capsys: pytest.CaptureFixture[str]
) -> None:
    first, second, third = run(name)
    output = capsys.readouterr().out
    assert f"There are {BALLS} balls. Then: Wrong arguments for adjust_ptz: pan_deg: Input should be a valid number" in output
    assert "sk-secret" not in output

    for request in (first, second, third):
        assert request.headers["authorization"] == "Bearer sk-secret"
        check_request(request.data)
        tools = [tool.get("function", tool) for tool in request.data["tools"]]
        assert [tool["name"] for tool in tools] == list(TOOLS)
        assert "pattern" not in json.dumps(tools)
    assert not list(pictures_in(first.data))
    (picture,) = pictures_in(second.data)
    assert picture.size == (320, 180)
    assert len(list(pictures_in(third.data))) == 1
    count = json.loads(texts_of_results(second)[0])
    assert count["message"].startswith("<camera_text>"), "the text must separate what the camera saw from instructions"


@pytest.mark.parametrize("name", FUNCTION_CALLING)
def test_a_model_that_accepts_only_text_gets_no_picture(
    name: str, run: Callable[..., list[Request]], capsys: pytest.CaptureFixture[str]
) -> None:
    requests = run(name, "--text-only")
    assert f"There are {BALLS} balls." in capsys.readouterr().out
    assert not [picture for request in requests for picture in pictures_in(request.data)]
