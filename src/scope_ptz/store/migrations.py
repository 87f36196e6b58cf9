"""Migrations of the store's tables. Never change a released migration; add a new one."""

from __future__ import annotations

from typing import TYPE_CHECKING

from scope_ptz.errors import StoreError

if TYPE_CHECKING:
    from sqlalchemy import Connection

_INITIAL_SCHEMA = """
CREATE TABLE runs (
    number INTEGER PRIMARY KEY, id VARCHAR NOT NULL UNIQUE, kind VARCHAR NOT NULL, conversation VARCHAR, actor VARCHAR NOT NULL,
    started FLOAT NOT NULL, ended FLOAT, instruction TEXT NOT NULL, answer TEXT NOT NULL, outcome VARCHAR NOT NULL,
    planner VARCHAR NOT NULL, perception VARCHAR NOT NULL, camera VARCHAR NOT NULL, scene VARCHAR, simulated INTEGER NOT NULL,
    version VARCHAR NOT NULL, steps INTEGER NOT NULL, calls INTEGER NOT NULL, failed_calls INTEGER NOT NULL,
    total_s FLOAT NOT NULL, planner_s FLOAT NOT NULL, perception_s FLOAT NOT NULL, camera_s FLOAT NOT NULL,
    render_s FLOAT NOT NULL, input_tokens INTEGER NOT NULL, output_tokens INTEGER NOT NULL,
    kept INTEGER NOT NULL DEFAULT 0, trace_bytes INTEGER NOT NULL, folder_bytes INTEGER NOT NULL);
CREATE INDEX runs_by_time ON runs (started, number);
CREATE INDEX runs_by_outcome ON runs (outcome, started, number);
CREATE INDEX runs_by_camera ON runs (camera, started, number);
CREATE INDEX runs_by_pair ON runs (planner, perception, started, number);
CREATE INDEX runs_by_perception ON runs (perception, started, number);
CREATE INDEX runs_by_kind ON runs (kind, started, number);
CREATE INDEX runs_by_actor ON runs (actor, started, number);
CREATE INDEX runs_by_conversation ON runs (conversation, started, number);
CREATE TABLE steps (
    run INTEGER NOT NULL REFERENCES runs (number) ON DELETE CASCADE, position INTEGER NOT NULL, step INTEGER NOT NULL,
    tool VARCHAR NOT NULL, arguments TEXT NOT NULL, message TEXT NOT NULL, fault VARCHAR, pan_deg FLOAT NOT NULL,
    tilt_deg FLOAT NOT NULL, zoom FLOAT NOT NULL, total_s FLOAT NOT NULL, perception_s FLOAT NOT NULL,
    camera_s FLOAT NOT NULL, render_s FLOAT NOT NULL, PRIMARY KEY (run, position)) WITHOUT ROWID;
CREATE INDEX steps_by_tool ON steps (tool, run);
CREATE TABLE frames (
    run INTEGER NOT NULL REFERENCES runs (number) ON DELETE CASCADE, name VARCHAR NOT NULL, position INTEGER,
    PRIMARY KEY (run, name)) WITHOUT ROWID;
CREATE TABLE feedback (
    id INTEGER PRIMARY KEY, run INTEGER NOT NULL REFERENCES runs (number) ON DELETE CASCADE, position INTEGER,
    rating INTEGER NOT NULL, comment TEXT NOT NULL, actor VARCHAR NOT NULL, created FLOAT NOT NULL);
CREATE INDEX feedback_by_run ON feedback (run);
CREATE INDEX feedback_by_rating ON feedback (rating, run);
CREATE TABLE conversations (
    id VARCHAR PRIMARY KEY NOT NULL, camera VARCHAR NOT NULL, pair VARCHAR NOT NULL, owner VARCHAR NOT NULL, title TEXT NOT NULL,
    created FLOAT NOT NULL, updated FLOAT NOT NULL);
CREATE INDEX conversations_by_owner ON conversations (owner, updated);
CREATE TABLE audit_files (number INTEGER PRIMARY KEY, path VARCHAR NOT NULL UNIQUE, offset INTEGER NOT NULL);
CREATE TABLE audit (
    number INTEGER PRIMARY KEY, file INTEGER NOT NULL REFERENCES audit_files (number) ON DELETE CASCADE, time FLOAT NOT NULL,
    camera VARCHAR NOT NULL, actor VARCHAR NOT NULL, event VARCHAR NOT NULL, details TEXT NOT NULL);
CREATE INDEX audit_by_time ON audit (time, number);
CREATE INDEX audit_by_file ON audit (file);
CREATE VIRTUAL TABLE runs_text USING fts5 (
    instruction, answer, content='runs', content_rowid='number', tokenize='unicode61 remove_diacritics 2', prefix='2 3');
CREATE TRIGGER runs_text_added AFTER INSERT ON runs BEGIN
    INSERT INTO runs_text (rowid, instruction, answer) VALUES (new.number, new.instruction, new.answer);
END;
CREATE TRIGGER runs_text_removed AFTER DELETE ON runs BEGIN
    INSERT INTO runs_text (runs_text, rowid, instruction, answer) VALUES ('delete', old.number, old.instruction, old.answer);
END;
CREATE TRIGGER runs_text_changed AFTER UPDATE OF instruction, answer ON runs BEGIN
    INSERT INTO runs_text (runs_text, rowid, instruction, answer) VALUES ('delete', old.number, old.instruction, old.answer);
    INSERT INTO runs_text (rowid, instruction, answer) VALUES (new.number, new.instruction, new.answer);
END
"""

MIGRATIONS: tuple[str, ...] = (_INITIAL_SCHEMA,)
"""SQL scripts; the script at index N migrates version N to N + 1. Each statement ends with a semicolon at the end of a line."""


def migrate(connection: Connection) -> None:
    """Migrate the tables to the newest version, inside the caller's transaction.

    Raises:
        StoreError: The store was created by a newer version of the program.
    """
    version = int(connection.exec_driver_sql("PRAGMA user_version").scalar_one())
    if version > len(MIGRATIONS):
        raise StoreError(
            f"The store has version {version}, but this program supports only up to {len(MIGRATIONS)}. Install a newer scope-ptz."
        )
    for number, script in enumerate(MIGRATIONS[version:], version + 1):
        for statement in _statements(script):
            connection.exec_driver_sql(statement)
        connection.exec_driver_sql(f"PRAGMA user_version = {number}")


def _statements(script: str) -> list[str]:
    """Split a script into statements. A trigger, up to its END, is one statement."""
    statements, current = [], ""
    for line in script.strip().splitlines():
        current += line + "\n"
        inside = current.startswith("CREATE TRIGGER") and not line.startswith("END")
        if line.endswith(";") and not inside:
            statements.append(current.strip().removesuffix(";"))
            current = ""
    return [*statements, current] if current.strip() else statements
