"""``scope profile``: what a pair does on the user's own servers: speed, well-formed calls, perception latency, and the verdict on
the paper's real-time bar."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

import anyio
from pydantic import BaseModel, ValidationError
from rich.console import Console
from rich.progress import Progress, TextColumn

from scope_ptz.builtin_names import DEFAULT_SCENE
from scope_ptz.cli.endings import FAILED, put_json
from scope_ptz.cli.profile_report import PerceptionSpeed, Side, show
from scope_ptz.endpoints.serving_facts import memory_gb, serving_facts
from scope_ptz.errors import InputError, PerceptionError
from scope_ptz.factory.cameras import open_camera
from scope_ptz.factory.models import (
    ModelOptions,
    ResolvedPerception,
    ResolvedPlanner,
    make_perception,
    make_planner,
    resolve_models,
)
from scope_ptz.factory.scenes import open_scene
from scope_ptz.planner.profile import InstructionRow, Sensitivity, ask_once, load_rows, measure_sensitivity
from scope_ptz.planner.profile.speed import Spread, speed_of

if TYPE_CHECKING:
    from scope_ptz.camera.base import Frame
    from scope_ptz.perception.base import Perception

REAL_TIME_S = 0.5
"""The paper's bar: a control loop of about 2 Hz, 500 ms an inference or less."""
THING, QUESTION = "car", "What is the main thing in this picture? Answer in a few words."


@dataclass(frozen=True, slots=True)
class Extent:
    """How much to measure. ``instructions``: a file in place of the packaged set; ``limit``: so many of them, evenly chosen."""

    instructions: Path | None = None
    limit: int | None = None
    frames: int = 6
    scene: str = DEFAULT_SCENE
    prompts: bool = False


def profile(wishes: ModelOptions, extent: Extent, *, as_json: bool) -> int:
    """Measure and print; exit code 0 whatever the verdict is, 1 when there is nothing to judge: no request of a side succeeded."""
    report: dict[str, Any] = {}
    rows = _rows(extent)

    async def work() -> None:
        choice = await resolve_models(wishes)
        if choice.planner.endpoint is None and choice.perception.spec is None:
            raise InputError("Say what to profile: a pair, or a planner or eyes with the address of its server.")
        sides = {}
        if choice.planner.endpoint is not None:
            sides["planner"] = await _planner_side(choice.planner, rows)
        if choice.perception.spec is not None:
            sides["eyes"] = await _eyes_side(choice.perception, extent)
        report.update({role: side.model_dump() for role, side in sides.items()})
        report["real_time"] = _verdict([side.meets_real_time for side in sides.values()])
        if extent.prompts and "planner" in sides and sides["planner"].meets_real_time is not None:
            report["prompts"] = (await _sensitivity(choice.planner, rows)).model_dump()

    anyio.run(work)
    if as_json:
        put_json(report)
    else:
        show(Console(highlight=False), report)
    return FAILED if report["real_time"] == "unknown" else 0


