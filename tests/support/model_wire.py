"""Valid replies of model servers: OpenAI chat completions (whole and streamed) and responses, and Moondream's four replies."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from tests.support.loopback import Request

MODEL = "loopback-model"


@dataclass(frozen=True)
class Say:
    """The reply of the model on the server."""

    text: str = "All done."
    reasoning: str = ""
    tool_calls: tuple[tuple[str, Any], ...] = ()
    finish_reason: str = ""

    def calls(self) -> list[dict[str, Any]]:
        return [
            {
                "id": f"call-{index}",
                "type": "function",
                "function": {"name": name, "arguments": arguments if isinstance(arguments, str) else json.dumps(arguments)},
            }
            for index, (name, arguments) in enumerate(self.tool_calls)
        ]

    @property
    def ending(self) -> str:
        return self.finish_reason or ("tool_calls" if self.tool_calls else "stop")


Responder = Callable[[Request], Say]


def completion(say: Say) -> dict[str, Any]:
    """Return a chat completion in the format of vLLM."""
    message: dict[str, Any] = {"role": "assistant", "content": say.text or None, "tool_calls": say.calls()}
    if say.reasoning:
        message["reasoning_content"] = say.reasoning
    return {
        "id": "chatcmpl-1",
        "object": "chat.completion",
        "created": 1,
        "model": MODEL,
        "choices": [{"index": 0, "message": message, "finish_reason": say.ending}],
        "usage": {"prompt_tokens": 11, "completion_tokens": 7, "total_tokens": 18, "prompt_tokens_details": {"cached_tokens": 4}},
    }


def response(say: Say) -> dict[str, Any]:
    """Return the reply in the format of the responses API."""
    output: list[dict[str, Any]] = []
    if say.text:
        content = [{"type": "output_text", "text": say.text, "annotations": []}]
        output.append({"id": "msg-1", "type": "message", "role": "assistant", "status": "completed", "content": content})
    for call in say.calls():
        item = {"id": f"fc-{call['id']}", "type": "function_call", "call_id": call["id"], "status": "completed"}
        output.append(item | call["function"])
    return {
        "id": "resp-1",
        "object": "response",
        "created_at": 1,
        "status": "completed",
        "model": MODEL,
        "output": output,
        "parallel_tool_calls": True,
        "tool_choice": "auto",
        "tools": [],
    }


def pieces(say: Say) -> Iterator[dict[str, Any]]:
    """Yield the reply as the chunks of a stream, with text and arguments in halves."""

    def chunk(delta: dict[str, Any], ending: str | None = None) -> dict[str, Any]:
        choice = {"index": 0, "delta": delta, "finish_reason": ending}
        return {"id": "chatcmpl-1", "object": "chat.completion.chunk", "created": 1, "model": MODEL, "choices": [choice]}

    yield chunk({"role": "assistant", "content": ""})
    for name, text in (("reasoning_content", say.reasoning), ("content", say.text)):
        half = len(text) // 2
        for part in (text[:half], text[half:]):
            if part:
                yield chunk({name: part})
    for index, call in enumerate(say.calls()):
        arguments = call["function"]["arguments"]
        half = len(arguments) // 2
        first = {"name": call["function"]["name"], "arguments": arguments[:half]}
        yield chunk({"tool_calls": [{"index": index, "id": call["id"], "type": "function", "function": first}]})
        yield chunk({"tool_calls": [{"index": index, "function": {"arguments": arguments[half:]}}]})
    yield chunk({}, say.ending)
    yield {**chunk({}), "choices": [], "usage": completion(say)["usage"]}


MOONDREAM: dict[str, dict[str, Any]] = {
    "query": {"answer": "A white van."},
    "caption": {"caption": "A road with cars."},
    "detect": {"objects": [{"x_min": 0.25, "y_min": 0.25, "x_max": 0.5, "y_max": 0.75}]},
    "point": {"points": [{"x": 0.375, "y": 0.5}]},
}
