"""``scope ask`` and ``scope replay``: carry out an instruction, and repeat a recorded run. ``scope chat`` also uses ``Session``."""

from __future__ import annotations

import shlex
import shutil
import signal
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import anyio
from anyio.lowlevel import checkpoint
from rich.console import Console
from rich.text import Text

from scope_ptz.agent.filmstrip import write_filmstrip
from scope_ptz.agent.loop import Agent
from scope_ptz.agent.records import Budgets, Called, Decided, Ended, Listener, RunLabels, RunResult, Started
from scope_ptz.agent.store import RunFolder
from scope_ptz.agent.trace import Trace, TraceWriter, read_trace
from scope_ptz.cli import pause_garbage_collection
from scope_ptz.cli.display import LiveView, sanitize, show_end, show_planned
from scope_ptz.cli.exit import (
    BAD_INPUT,
    CANCELLED,
    FAILED,
    exit_code,
    handle_interrupts,
    put,
    put_json,
    run_async,
    run_until_interrupted,
)
from scope_ptz.cli.options import SessionFlags
from scope_ptz.errors import InputError, PackError, UnknownNameError
from scope_ptz.factory.cameras import OpenCamera
from scope_ptz.factory.models import ModelOptions, dry_run_note, make_perception, make_planner, perception_note, resolve_models
from scope_ptz.perception.base import Perception
from scope_ptz.planner.base import PastTurn, Planner
from scope_ptz.settings import load_settings

if TYPE_CHECKING:
    from scope_ptz.agent.replay import Replay
    from scope_ptz.camera.simulated import SimulatedCamera

_LEAD_TIME_S = 30.0  # the clock starts this many seconds before the run, which leaves time to reach the first pose
_NO_CALLS = "the trace contains no calls, so there is nothing to repeat"
_NEXT_STEPS = """
Next:
  {program} ask "count the workers"    another instruction, in your own words
  {program} chat                       a conversation with the camera
  {program} scene list                 the scenes; select one with --scene
  {program} --help                     every command"""


class Session:
    """The camera, perception backend and planner of one or more runs."""

    def __init__(self, flags: SessionFlags, opened: OpenCamera, perception: Perception, planner: Planner, note: str) -> None:
        self.flags, self.perception, self.planner, self.note = flags, perception, planner, note
        self.opened, self.camera = opened, opened.camera
        self.runs_dir = flags.runs_dir or load_settings().runs_dir
        self.planned_commands: list[str] = []
        """The commands that a dry run has reported since the list was last cleared."""

    @classmethod
    async def open(cls, flags: SessionFlags, models: ModelOptions, *, realtime: bool) -> Session:
        """Open the camera and connect to the models.

        Args:
            flags: The options for the camera, its start pose and the limits of runs.
            models: The options for the planner and perception.
            realtime: Whether moves take as long as with a real camera.
        """
        resolved = await resolve_models(models)
        planner = make_planner(resolved.planner)
        planned_commands: list[str] = []
        opened = await flags.open(realtime=realtime, dry_run=planned_commands.append if flags.dry_run else None)
        try:
            if opened.scenes is None and models.perception is None and models.pair is None and resolved.perception.spec is None:
                perception, note = _no_perception(), ""
            else:
                perception = make_perception(resolved.perception, opened.scenes, flags.seed, served_truth=opened.served_truth)
                note = perception_note(resolved.perception)
        except BaseException:
            await opened.aclose()
            raise
        session = cls(flags, opened, perception, planner, dry_run_note(note) if flags.dry_run else note)
        session.planned_commands = planned_commands
        return session

    async def run(
        self, instruction: str, folder: RunFolder, listener: Listener, conversation: tuple[PastTurn, ...] = ()
    ) -> RunResult:
        """Carry out one instruction, and write the trace of the run."""
        self.opened.record_instruction(instruction)
        labels = RunLabels(perception_note=self.note, seed=self.flags.seed, home_viewpoint=self.flags.viewpoint)
        budgets = Budgets(max_steps=self.flags.max_steps, time_s=self.flags.time_budget)
        agent = Agent(self.planner, self.camera, self.perception, folder, budgets=budgets, labels=labels)
        with TraceWriter(folder.trace) as trace:

            def write_and_show(record: Started | Decided | Called | Ended) -> None:
                trace(record)
                listener(record)

            return await agent.run(instruction, conversation=conversation, listener=write_and_show)

    async def close(self) -> None:
        """Close the camera and the connections to model servers."""
        await self.opened.aclose()
        await self.perception.close()
        await self.planner.close()


