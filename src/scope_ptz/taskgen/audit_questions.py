"""Write the questions of a picture audit, with the frames that a task's reference program observes."""

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
"""Maximum difference between a view and the preset in its caption, for pan and tilt (degrees) and for zoom (magnification)."""


async def write_question(
    number: str, task: Task, runner: ProgramRunner, out: Path, notify: Callable[[str], None]
) -> dict[str, Any]:
    """Write the pictures of an audit question to a folder, and return the question as JSON data.

    Args:
        number: Number of the question. The names of its pictures begin with it.
        task: The task.
        runner: Runs the task's reference program in its scene.
        out: Folder for the pictures.
        notify: Called with a note if the question has no pictures, because the reference program makes no perception call.

    Raises:
        OutputError: A picture cannot be written.
    """
    episode = await runner.run(task, task.reference, "")
    observations = [call.observations[0] for call in episode.calls if call.observations]
    views = list({(observation.viewpoint, observation.projection): observation for observation in observations}.values())
    pictures = []
    for index, view in enumerate(views, 1):
        name = f"{number}-{index}.jpg"
        image = picture(runner.scene, str(view.viewpoint), view.projection, view.time_s)
        if not cv2.imwrite(str(out / name), cv2.cvtColor(image, cv2.COLOR_RGB2BGR), [cv2.IMWRITE_JPEG_QUALITY, 95]):
            raise OutputError(f"{out / name} cannot be written. Check the folder's permissions and the free disk space.")
        pictures.append({"file": name, "caption": _caption(view, runner.scene)})
    if not pictures:
        notify(f"{task.id} has no pictures, because its reference program makes no perception call")
    return {"q": number, "asked": task.instruction, "pictures": pictures}


def _caption(observation: Observation, scene: Scene) -> str:
    """Return the caption of a picture: its preset (or its viewpoint, if no preset has this view) and its pose."""
    view = observation.projection
    if not isinstance(view, Perspective):
        return "everything around the camera, from pan -180 to 180 degrees"
    zoom = AXIS_M5075_G.zoom_for_hfov(view.hfov_deg)
    presets = [
        p.name
        for p in scene.file.presets
        if p.viewpoint == observation.viewpoint
        and abs(p.pan_deg - view.pan_deg) < POSE_TOLERANCE
        and abs(p.tilt_deg - view.tilt_deg) < POSE_TOLERANCE
        and abs(p.zoom - zoom) < POSE_TOLERANCE
    ]
    place = f"preset {presets[0]}" if presets else f"camera at the {observation.viewpoint}"
    return f"{place}: pan {view.pan_deg:.4g}, tilt {view.tilt_deg:.4g} degrees, zoom {zoom:.3g}x"
