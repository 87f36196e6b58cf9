"""Run an external agent's class in a separate process. Uses only the standard library of Python 3.9 or later.

Usage: ``python runner.py MODULE:CLASS``. Stdin and stdout carry the protocol described in ``docs/external-agents.md``, and the
agent's own output goes to stderr. SCOPE need not be installed: agents can import ``AgentReply`` from the module ``scope_agent``,
which this file creates at run time.
"""

from __future__ import annotations

import asyncio
import base64
import importlib
import json
import os
import queue
import sys
import threading
import traceback
import types
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable

PROTOCOL = 1
MODULE = "scope_agent"
FAILED, OUT_OF_MEMORY, NOT_LOADED = 70, 71, 72  # exit codes
KINDS = ("answered", "clarification", "refused")

Message = dict[str, Any]


@dataclass(frozen=True)
class AgentReply:
    """An agent's final reply: an answer, a clarifying question or a refusal.

    Attributes:
        text: The text of the reply.
        kind: "answered", "clarification" or "refused".
    """

    text: str
    kind: str = "answered"


class AgentLoadError(Exception):
    """The agent cannot be imported, or it is not a valid agent class."""


class Session:
    """An agent's interface to one run.

    Attributes:
        instruction: The instruction to the agent.
        tools: The JSON schemas of the tools in the OpenAI function format.
        presets: The names of the presets.
        limits: The limits of the camera: ``min_pan_deg``, ``max_pan_deg``, ``min_tilt_deg``, ``max_tilt_deg``, ``min_zoom``,
            ``max_zoom`` and ``pan_endless``.
        pose: The initial pose of the camera: ``pan_deg``, ``tilt_deg`` and ``zoom``.
    """

    def __init__(self, task: Message, send: Callable[[Message], None], sees: bool = False) -> None:
        self.instruction: str = task["instruction"]
        self.tools: tuple[Message, ...] = tuple(task["tools"])
        self.presets: tuple[str, ...] = tuple(task["presets"])
        self.limits = types.SimpleNamespace(**task["limits"])
        self.pose = types.SimpleNamespace(**task["pose"])
        self._send, self._sees = send, sees
        self._queued: list[tuple[Message, asyncio.Future[Message]]] = []
        self._sent: dict[str, asyncio.Future[Message]] = {}
        self._calls_made = 0
        self._is_flush_scheduled = False
        self._view: bytes | None = None
        self._is_view_current = False
        self._views: queue.Queue[Message | None] = queue.Queue()
        self._loop: asyncio.AbstractEventLoop | None = None
        self._task: asyncio.Task[Message] | None = None
        self._ended = False

    async def call(self, name: str, arguments: dict[str, Any] | None = None) -> dict[str, Any]:
        """Call a tool, and return its result as JSON data, or ``{"error": "..."}`` if the call failed.

        Calls that are awaited together form one step. Within a step, perception calls run concurrently and other calls in order.
        """
        self._calls_made += 1
        call = {"id": f"call-{self._calls_made}", "name": name, "arguments": arguments or {}}
        json.dumps(call, allow_nan=False)  # arguments that are not valid JSON raise here, in the agent's own code
        answer: asyncio.Future[Message] = asyncio.get_running_loop().create_future()
        self._queued.append((call, answer))
        self._schedule_flush()
        return await answer

    def view(self) -> bytes | None:
        """Return the newest frame as JPEG data. If the agent's class does not have ``sees = True``, return None."""
        if self._sees and not self._is_view_current and not self._ended:
            self._send({"type": "view"})
            message = self._views.get() or {}
            self._view = base64.b64decode(message["data"]) if message.get("data") else None
            self._is_view_current = True
        return self._view

    def deliver(self, message: Message | None) -> None:
        """Handle a message from the host. Can be called from any thread. None means that the host has disconnected."""
        kind = message["type"] if message is not None else "end"
        if kind == "view":
            self._views.put(message)
        elif kind == "results" and message is not None:
            self._in_loop(self._resolve, message["results"])
        elif kind in ("end", "error"):
            self._ended = True
            self._views.put(None)
            self._in_loop(self._cancel)

    async def run(self, agent_class: Callable[[], Any]) -> Message:
        """Run an agent, and return the message with its reply. The agent is cancelled if the host ends the run."""
        self._loop = asyncio.get_running_loop()
        self._task = asyncio.ensure_future(self._reply(agent_class))
        if self._ended:
            self._cancel()
        return await self._task

    async def _reply(self, agent_class: Callable[[], Any]) -> Message:
        result = await agent_class().run(self)
        if isinstance(result, dict):
            text, kind = result.get("text"), result.get("kind", "answered")
        else:
            text, kind = getattr(result, "text", result), getattr(result, "kind", "answered")
        if kind not in KINDS:
            raise ValueError(f"The kind of a reply must be one of {', '.join(KINDS)}; got {kind!r}.")
        return {"type": "reply", "kind": kind, "text": "" if text is None else str(text)}

    def _in_loop(self, work: Callable[..., None], *arguments: Any) -> None:
        if self._loop is not None and not self._loop.is_closed():
            self._loop.call_soon_threadsafe(work, *arguments)

    def _cancel(self) -> None:
        if self._task is not None:
            self._task.cancel()

    def _schedule_flush(self) -> None:
        """Schedule a flush for after the agent has made all calls that it awaits together. Steps do not overlap."""
        if self._queued and not self._sent and not self._is_flush_scheduled:
            self._is_flush_scheduled = True
            loop = asyncio.get_running_loop()
            loop.call_soon(lambda: loop.call_soon(self._flush))

    def _flush(self) -> None:
        self._is_flush_scheduled = False
        queued, self._queued = self._queued, []
        self._sent = {call["id"]: answer for call, answer in queued}
        self._send({"type": "calls", "calls": [call for call, _ in queued]})

    def _resolve(self, results: list[Message]) -> None:
        sent, self._sent = self._sent, {}
        self._is_view_current = False
        for result in results:
            answer = sent.get(result["id"])
            if answer is not None and not answer.done():
                answer.set_result({"error": result["error"]} if result.get("result") is None else result["result"])
        self._schedule_flush()


