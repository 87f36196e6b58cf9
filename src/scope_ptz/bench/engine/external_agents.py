"""Agents of other people: any loop that calls tools, run on the same tasks, traced and checked as our own.

    class Agent:
        sees = False

        async def run(self, desk: SceneDrafts) -> str:
            seen = await desk.call("count_objects", {"description": "cars", "view": "full"})
            return f"I count {seen['count']} cars."

A fresh object is made for each run. ``run`` gives the answer, or ``Reply`` for a question or a refusal.
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
class Reply:
    """How an agent ends a run: with an answer, a question back, or a refusal."""

    text: str
    kind: Literal["answered", "clarification", "refused"] = "answered"


class SceneDrafts:
    """What an agent works with: the instruction, the tools, what is known of the camera, and a way to call.

    ``tools``: JSON schemas in the OpenAI function format; ``presets``: names of views to go to.
    """

    def __init__(self, state: State, call: Callable[[str, dict[str, Any]], Any], view: Callable[[], bytes | None]) -> None:
        self.instruction: str = state.instruction
        self.tools: tuple[dict[str, Any], ...] = state.tools
        self.presets: tuple[str, ...] = state.briefing.presets
        self.limits: Limits = state.briefing.limits
        self.pose: Pose = state.briefing.pose
        self._call, self._view = call, view

    async def call(self, name: str, arguments: dict[str, Any] | None = None) -> dict[str, Any]:
        """Call a tool. What it brings back is JSON data; of a call that failed, ``{"error": "..."}``.

        Calls that are awaited together are made as one step: looks at the same time, anything else in order.
        """
        result: dict[str, Any] = await self._call(name, arguments or {})
        return result

    def view(self) -> bytes | None:
        """The newest view as JPEG, for agents whose class says ``sees = True``; None for others."""
        return self._view()


class ExternalAgent(Protocol):
    """An agent of somebody else. ``sees`` (False where it is missing): it wants frames."""

    async def run(self, desk: SceneDrafts) -> str | Reply: ...


def load_external_agent(name: str) -> Callable[[], ExternalAgent]:
    """The class ``module:Class``, looked for in the current folder too. Raises ``ConfigError``."""
    module, colon, attribute = name.partition(":")
    if not colon or not module or not attribute:
        raise ConfigError(f"--agent wants module:Class, got '{name}'.")
    here = str(Path.cwd())
    if here not in sys.path:
        sys.path.insert(0, here)
    try:
        made = getattr(importlib.import_module(module), attribute)
    except (ImportError, AttributeError, SyntaxError) as error:
        raise ConfigError(f"The agent {name} cannot be imported: {error}.") from error
    if not callable(made) or not callable(getattr(made, "run", None)):
        raise ConfigError(f"{name} is no agent: it needs a method `async def run(self, desk)`.")
    guest: Callable[[], ExternalAgent] = made
    return guest


def source_digest(name: str) -> str:
    """Names the source of ``module:Class``: of its module, or of all Python files of its package where it is in one. Empty for
    what has no source to read. Raises ``ConfigError``."""
    load_external_agent(name)
    module = sys.modules[name.partition(":")[0]]
    package = sys.modules.get(module.__name__.partition(".")[0])
    own = [Path(module.__file__)] if module.__file__ else []
    folders = [Path(folder) for folder in getattr(package, "__path__", ())]
    files = sorted((path.relative_to(folder).as_posix(), path) for folder in folders for path in folder.rglob("*.py"))
    said = hashlib.sha256()
    for place, path in files or [(path.name, path) for path in own]:
        try:
            said.update(f"{place}\0{hashlib.sha256(path.read_bytes()).hexdigest()}\n".encode())
        except OSError as error:
            raise ConfigError(f"The source of the agent {name} cannot be read: {path}: {error.strerror}.") from error
    return said.hexdigest()[:DIGEST_CHARS] if files or own else ""


class ExternalPlanner(Planner):
    """Another agent's loop, turned inside out: what it calls becomes this planner's decisions, what comes back its results.

    It lives for one run, because the other loop keeps its state where nobody sees it.
    """

    def __init__(self, make: Callable[[], ExternalAgent], name: str) -> None:
        self.name, self.sees = name, bool(getattr(make, "sees", False))
        self._make = make
        self._wanted: list[tuple[ToolCall, asyncio.Future[dict[str, Any]]]] = []
        self._given: list[asyncio.Future[dict[str, Any]]] = []
        self._stirred = asyncio.Event()
        self._newest: bytes | None = None
        self._opened = False
        self._asked = 0
        self._task: asyncio.Task[str | Reply] | None = None

    async def step(self, state: State) -> Decision:
        self._opened = False
        if state.view is not None:
            self._newest = base64.b64decode(state.view.data_url.partition(",")[2])
        if self._task is None:
            self._task = asyncio.ensure_future(self._make().run(SceneDrafts(state, self._call, self._view)))
            self._task.add_done_callback(lambda _: self._stirred.set())
        elif state.history:
            self._hand_over(state.history[-1].outcomes)
        await self._stirred.wait()
        # Calls that are awaited together are asked for one after the other, without anything in between.
        await asyncio.sleep(0)
        self._stirred.clear()
        if self._wanted:
            calls, self._given = tuple(c for c, _ in self._wanted), [f for _, f in self._wanted]
            self._wanted = []
            return CallTools(calls=calls, opened=self._opened)
        return _ending(self._task, opened=self._opened)

    def _view(self) -> bytes | None:
        """Only a picture that the other loop asked for was looked at."""
        self._opened = self._newest is not None
        return self._newest

    async def _call(self, name: str, arguments: dict[str, Any]) -> dict[str, Any]:
        self._asked += 1
        answer: asyncio.Future[dict[str, Any]] = asyncio.get_running_loop().create_future()
        self._wanted.append((ToolCall(id=f"call-{self._asked}", name=name, arguments=arguments), answer))
        self._stirred.set()
        return await answer

    def _hand_over(self, outcomes: tuple[ToolOutcome, ...]) -> None:
        for outcome, answer in zip(outcomes, self._given, strict=True):
            if not answer.done():
                answer.set_result(
                    outcome.result if outcome.error is None and outcome.result is not None else {"error": outcome.error}
                )
        self._given = []

    async def close(self) -> None:
        """End the other loop, wherever it is."""
        if self._task is not None and not self._task.done():
            self._task.cancel()
            await asyncio.wait([self._task])


def _ending(task: asyncio.Task[str | Reply], *, opened: bool) -> Finish:
    if task.cancelled():
        raise PlannerError("The agent ended its own task.")
    error = task.exception()
    if error is not None:
        raise PlannerError(f"The agent failed: {type(error).__name__}: {error}") from error
    said = task.result()
    reply = said if isinstance(said, Reply) else Reply(str(said) if said is not None else "")
    if not reply.text.strip():
        raise PlannerError("The agent ended without a word.", kind="empty")
    return Finish(kind=reply.kind, text=reply.text, opened=opened)
