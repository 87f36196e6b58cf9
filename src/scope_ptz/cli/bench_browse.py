"""A task for a person to look at: its words, the run of its reference program, the frames of its evidence."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import anyio
import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.bench.coverage import box_directions
from scope_ptz.bench.episode import Eyes
from scope_ptz.bench.phrasing import right_answers
from scope_ptz.bench.run_program import Stage
from scope_ptz.bench.tasks import EvidenceView, Task
from scope_ptz.bench.verdict import judge
from scope_ptz.cli.bench_eyes import equip_with_truth
from scope_ptz.geometry import Pose
from scope_ptz.world.pack import Scene
from scope_ptz.world.views import picture

EYES = Eyes(1280, 720)
_YELLOW = (255, 220, 0)


def summary(task: Task) -> Iterator[str]:
    yield f"{task.id}  ({task.category}, {task.difficulty}, {task.scope} scope; needs {', '.join(task.needs) or 'nothing'})"
    yield f"asked      {task.instruction}"
    yield f"starts     {task.scene}, preset {task.preset}, {task.time_s:g} s"
    yield f"expected   {json.dumps(task.expected.model_dump(exclude_defaults=True), ensure_ascii=False)}"
    for view in task.evidence:
        pose = view.aim
        items = ", ".join(item.instance for item in view.items) or "nothing"
        yield f"evidence   {pose.viewpoint} at {pose.pan_deg:g}/{pose.tilt_deg:g}/{pose.zoom:g}x, {view.scope}: {items}"


def reference_run(task: Task, scene: Scene) -> Iterator[str]:
    """The calls of the reference program with what the tools said, and the verdict on it."""
    text, outcome = right_answers(task.expected)[0], task.behaviour.outcomes[0]
    stage = Stage(scene, equip_with_truth({scene.name: scene}), EYES)
    episode = anyio.run(stage.run, task, task.reference, text, outcome)
    for call in episode.calls:
        yield f"call       {call.name} {json.dumps(dict(call.arguments))} -> {call.error or (call.result or {}).get('message')}"
    yield f"answer     {text}"
    verdict = judge(task, episode)
    yield f"verdict    {verdict.headline}: {verdict.reason}"


def frames(task: Task, scene: Scene, out: Path) -> Iterator[Path]:
    """A picture of each view of the evidence, what counted in it outlined."""
    out.mkdir(parents=True, exist_ok=True)
    for number, view in enumerate(task.evidence, 1):
        path = out / f"{task.id}-{number}.jpg"
        cv2.imwrite(str(path), cv2.cvtColor(_frame(view, scene, task.time_s), cv2.COLOR_RGB2BGR))
        yield path


def _frame(view: EvidenceView, scene: Scene, time_s: float) -> NDArray[np.uint8]:
    aim = view.aim
    projection = EYES.sweep() if view.scope == "full" else EYES.view(Pose(aim.pan_deg, aim.tilt_deg, aim.zoom))
    image = picture(scene, aim.viewpoint, projection, time_s)
    for item in view.items:
        points = projection.points(box_directions(item.box_deg)) * (projection.width, projection.height)
        if not np.isnan(points).any():
            low, high = (tuple(int(v) for v in corner) for corner in (points.min(axis=0), points.max(axis=0)))
            cv2.rectangle(image, low, high, _YELLOW, 2)
    return image
