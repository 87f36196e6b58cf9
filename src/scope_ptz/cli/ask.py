"""``scope ask`` and the part of it that ``scope chat`` shares."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import anyio
from rich.console import Console

from scope_ptz.agent.filmstrip import write_filmstrip
from scope_ptz.agent.loop import Agent
from scope_ptz.agent.records import Budgets, Called, Decided, Ended, Listener, RunLabels, RunResult, Started
from scope_ptz.agent.store import RunFolder
from scope_ptz.agent.trace import TraceWriter, read_trace
from scope_ptz.camera.base import Camera
from scope_ptz.cli.display import LiveView, show_end
from scope_ptz.cli.endings import CANCELLED, exit_code, put_json
from scope_ptz.errors import InputError
from scope_ptz.factory.cameras import OpenCamera, open_camera
from scope_ptz.factory.models import ModelOptions, make_perception, make_planner, perception_note, resolve_models
from scope_ptz.perception.base import Perception
from scope_ptz.planner.base import PastTurn, Planner


@dataclass(frozen=True, slots=True)
class Asking:
    """The options of a session."""

    camera: str
    viewpoint: str | None
    preset: str | None
    time_s: float | None
    wishes: ModelOptions
    runs_dir: Path
    budgets: Budgets
    seed: int
    realtime: bool | None
    as_json: bool = False

    @property
    def in_real_time(self) -> bool:
        """A person at a terminal sees the camera take its time; a program does not wait."""
        return self.realtime if self.realtime is not None else sys.stdout.isatty() and not self.as_json


class Session:
    """A camera, perception and a planner that stay together for one or several runs."""

    def __init__(self, options: Asking, opened: OpenCamera, perception: Perception, planner: Planner, note: str) -> None:
        self.options, self.opened, self.perception, self.planner, self.note = options, opened, perception, planner, note

    @property
    def camera(self) -> Camera:
        return self.opened.camera

    @classmethod
    async def open(cls, options: Asking) -> Session:
        choice = await resolve_models(options.wishes)
        planner = make_planner(choice.planner)
        opened = await open_camera(
            options.camera, viewpoint=options.viewpoint, preset=options.preset, time_s=options.time_s, realtime=options.in_real_time
        )
        try:
            perception = make_perception(choice.perception, opened.scenes, options.seed)
        except BaseException:
            await opened.aclose()
            raise
        return cls(options, opened, perception, planner, perception_note(choice.perception))

    async def run(
        self, instruction: str, folder: RunFolder, listener: Listener, conversation: tuple[PastTurn, ...] = ()
    ) -> RunResult:
        """One run, recorded in ``folder``."""
        labels = RunLabels(perception_note=self.note, seed=self.options.seed, home_viewpoint=self.options.viewpoint)
        agent = Agent(self.planner, self.camera, self.perception, folder, budgets=self.options.budgets, labels=labels)
        with TraceWriter(folder.trace) as trace:

            def both(record: Started | Decided | Called | Ended) -> None:
                trace(record)
                listener(record)

            return await agent.run(instruction, conversation=conversation, listener=both)

    async def close(self) -> None:
        await self.opened.aclose()
        await self.perception.close()
        await self.planner.close()


def ask(instruction: str, options: Asking) -> int:
    """Carry out one instruction and show it; the exit code."""
    if not instruction.strip():
        raise InputError("The instruction is empty. Say what the camera should do.")
    folder: RunFolder | None = None

    async def work() -> None:
        nonlocal folder
        session = await Session.open(options)
        folder = RunFolder.create(options.runs_dir, instruction)
        view: Listener = (lambda _: None) if options.as_json else LiveView(Console(highlight=False))
        try:
            await session.run(instruction, folder, view)
        finally:
            folder.discard_if_empty()
            with anyio.CancelScope(shield=True):
                await session.close()

    cancelled = False
    try:
        anyio.run(work)
    except KeyboardInterrupt:
        cancelled = True
    if folder is None or not folder.trace.is_file():
        return CANCELLED
    return _report(folder, options, CANCELLED if cancelled else None)


def _report(folder: RunFolder, options: Asking, code: int | None) -> int:
    trace = read_trace(folder.path)
    if trace.ended is None:
        return CANCELLED
    filmstrip = write_filmstrip(trace)
    if options.as_json:
        put_json(summary(trace.calls, trace.ended, folder.path))
    else:
        show_end(Console(highlight=False), trace.ended, trace.started.labels.perception_note, folder.path, filmstrip)
    return exit_code(trace.ended.outcome) if code is None else code


def summary(calls: tuple[Called, ...], ended: Ended, folder: Path) -> dict[str, Any]:
    """The one object that ``scope ask --json`` prints."""
    return {
        "answer": ended.text,
        "outcome": ended.outcome,
        "tool_calls": [
            {
                "name": c.outcome.call.name,
                "arguments": c.outcome.call.arguments,
                "result": c.outcome.result,
                "error": c.outcome.error,
            }
            for c in calls
        ],
        "pose": ended.pose.pose().as_dict(),
        "timings": ended.timings.model_dump(),
        "run_dir": str(folder),
    }