def load(name: str) -> Callable[[], Any]:
    """Import the class ``module:Class``.

    Raises:
        AgentLoadError: The class cannot be imported or is not an agent.
    """
    module, _, attribute = name.partition(":")
    try:
        agent_class = getattr(importlib.import_module(module), attribute)
    except (ImportError, AttributeError, SyntaxError) as error:
        raise AgentLoadError(f"The agent {name} cannot be imported: {error}.") from error
    if not callable(agent_class) or not callable(getattr(agent_class, "run", None)):
        raise AgentLoadError(f"{name} is not an agent. Define a class with a method `async def run(self, session)`.")
    loaded: Callable[[], Any] = agent_class
    return loaded


def provide_module() -> None:
    """Create the module ``scope_agent``, so that agents can import ``AgentReply`` from it."""
    module = types.ModuleType(MODULE, "The interface of SCOPE for external agents.")
    module.__dict__.update(AgentReply=AgentReply, AgentSession=Session)
    sys.modules[MODULE] = module


class Pipe:
    """The connection to the host through the original stdin and stdout."""

    def __init__(self) -> None:
        """Take over stdin and stdout. Afterwards, stdin is empty, and the agent's output goes to stderr."""
        self._input = os.fdopen(os.dup(0), "rb")
        self._output = os.fdopen(os.dup(1), "wb")
        self._lock = threading.Lock()
        devnull = os.open(os.devnull, os.O_RDONLY)
        os.dup2(devnull, 0)
        os.dup2(2, 1)
        os.close(devnull)

    def send(self, message: Message) -> None:
        """Send a message."""
        line = json.dumps(message, allow_nan=False).encode() + b"\n"
        with self._lock:
            self._output.write(line)
            self._output.flush()

    def receive(self) -> Message | None:
        """Wait for the next message, and return it; None if the host has disconnected."""
        line = self._input.readline()
        return json.loads(line) if line else None


def serve(agent_class: Callable[[], Any], name: str, pipe: Pipe) -> None:
    """Run an agent on the task from the host."""
    sees = bool(getattr(agent_class, "sees", False))
    pipe.send({"type": "hello", "protocol": PROTOCOL, "name": name, "sees": sees})
    task = pipe.receive()
    if task is None or task["type"] != "task":
        return
    session = Session(task, pipe.send, sees)

    def read() -> None:
        message: Message | None = {}
        while message is not None:
            message = pipe.receive()
            session.deliver(message)

    threading.Thread(target=read, name="host", daemon=True).start()
    pipe.send(asyncio.run(session.run(agent_class)))


def main(name: str) -> int:
    """Run the agent ``module:Class``, and return the exit code."""
    pipe = Pipe()
    # The folder of this file must not shadow the agent's modules. As with ``python -m``, search the working folder instead.
    sys.path[0] = str(Path.cwd())
    provide_module()
    try:
        serve(load(name), name, pipe)
    except AgentLoadError as error:
        print(error, file=sys.stderr)  # noqa: T201 - the host reads it
        return NOT_LOADED
    except asyncio.CancelledError:
        return 0
    except MemoryError:
        print("MemoryError", file=sys.stderr)  # noqa: T201
        return OUT_OF_MEMORY
    except Exception:
        traceback.print_exc()
        return FAILED
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
