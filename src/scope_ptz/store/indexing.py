"""Index run folders in the database. A folder that cannot be read is reported and left unchanged."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from sqlalchemy import Connection, delete, insert, select, update

from scope_ptz.agent.records import Called
from scope_ptz.agent.trace import FILE_NAME as TRACE
from scope_ptz.agent.trace import picture_names, read_trace
from scope_ptz.errors import TraceError
from scope_ptz.store.database import Database
from scope_ptz.store.request_file import read_request
from scope_ptz.store.rows import UNFINISHED
from scope_ptz.store.schema import FEEDBACK, FRAMES, RUNS, STEPS

BATCH_SIZE = 100
"""Maximum number of runs in one transaction."""


@dataclass(slots=True)
class IndexReport:
    """The result of indexing a folder.

    Attributes:
        added: Number of new runs.
        updated: Number of runs whose trace has changed.
        removed: Number of runs that were removed from the index because their folder no longer exists.
        missing: Number of runs without a folder that stay in the index because they have feedback.
        damaged: Why each unreadable folder cannot be read, by folder name.
    """

    added: int = 0
    updated: int = 0
    removed: int = 0
    missing: int = 0
    damaged: dict[str, str] = field(default_factory=dict)


def index_runs(database: Database, root: Path) -> IndexReport:
    """Index all run folders in ``root`` that are new or have changed, and remove runs whose folder no longer exists.

    Raises:
        StoreError: The database is locked or damaged.
        OutputError: The disk is full.
    """
    report = IndexReport()
    with database.read_transaction() as connection:
        indexed = {row.id: row.trace_bytes for row in connection.execute(select(RUNS.c.id, RUNS.c.trace_bytes))}
    existing: set[str] = set()
    batch: list[tuple[Path, int]] = []
    for name, size in _folders(root):
        existing.add(name)
        if indexed.get(name) == size:
            continue
        batch.append((root / name, size))
        if len(batch) == BATCH_SIZE:
            _index_batch(database, batch, report)
            batch = []
    _index_batch(database, batch, report)
    _remove_missing(database, [name for name in indexed if name not in existing], report)
    return report


def index_run(database: Database, folder: Path) -> None:
    """Index one run folder.

    Raises:
        TraceError: Its trace cannot be read.
        StoreError: The database is locked or damaged.
        OutputError: The disk is full.
    """
    size = (folder / TRACE).stat().st_size if (folder / TRACE).is_file() else 0
    row, steps, frames = _contents(folder, size)
    with database.write_transaction() as connection:
        _upsert(connection, row, steps, frames)


def _folders(root: Path) -> Iterator[tuple[str, int]]:
    """Yield the names of run folders, each with the size of its trace in bytes."""
    try:
        entries = os.scandir(root)
    except FileNotFoundError:
        return
    with entries:
        for entry in entries:
            if not entry.is_dir(follow_symlinks=False):
                continue
            try:
                size = os.stat(os.path.join(entry.path, TRACE)).st_size  # noqa: PTH116, PTH118 - twice as fast as a Path
            except OSError:
                continue
            if size:
                yield entry.name, size


def _index_batch(database: Database, batch: list[tuple[Path, int]], report: IndexReport) -> None:
    contents = []
    for folder, size in batch:
        try:
            contents.append(_contents(folder, size))
        except TraceError as error:
            report.damaged[folder.name] = str(error)
    if not contents:
        return
    added = updated = 0
    with database.write_transaction() as connection:
        for row, steps, frames in contents:
            is_new = _upsert(connection, row, steps, frames)
            added, updated = added + is_new, updated + (not is_new)
    report.added += added
    report.updated += updated


def _remove_missing(database: Database, missing: list[str], report: IndexReport) -> None:
    for start in range(0, len(missing), BATCH_SIZE):
        names = missing[start : start + BATCH_SIZE]
        with database.write_transaction() as connection:
            rated = select(FEEDBACK.c.run)
            removed = connection.execute(delete(RUNS).where(RUNS.c.id.in_(names), RUNS.c.number.not_in(rated))).rowcount
        report.removed += removed
        report.missing += len(names) - removed


def _contents(folder: Path, trace_bytes: int) -> tuple[dict[str, Any], list[dict[str, Any]], list[dict[str, Any]]]:
    """Return the database rows for a run folder: the run, its steps, and its frames."""
    trace = read_trace(folder)
    request, started, ended = read_request(folder), trace.started, trace.ended
    # The duration of a run without a recorded end is the sum of its steps.
    times = {name: sum(getattr(call.timings, name) for call in trace.calls) for name in ("perception_s", "camera_s", "render_s")}
    times["planner_s"] = sum(decision.planner_s for decision in trace.decisions)
    times["total_s"] = times["planner_s"] + sum(call.timings.total_s for call in trace.calls)
    if ended is not None:
        times = {name: getattr(ended.timings, name) for name in times}
    steps = [_step(position, call) for position, call in enumerate(trace.calls)]
    row = {
        "id": folder.name,
        "kind": request.kind,
        "conversation": request.conversation,
        "actor": request.actor,
        "started": started.started.timestamp(),
        "ended": None if ended is None else ended.ended.timestamp(),
        "instruction": started.instruction,
        "answer": "" if ended is None else ended.text,
        "outcome": UNFINISHED if ended is None else ended.outcome,
        "planner": started.planner,
        "perception": started.perception,
        "camera": request.camera or started.scene or started.camera,
        "scene": started.scene,
        "simulated": int(started.simulated),
        "version": started.version,
        "steps": ended.steps if ended is not None else max((call.step for call in trace.calls), default=0),
        "calls": len(steps),
        "failed_calls": sum(step["fault"] is not None for step in steps),
        **times,
        "input_tokens": 0 if ended is None else ended.usage.input_tokens,
        "output_tokens": 0 if ended is None else ended.usage.output_tokens,
        "trace_bytes": trace_bytes,
        "folder_bytes": folder_bytes(folder),
    }
    return row, steps, [{"name": name, "position": position} for name, position in picture_names(trace).items()]


def _step(position: int, call: Called) -> dict[str, Any]:
    outcome, pose, timings = call.outcome, call.pose, call.timings
    return {
        "position": position,
        "step": call.step,
        "tool": outcome.call.name,
        "arguments": json.dumps(outcome.call.arguments, ensure_ascii=False),
        "message": outcome.error if outcome.error is not None else str((outcome.result or {}).get("message", "")),
        "fault": call.fault,
        "pan_deg": pose.pan_deg,
        "tilt_deg": pose.tilt_deg,
        "zoom": pose.zoom,
        "total_s": timings.total_s,
        "perception_s": call.perception_s,
        "camera_s": timings.camera_s,
        "render_s": timings.render_s,
    }


def folder_bytes(folder: Path) -> int:
    """Return the total size of the files in a run folder in bytes. Files that are deleted in the meantime are not counted."""
    total = 0
    for parent, _, files in os.walk(folder):
        for name in files:
            try:
                total += os.lstat(os.path.join(parent, name)).st_size  # noqa: PTH118
            except OSError:
                continue
    return total


def _upsert(connection: Connection, row: dict[str, Any], steps: list[dict[str, Any]], frames: list[dict[str, Any]]) -> bool:
    """Insert or update a run. Return whether it is new."""
    number = connection.execute(select(RUNS.c.number).where(RUNS.c.id == row["id"])).scalar()
    if is_new := number is None:
        number = connection.execute(insert(RUNS).values(**row, kept=0).returning(RUNS.c.number)).scalar_one()
    else:
        connection.execute(update(RUNS).where(RUNS.c.number == number).values(**row))
        connection.execute(delete(STEPS).where(STEPS.c.run == number))
        connection.execute(delete(FRAMES).where(FRAMES.c.run == number))
    if steps:
        connection.execute(insert(STEPS), [{"run": number, **step} for step in steps])
    if frames:
        connection.execute(insert(FRAMES), [{"run": number, **frame} for frame in frames])
    return is_new
