"""Show a task to a person: its text, its reference run, and pictures of the start view and the evidence."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path

import anyio
import numpy as np
from PIL import Image

from scope_ptz.agent.drawing import (
    AMBER,
    CYAN,
    EDGE_COLOUR,
    PANEL_COLOUR,
    SECONDARY_TEXT_COLOUR,
    TEXT_COLOUR,
    Canvas,
    shorten,
    to_printable,
    wrap,
)
from scope_ptz.bench.program_runner import MakeToolContext, ProgramRunner
from scope_ptz.bench.scoring.coverage import box_directions
from scope_ptz.bench.scoring.verdict import score_episode
from scope_ptz.bench.tasks.task import EvidenceView, Item, Task
from scope_ptz.errors import OutputError
from scope_ptz.geometry import Equirectangular, Perspective, Pose, Projection
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.views import picture
from scope_ptz.taskgen.facts.answer_phrasing import correct_answers
from scope_ptz.taskgen.facts.robust import TASK_CAMERA

_MARGIN, _HEADER, _LINE_HEIGHT = 28, 118, 24  # pixels
_SWEEP_WIDTH = 2200.0
"""Width of a sweep's picture in pixels."""
_CLOSE_UP = (260, 146)
"""Size of the close-ups below a sweep's picture, in pixels."""


def summary(task: Task, wordings: Sequence[Task]) -> Iterator[str]:
    """Yield lines of text about a task. ``wordings`` are its paraphrases."""
    yield f"{task.id}  ({task.category}, {task.difficulty}, {task.scope} scope; needs {', '.join(task.needs) or 'nothing'})"
    yield f"asked      {task.instruction}"
    for other in wordings:
        yield f"or         {other.instruction}"
    yield f"starts     {task.world}, preset {task.preset}, {task.time_s:g} s"
    yield f"expected   {json.dumps(task.expected.model_dump(exclude_defaults=True), ensure_ascii=False)}"
    for view in task.evidence:
        pose = view.aim
        items = ", ".join(item.instance for item in view.items) or "nothing"
        yield f"evidence   {pose.viewpoint} at {pose.pan_deg:g}/{pose.tilt_deg:g}/{pose.zoom:g}x, {view.scope}: {items}"
    if task.pair:
        yield f"twin       {task.pair}"


def reference_run(task: Task, scene: Scene, make_context: MakeToolContext) -> Iterator[str]:
    """Run a task's reference program, and yield lines with its calls and their results, its answer, and the verdict."""
    text, outcome = correct_answers(task.expected)[0], task.behaviour.outcomes[0]
    runner = ProgramRunner(scene, make_context, TASK_CAMERA)
    episode = anyio.run(runner.run, task, task.reference, text, outcome)
    for call in episode.calls:
        yield f"call       {call.name} {json.dumps(dict(call.arguments))} -> {call.error or (call.result or {}).get('message')}"
    yield f"answer     {text if outcome == 'answered' else f'({outcome})'}"
    verdict = score_episode(task, episode)
    yield f"verdict    {verdict.headline}: {verdict.reason}"


def write_frames(task: Task, scene: Scene, out: Path) -> Iterator[Path]:
    """Write a picture of the start view, and one of each evidence view with its items outlined, and yield the paths."""
    start = next(p for p in scene.file.presets if p.name == task.preset)
    start_projection = TASK_CAMERA.view(Pose(start.pan_deg, start.tilt_deg, start.zoom))
    sheets = [
        (f"{task.id}-start.png", _draw_sheet(task, scene, start.viewpoint, start_projection, (), f"start: preset {start.name}"))
    ]
    for number, view in enumerate(task.evidence, 1):
        caption = f"evidence {number} of {len(task.evidence)}: {_view_caption(view)}"
        sheets.append(
            (f"{task.id}-{number}.png", _draw_sheet(task, scene, view.aim.viewpoint, _projection(view), view.items, caption))
        )
    try:
        out.mkdir(parents=True, exist_ok=True)
        for name, sheet in sheets:
            sheet.save(out / name)
            yield out / name
    except OSError as error:
        raise OutputError(f"Pictures cannot be written to {out}: {error.strerror}. Choose another folder with --out.") from error


