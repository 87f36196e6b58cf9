"""External agents, which replace the built-in loop and run on the same tasks with the same tools, traces and checks.

A minimal agent:

    class Agent:
        sees = False

        async def run(self, session: AgentSession) -> str:
            seen = await session.call("count_objects", {"description": "cars", "view": "full"})
            return f"I count {seen['count']} cars."

Each run creates a new instance of the class. ``run`` returns the answer, or an ``AgentReply`` for a clarifying question or a
refusal.
"""

from __future__ import annotations

import asyncio
import base64
import hashlib
import importlib
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, Protocol

from scope_ptz.bench.engine.entries import DIGEST_CHARS
from scope_ptz.errors import ConfigError, PlannerError
from scope_ptz.geometry import Limits, Pose
from scope_ptz.planner.base import CallTools, Decision, Finish, Planner, State, ToolCall, ToolOutcome


@dataclass(frozen=True, slots=True)
class AgentReply:
    """An agent's final reply: an answer, a clarifying question or a refusal."""

    text: str
    kind: Literal["answered", "clarification", "refused"] = "answered"


class AgentSession:
    """The interface of an external agent to one run.

    Attributes:
        instruction: The instruction to the agent.
        tools: The JSON schemas of the tools in the OpenAI function format.
        presets: The names of the presets.
        limits: The limits of the camera.
        pose: The pose of the camera at the start.
    """

    def __init__(self, state: State, call: Callable[[str, dict[str, Any]], Any], view: Callable[[], bytes | None]) -> None:
        self.instruction: str = state.instruction
        self.tools: tuple[dict[str, Any], ...] = state.tools
        self.presets: tuple[str, ...] = state.briefing.presets
        self.limits: Limits = state.briefing.limits
        self.pose: Pose = state.briefing.pose
        self._call, self._view = call, view

    async def call(self, name: str, arguments: dict[str, Any] | None = None) -> dict[str, Any]:
        """Call a tool and return its result as JSON data, or ``{"error": "..."}`` if the call failed.

        Calls that are awaited together form one step. In a step, perception calls run concurrently and other calls in order.
        """
        result: dict[str, Any] = await self._call(name, arguments or {})
        return result

    def view(self) -> bytes | None:
        """Return the newest view as JPEG if the agent's class has ``sees = True``, otherwise None."""
        return self._view()


class ExternalAgent(Protocol):
    """An external agent. Set its optional attribute ``sees`` to True if it needs frames."""

    async def run(self, session: AgentSession) -> str | AgentReply: ...


def load_external_agent(name: str) -> Callable[[], ExternalAgent]:
    """Import the class ``module:Class``. The module may be in the current folder.

    Raises:
        ConfigError: The class cannot be imported or is not an agent.
    """
    module, colon, attribute = name.partition(":")
    if not colon or not module or not attribute:
        raise ConfigError(f"--agent must have the form module:Class; got '{name}'.")
    current_folder = str(Path.cwd())
    if current_folder not in sys.path:
        sys.path.insert(0, current_folder)
    try:
        agent_class = getattr(importlib.import_module(module), attribute)
    except (ImportError, AttributeError, SyntaxError) as error:
        raise ConfigError(f"The agent {name} cannot be imported: {error}.") from error
    if not callable(agent_class) or not callable(getattr(agent_class, "run", None)):
        raise ConfigError(f"{name} is not an agent. Define a class with a method `async def run(self, session)`.")
    agent: Callable[[], ExternalAgent] = agent_class
    return agent


