"""``scope replay``: show a recorded run, and repeat it where its world can be had again."""

from __future__ import annotations

from pathlib import Path

import anyio
from rich.console import Console
from rich.text import Text

from scope_ptz.agent.records import Started
from scope_ptz.agent.replay import Replay
from scope_ptz.agent.replay import replay as repeat
from scope_ptz.agent.trace import Trace, read_trace
from scope_ptz.camera.simulated import SimulatedCamera
from scope_ptz.cli.asking import summary
from scope_ptz.cli.display import LiveView, plain, show_end
from scope_ptz.cli.endings import FAILED, put_json
from scope_ptz.errors import InputError, PackError, UnknownNameError
from scope_ptz.factory.scenes import open_scene
from scope_ptz.simulator.clock import SceneClock

_LEAD_S = 30.0
"""The clock starts this much before the run, so that getting to the first pose ends in time."""


def replay(run: Path, *, as_json: bool) -> int:
    """Show and repeat a run; the exit code says whether it came out the same."""
    trace = read_trace(run)
    why_not, found = "", None
    try:
        found = anyio.run(_repeat, trace)
    except (InputError, PackError) as error:
        why_not = str(error)
    if as_json:
        put_json(_as_json(trace, found, why_not))
    else:
        _show(trace, found, why_not)
    return FAILED if found is not None and not found.equal else 0


async def _repeat(trace: Trace) -> Replay:
    started = trace.started
    if not started.simulated or started.scene is None:
        raise InputError("the run was made with a real camera, whose world cannot be had again")
    camera = SimulatedCamera(
        open_scene(started.scene),
        viewpoint=started.labels.home_viewpoint,
        clock=SceneClock(started.scene_time_s - _LEAD_S),
        width=started.frame_width,
        height=started.frame_height,
    )
    await _take_position(camera, started)
    return await repeat(trace, camera)


async def _take_position(camera: SimulatedCamera, started: Started) -> None:
    """Bring a fresh camera to where the recorded one was, at that scene time."""
    if camera.viewpoint != started.viewpoint:
        presets = open_scene(started.scene or "").file.presets
        there = next((p.name for p in presets if p.viewpoint == started.viewpoint), None)
        if there is None:
            raise UnknownNameError("viewpoint", str(started.viewpoint), {p.viewpoint for p in presets})
        await camera.go_to_preset(there)
    await camera.move(started.pose.pose())
    await camera.clock.sleep(max(0.0, started.scene_time_s - camera.clock.now_s()))


def _show(trace: Trace, found: Replay | None, why_not: str) -> None:
    console = Console(highlight=False)
    view = LiveView(console)
    view(trace.started)
    differences = {(c.recorded.step, c.recorded.index): c.difference for c in found.comparisons} if found else {}
    for call in trace.calls:
        view(call)
        if difference := differences.get((call.step, call.index)):
            console.print(Text(f"     differs: {plain(difference)}", style="bold red"))
    if trace.ended is None:
        console.print(Text("The recording was cut off here.", style="bold red"))
    else:
        show_end(console, trace.ended, trace.started.labels.perception_note, trace.folder, None)
    console.print()
    console.print(Text(_verdict(found, why_not), style="bold green" if found and found.equal else "bold yellow"))


def _verdict(found: Replay | None, why_not: str) -> str:
    if found is None:
        return f"Shown from the trace only, not repeated: {plain(why_not)}"
    count = len(found.comparisons)
    if found.equal:
        return f"Repeated without models: all {count} calls gave the same results."
    wrong = sum(1 for c in found.comparisons if c.difference)
    tail = f"; {plain(found.outcome_difference)}" if found.outcome_difference else ""
    return f"Repeated without models: {wrong} of {count} calls came out different{tail}."


def _as_json(trace: Trace, found: Replay | None, why_not: str) -> dict[str, object]:
    recorded = summary(trace.calls, trace.ended, trace.folder) if trace.ended else None
    return {
        "recorded": recorded,
        "repeated": found is not None,
        "equal": found.equal if found else None,
        "differences": [c.difference for c in found.comparisons] if found else [],
        "outcome_difference": found.outcome_difference if found else "",
        "reason": why_not,
    }