def ask(instruction: str, flags: SessionFlags, models: ModelOptions, *, as_json: bool, next_steps: bool) -> int:
    """Carry out one instruction, show the run, and return the exit code."""
    if not instruction.strip():
        raise InputError("The instruction is empty. Describe what the camera should do.")
    folder: RunFolder | None = None
    planned_commands: list[str] = []

    async def work() -> None:
        nonlocal folder, planned_commands
        with pause_garbage_collection():  # opening a session imports the modules of its planner, camera and perception backend
            session = await Session.open(flags, models, realtime=flags.in_real_time(as_json=as_json))
        try:
            planned_commands = session.planned_commands
            await checkpoint()
            folder = RunFolder.create(session.runs_dir, instruction)
            view: Listener = (lambda _: None) if as_json else LiveView(Console(highlight=False))
            await session.run(instruction, folder, view)
        finally:
            with anyio.CancelScope(shield=True):
                await session.close()

    try:
        run_until_interrupted(work)
    finally:
        if folder is not None:
            folder.discard_if_not_started()
    if folder is None or not folder.trace.is_file():
        raise KeyboardInterrupt
    with handle_interrupts(signal.SIG_IGN):
        code = _report(folder, planned_commands if flags.dry_run else None, as_json=as_json)
    if next_steps and not as_json and code == 0:
        put(_NEXT_STEPS.format(program=_program()))
    return code


def _program() -> str:
    """Return the shell command that starts this program."""
    if shutil.which("scope"):
        return "scope"
    script = Path(sys.argv[0])
    return shlex.quote(sys.argv[0]) if script.name != "__main__.py" else f"{shlex.quote(sys.executable)} -m scope_ptz.cli"


def make_filmstrip(trace: Trace) -> Path | None:
    """Draw the filmstrip of a run, unless the planner asked for clarification or refused without making a call."""
    if not trace.calls and (trace.ended is None or trace.ended.outcome in ("clarification", "refused")):
        return None
    return write_filmstrip(trace)


def _report(folder: RunFolder, planned_commands: list[str] | None, *, as_json: bool) -> int:
    trace = read_trace(folder.path)
    if trace.ended is None:
        return CANCELLED
    filmstrip = make_filmstrip(trace)
    if as_json:
        dry_run = (
            {}
            if planned_commands is None
            else {"dry_run": True, "planned": planned_commands, "note": trace.started.labels.perception_note}
        )
        put_json({**summary(trace.calls, trace.ended, folder.path), **dry_run})
    else:
        console = Console(highlight=False)
        if planned_commands is not None:
            show_planned(console, planned_commands)
        note = trace.started.labels.perception_note if filmstrip or planned_commands is not None else ""
        show_end(console, trace.ended, note, folder.path, filmstrip)
    code = exit_code(trace.ended.outcome)
    return FAILED if code == 0 and planned_commands is None and has_failed_perception(trace.calls) else code


def has_failed_perception(calls: Sequence[Called]) -> bool:
    """Return whether a perception tool was called in a run but never returned a result."""
    from scope_ptz.tools.registry import TOOLS

    failed = {c.outcome.call.name for c in calls if c.outcome.error is not None}
    succeeded = {c.outcome.call.name for c in calls if c.outcome.error is None}
    return bool((failed - succeeded) & set(TOOLS.perceiving))


def summary(calls: tuple[Called, ...], ended: Ended, folder: Path) -> dict[str, Any]:
    """Return the object that ``scope ask --json`` prints."""
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


def _no_perception() -> Perception:
    """Return the placeholder for missing perception, which raises an error for every perception call."""
    from scope_ptz.perception.no_perception import NoPerception

    return NoPerception("Name a vision model with --perception; `scope models --role perception` lists them.")


