"""The published tasks by their ids, and the viewpoints of the presets of the scenes in the package.

Logs and submissions contain copies of their tasks. Scores use the published task instead, so a modified copy has no effect.
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
"""The splits that together contain each published task exactly once."""


@lru_cache(maxsize=1)
def published_tasks() -> Mapping[str, Task]:
    """Return the tasks of every published split that is installed, by id."""
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
    """Return the viewpoint of each preset by its name, and the viewpoint of the home preset.

    Args:
        world: Name of a scene, or of a variation of a scene, which has its own presets.

    Returns:
        None if the package does not contain the scene.
    """
    try:
        file = load_scene(world).file
    except (UnknownNameError, PackError):
        return None
    presets = {preset.name: preset.viewpoint for preset in file.presets}
    return presets, presets[file.home_preset]
