"""A scripted chat server on loopback that records every request. It does not import the program under test."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from types import TracebackType
from typing import Any

MODEL = "scripted-model"
Reply = tuple[int, dict[str, Any]]
Script = Callable[[dict[str, Any]], "dict[str, Any] | Reply"]
"""Function that maps the body of a request to the assistant's message, or to an HTTP status and a body."""


def calls_message(calls: list[dict[str, Any]]) -> dict[str, Any]:
    """Return an assistant message with tool calls."""
    tool_calls = [
        {
            "id": f"call-{number}",
            "type": "function",
            "function": {
                "name": call["name"],
                "arguments": call["arguments"] if isinstance(call["arguments"], str) else json.dumps(call["arguments"]),
            },
        }
        for number, call in enumerate(calls)
    ]
    return {"role": "assistant", "content": None, "tool_calls": tool_calls}


def text_message(text: str) -> dict[str, Any]:
    """Return an assistant message with text only."""
    return {"role": "assistant", "content": text}


class ScriptedServer:
    """The scripted server. ``requests`` contains the bodies of all chat requests in the order of arrival."""

    def __init__(self, script: Script, model: str = MODEL) -> None:
        requests: list[dict[str, Any]] = []
        self.requests, lock = requests, threading.Lock()

        class Handler(BaseHTTPRequestHandler):
            protocol_version = "HTTP/1.1"

            def do_GET(self) -> None:
                if self.path.endswith("/models"):
                    self._send(200, {"object": "list", "data": [{"id": model, "object": "model"}]})
                else:
                    self._send(404, {"error": {"message": "no such path", "type": "NotFound", "code": 404}})

            def do_POST(self) -> None:
                body = json.loads(self.rfile.read(int(self.headers.get("Content-Length", 0))))
                if not self.path.endswith("/chat/completions"):
                    self._send(404, {"error": {"message": "no such path", "type": "NotFound", "code": 404}})
                    return
                with lock:
                    requests.append(body)
                    reply = script(body)
                self._send(*(reply if isinstance(reply, tuple) else (200, completion(reply, model))))

            def _send(self, status: int, content: dict[str, Any]) -> None:
                data = json.dumps(content).encode()
                self.send_response(status)
                self.send_header("Content-Type", "application/json")
                self.send_header("Content-Length", str(len(data)))
                self.end_headers()
                self.wfile.write(data)

            def log_message(self, format: str, *args: Any) -> None:  # noqa: A002 - the base class's signature
                pass

        self._server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self._server.daemon_threads = True
        self._thread = threading.Thread(target=self._server.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True)

    @property
    def url(self) -> str:
        """The base URL of the server, ending in /v1."""
        return f"http://127.0.0.1:{self._server.server_address[1]}/v1"

    def __enter__(self) -> ScriptedServer:
        self._thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._server.shutdown()
        self._server.server_close()
        self._thread.join()


def completion(message: dict[str, Any], model: str) -> dict[str, Any]:
    """Return a chat completion with this message."""
    return {
        "id": "chatcmpl-1",
        "object": "chat.completion",
        "created": 1,
        "model": model,
        "choices": [{"index": 0, "message": message, "finish_reason": "tool_calls" if message.get("tool_calls") else "stop"}],
        "usage": {"prompt_tokens": 100, "completion_tokens": 10, "total_tokens": 110},
    }
