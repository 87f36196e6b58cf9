"""Entries of an evaluation: each is one instruction in one view of a scene, with the facts by which reports group runs.

Most entries have a task with executable checks. Entries imported from other formats have none, and only a judge can score them.
"""

from __future__ import annotations

import hashlib
import json
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from scope_ptz.bench.tasks.imported import ImportedTask
from scope_ptz.bench.tasks.task import Task
from scope_ptz.bench.tasks.task_facts import TaskFacts
from scope_ptz.bench.tasks.task_wording import facts_of
from scope_ptz.errors import InputError, TraceError, UnknownNameError
from scope_ptz.simulator.pack import Scene

OpenScene = Callable[[str], Scene]
DIGEST_CHARS = 16


class Entry(BaseModel):
    """One instruction to run.

    Attributes:
        facts: The facts about the task, by which reports group runs.
        world: Name under which the scene, or its variation, is opened.
        time_s: Scene time at the start.
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
        """Return the entry as a log stores it. Metrics and the log viewer group by its facts."""
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
        """Return the entry that a log stores. Raises ``TraceError`` when there is none."""
        try:
            facts = {name: metadata[name] for name in TaskFacts.model_fields if name in metadata}
            return cls.model_validate(
                {"facts": facts, **{name: metadata[name] for name in ("world", "time_s", "task", "imported")}}
            )
        except (KeyError, ValidationError) as error:
            raise TraceError("A sample of this log names no task. The log is not one of this benchmark.") from error


def entry_of(task: Task, scene: Scene) -> Entry:
    """Return the entry of a benchmark task. Raises ``UnknownNameError`` when the scene lacks its preset."""
    presets = {preset.name: preset.viewpoint for preset in scene.file.presets}
    if task.preset not in presets:
        raise UnknownNameError(f"preset in {task.scene} (of task {task.id})", task.preset, presets)
    return Entry(facts=facts_of(task, presets[task.preset]), world=task.world, time_s=task.time_s, task=task)


def entries_of(tasks: Iterable[Task], open_scene: OpenScene) -> tuple[Entry, ...]:
    """Return the entries of benchmark tasks."""
    return tuple(entry_of(task, open_scene(task.world)) for task in tasks)


def imported_entries(tasks: Iterable[ImportedTask]) -> tuple[Entry, ...]:
    """Return the entries of imported tasks. A judge scores them; the only check is that of their expected calls."""
    return tuple(Entry(facts=t.facts, world=t.facts.scene, time_s=t.start_s, imported=t) for t in tasks)


def select(
    entries: Sequence[Entry], categories: Sequence[str] = (), scenes: Sequence[str] = (), limit: int | None = None
) -> tuple[Entry, ...]:
    """Return at most ``limit`` entries of the given categories and scenes; without categories or scenes, of all.

    They are sampled evenly across the selected categories, scenes and scopes. The sample is always the same.

    Raises:
        UnknownNameError: No entry has one of the categories or scenes.
        InputError: The selection is empty.
    """
    for kind, names, have in (
        ("category", categories, {entry.facts.category for entry in entries}),
        ("scene", scenes, {entry.facts.scene for entry in entries}),
    ):
        for name in names:
            if name not in have:
                raise UnknownNameError(f"{kind} among these tasks", name, have)
    kept = [e for e in entries if (not categories or e.facts.category in categories) and (not scenes or e.facts.scene in scenes)]
    if not kept:
        raise InputError("No task matches the selection. Select other categories or scenes.")
    if limit is None or limit >= len(kept):
        return tuple(kept)
    return _sample_evenly(kept, limit)


def _sample_evenly(entries: Sequence[Entry], limit: int) -> tuple[Entry, ...]:
    """Sample entries evenly, keeping their order.

    Each step takes an entry from the group (category, scene, scope) that is least represented so far, relative to the numbers of
    entries with its category, its scene and its scope. Within a group, entries are taken at equal distances.
    """
    groups: dict[tuple[str, str, str], list[Entry]] = {}
    for entry in entries:
        groups.setdefault((entry.facts.category, entry.facts.scene, entry.facts.scope), []).append(entry)
    there = Counter((place, name) for group, own in groups.items() for place, name in enumerate(group) for _ in own)
    taken, used = Counter[tuple[int, str]](), Counter[tuple[str, str, str]]()
    for _ in range(limit):
        open_ = [group for group, own in groups.items() if used[group] < len(own)]
        # Ties go to the group with most entries left, so that they do not use up small groups.
        least = min(open_, key=lambda s: (sum(Fraction(taken[f], there[f]) for f in enumerate(s)), used[s] - len(groups[s])))
        used[least] += 1
        taken.update(enumerate(least))
    selected = {id(own[at * len(own) // used[group]]) for group, own in groups.items() for at in range(used[group])}
    return tuple(entry for entry in entries if id(entry) in selected)


def digest(entries: Iterable[Entry]) -> str:
    """Return a digest of entries that does not depend on their order."""
    rows = sorted(json.dumps(entry.metadata(), sort_keys=True) for entry in entries)
    return hashlib.sha256("\n".join(rows).encode()).hexdigest()[:DIGEST_CHARS]


def datasets(entries: Iterable[Entry]) -> str:
    """Return the dataset versions of entries, joined by "+"."""
    return "+".join(sorted({entry.facts.dataset for entry in entries}))
