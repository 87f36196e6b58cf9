"""Convert entries to Inspect samples, and define the data that a run stores in its sample for checks and judges."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from inspect_ai.dataset import MemoryDataset, Sample
from pydantic import ValidationError

from scope_ptz.agent.records import RECORD, Called, Decided, Ended, Started
from scope_ptz.agent.trace import FILE_NAME, Trace
from scope_ptz.bench.engine.entries import Entry, OpenScene
from scope_ptz.bench.scoring.episode import Episode, PresetViewpoints, episode_of
from scope_ptz.errors import TraceError

MAX_SHARED_VIEWPOINTS = 2
"""Entries that use more viewpoints are placed last in their scene."""
STORE = "scope"
"""Key of SCOPE's data in the store of a sample."""


def viewpoint_order(entries: Iterable[Entry], open_scene: OpenScene) -> list[Entry]:
    """Sort entries so that few viewpoints are in use at a time, because loading a viewpoint takes as long as many runs.

    Within a scene, entries that use one or two viewpoints follow each other so that neighbours share a viewpoint. Those that use
    more come last.
    """

    def key(entry: Entry) -> tuple[str, bool, str, int, list[str], str]:
        used = sorted(_viewpoints_of(entry, open_scene))
        return entry.facts.scene, len(used) > MAX_SHARED_VIEWPOINTS, used[0], len(used), used, entry.facts.viewpoint

    return sorted(entries, key=key)


def _viewpoints_of(entry: Entry, open_scene: OpenScene) -> set[str]:
    """Return the viewpoints that a run probably uses: those of its start, its evidence and its reference program."""
    used = {entry.facts.viewpoint}
    if entry.task is not None:
        file = open_scene(entry.world).file
        of_preset = {preset.name: preset.viewpoint for preset in file.presets}
        used |= {view.aim.viewpoint for view in entry.task.evidence}
        visited = [str(call.arguments.get("name")) for call in entry.task.reference if call.tool == "go_to_preset"]
        visited += [file.home_preset for call in entry.task.reference if call.tool == "go_home"]
        used |= {of_preset[name] for name in visited if name in of_preset}
    return used


def dataset_of(entries: Iterable[Entry], name: str) -> MemoryDataset:
    """Return entries as an Inspect dataset, in the same order."""
    samples = [Sample(id=e.facts.id, input=e.facts.instruction, target=e.facts.expected, metadata=e.metadata()) for e in entries]
    return MemoryDataset(samples, name=name)


def sample_name(task: str, epoch: int) -> str:
    """Return the name of a run in its log."""
    return f"{task}#{epoch}"


@dataclass(frozen=True, slots=True)
class Kept:
    """The data that a run stored.

    Attributes:
        trace: Trace as JSON lines; empty if the run never began.
        presets: Viewpoint of each preset.
        home: Viewpoint of the home preset.
        sees: Whether the planner was shown frames.
        pictures: References to pictures in the log, by their names in the trace.
        truths: True counts by the index of the call, if they were looked up.
    """

    trace: str
    presets: Mapping[str, str]
    home: str
    sees: bool = False
    pictures: Mapping[str, str] = field(default_factory=dict)
    truths: Mapping[str, int | None] = field(default_factory=dict)

    def as_store(self) -> dict[str, Any]:
        """Return the data in the form that a sample stores."""
        return {
            "trace": self.trace, "presets": dict(self.presets), "home": self.home, "sees": self.sees,
            "pictures": dict(self.pictures), "truths": dict(self.truths),
        }  # fmt: skip

    @classmethod
    def of_store(cls, store: Any) -> Kept:
        """Return the data of the run in a sample's store. Raises ``TraceError`` if there are none."""
        try:
            return cls(**{name: store[name] for name in ("trace", "presets", "home", "sees", "pictures", "truths")})
        except (KeyError, TypeError) as error:
            raise TraceError("A sample of this log contains no run of this benchmark.") from error

    @property
    def places(self) -> PresetViewpoints:
        """The viewpoints of the presets and of home."""
        return PresetViewpoints(self.presets, self.home)

    def episode(self, trace: Trace) -> Episode:
        """Return the run as an episode, on which the checks run."""
        return episode_of(trace, self.places, planner_sees=self.sees, keeps_files=False)


def trace_of(text: str, where: Path) -> Trace | None:
    """Parse a trace from JSON lines; None if the run never began. Raises ``TraceError``."""
    try:
        records = [RECORD.validate_json(line) for line in text.splitlines() if line]
    except ValidationError as error:
        raise TraceError(f"The trace of a run in {where} is damaged: {error.errors(include_url=False)[0]['msg']}.") from error
    if not records:
        return None
    first, last = records[0], records[-1]
    if not isinstance(first, Started):
        raise TraceError(f"The trace of a run in {where} does not begin with a header ({FILE_NAME}).")
    return Trace(
        folder=where,
        started=first,
        decisions=tuple(r for r in records if isinstance(r, Decided)),
        calls=tuple(r for r in records if isinstance(r, Called)),
        ended=last if isinstance(last, Ended) else None,
    )
