"""The questions of an audit: frames on which the answer of a task rests, with a caption that says where each was taken."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2

from scope_ptz.bench.program_runner import ProgramRunner
from scope_ptz.bench.scoring.episode import Observation
from scope_ptz.bench.tasks.task import Task
from scope_ptz.errors import OutputError
from scope_ptz.geometry import AXIS_M5075_G, Perspective
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.views import picture

POSE_TOLERANCE = 0.01
"""Degrees, or magnification, by which a view may differ from the preset that its caption names."""


async def write_question(q: str, task: Task, stage: ProgramRunner, out: Path, notify: Callable[[str], None]) -> dict[str, Any]:
    """Write the pictures of a question into a folder, and return its row."""
    episode = await stage.run(task, task.reference, "")
    looks = list({(look.viewpoint, look.projection): look for call in episode.calls for look in call.observations[:1]}.values())
    shown = []
    for number, look in enumerate(looks, 1):
        name = f"{q}-{number}.jpg"
        image = picture(stage.scene, str(look.viewpoint), look.projection, look.time_s)
        if not cv2.imwrite(str(out / name), cv2.cvtColor(image, cv2.COLOR_RGB2BGR), [cv2.IMWRITE_JPEG_QUALITY, 95]):
            raise OutputError(f"{out / name} cannot be written.")
        shown.append({"file": name, "caption": _caption(look, stage.scene)})
    if not shown:
        notify(f"{task.id} makes no perception call")
    return {"q": q, "asked": task.instruction, "pictures": shown}


def _caption(look: Observation, scene: Scene) -> str:
    """Return where a picture was taken, as the operator of the camera would know it."""
    view = look.projection
    if not isinstance(view, Perspective):
        return "everything around the camera, from pan -180 to 180 degrees"
    zoom = AXIS_M5075_G.zoom_for_hfov(view.hfov_deg)
    at = [
        p.name
        for p in scene.file.presets
        if p.viewpoint == look.viewpoint
        and abs(p.pan_deg - view.pan_deg) < POSE_TOLERANCE
        and abs(p.tilt_deg - view.tilt_deg) < POSE_TOLERANCE
        and abs(p.zoom - zoom) < POSE_TOLERANCE
    ]
    place = f"preset {at[0]}" if at else f"camera at the {look.viewpoint}"
    return f"{place}: pan {view.pan_deg:.4g}, tilt {view.tilt_deg:.4g} degrees, zoom {zoom:.3g}x"
