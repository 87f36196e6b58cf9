"""What is run: one instruction at one place in a scene, with what reports group by and, where there is one, its checked task.

A source of tasks yields entries. One without a ``task`` (from a file of another format) runs in the same way; only a judge can
say how it went.
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
    """``world``: the name under which its scene, or the variation of it, is opened; ``time_s``: scene time at the start; ``task``:
    None where nothing but a judge can tell right from wrong; ``imported``: what another file expects of the calls then."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    facts: TaskFacts
    world: str
    time_s: Annotated[float, Field(ge=0, allow_inf_nan=False)] = 0.0
    task: Task | None = None
    imported: ImportedTask | None = None

    def metadata(self) -> dict[str, Any]:
        """The entry as a log keeps it: facts by name, so that metrics and the viewer can group by them."""
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
        """The entry that a log keeps. Raises ``TraceError`` when it is none."""
        try:
            facts = {name: metadata[name] for name in TaskFacts.model_fields if name in metadata}
            return cls.model_validate(
                {"facts": facts, **{name: metadata[name] for name in ("world", "time_s", "task", "imported")}}
            )
        except (KeyError, ValidationError) as error:
            raise TraceError("A sample of this log does not say which task it is of: it is no log of this benchmark.") from error


def entry_of(task: Task, scene: Scene) -> Entry:
    """A benchmark task to run. Raises ``UnknownNameError`` when its preset is not in the scene."""
    presets = {preset.name: preset.viewpoint for preset in scene.file.presets}
    if task.preset not in presets:
        raise UnknownNameError(f"preset in {task.scene} (of task {task.id})", task.preset, presets)
    return Entry(facts=facts_of(task, presets[task.preset]), world=task.world, time_s=task.time_s, task=task)


def entries_of(tasks: Iterable[Task], open_scene: OpenScene) -> tuple[Entry, ...]:
    """Benchmark tasks to run."""
    return tuple(entry_of(task, open_scene(task.world)) for task in tasks)


def imported_entries(tasks: Iterable[ImportedTask]) -> tuple[Entry, ...]:
    """Tasks of another file's format: a judge says whether they were done, and their expected calls are the one check."""
    return tuple(Entry(facts=t.facts, world=t.facts.scene, time_s=t.start_s, imported=t) for t in tasks)


def chosen(
    entries: Sequence[Entry], categories: Sequence[str] = (), scenes: Sequence[str] = (), limit: int | None = None
) -> tuple[Entry, ...]:
    """Those of some categories and scenes, no more than ``limit``, spread evenly over the categories, scenes and scopes that are
    left: always the same ones. Raises ``InputError`` when nothing is left.
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
        raise InputError("No task is left to run. Ask for other categories or scenes.")
    if limit is None or limit >= len(kept):
        return tuple(kept)
    return _spread(kept, limit)


def _spread(entries: Sequence[Entry], limit: int) -> tuple[Entry, ...]:
    """So many entries in their order. One after the other is taken of the sort whose category, scene and scope are, measured by how
    many there are of them, taken least; of one sort they are taken evenly over it."""
    sorts: dict[tuple[str, str, str], list[Entry]] = {}
    for entry in entries:
        sorts.setdefault((entry.facts.category, entry.facts.scene, entry.facts.scope), []).append(entry)
    there = Counter((place, name) for sort, own in sorts.items() for place, name in enumerate(sort) for _ in own)
    taken, used = Counter[tuple[int, str]](), Counter[tuple[str, str, str]]()
    for _ in range(limit):
        open_ = [sort for sort, own in sorts.items() if used[sort] < len(own)]
        # Among equals the sort with most entries left: small ones are not used up by ties alone.
        least = min(open_, key=lambda s: (sum(Fraction(taken[f], there[f]) for f in enumerate(s)), used[s] - len(sorts[s])))
        used[least] += 1
        taken.update(enumerate(least))
    chosen_ones = {id(own[at * len(own) // used[sort]]) for sort, own in sorts.items() for at in range(used[sort])}
    return tuple(entry for entry in entries if id(entry) in chosen_ones)


def digest(entries: Iterable[Entry]) -> str:
    """Names exactly these tasks, whatever their order."""
    rows = sorted(json.dumps(entry.metadata(), sort_keys=True) for entry in entries)
    return hashlib.sha256("\n".join(rows).encode()).hexdigest()[:DIGEST_CHARS]


def datasets(entries: Iterable[Entry]) -> str:
    """The versions of the datasets that tasks are of, joined where there are several."""
    return "+".join(sorted({entry.facts.dataset for entry in entries}))
