"""``scope profile``: measure a pair on the user's own servers, and test it against the paper's real-time criterion."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, ConfigDict
from rich.console import Console
from rich.progress import Progress, TextColumn
from rich.text import Text

from scope_ptz.builtin_names import DEFAULT_SCENE
from scope_ptz.cli.display import sanitize
from scope_ptz.cli.exit import FAILED, put_json, run_async
from scope_ptz.endpoints.serving_facts import memory_gb, serving_facts
from scope_ptz.errors import InputError
from scope_ptz.factory.cameras import open_camera
from scope_ptz.factory.models import (
    ModelOptions,
    ResolvedPerception,
    ResolvedPlanner,
    make_perception,
    make_planner,
    resolve_models,
)
from scope_ptz.planner.profile import InstructionRow, Sensitivity, ask_once, load_rows, measure_sensitivity, read_rows
from scope_ptz.planner.profile.perception_speed import PerceptionSpeed, measure_perception
from scope_ptz.planner.profile.prompt_sensitivity import Rate
from scope_ptz.planner.profile.speed import Speed, Spread, speed_of

if TYPE_CHECKING:
    from scope_ptz.camera.base import Frame

REAL_TIME_S = 0.5  # the paper's criterion in seconds per inference, for a control loop of about 2 Hz
_EXTRA_PAN_DEG = 7.0  # pan offset between frames at the same preset, used if there are more frames than presets


@dataclass(frozen=True, slots=True)
class Workload:
    """The instructions and frames for measuring a pair.

    Attributes:
        instructions: An instruction file to use instead of the packaged instructions.
        limit: Maximum number of instructions, sampled evenly.
        frames: Number of frames for perception.
        scene: Scene from which to take the frames.
        edits_prompts: Whether to measure the effect of small edits to the prompt and the instruction.
    """

    instructions: Path | None = None
    limit: int | None = None
    frames: int = 6
    scene: str = DEFAULT_SCENE
    edits_prompts: bool = False


class RoleMeasurements(BaseModel):
    """The measurements of a planner or a perception backend.

    ``meets_real_time`` is None if all requests, or all requests for one skill, failed.
    """

    model_config = ConfigDict(frozen=True)

    name: str
    served_as: str = ""
    url: str = ""
    planner: Speed | None = None
    perception: PerceptionSpeed | None = None
    slowest_median_s: float | None = None
    meets_real_time: bool | None = None
    memory_gb: float | None = None
    computed_memory_gb: float | None = None
    serving: dict[str, str] = {}


def profile(options: ModelOptions, workload: Workload, *, as_json: bool) -> int:
    """Measure a pair, and print the report.

    Returns:
        The exit code: 1 if the real-time criterion cannot be evaluated because requests failed, otherwise 0.
    """
    report: dict[str, Any] = {}
    rows = _load_instructions(workload)

    async def work() -> None:
        resolved = await resolve_models(options)
        if resolved.planner.endpoint is None and resolved.perception.spec is None:
            raise InputError("There is nothing to profile. Give a pair, or a planner or perception with the address of its server.")
        by_role = {}
        if resolved.planner.endpoint is not None:
            by_role["planner"] = await _measure_planner(resolved.planner, rows)
        if resolved.perception.spec is not None:
            by_role["perception"] = await _measure_perception_backend(resolved.perception, workload)
        report.update({role: measured.model_dump() for role, measured in by_role.items()})
        report["real_time"] = _verdict([measured.meets_real_time for measured in by_role.values()])
        if workload.edits_prompts and "planner" in by_role and by_role["planner"].meets_real_time is not None:
            report["prompts"] = (await _sensitivity(resolved.planner, rows)).model_dump()

    run_async(work)
    if as_json:
        put_json(report)
    else:
        _show(Console(highlight=False), report)
    return FAILED if report["real_time"] == "unknown" else 0


def _load_instructions(workload: Workload) -> tuple[InstructionRow, ...]:
    rows = load_rows() if workload.instructions is None else read_rows(workload.instructions)
    if workload.limit is not None and workload.limit < len(rows):
        rows = tuple(rows[i * len(rows) // workload.limit] for i in range(workload.limit))
    return rows


# Measuring -------------------------------------------------------------------------------------------------------------
async def _measure_planner(resolved: ResolvedPlanner, rows: tuple[InstructionRow, ...]) -> RoleMeasurements:
    assert resolved.endpoint is not None  # noqa: S101 - called only with a server
    planner, trials = make_planner(resolved), []
    try:
        first = await ask_once(planner, rows[0])  # loads the model, opens the connection, and fills the prefix cache
        with _progress_bar("planner", len(rows)) as advance:
            for row in rows:
                trials.append(await ask_once(planner, row))
                advance()
    finally:
        await planner.close()
    speed, facts = speed_of(trials, first), await serving_facts(resolved.endpoint)
    return RoleMeasurements(
        name=resolved.name,
        served_as=resolved.endpoint.model,
        url=resolved.endpoint.url,
        planner=speed,
        memory_gb=memory_gb(facts),
        computed_memory_gb=resolved.model.memory_for() if resolved.model else None,
        serving=facts,
        **_criterion_fields(speed.turn_s.median if speed.turn_s else None),
    )


async def _measure_perception_backend(resolved: ResolvedPerception, workload: Workload) -> RoleMeasurements:
    assert resolved.spec is not None  # noqa: S101 - called only with a backend
    frames = await _frames(workload.scene, workload.frames)
    perception = make_perception(resolved, None, 0)
    try:
        with _progress_bar("perception", len(frames) * len(perception.skills)) as advance:
            speed = await measure_perception(perception, frames, advance)
    finally:
        await perception.close()
    facts = await serving_facts(resolved.spec.endpoint) if resolved.spec.endpoint else {}
    return RoleMeasurements(
        name=resolved.name,
        served_as=resolved.spec.model,
        url=resolved.spec.endpoint.url if resolved.spec.endpoint else "",
        perception=speed,
        memory_gb=memory_gb(facts),
        computed_memory_gb=resolved.model.memory_for() if resolved.model else None,
        serving=facts,
        **_criterion_fields(speed.slowest_median_s),
    )


def _criterion_fields(median_s: float | None) -> dict[str, Any]:
    return {"slowest_median_s": median_s, "meets_real_time": None if median_s is None else median_s <= REAL_TIME_S}


async def _frames(scene_name: str, count: int) -> list[Frame]:
    """Take frames at a scene's presets. If ``count`` exceeds the number of presets, further frames are shifted in pan."""
    from scope_ptz.geometry import Pose

    async with await open_camera(f"sim:{scene_name}") as opened:
        camera = opened.camera
        names = [preset.name for preset in await camera.presets()]
        frames = []
        for index in range(count):
            await camera.go_to_preset(names[index % len(names)])
            if index >= len(names):
                pose = await camera.pose()
                await camera.move(Pose(pose.pan_deg + _EXTRA_PAN_DEG * (index // len(names)), pose.tilt_deg, pose.zoom))
            frames.append(await camera.frame())
        return frames


async def _sensitivity(resolved: ResolvedPlanner, rows: tuple[InstructionRow, ...]) -> Sensitivity:
    from scope_ptz.planner.chat import ChatOptions, ChatPlanner, Prompt, load_prompt

    assert resolved.endpoint is not None  # noqa: S101 - called only with a server
    endpoint, options = resolved.endpoint, resolved.options or ChatOptions()

    def planner_with(prompt: Prompt) -> ChatPlanner:
        return ChatPlanner(endpoint, options, prompt=prompt)

    return await measure_sensitivity(planner_with, load_prompt(options.prompt), rows=rows)


def _verdict(meets_real_time: list[bool | None]) -> str:
    if None in meets_real_time:
        return "unknown"
    return "met" if all(meets_real_time) else "missed"


@contextmanager
def _progress_bar(title: str, total: int) -> Iterator[Callable[[], None]]:
    """Show a progress bar if stderr is a terminal, and yield the function that advances it."""
    console = Console(stderr=True)
    columns = (*Progress.get_default_columns(), TextColumn(title))
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task(title, total=total)
        yield lambda: progress.advance(task)


# Printing --------------------------------------------------------------------------------------------------------------
_VERDICTS = {
    "met": ("met", "bold green"),
    "missed": ("missed", "bold yellow"),
    "unknown": ("unknown, because requests failed", "bold red"),
}


def _show(console: Console, report: dict[str, Any]) -> None:
    for role in ("planner", "perception"):
        if role in report:
            _show_role(console, role, RoleMeasurements.model_validate(report[role]))
    console.print(Text.assemble("Real-time criterion of the paper (2 Hz, 500 ms per inference): ", _VERDICTS[report["real_time"]]))
    if "prompts" in report:
        _show_prompts(console, Sensitivity.model_validate(report["prompts"]))


def _show_role(console: Console, role: str, measured: RoleMeasurements) -> None:
    served = f", served as {measured.served_as}" if measured.served_as not in ("", measured.name) else ""
    address = f" at {measured.url}" if measured.url else ""
    console.print(Text.assemble((f"{role} {measured.name}", "bold"), f"{served}{address}"), soft_wrap=True)
    if measured.planner is not None:
        _show_planner(console, measured.planner)
    if measured.perception is not None:
        _show_perception(console, measured.perception)
    reported = (
        f"{measured.memory_gb:g} GB, reported by the server" if measured.memory_gb is not None else "not reported by the server"
    )
    computed = f"; computed: {measured.computed_memory_gb:g} GB" if measured.computed_memory_gb is not None else ""
    console.print(f"  {'memory':16}{reported}{computed}")
    for name, value in measured.serving.items():
        console.print(Text(sanitize(f"  {name}: {value}"), style="dim"), soft_wrap=True)


def _show_planner(console: Console, speed: Speed) -> None:
    console.print(f"  {speed.turns} instructions, first step of each")
    _show_spread(console, "first token", speed.first_token_s, " s")
    _show_spread(console, "whole turn", speed.turn_s, " s")
    _show_spread(console, "tokens/s", speed.tokens_per_s, "")
    for label, rate in (("valid calls", speed.valid), ("expected call", speed.right), ("inverted moves", speed.inverted)):
        interval = "" if rate.share is None else f", 95% {rate.low:.0%} to {rate.high:.0%}"
        console.print(f"  {label:16}{_rate(rate, interval)}")
    _show_failures(console, speed.failures, speed.first_failure)


def _show_perception(console: Console, speed: PerceptionSpeed) -> None:
    console.print(f"  {speed.frames} frames")
    for skill, spread in speed.by_skill.items():
        _show_spread(console, skill, spread, " s")
    for skill in speed.never_worked:
        console.print(Text(f"  {skill:16}no request succeeded", style="red"))
    _show_failures(console, speed.failures, speed.first_failure)


def _rate(rate: Rate, interval: str = "") -> str:
    return "-" if rate.share is None else f"{rate.share:.1%} ({rate.count} of {rate.of}{interval})"


def _show_spread(console: Console, label: str, spread: Spread | None, unit: str) -> None:
    console.print(f"  {label:16}{'-' if spread is None else f'{spread.median:.3g}{unit} (95%: {spread.p95:.3g}{unit})'}")


def _show_failures(console: Console, failures: dict[str, int], first: str) -> None:
    if failures:
        console.print(Text(f"  {'failures':16}{', '.join(f'{n} {kind}' for kind, n in failures.items())}", style="red"))
    if failures and first:
        console.print(Text(f"  {'first failure':16}{sanitize(first)}", style="red"), soft_wrap=True)


def _show_prompts(console: Console, result: Sensitivity) -> None:
    console.print(Text(f"prompt {result.prompt}, {result.instructions} instructions", style="bold"))
    rates = {
        "tools changed by prompt edits": result.by_prompt,
        "by instruction edits": result.by_instruction,
        "without edits (noise)": result.noise,
        "inverted moves, all trials": result.inverted_anywhere,
    }
    for label, rate in rates.items():
        console.print(f"  {label:32}{_rate(rate)}")
