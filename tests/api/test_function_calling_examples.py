"""The programs in ``examples/`` that let a model operate a camera run against a scripted model server."""

from __future__ import annotations

import base64
import json
import runpy
import sys
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from tests.api.test_examples import EXAMPLES, FUNCTION_CALLING
from tests.support.misbehaving import MODEL, Misbehaving, Request, Say, good

CAMERA = "sim:analytic-yard?width=320&height=180"
BALLS = 2  # in the home view of the scene


def texts_of_results(request: Request) -> list[str]:
    """Return the texts of all tool results in a request of either API."""
    chat = [message["content"] for message in request.data.get("messages", ()) if message["role"] == "tool"]
    items = request.data.get("input", ())
    outputs = [item["output"] for item in items if item.get("type") == "function_call_output"]
    return [text if isinstance(text, str) else text[0]["text"] for text in [*chat, *outputs]]


def scripted_model(request: Request) -> Say:
    """A deliberate stand-in for a model: it calls two tools together, then one with wrong arguments, and reports the count."""
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


@pytest.mark.parametrize("name", FUNCTION_CALLING)
def test_a_program_lets_a_model_operate_the_camera(
    name: str, analytic_folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("SCOPE_SCENES_DIR", str(analytic_folder.parent))
    monkeypatch.setenv("OPENAI_API_KEY", "sk-secret")
    with Misbehaving([], then=good(scripted_model)) as server:
        arguments = ["--url", server.url, "--model", MODEL, "--camera", CAMERA, "count the balls"]
        monkeypatch.setattr(sys, "argv", [name, *arguments])
        runpy.run_path(str(EXAMPLES / name), run_name="__main__")
    printed = capsys.readouterr().out
    assert f"There are {BALLS} balls. Then: Wrong arguments for adjust_ptz: pan_deg: Input should be a valid number" in printed
    assert "sk-secret" not in printed

    first, second, third = server.requests
    assert first.headers["authorization"] == "Bearer sk-secret"
    tools = [tool.get("function", tool) for tool in first.data["tools"]]
    assert [tool["name"] for tool in tools][:2] == ["adjust_ptz", "go_to_preset"]
    assert len(tools) == 9
    assert "pattern" not in json.dumps(tools)
    assert not list(pictures_in(first.data))
    (picture,) = pictures_in(second.data)
    assert picture.size == (320, 180)
    assert len(list(pictures_in(third.data))) == 1
    count = json.loads(texts_of_results(second)[0])
    assert count["message"].startswith("<camera_text>"), "the model can tell what the camera saw from instructions"
