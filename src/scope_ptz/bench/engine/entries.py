"""The entries of an evaluation: instructions to run, each with a scene, a start preset and properties for grouping runs.

Most entries have a task with executable checks. Imported entries have no answer check, so only a judge can score them.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterable, Sequence
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from scope_ptz.bench.tasks.imported import ImportedTask
from scope_ptz.bench.tasks.stratified import SampledTask, answer_key, balanced_sample
from scope_ptz.bench.tasks.task import Task
from scope_ptz.bench.tasks.task_facts import TaskFacts
from scope_ptz.bench.tasks.task_wording import facts_of
from scope_ptz.errors import InputError, TraceError, UnknownNameError
from scope_ptz.simulator.pack import Scene

OpenScene = Callable[[str], Scene]
"""Function that opens a scene or a scene variation by name."""
DIGEST_CHARS = 16
"""Length of the digests in logs, in hexadecimal characters."""


class Entry(BaseModel):
    """One instruction to run.

    Attributes:
        facts: The task's properties, by which reports group runs.
        world: Name of the scene or scene variation to open.
        time_s: Scene time at the start, in seconds.
        task: The task with its checks; None if only a judge can score the run.
        imported: The imported task, if it comes from a file of another format.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    facts: TaskFacts
    world: str
    time_s: Annotated[float, Field(ge=0, allow_inf_nan=False)] = 0.0
    task: Task | None = None
    imported: ImportedTask | None = None

    def metadata(self) -> dict[str, Any]:
        """Return the entry as sample metadata. Metrics and the log viewer group samples by its fields."""
        facts = self.facts.model_dump(mode="json")
        return {
            **facts,
            "place": f"{self.facts.scene}/{self.facts.viewpoint}",
            "world": self.world,
            "time_s": self.time_s,
            "task": self.task.model_dump(mode="json", exclude_defaults=True) if self.task else None,
            "imported": self.imported.model_dump(mode="json") if self.imported else None,
        }

    @classmethod
    def of_metadata(cls, metadata: dict[str, Any]) -> Entry:
        """Return the entry in a sample's metadata.

        Raises:
            TraceError: The metadata contains no entry.
        """
        try:
            facts = {name: metadata[name] for name in TaskFacts.model_fields if name in metadata}
            return cls.model_validate(
                {"facts": facts, **{name: metadata[name] for name in ("world", "time_s", "task", "imported")}}
            )
        except (KeyError, ValidationError) as error:
            raise TraceError("A sample of this log contains no task, so the log is not from this benchmark.") from error


def entry_of(task: Task, scene: Scene) -> Entry:
    """Create the entry for a benchmark task.

    Raises:
        UnknownNameError: The scene does not have the task's preset.
    """
    presets = {preset.name: preset.viewpoint for preset in scene.file.presets}
    if task.preset not in presets:
        raise UnknownNameError(f"preset in {task.scene} (of task {task.id})", task.preset, presets)
    return Entry(facts=facts_of(task, presets[task.preset]), world=task.world, time_s=task.time_s, task=task)


def entries_of(tasks: Iterable[Task], open_scene: OpenScene) -> tuple[Entry, ...]:
    """Create the entries for benchmark tasks."""
    return tuple(entry_of(task, open_scene(task.world)) for task in tasks)


def imported_entries(tasks: Iterable[ImportedTask]) -> tuple[Entry, ...]:
    """Create the entries for imported tasks. A judge scores their answers, and the only check is that expected calls were made."""
    return tuple(Entry(facts=t.facts, world=t.facts.scene, time_s=t.start_s, imported=t) for t in tasks)


def select_entries(
    entries: Sequence[Entry], categories: Sequence[str] = (), scenes: Sequence[str] = (), limit: int | None = None
) -> tuple[Entry, ...]:
    """Return the entries in the given categories and scenes. An empty sequence includes all categories or scenes.

    If there are more than ``limit`` entries, they are sampled evenly across categories, scenes, scopes and answers. The two tasks
    of a contrast pair are sampled together. Sampling is deterministic.

    Raises:
        UnknownNameError: One of the categories or scenes matches no entry.
        InputError: The selection is empty.
    """
    for kind, names, available in (
        ("category", categories, {entry.facts.category for entry in entries}),
        ("scene", scenes, {entry.facts.scene for entry in entries}),
    ):
        for name in names:
            if name not in available:
                raise UnknownNameError(f"{kind} among these tasks", name, available)
    selected = [
        e for e in entries if (not categories or e.facts.category in categories) and (not scenes or e.facts.scene in scenes)
    ]
    if not selected:
        raise InputError("No task matches the selection. Select other categories or scenes.")
    if limit is None or limit >= len(selected):
        return tuple(selected)
    return _sample_evenly(selected, limit)


def _sample_evenly(entries: Sequence[Entry], limit: int) -> tuple[Entry, ...]:
    """Sample entries evenly across categories, scenes, scopes and answers, and return them in their original order."""
    index_of = {entry.facts.id: f"{index:09}" for index, entry in enumerate(entries)}
    chosen = balanced_sample(
        [
            SampledTask(
                f"{index:09}",
                (entry.facts.category, entry.facts.scene, entry.facts.scope),
                "" if entry.task is None else answer_key(entry.task.expected),
                index_of.get(entry.facts.pair or ""),
            )
            for index, entry in enumerate(entries)
        ],
        limit,
    )
    return tuple(entry for index, entry in enumerate(entries) if f"{index:09}" in chosen)


def digest(entries: Iterable[Entry]) -> str:
    """Return a digest of entries that does not depend on their order."""
    rows = sorted(json.dumps(entry.metadata(), sort_keys=True) for entry in entries)
    return hashlib.sha256("\n".join(rows).encode()).hexdigest()[:DIGEST_CHARS]


def datasets(entries: Iterable[Entry]) -> str:
    """Return the dataset versions of entries, separated by "+"."""
    return "+".join(sorted({entry.facts.dataset for entry in entries}))