def _view_caption(view: EvidenceView) -> str:
    aim = view.aim
    if view.scope == "full":
        return f"everything around {aim.viewpoint}"
    return f"{aim.viewpoint}, pan {aim.pan_deg:g}°, tilt {aim.tilt_deg:g}°, zoom {aim.zoom:g}x"


def _projection(view: EvidenceView) -> Projection:
    aim = view.aim
    return TASK_CAMERA.sweep() if view.scope == "full" else TASK_CAMERA.view(Pose(aim.pan_deg, aim.tilt_deg, aim.zoom))


def _draw_sheet(
    task: Task, scene: Scene, viewpoint: str, projection: Projection, items: Sequence[Item], caption: str
) -> Image.Image:
    """Draw the task's text, the frame and the list of outlined items. For a sweep, also draw a close-up of each item."""
    image = Image.fromarray(picture(scene, viewpoint, projection, task.time_s))
    is_sweep = isinstance(projection, Equirectangular)
    width = _SWEEP_WIDTH if is_sweep else float(projection.width)
    height = width * projection.height / projection.width
    columns = int(width / (_CLOSE_UP[0] + 12)) if is_sweep else 2
    cell = (width / columns, _CLOSE_UP[1] + _LINE_HEIGHT + 18 if is_sweep else _LINE_HEIGHT)
    rows = -(-len(items) // columns)
    canvas = Canvas(width + 2 * _MARGIN, _HEADER + height + _MARGIN + (rows * cell[1] + 24 if rows else 0))
    lines = wrap(task.instruction, 24, width, 2)
    for index, line in enumerate(lines):
        canvas.text(_MARGIN, (72 if len(lines) == 1 else 42) + 30 * index, line, 24, TEXT_COLOUR, bold=True)
    canvas.text(_MARGIN, _HEADER - 16, shorten(to_printable(f"{task.id} · {caption}"), 17, width), 17, SECONDARY_TEXT_COLOUR)
    canvas.picture(image, _MARGIN, _HEADER, width, height)
    for number, item in enumerate(items, 1):
        _outline(canvas, projection, item, number, width, height)
        row, column = divmod(number - 1, columns)
        x, y = _MARGIN + column * cell[0], _HEADER + height + 34 + row * cell[1]
        if is_sweep:
            close_up = Image.fromarray(picture(scene, viewpoint, _close_up_view(item), task.time_s))
            canvas.picture(close_up, x, y - 16, *_CLOSE_UP)
            y += _CLOSE_UP[1] + 8
        canvas.panel(x, y - 14, 34, 20, PANEL_COLOUR, radius=6, edge=EDGE_COLOUR)
        canvas.text(x + 17, y - 4, str(number), 14, AMBER, bold=True, anchor="mm")
        caption_text = item.instance if item.value is None or isinstance(item.value, bool) else f"{item.instance}: {item.value}"
        canvas.text(x + 44, y, shorten(to_printable(caption_text), 17, cell[0] - 60), 17, TEXT_COLOUR)
    return canvas.finish()


def _close_up_view(item: Item) -> Perspective:
    """Return a close-up view of an item and its surroundings."""
    left, bottom, right, top = item.box_deg
    width_deg = (right - left) % 360.0
    hfov_deg = min(max(2.5 * max(width_deg, (top - bottom) * _CLOSE_UP[0] / _CLOSE_UP[1]), 6.0), 80.0)
    return Perspective((left + width_deg / 2 + 180) % 360 - 180, (bottom + top) / 2, hfov_deg, 2 * _CLOSE_UP[0], 2 * _CLOSE_UP[1])


def _outline(canvas: Canvas, projection: Projection, item: Item, number: int, width: float, height: float) -> None:
    points = projection.points(box_directions(item.box_deg)) * (width, height)
    if np.isnan(points).any():
        return
    (x0, y0), (x1, y1) = (tuple(map(float, corner)) for corner in (points.min(axis=0), points.max(axis=0)))
    canvas.frame(_MARGIN + x0, _HEADER + y0, x1 - x0, y1 - y0, CYAN)
    canvas.tag(
        _MARGIN + min(max(x0, 12), width - 12),
        _HEADER + max(y0 - 12, 12),
        str(number),
        13,
        fill=AMBER,
        text_colour="#0E131A",
        anchor="m",
    )
