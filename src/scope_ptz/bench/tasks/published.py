"""Look up published tasks by id, and the viewpoints of presets in packaged scenes.

Logs and submissions contain copies of their tasks. Scoring uses the published tasks instead, so modified copies have no effect.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

from scope_ptz.bench.tasks.files import digest_of
from scope_ptz.bench.tasks.splits import load_split
from scope_ptz.bench.tasks.task import Task
from scope_ptz.errors import InputError, PackError, UnknownNameError
from scope_ptz.simulator.pack import load_scene

PUBLISHED_SPLITS = ("core", "paraphrase", "reaction", "unseen")
"""The splits that together contain every published task exactly once."""


@lru_cache(maxsize=1)
def published_tasks() -> Mapping[str, Task]:
    """Return the tasks of all installed published splits, by id."""
    tasks: dict[str, Task] = {}
    for split in PUBLISHED_SPLITS:
        try:
            tasks.update({task.id: task for task in load_split(split)})
        except InputError:
            continue
    return tasks


@lru_cache(maxsize=4096)
def published_digest(task_id: str) -> str | None:
    """Return the digest of a published task; None if there is no published task with this id."""
    task = published_tasks().get(task_id)
    return None if task is None else digest_of([task])


@lru_cache(maxsize=256)
def preset_viewpoints(world: str) -> tuple[Mapping[str, str], str] | None:
    """Return the viewpoints of a scene's presets by name, and the viewpoint of the home preset.

    Args:
        world: Name of a scene or of a scene variation. A variation has its own presets.

    Returns:
        The viewpoints, or None if the package does not contain the scene.
    """
    try:
        file = load_scene(world).file
    except (UnknownNameError, PackError):
        return None
    presets = {preset.name: preset.viewpoint for preset in file.presets}
    return presets, presets[file.home_preset]