def _rows(extent: Extent) -> tuple[InstructionRow, ...]:
    rows = load_rows() if extent.instructions is None else _read(extent.instructions)
    if extent.limit is not None and extent.limit < len(rows):
        rows = tuple(rows[i * len(rows) // extent.limit] for i in range(extent.limit))
    return rows


def _read(source: Path) -> tuple[InstructionRow, ...]:
    """The lines of a file of instructions that have calls; other lines expect a question back, and are no test of calls."""
    try:
        lines = source.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{source} cannot be read: {error}.") from error
    rows: list[InstructionRow] = []
    for number, line in enumerate(lines, 1):
        if not line.strip():
            continue
        try:
            given = _Line.model_validate_json(line)
            if given.calls:
                rows.append(InstructionRow.model_validate(given.model_dump()))
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            where = ".".join(str(part) for part in first["loc"])
            raise InputError(f"{source}, line {number}: {f'{where}: ' if where else ''}{first['msg']}.") from error
    if not rows:
        raise InputError(f"{source} holds no instruction with expected calls.")
    return tuple(rows)


class _Line(BaseModel):
    instruction: str
    kind: str = ""
    calls: list[dict[str, Any]] = []
    alternatives: tuple[str, ...] = ()


async def _planner_side(choice: ResolvedPlanner, rows: tuple[InstructionRow, ...]) -> Side:
    assert choice.endpoint is not None  # noqa: S101 - asked for only then
    planner, trials = make_planner(choice), []
    try:
        first = await ask_once(planner, rows[0])  # Loads the model, opens the connection, fills the prefix cache
        with _bar("planner", len(rows)) as advance:
            for row in rows:
                trials.append(await ask_once(planner, row))
                advance()
    finally:
        await planner.close()
    speed, facts = speed_of(trials, first), await serving_facts(choice.endpoint)
    middle = speed.turn_s.median if speed.turn_s else None
    return Side(
        name=choice.name,
        served_as=choice.endpoint.model,
        url=choice.endpoint.url,
        planner=speed,
        slowest_median_s=middle,
        meets_real_time=None if middle is None else middle <= REAL_TIME_S,
        memory_gb=memory_gb(facts),
        computed_memory_gb=choice.model.memory_for() if choice.model else None,
        serving=facts,
    )


async def _eyes_side(choice: ResolvedPerception, extent: Extent) -> Side:
    assert choice.spec is not None  # noqa: S101 - asked for only then
    frames = await _frames(extent.scene, extent.frames)
    eyes = make_perception(choice, open_scene, 0)
    try:
        speed = await _look(eyes, frames)
    finally:
        await eyes.close()
    facts = await serving_facts(choice.spec.endpoint) if choice.spec.endpoint else {}
    # A skill that never worked is not fast.
    slowest = max((spread.median for spread in speed.by_skill.values()), default=None) if not speed.never_worked else None
    return Side(
        name=choice.name,
        served_as=choice.spec.model,
        url=choice.spec.endpoint.url if choice.spec.endpoint else "",
        eyes=speed,
        slowest_median_s=slowest,
        meets_real_time=None if slowest is None else slowest <= REAL_TIME_S,
        memory_gb=memory_gb(facts),
        computed_memory_gb=choice.model.memory_for() if choice.model else None,
        serving=facts,
    )


async def _frames(scene_name: str, count: int) -> list[Frame]:
    """Frames of a scene's presets, and turned on from them when more are wanted: no two alike, so that nothing is cached."""
    from scope_ptz.geometry import Pose

    async with await open_camera(scene_name) as opened:
        camera = opened.camera
        names = [preset.name for preset in await camera.presets()]
        frames = []
        for index in range(count):
            await camera.go_to_preset(names[index % len(names)])
            if index >= len(names):
                pose = await camera.pose()
                await camera.move(Pose(pose.pan_deg + 7.0 * (index // len(names)), pose.tilt_deg, pose.zoom))
            frames.append(await camera.frame())
        return frames


async def _look(eyes: Perception, frames: list[Frame]) -> PerceptionSpeed:
    skills: dict[str, Callable[[Frame], Awaitable[object]]] = {
        "query": lambda frame: eyes.query(frame, QUESTION),
        "caption": eyes.caption,
        "detect": lambda frame: eyes.detect(frame, THING),
        "point": lambda frame: eyes.point(frame, THING),
    }
    times: dict[str, list[float]] = {name: [] for name in skills if name in eyes.skills}
    failures: dict[str, int] = {}
    first = ""
    with _bar("eyes", len(frames) * len(times)) as advance:
        for number, frame in enumerate([frames[0], *frames]):
            for name in times:
                began = perf_counter()
                try:
                    await skills[name](frame)
                    if number:  # The first round loads the model and opens the connection
                        times[name].append(perf_counter() - began)
                except PerceptionError as error:
                    kind, first = error.kind or "perception", first or str(error)
                    failures[kind] = failures.get(kind, 0) + bool(number)
                advance(bool(number))
    by_skill = {name: spread for name, values in times.items() if (spread := Spread.of(values)) is not None}
    return PerceptionSpeed(
        frames=len(frames),
        by_skill=by_skill,
        never_worked=tuple(name for name in times if name not in by_skill),
        failures={k: n for k, n in failures.items() if n},
        first_failure=first,
    )


async def _sensitivity(choice: ResolvedPlanner, rows: tuple[InstructionRow, ...]) -> Sensitivity:
    from scope_ptz.planner.chat import ChatOptions, ChatPlanner, Prompt, load_prompt

    assert choice.endpoint is not None  # noqa: S101 - asked for only then
    endpoint, options = choice.endpoint, choice.options or ChatOptions()

    def make(prompt: Prompt) -> ChatPlanner:
        return ChatPlanner(endpoint, options, prompt=prompt)

    return await measure_sensitivity(make, load_prompt(options.prompt), rows=rows)


def _verdict(sides: list[bool | None]) -> str:
    if None in sides:
        return "unknown"
    return "met" if all(sides) else "missed"


@contextmanager
def _bar(about: str, total: int) -> Iterator[Callable[..., None]]:
    """A progress bar on stderr, for terminals only."""
    console = Console(stderr=True)
    columns = (*Progress.get_default_columns(), TextColumn(about))
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task(about, total=total)
        yield lambda steps=1: progress.advance(task, int(steps))
