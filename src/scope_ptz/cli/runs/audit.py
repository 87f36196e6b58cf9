"""``scope runs audit``: list the commands in audit logs, who issued them, and the moves that they caused."""

from __future__ import annotations

from typing import Annotated

import typer

from scope_ptz.cli.options import JsonOption
from scope_ptz.cli.runs.common import AuditLogs, RunsDir, index_audit_logs, open_store, parse_time


def runs_audit(
    runs_dir: RunsDir = None,
    audit: AuditLogs = None,
    camera: Annotated[str | None, typer.Option("--camera", help="Print only entries of this camera.")] = None,
    since: Annotated[str | None, typer.Option("--since", metavar="TIME", help="Print only entries at this time or later.")] = None,
    until: Annotated[str | None, typer.Option("--until", metavar="TIME", help="Print only entries before this time.")] = None,
    limit: Annotated[int, typer.Option("--limit", min=1, max=10_000, help="Number of entries to print.")] = 50,
    as_json: JsonOption = False,
) -> None:
    """Index the audit logs of cameras and list their entries, newest first."""
    from scope_ptz.cli.exit import put, put_json
    from scope_ptz.store.audit_index import list_audit

    from_time, to_time = parse_time("--since", since), parse_time("--until", until)
    with open_store(runs_dir) as store:
        index_audit_logs(store, audit)
        entries = list_audit(store.database, camera=camera, since=from_time, until=to_time, limit=limit)
    if as_json:
        put_json([entry.model_dump(mode="json") for entry in entries])
        return
    for entry in entries:
        columns = f"{entry.camera[:20]:<20}  {entry.actor[:16]:<16}  {entry.event:<12}"
        details = "".join(f"  {name}={value}" for name, value in entry.details.items())
        put(f"{entry.time.astimezone():%Y-%m-%d %H:%M:%S}  {columns}{details}".rstrip())
    if not entries:
        put("No entries. A camera writes an audit log if `audit_log` is set for it in scope.yaml.")