def replay(run: Path, *, as_json: bool) -> int:
    """Show and repeat a run. Return the exit code, which is 0 only if calls were repeated and gave the same results."""
    trace = read_trace(run)
    reason = "" if trace.calls else _NO_CALLS
    result: Replay | None = None

    async def work() -> None:
        nonlocal result
        result = await _repeat(trace)

    try:
        run_async(work)
    except (InputError, PackError) as error:
        reason = str(error)
    if as_json:
        put_json(_replay_data(trace, result, reason))
    else:
        _show_replay(trace, result, reason)
    if result is None or (result.matches and not trace.calls):
        return BAD_INPUT
    return 0 if result.matches else FAILED


async def _repeat(trace: Trace) -> Replay:
    from scope_ptz.agent.replay import replay as repeat
    from scope_ptz.camera.guard.dry_run import DryRunCamera
    from scope_ptz.camera.simulated import SimulatedCamera
    from scope_ptz.factory.scenes import open_scene
    from scope_ptz.simulator.clock import SceneClock

    started = trace.started
    if not started.simulated or started.scene is None:
        raise InputError("the run was made with a real camera, and only runs with a simulated camera can be repeated")
    camera = SimulatedCamera(
        open_scene(started.scene),
        viewpoint=started.labels.home_viewpoint,
        clock=SceneClock(started.scene_time_s - _LEAD_TIME_S),
        width=started.frame_width,
        height=started.frame_height,
    )
    await _move_to_start(camera, started)
    return await repeat(trace, DryRunCamera(camera, _ignore) if started.dry_run else camera)


def _ignore(report: str) -> None:
    """Ignore a dry-run report, because the results of the calls contain the same information."""


async def _move_to_start(camera: SimulatedCamera, started: Started) -> None:
    """Move a new camera to the recorded start pose, at the recorded scene time."""
    from scope_ptz.factory.scenes import open_scene

    if camera.viewpoint != started.viewpoint:
        presets = open_scene(started.scene or "").file.presets
        preset = next((p.name for p in presets if p.viewpoint == started.viewpoint), None)
        if preset is None:
            raise UnknownNameError("viewpoint", str(started.viewpoint), {p.viewpoint for p in presets})
        await camera.go_to_preset(preset)
    await camera.move(started.pose.pose())
    await camera.clock.sleep(max(0.0, started.scene_time_s - camera.clock.now_s()))


def _show_replay(trace: Trace, result: Replay | None, reason: str) -> None:
    console = Console(highlight=False)
    view = LiveView(console)
    view(trace.started)
    differences = {(c.recorded.step, c.recorded.index): c.difference for c in result.comparisons} if result else {}
    for call in trace.calls:
        view(call)
        if difference := differences.get((call.step, call.index)):
            console.print(Text(f"     differs: {sanitize(difference)}", style="bold red"))
    if trace.ended is None:
        console.print(Text("The trace ends here: the run was interrupted.", style="bold red"))
    else:
        show_end(console, trace.ended, trace.started.labels.perception_note, trace.folder, None)
    console.print()
    style = "bold green" if result and result.matches and not reason else "bold yellow"
    console.print(Text(_verdict(result, reason), style=style))


def _verdict(result: Replay | None, reason: str) -> str:
    if result is None:
        return f"Shown from the trace only, not repeated: {sanitize(reason)}"
    count = len(result.comparisons)
    if not result.matches:
        differing = sum(1 for c in result.comparisons if c.difference)
        tail = f"; {sanitize(result.outcome_difference)}" if result.outcome_difference else ""
        return f"Repeated without models: {differing} of {count} calls gave different results{tail}."
    if reason:
        return f"Shown from the trace only: {sanitize(reason)}."
    return f"Repeated without models: all {count} calls gave the same results."


def _replay_data(trace: Trace, result: Replay | None, reason: str) -> dict[str, object]:
    recorded = summary(trace.calls, trace.ended, trace.folder) if trace.ended else None
    return {
        "recorded": recorded,
        "repeated": result is not None,
        "equal": result.matches if result else None,
        "differences": [c.difference for c in result.comparisons] if result else [],
        "outcome_difference": result.outcome_difference if result else "",
        "reason": reason,
    }
