"""Convert entries to Inspect samples, and put them in an efficient order."""

from __future__ import annotations

from collections.abc import Iterable

from inspect_ai.dataset import MemoryDataset, Sample

from scope_ptz.bench.engine.entries import Entry, OpenScene

MAX_SHARED_VIEWPOINTS = 2
"""Entries with at most this many viewpoints are grouped by viewpoint. Entries with more viewpoints come last in their scene."""


def viewpoint_order(entries: Iterable[Entry], open_scene: OpenScene) -> list[Entry]:
    """Sort entries so that few viewpoints are in use at the same time. Loading one viewpoint takes as much time as many runs do.

    Within a scene, entries with one or two viewpoints are sorted so that neighbouring entries share a viewpoint. Entries with more
    viewpoints come last.
    """

    def key(entry: Entry) -> tuple[str, bool, str, int, list[str], str]:
        viewpoints = sorted(_viewpoints_of(entry, open_scene))
        return (
            entry.facts.scene,
            len(viewpoints) > MAX_SHARED_VIEWPOINTS,
            viewpoints[0],
            len(viewpoints),
            viewpoints,
            entry.facts.viewpoint,
        )

    return sorted(entries, key=key)


def _viewpoints_of(entry: Entry, open_scene: OpenScene) -> set[str]:
    """Return the viewpoints that a run probably uses: those of the start, the evidence and the reference program."""
    viewpoints = {entry.facts.viewpoint}
    if entry.task is not None:
        file = open_scene(entry.world).file
        viewpoint_of_preset = {preset.name: preset.viewpoint for preset in file.presets}
        viewpoints |= {view.aim.viewpoint for view in entry.task.evidence}
        visited = [str(call.arguments.get("name")) for call in entry.task.reference if call.tool == "go_to_preset"]
        visited += [file.home_preset for call in entry.task.reference if call.tool == "go_home"]
        viewpoints |= {viewpoint_of_preset[name] for name in visited if name in viewpoint_of_preset}
    return viewpoints


def dataset_of(entries: Iterable[Entry], name: str) -> MemoryDataset:
    """Convert entries to an Inspect dataset in the same order."""
    samples = [Sample(id=e.facts.id, input=e.facts.instruction, target=e.facts.expected, metadata=e.metadata()) for e in entries]
    return MemoryDataset(samples, name=name)
