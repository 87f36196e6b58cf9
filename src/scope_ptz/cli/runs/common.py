"""Code that the commands of ``scope runs`` share: opening the store, and parsing times given as options."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.errors import InputError

if TYPE_CHECKING:
    from scope_ptz.store.run_store import RunStore

RunsDir = Annotated[Path | None, typer.Option("--runs-dir", help="Folder with the runs (default: SCOPE_RUNS_DIR, else runs).")]
AuditLogs = Annotated[
    list[Path] | None,
    typer.Option("--audit", help="Audit log of a camera to index (default: those in scope.yaml; repeatable)."),
]


def open_store(runs_dir: Path | None) -> RunStore:
    """Open the store of a runs folder.

    Raises:
        InputError: The folder does not exist, or SQLAlchemy is not installed.
    """
    from scope_ptz.settings import load_settings

    try:
        from scope_ptz.store.run_store import RunStore
    except ModuleNotFoundError as error:
        if error.name != "sqlalchemy":
            raise
        raise InputError("The store needs SQLAlchemy. Install it with: pip install 'scope-ptz[store]'.") from error
    root = runs_dir or load_settings().runs_dir
    if not root.is_dir():
        raise InputError(f"The runs folder {root} does not exist. Specify another one with --runs-dir.")
    return RunStore(root)


def parse_time(option: str, text: str | None) -> datetime | None:
    """Parse the value of an option as a time, which is local if it has no time zone. Return None if the option is missing.

    Raises:
        InputError: The value is not a time.
    """
    if text is None:
        return None
    try:
        time = datetime.fromisoformat(text)
        return time.astimezone(UTC)
    except (ValueError, OverflowError):
        raise InputError(f"{option} must be a time such as 2026-05-01 or 2026-05-01T14:30; got '{text[:40]}'.") from None


def index_audit_logs(store: RunStore, paths: list[Path] | None) -> int:
    """Index audit logs and return the number of new entries. By default, the logs are those in ``scope.yaml``.

    Raises:
        InputError: A file cannot be read.
    """
    from scope_ptz.factory.cameras.named import audit_logs
    from scope_ptz.store.audit_index import index_audit_log

    logs = paths if paths is not None else [path for path in audit_logs() if path.is_file()]
    return sum(index_audit_log(store.database, path) for path in logs)
