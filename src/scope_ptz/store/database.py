"""A store's database file: connections, transactions and error messages."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from sqlalchemy import Connection, Engine, create_engine, event
from sqlalchemy.exc import DBAPIError

from scope_ptz.errors import OutputError, StoreError
from scope_ptz.store.matching import has_words
from scope_ptz.store.migrations import migrate

FILE_NAME = "store.sqlite"

BUSY_S = 5.0
"""Seconds to wait while another process writes."""


class Database:
    """The database in a runs folder. Several threads and several processes may use it at the same time.

    Args:
        path: The file. It is created if needed, and migrated to the newest version.
        busy_s: Seconds to wait while another process writes.

    Raises:
        OutputError: The file cannot be written.
        StoreError: The file is damaged, locked, or was created by a newer version.
    """

    def __init__(self, path: Path, *, busy_s: float = BUSY_S) -> None:
        self.path = path
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise OutputError(f"The folder {path.parent} cannot be created: {error.strerror}.") from error
        self._engine = _engine(path, busy_s)
        try:
            with self.write_transaction() as connection:
                migrate(connection)
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Close all connections."""
        self._engine.dispose()

    @contextmanager
    def read_transaction(self) -> Iterator[Connection]:
        """Return a connection that sees a snapshot of the database until the block ends.

        Raises:
            StoreError: The database is locked or damaged.
        """
        with self._translate_errors(), self._engine.connect() as connection, connection.begin():
            yield connection

    @contextmanager
    def write_transaction(self) -> Iterator[Connection]:
        """Return a connection in a transaction that is committed when the block ends without an exception.

        Raises:
            StoreError: The database is locked by another program, or damaged.
            OutputError: The disk is full, or the file cannot be written.
        """
        with self._translate_errors(), self._engine.connect() as connection:
            connection = connection.execution_options(scope_writes=True)
            with connection.begin():
                yield connection

    @contextmanager
    def _translate_errors(self) -> Iterator[None]:
        try:
            yield
        except DBAPIError as error:
            raise _translate(self.path, str(error.orig)) from error
        except sqlite3.Error as error:
            raise _translate(self.path, str(error)) from error


def _engine(path: Path, busy_s: float) -> Engine:
    engine = create_engine(f"sqlite+pysqlite:///{path}", connect_args={"timeout": busy_s, "check_same_thread": False})

    @event.listens_for(engine, "connect")
    def set_up(connection: sqlite3.Connection, _: Any) -> None:
        # sqlite3 itself would begin transactions too late for readers and without a lock for writers, so `begin` below begins them.
        connection.isolation_level = None
        cursor = connection.cursor()
        for pragma in ("journal_mode = WAL", "synchronous = NORMAL", "foreign_keys = ON"):
            cursor.execute(f"PRAGMA {pragma}")
        cursor.close()
        connection.create_function("has_words", 3, has_words, deterministic=True)

    @event.listens_for(engine, "begin")
    def begin(connection: Connection) -> None:
        # A writer must lock the database from the start: upgrading a reader to a writer would fail without waiting.
        writes = connection.get_execution_options().get("scope_writes", False)
        connection.exec_driver_sql("BEGIN IMMEDIATE" if writes else "BEGIN")

    return engine


def _translate(path: Path, reason: str) -> StoreError | OutputError:
    lowered = reason.lower()
    if "locked" in lowered or "busy" in lowered:
        return StoreError(
            f"Another program is writing to the store {path}. Try again later. Runs are still written to their folders."
        )
    if "full" in lowered:
        return OutputError(f"The store {path} cannot be written: the disk is full. Free some space, then run `scope runs index`.")
    if "readonly" in lowered or "unable to open" in lowered or "disk i/o" in lowered:
        return OutputError(
            f"The store {path} cannot be written: {reason}. Check the permissions of its folder and the space on its disk."
        )
    if "malformed" in lowered or "not a database" in lowered:
        return StoreError(
            f"The store {path} is damaged: {reason}. Move it away and run `scope runs index` to create a new one from the runs."
        )
    return StoreError(f"The store {path} failed: {reason}.")