def source_digest(name: str) -> str:
    """Return a digest of the source of ``module:Class``, or of all Python files of its package if it is in one.

    The digest is empty if there is no source file.

    Raises:
        ConfigError: The class cannot be imported, or its source cannot be read.
    """
    load_external_agent(name)
    module = sys.modules[name.partition(":")[0]]
    package = sys.modules.get(module.__name__.partition(".")[0])
    module_file = [Path(module.__file__)] if module.__file__ else []
    folders = [Path(folder) for folder in getattr(package, "__path__", ())]
    files = sorted((path.relative_to(folder).as_posix(), path) for folder in folders for path in folder.rglob("*.py"))
    digest = hashlib.sha256()
    for relative_path, path in files or [(path.name, path) for path in module_file]:
        try:
            digest.update(f"{relative_path}\0{hashlib.sha256(path.read_bytes()).hexdigest()}\n".encode())
        except OSError as error:
            raise ConfigError(f"The source of the agent {name} cannot be read: {path}: {error.strerror}.") from error
    return digest.hexdigest()[:DIGEST_CHARS] if files or module_file else ""


class ExternalPlanner(Planner):
    """A planner whose decisions are the tool calls and the final reply of an external agent.

    An instance can be used for one run only, because the agent has its own state.
    """

    def __init__(self, agent_class: Callable[[], ExternalAgent], name: str) -> None:
        self.name, self.sees = name, bool(getattr(agent_class, "sees", False))
        self._agent_class = agent_class
        self._requested: list[tuple[ToolCall, asyncio.Future[dict[str, Any]]]] = []
        self._pending: list[asyncio.Future[dict[str, Any]]] = []
        self._wake_up = asyncio.Event()
        self._newest_view: bytes | None = None
        self._opened = False
        self._calls_made = 0
        self._task: asyncio.Task[str | AgentReply] | None = None

    async def step(self, state: State) -> Decision:
        self._opened = False
        if state.view is not None:
            self._newest_view = base64.b64decode(state.view.data_url.partition(",")[2])
        if self._task is None:
            self._task = asyncio.ensure_future(self._agent_class().run(AgentSession(state, self._call, self._view)))
            self._task.add_done_callback(lambda _: self._wake_up.set())
        elif state.history:
            self._return_results(state.history[-1].outcomes)
        await self._wake_up.wait()
        # Let the agent make all calls that it awaits together.
        await asyncio.sleep(0)
        self._wake_up.clear()
        if self._requested:
            calls, self._pending = tuple(c for c, _ in self._requested), [f for _, f in self._requested]
            self._requested = []
            return CallTools(calls=calls, opened=self._opened)
        return _final_decision(self._task, opened=self._opened)

    def _view(self) -> bytes | None:
        """Return the newest view, and record that the agent requested it."""
        self._opened = self._newest_view is not None
        return self._newest_view

    async def _call(self, name: str, arguments: dict[str, Any]) -> dict[str, Any]:
        self._calls_made += 1
        answer: asyncio.Future[dict[str, Any]] = asyncio.get_running_loop().create_future()
        self._requested.append((ToolCall(id=f"call-{self._calls_made}", name=name, arguments=arguments), answer))
        self._wake_up.set()
        return await answer

    def _return_results(self, outcomes: tuple[ToolOutcome, ...]) -> None:
        for outcome, answer in zip(outcomes, self._pending, strict=True):
            if not answer.done():
                answer.set_result(
                    outcome.result if outcome.error is None and outcome.result is not None else {"error": outcome.error}
                )
        self._pending = []

    async def close(self) -> None:
        """Cancel the agent if it is still running."""
        if self._task is not None and not self._task.done():
            self._task.cancel()
            await asyncio.wait([self._task])


def _final_decision(task: asyncio.Task[str | AgentReply], *, opened: bool) -> Finish:
    if task.cancelled():
        raise PlannerError("The agent cancelled its own task.")
    error = task.exception()
    if error is not None:
        raise PlannerError(f"The agent failed: {type(error).__name__}: {error}") from error
    result = task.result()
    reply = result if isinstance(result, AgentReply) else AgentReply(str(result) if result is not None else "")
    if not reply.text.strip():
        raise PlannerError("The agent ended without an answer.", kind="empty")
    return Finish(kind=reply.kind, text=reply.text, opened=opened)
