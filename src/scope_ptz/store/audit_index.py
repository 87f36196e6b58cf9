"""Index the audit logs of cameras, so that they can be searched. The files remain the primary data."""

from __future__ import annotations

import json
from datetime import datetime
from pathlib import Path
from typing import Any

from sqlalchemy import Connection, delete, insert, select, update

from scope_ptz.errors import InputError
from scope_ptz.store.database import Database
from scope_ptz.store.queries import utc_time
from scope_ptz.store.rows import AuditRow
from scope_ptz.store.schema import AUDIT, AUDIT_FILES

MAX_READ_BYTES = 4_000_000
"""Maximum number of bytes to read in one call."""


def index_audit_log(database: Database, path: Path) -> int:
    """Index the lines that were appended to an audit log since the previous call.

    Invalid lines are skipped. An incomplete last line is left for the next call. A file that has become shorter must have been
    replaced, so it is indexed from its beginning.

    Returns:
        Number of new entries.

    Raises:
        InputError: The file cannot be read.
        StoreError: The database is locked or damaged.
    """
    path, added = path.resolve(), 0
    while True:
        with database.write_transaction() as connection:
            number, offset = _log_position(connection, path)
            try:
                if path.stat().st_size < offset:
                    connection.execute(delete(AUDIT).where(AUDIT.c.file == number))
                    offset = 0
                with path.open("rb") as file:
                    file.seek(offset)
                    content = file.read(MAX_READ_BYTES)
            except OSError as error:
                raise InputError(f"The audit log {path} cannot be read: {error.strerror}.") from error
            complete_lines = content[: content.rfind(b"\n") + 1]
            entries = [entry for line in complete_lines.splitlines() if (entry := _entry(line)) is not None]
            if entries:
                connection.execute(insert(AUDIT), [{"file": number, **entry} for entry in entries])
            connection.execute(
                update(AUDIT_FILES).where(AUDIT_FILES.c.number == number).values(offset=offset + len(complete_lines))
            )
            added += len(entries)
        if len(content) < MAX_READ_BYTES or not complete_lines:
            return added


def list_audit(
    database: Database, *, camera: str | None = None, since: datetime | None = None, until: datetime | None = None, limit: int = 100
) -> list[AuditRow]:
    """Return audit log entries, newest first."""
    query = select(AUDIT)
    if camera is not None:
        query = query.where(AUDIT.c.camera == camera)
    if since is not None:
        query = query.where(AUDIT.c.time >= since.timestamp())
    if until is not None:
        query = query.where(AUDIT.c.time < until.timestamp())
    with database.read_transaction() as connection:
        rows = connection.execute(query.order_by(AUDIT.c.time.desc(), AUDIT.c.number.desc()).limit(limit)).mappings().all()
    return [
        AuditRow(
            time=utc_time(row["time"]),
            camera=row["camera"],
            actor=row["actor"],
            event=row["event"],
            details=json.loads(row["details"]),
        )
        for row in rows
    ]


def _log_position(connection: Connection, path: Path) -> tuple[int, int]:
    """Return an audit log's number in the index and the number of bytes indexed so far. A new log is added."""
    row = connection.execute(select(AUDIT_FILES).where(AUDIT_FILES.c.path == str(path))).mappings().first()
    if row is not None:
        return row["number"], row["offset"]
    insertion = insert(AUDIT_FILES).values(path=str(path), offset=0).returning(AUDIT_FILES.c.number)
    return connection.execute(insertion).scalar_one(), 0


def _entry(line: bytes) -> dict[str, Any] | None:
    """Convert a line of an audit log to a row. Return None if the line is damaged."""
    try:
        fields = json.loads(line)
        time_s = datetime.fromisoformat(fields.pop("time")).timestamp()
        head = {name: str(fields.pop(name)) for name in ("camera", "actor", "event")}
    except (ValueError, KeyError, TypeError, AttributeError):
        return None
    return {"time": time_s, **head, "details": json.dumps(fields, ensure_ascii=False)}
