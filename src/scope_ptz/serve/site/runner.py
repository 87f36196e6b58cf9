"""Start and execute runs on the site's cameras, whether or not clients follow them."""

from __future__ import annotations

import asyncio
import logging
from dataclasses import dataclass
from typing import Any

from scope_ptz.agent.loop import Agent
from scope_ptz.agent.records import Budgets, RunLabels
from scope_ptz.agent.store import RunFolder
from scope_ptz.agent.tool_calls import RunTool
from scope_ptz.agent.trace import TraceWriter
from scope_ptz.camera.base import Camera
from scope_ptz.camera.guard.dry_run import DryRunCamera
from scope_ptz.errors import ScopeError
from scope_ptz.factory.models import dry_run_note
from scope_ptz.planner.base import PastTurn, Planner
from scope_ptz.planner.limits import MAX_INSTRUCTION_CHARS
from scope_ptz.serve.site.clients import Client
from scope_ptz.serve.site.errors import StoppedError
from scope_ptz.serve.site.run_handle import Record, RunHandle
from scope_ptz.serve.site.run_library import RunLibrary
from scope_ptz.serve.site.station import Station
from scope_ptz.serve.site.tool_call_planner import SingleCallPlanner, call_text
from scope_ptz.store.request_file import RunRequest
from scope_ptz.store.rows import RunKind
from scope_ptz.tools.context import ToolContext
from scope_ptz.tools.registry import TOOLS
from scope_ptz.tools.results import Result

MAX_FINISHED = 50
"""Maximum number of ended runs to keep in memory. Older ones are read from their folders."""

logger = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class RunSpec:
    """The specification of a run.

    Attributes:
        instruction: The instruction, or a tool call as text.
        pair: The name of the pair of models.
        conversation: The id of the conversation, if any.
        kind: Whether the run is an instruction, a dry run, or a direct tool call.
        planner: A planner to use instead of the pair's planner; None to use the pair's planner.
        snapshots: Whether to store pictures of the camera's view in addition to the frames that perception reads.
    """

    instruction: str
    pair: str
    conversation: str | None = None
    kind: RunKind = "instruction"
    planner: Planner | None = None
    snapshots: bool = True

    @classmethod
    def tool_call(cls, name: str, arguments: dict[str, Any], pair: str) -> RunSpec:
        """Return the specification for a run that calls one tool."""
        text = call_text(name, arguments)[:MAX_INSTRUCTION_CHARS]
        return cls(text, pair, kind="tool", planner=SingleCallPlanner(name, arguments), snapshots=False)


class Runner:
    """Executes runs and keeps their state, so that a run continues if its client disconnects, and the client can reconnect.

    Args:
        library: Stores the runs.
        budgets: The limits for a run.
    """

    def __init__(self, library: RunLibrary, budgets: Budgets) -> None:
        self._library, self._budgets = library, budgets
        self._handles: dict[str, RunHandle] = {}
        self._tasks: set[asyncio.Task[None]] = set()

    def find(self, run_id: str) -> RunHandle | None:
        """Return a run that is in progress or ended recently; None for other runs."""
        return self._handles.get(run_id)

    async def start(self, station: Station, spec: RunSpec, client: Client) -> RunHandle:
        """Start a run, and return its handle after its first record.

        Raises:
            NotInControlError: Another client controls the camera.
            BusyError: A run is in progress on the camera.
            ScopeError: The run failed before its first step.
        """
        camera = await station.require_control(client)
        request = RunRequest(kind=spec.kind, camera=station.name, conversation=spec.conversation, actor=client.name)
        folder = RunFolder.create(self._library.root, spec.instruction)
        handle = RunHandle(folder.path.name, spec.instruction, request)
        # The station is busy from here to the end of `_execute`. There must be no `await` between the check above and this line.
        station.current_run = handle
        self._remember(handle)
        task = asyncio.create_task(self._execute(station, camera, spec, folder, handle))
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)
        try:
            await handle.wait_until_started()
        except asyncio.CancelledError:
            handle.cancel()  # the client does not know the id yet, so nobody else could cancel the run
            raise
        return handle

    async def close(self) -> None:
        """Cancel all runs and wait until each has recorded its end."""
        for handle in self._handles.values():
            handle.cancel()
        if self._tasks:
            await asyncio.wait(self._tasks, timeout=10.0)

    def _remember(self, handle: RunHandle) -> None:
        self._handles[handle.id] = handle
        ended = [key for key, known_handle in self._handles.items() if known_handle.done.is_set()]
        for key in ended[: max(0, len(ended) - MAX_FINISHED)]:
            del self._handles[key]

    async def _execute(self, station: Station, camera: Camera, spec: RunSpec, folder: RunFolder, handle: RunHandle) -> None:
        failure: Exception | None = None
        try:
            with handle.cancel_scope:
                await self._run(station, camera, spec, folder, handle)
        except ScopeError as error:
            failure = error
        except Exception as error:  # a bug must not leave the camera busy forever
            logger.exception("A run on %s failed unexpectedly", station.name)
            failure = ScopeError(f"The run failed unexpectedly: {type(error).__name__}. The server's log has details.")
        finally:
            folder.discard_if_not_started()
            if handle.records:
                self._library.index_soon(handle.id)
            elif failure is None:
                failure = StoppedError(station.name)
            station.current_run = None
            station.touch()
            await station.control.clear_if_released()
            handle.finish(failure)

    async def _run(self, station: Station, camera: Camera, spec: RunSpec, folder: RunFolder, handle: RunHandle) -> None:
        models = await station.models(spec.pair)
        if spec.kind == "dry_run":
            camera = DryRunCamera(camera, handle.preview.append)
        else:
            await station.remember()
            (await station.get_open_camera()).record_instruction(f"{handle.request.actor}: {spec.instruction}")
        conversation: tuple[PastTurn, ...] = ()
        if spec.conversation is not None:
            conversation = await self._library.turns(spec.conversation)
        handle.request.write(folder.path)
        note = dry_run_note(models.note) if spec.kind == "dry_run" else models.note
        labels = RunLabels(perception_note=note, seed=0)
        agent = Agent(
            spec.planner or models.planner,
            camera,
            models.perception,
            folder,
            budgets=self._budgets,
            labels=labels,
            snapshots=spec.snapshots,
            run_tool=_record_errors(handle),
        )
        with TraceWriter(folder.trace) as trace:

            def listen(record: Record) -> None:
                trace(record)  # first, so that every record that a client sees is stored
                handle.add(record)
                if len(handle.records) == 1:
                    self._library.index_soon(handle.id)

            result = await agent.run(spec.instruction, conversation=conversation, listener=listen)
        if spec.conversation is not None and spec.kind == "instruction":
            await self._library.add_turn(spec.conversation, result.past_turn())


def _record_errors(handle: RunHandle) -> RunTool:
    """Return a function that runs tool calls and records a call's error in a run's handle."""

    async def run(context: ToolContext, name: str, arguments: Any) -> Result:
        try:
            return await TOOLS.run(context, name, arguments)
        except Exception as error:
            handle.call_error = error
            raise

    return run
