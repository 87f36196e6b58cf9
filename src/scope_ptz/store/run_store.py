"""The store for a runs folder: the run folders together with their database."""

from __future__ import annotations

from pathlib import Path
from types import TracebackType
from typing import Self

from scope_ptz.errors import UnknownNameError
from scope_ptz.store.database import BUSY_S, FILE_NAME, Database
from scope_ptz.store.export import ExportFormat, export_runs
from scope_ptz.store.indexing import IndexReport, index_run, index_runs
from scope_ptz.store.queries import MAX_PAGE, RunPage, StoredRun, count_matching, list_runs, load_run
from scope_ptz.store.retention import PruneReport, Retention, prune
from scope_ptz.store.rows import RunFilter


class RunStore:
    """The runs in a folder, with an index in its file ``store.sqlite``.

    The run folders are the primary data. A deleted database can be rebuilt from them, except for feedback, conversations
    and the marks that exempt runs from ``prune``. The modules ``feedback`` and ``conversations`` operate on ``database``.

    Args:
        root: The runs folder. It is created if needed.
        busy_s: Seconds to wait while another process writes to the database.

    Raises:
        OutputError: The database cannot be written.
        StoreError: The database is damaged, locked, or was created by a newer version.
    """

    def __init__(self, root: Path, *, busy_s: float = BUSY_S) -> None:
        self.root = root
        self.database = Database(root / FILE_NAME, busy_s=busy_s)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """Close the database."""
        self.database.close()

    def index(self) -> IndexReport:
        """Index the folders that are new or have changed, and remove runs whose folder no longer exists."""
        return index_runs(self.database, self.root)

    def index_run(self, run_id: str) -> None:
        """Index one run folder again. Raises ``TraceError`` if its trace cannot be read."""
        index_run(self.database, self.folder(run_id))

    def runs(self, run_filter: RunFilter | None = None, *, limit: int = 50, after: str | None = None) -> RunPage:
        """Return runs, newest first. See ``list_runs``."""
        return list_runs(self.database, run_filter or RunFilter(), limit=limit, after=after)

    def count(self, run_filter: RunFilter | None = None) -> int:
        """Return the number of runs that match a filter."""
        return count_matching(self.database, run_filter or RunFilter())

    def run(self, run_id: str) -> StoredRun:
        """Return the stored data for a run. Raises ``UnknownNameError`` if there is no such run."""
        return load_run(self.database, run_id)

    def folder(self, run_id: str) -> Path:
        """Return the folder of a run, which may not exist. Raises ``UnknownNameError`` if the id is not a valid folder name."""
        if not run_id or run_id in (".", "..") or not all(c.isascii() and (c.isalnum() or c in "-_.") for c in run_id):
            raise UnknownNameError("run", run_id[:120], ())
        return self.root / run_id

    def prune(self, retention: Retention, *, dry_run: bool = False) -> PruneReport:
        """Remove the runs beyond the limits, with their folders. See ``retention.prune``."""
        return prune(self.database, self.root, retention, dry_run=dry_run)

    def ids(self, run_filter: RunFilter) -> list[str]:
        """Return the ids of all runs that match a filter, newest first."""
        ids: list[str] = []
        page = self.runs(run_filter, limit=MAX_PAGE)
        while True:
            ids += [run.id for run in page.runs]
            if page.next is None:
                return ids
            page = self.runs(run_filter, limit=MAX_PAGE, after=page.next)

    def export(self, runs: list[str], out: Path, kind: ExportFormat) -> int:
        """Write runs to a file and return the number written. See ``export_runs``."""
        return export_runs(self.database, self.root, runs, out, kind)
