"""Runs of the real agent with the built-in planner, and what their traces say about a fault."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from scope_ptz.agent.filmstrip import draw_filmstrip
from scope_ptz.agent.loop import Agent
from scope_ptz.agent.records import Called, Decided, Ended, RunResult, Started
from scope_ptz.agent.replay import replay
from scope_ptz.agent.store import RunFolder
from scope_ptz.agent.trace import Trace, TraceWriter, read_trace
from scope_ptz.camera.base import Camera
from scope_ptz.errors import CameraError, ScopeError, TraceError
from scope_ptz.planner.grammar import GrammarPlanner
from scope_ptz.tools.context import ToolContext
from scope_ptz.tools.registry import TOOLS
from scope_ptz.tools.results import Result
from tests.agent.scripted import ScriptedCamera, ScriptedPerception
from tests.camera.faults.drivers import ACCOUNTS


@dataclass(frozen=True)
class Run:
    """A finished run.

    Attributes:
        result: What the agent returned.
        trace: The trace as read from its file.
        errors: What the tools raised, in order.
    """

    result: RunResult
    trace: Trace
    errors: list[ScopeError]


async def ask(camera: Camera, instruction: str, root: Path, *, when_started: Callable[[], object] = lambda: None) -> Run:
    """Let the agent carry out an instruction, and read its trace from the file.

    Args:
        camera: The camera.
        instruction: The instruction.
        root: Folder of the run.
        when_started: What happens between the first look at the camera and the first step.
    """
    folder, errors = RunFolder.create(root, "fault"), list[ScopeError]()

    async def observed(context: ToolContext, name: str, arguments: Any) -> Result:
        try:
            return await TOOLS.run(context, name, arguments)
        except ScopeError as error:
            errors.append(error)
            raise

    agent = Agent(GrammarPlanner(), camera, ScriptedPerception(3), folder, run_tool=observed)
    with TraceWriter(folder.trace) as trace:

        def listen(record: Started | Decided | Called | Ended) -> None:
            trace(record)
            if isinstance(record, Started):
                when_started()

        result = await agent.run(instruction, listener=listen)
    return Run(result, read_trace(folder.path), errors)


async def expect_camera_error(run: Run, error: type[CameraError], words: str) -> Called:
    """Check that a run ended in a typed error that planner and person see, and that its trace is whole.

    Returns:
        The call that failed.
    """
    (raised,) = run.errors
    assert type(raised) is error, repr(raised)
    message = str(raised)
    assert words in message, message
    assert message.endswith((".", ")")), message
    # The person.
    assert (run.result.ended.outcome, run.result.ended.text) == ("camera_error", message)
    # The planner.
    failed = run.result.exchanges[-1].outcomes[-1]
    assert failed.error == message
    assert failed.result is None
    await _expect_whole(run)
    assert run.trace.calls[-1].outcome == failed
    assert run.trace.calls[-1].fault == "camera"
    return run.trace.calls[-1]


async def expect_answer(run: Run) -> None:
    """Check that a run was carried out in spite of a fault."""
    assert (run.result.ended.outcome, run.errors) == ("answered", []), run.result.ended.text
    await _expect_whole(run)


async def _expect_whole(run: Run) -> None:
    """Check that a trace has a beginning and an end, every call of every decision, no password, and can be read and drawn."""
    trace = run.trace
    assert trace.ended is not None
    assert trace.ended == run.result.ended
    assert not trace.started.simulated
    decided = [call.id for step in trace.decisions if step.decision.kind == "call" for call in step.decision.calls]
    assert [call.outcome.call.id for call in trace.calls] == decided
    assert [call.outcome for call in trace.calls] == [outcome for each in run.result.exchanges for outcome in each.outcomes]
    assert draw_filmstrip(trace) is not None
    # A run of a real camera can be read by a replay, which says why it cannot be repeated.
    with pytest.raises(TraceError, match="real camera"):
        await replay(trace, ScriptedCamera())
    content = b"".join(path.read_bytes() for path in trace.folder.rglob("*.jsonl"))
    assert not any(account.password.encode() in content for account in ACCOUNTS)
