"""Options and functions shared by the ``scope runs`` commands."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from scope_ptz.errors import InputError

if TYPE_CHECKING:
    from scope_ptz.store.rows import RunFilter
    from scope_ptz.store.run_store import RunStore

RunsDir = Annotated[Path | None, typer.Option("--runs-dir", help="Folder with the runs (default: SCOPE_RUNS_DIR, else runs).")]
AuditLogs = Annotated[
    list[Path] | None,
    typer.Option("--audit", help="Audit log of a camera to index (default: those in scope.yaml; repeatable)."),
]


@dataclass(frozen=True, kw_only=True)
class FilterFlags:
    """Options that select runs."""

    text: Annotated[str, typer.Option("--text", help="Select only runs whose instruction or answer contains these words.")] = ""
    camera: Annotated[str | None, typer.Option("--camera", help="Select only runs with this camera or scene.")] = None
    outcome: Annotated[str | None, typer.Option("--outcome", help="Select only runs with this outcome, for example answered.")] = (
        None
    )
    tool: Annotated[str | None, typer.Option("--tool", help="Select only runs that called this tool.")] = None
    rating: Annotated[str | None, typer.Option("--rating", help="Select only runs with this rating: good or bad.")] = None
    since: Annotated[
        str | None,
        typer.Option(
            "--since", metavar="TIME", help="Select only runs that started at this time or later, for example 2026-05-01."
        ),
    ] = None
    until: Annotated[
        str | None, typer.Option("--until", metavar="TIME", help="Select only runs that started before this time.")
    ] = None

    def run_filter(self) -> RunFilter:
        """Convert the flags to a filter for the store.

        Raises:
            InputError: The rating or a time is invalid.
        """
        from scope_ptz.store.rows import RunFilter

        ratings: dict[str, Literal[-1, 1]] = {"good": 1, "bad": -1}
        if self.rating is not None and self.rating not in ratings:
            raise InputError(f"--rating must be good or bad; got '{self.rating[:40]}'.")
        return RunFilter(
            text=self.text[:200],
            camera=self.camera,
            outcome=self.outcome,
            tool=self.tool,
            rating=None if self.rating is None else ratings[self.rating],
            since=parse_time("--since", self.since),
            until=parse_time("--until", self.until),
        )


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
        raise InputError("The store requires SQLAlchemy. Install it with: pip install 'scope-ptz[store]'.") from error
    root = runs_dir or load_settings().runs_dir
    if not root.is_dir():
        raise InputError(f"The runs folder {root} does not exist. Specify another one with --runs-dir.")
    return RunStore(root)


def parse_time(option: str, text: str | None) -> datetime | None:
    """Parse the value of an option as a time, which is local unless it has a time zone. Return None if the option is missing.

    Raises:
        InputError: The value is not a valid time.
    """
    if text is None:
        return None
    try:
        time = datetime.fromisoformat(text)
        return time.astimezone(UTC)
    except (ValueError, OverflowError):
        raise InputError(f"{option} must be a time such as 2026-05-01 or 2026-05-01T14:30; got '{text[:40]}'.") from None


def index_audit_logs(store: RunStore, paths: list[Path] | None) -> int:
    """Index audit logs, and return the number of new entries. By default, index the logs in ``scope.yaml``.

    Raises:
        InputError: A file cannot be read.
    """
    from scope_ptz.factory.cameras.named_cameras import audit_logs
    from scope_ptz.store.audit_index import index_audit_log

    logs = paths if paths is not None else [path for path in audit_logs() if path.is_file()]
    return sum(index_audit_log(store.database, path) for path in logs)
