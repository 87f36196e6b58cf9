"""``scope replay``: show a recorded run, and repeat it if it used a simulated camera."""

from __future__ import annotations

from pathlib import Path

from rich.console import Console
from rich.text import Text

from scope_ptz.agent.records import Started
from scope_ptz.agent.replay import Replay
from scope_ptz.agent.replay import replay as repeat
from scope_ptz.agent.trace import Trace, read_trace
from scope_ptz.camera.guard.dry_run import DryRunCamera
from scope_ptz.camera.simulated import SimulatedCamera
from scope_ptz.cli.ask import summary
from scope_ptz.cli.display import LiveView, show_end
from scope_ptz.cli.exit import BAD_INPUT, FAILED, put_json, run_async
from scope_ptz.cli.texts import sanitize
from scope_ptz.errors import InputError, PackError, UnknownNameError
from scope_ptz.factory.scenes import open_scene
from scope_ptz.simulator.clock import SceneClock

_LEAD_TIME_S = 30.0  # the clock starts this many seconds before the run, which leaves time to reach the first pose
_NO_CALLS = "the trace contains no calls, so there is nothing to repeat"


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
        put_json(_as_json(trace, result, reason))
    else:
        _show(trace, result, reason)
    if result is None or (result.matches and not trace.calls):
        return BAD_INPUT
    return 0 if result.matches else FAILED


async def _repeat(trace: Trace) -> Replay:
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
    if camera.viewpoint != started.viewpoint:
        presets = open_scene(started.scene or "").file.presets
        preset = next((p.name for p in presets if p.viewpoint == started.viewpoint), None)
        if preset is None:
            raise UnknownNameError("viewpoint", str(started.viewpoint), {p.viewpoint for p in presets})
        await camera.go_to_preset(preset)
    await camera.move(started.pose.pose())
    await camera.clock.sleep(max(0.0, started.scene_time_s - camera.clock.now_s()))


def _show(trace: Trace, result: Replay | None, reason: str) -> None:
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


def _as_json(trace: Trace, result: Replay | None, reason: str) -> dict[str, object]:
    recorded = summary(trace.calls, trace.ended, trace.folder) if trace.ended else None
    return {
        "recorded": recorded,
        "repeated": result is not None,
        "equal": result.matches if result else None,
        "differences": [c.difference for c in result.comparisons] if result else [],
        "outcome_difference": result.outcome_difference if result else "",
        "reason": reason,
    }
