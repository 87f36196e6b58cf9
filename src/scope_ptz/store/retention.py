"""Remove old runs, except those that are marked as kept, have feedback, or may still be running."""

from __future__ import annotations

import shutil
import time
from dataclasses import dataclass
from pathlib import Path

from sqlalchemy import delete, select, update

from scope_ptz.agent.trace import FILE_NAME as TRACE
from scope_ptz.errors import InputError, UnknownNameError
from scope_ptz.store.database import Database
from scope_ptz.store.schema import FEEDBACK, RUNS

MAX_RUN_S = 24 * 3600.0
"""An unfinished run that began less than this many seconds ago may still be running."""


@dataclass(frozen=True, slots=True)
class Retention:
    """Limits on the runs to keep. Runs that exceed any limit are removed; None means no limit.

    Attributes:
        max_age_s: Maximum age in seconds.
        max_runs: Maximum number of runs.
        max_bytes: Maximum total size of all run folders in bytes.
    """

    max_age_s: float | None = None
    max_runs: int | None = None
    max_bytes: int | None = None

    def __post_init__(self) -> None:
        limits = (self.max_age_s, self.max_runs, self.max_bytes)
        if all(limit is None for limit in limits):
            raise InputError("Specify at least one limit: an age, a number of runs, or a size.")
        if any(limit is not None and limit < 0 for limit in limits):
            raise InputError("An age, a number of runs or a size must be zero or more.")


@dataclass(frozen=True, slots=True)
class PruneReport:
    """The removed runs, or those that a dry run would remove: their ids, and the total size of their folders in bytes."""

    runs: list[str]
    freed_bytes: int


def prune(
    database: Database, root: Path, retention: Retention, *, dry_run: bool = False, now_s: float | None = None
) -> PruneReport:
    """Remove the runs beyond the limits, the oldest first, with their folders.

    Raises:
        StoreError: The database is locked or damaged.
    """
    now_s = time.time() if now_s is None else now_s
    columns = RUNS.c.number, RUNS.c.id, RUNS.c.started, RUNS.c.ended, RUNS.c.kept, RUNS.c.folder_bytes
    with database.read_transaction() as connection:
        rated = set(connection.execute(select(FEEDBACK.c.run)).scalars())
        rows = connection.execute(select(*columns).order_by(RUNS.c.started.desc(), RUNS.c.number.desc())).all()
    candidates, kept_bytes, kept_runs = [], 0, 0
    for number, run_id, started, ended, kept, size in rows:
        too_old = retention.max_age_s is not None and now_s - started > retention.max_age_s
        too_many = retention.max_runs is not None and kept_runs >= retention.max_runs
        too_large = retention.max_bytes is not None and kept_bytes + size > retention.max_bytes
        exempt = kept or number in rated or (ended is None and now_s - started < MAX_RUN_S)
        if (too_old or too_many or too_large) and not exempt:
            candidates.append((number, run_id, size))
        else:
            kept_bytes, kept_runs = kept_bytes + size, kept_runs + 1
    removed = candidates if dry_run else [run for run in candidates if _remove_folder(root, run[1])]
    if not dry_run:
        for start in range(0, len(removed), 500):
            numbers = [number for number, _, _ in removed[start : start + 500]]
            with database.write_transaction() as connection:
                connection.execute(delete(RUNS).where(RUNS.c.number.in_(numbers)))
    return PruneReport([run_id for _, run_id, _ in removed], sum(size for _, _, size in removed))


def keep(database: Database, run_id: str, *, kept: bool = True) -> None:
    """Mark a run as exempt from ``prune``, or remove the mark.

    Raises:
        UnknownNameError: There is no such run.
    """
    with database.write_transaction() as connection:
        if not connection.execute(update(RUNS).where(RUNS.c.id == run_id).values(kept=int(kept))).rowcount:
            raise UnknownNameError("run", run_id[:120], ())


def _remove_folder(root: Path, name: str) -> bool:
    """Remove a run folder and return whether it no longer exists. Only run folders directly inside ``root`` are removed."""
    folder = root / name
    if folder.parent != root or folder.is_symlink():
        return False
    if not folder.exists():
        return True
    if not (folder / TRACE).is_file():
        return False
    shutil.rmtree(folder, ignore_errors=True)
    return not folder.exists()
