"""Entries as samples of the engine and back, and what a run leaves in its sample: enough to check and judge it again."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from inspect_ai.dataset import MemoryDataset, Sample
from pydantic import ValidationError

from scope_ptz.agent.records import RECORD, Called, Decided, Ended, Started
from scope_ptz.agent.trace import FILE_NAME, Trace
from scope_ptz.bench.engine.entries import Entry
from scope_ptz.bench.scoring.episode import Episode, PresetViewpoints, episode_of
from scope_ptz.errors import TraceError

STORE = "scope"
"""The one key of a sample's store that is ours."""


def dataset_of(entries: Iterable[Entry], name: str) -> MemoryDataset:
    """The entries as a dataset of the engine, those of one viewpoint one after the other: its layers are read once."""
    entries = sorted(entries, key=lambda e: (e.facts.scene, e.facts.viewpoint))
    samples = [Sample(id=e.facts.id, input=e.facts.instruction, target=e.facts.expected, metadata=e.metadata()) for e in entries]
    return MemoryDataset(samples, name=name)


def sample_name(task: str, epoch: int) -> str:
    """How a run is called in one log."""
    return f"{task}#{epoch}"


@dataclass(frozen=True, slots=True)
class Kept:
    """What a run left. ``trace`` is JSONL, empty when the run never began; ``pictures`` are the log's references by name;
    ``truths``: how many really showed, by number of the call, where that was looked up."""

    trace: str
    presets: Mapping[str, str]
    home: str
    sees: bool = False
    pictures: Mapping[str, str] = field(default_factory=dict)
    truths: Mapping[str, int | None] = field(default_factory=dict)

    def as_store(self) -> dict[str, Any]:
        return {
            "trace": self.trace, "presets": dict(self.presets), "home": self.home, "sees": self.sees,
            "pictures": dict(self.pictures), "truths": dict(self.truths),
        }  # fmt: skip

    @classmethod
    def of_store(cls, store: Any) -> Kept:
        """Raises ``TraceError`` when this is not what a run leaves."""
        try:
            return cls(**{name: store[name] for name in ("trace", "presets", "home", "sees", "pictures", "truths")})
        except (KeyError, TypeError) as error:
            raise TraceError("A sample of this log holds no run of this benchmark.") from error

    @property
    def places(self) -> PresetViewpoints:
        """Which viewpoint each preset and home have."""
        return PresetViewpoints(self.presets, self.home)

    def episode(self, trace: Trace) -> Episode:
        """The run as checks see it."""
        return episode_of(trace, self.places, planner_sees=self.sees, keeps_files=False)


def trace_of(text: str, where: Path) -> Trace | None:
    """The trace in a text of JSON lines; None when the run never began. Raises ``TraceError``."""
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
