"""The database file: versions, several processes, locks, damage and full disks."""

from __future__ import annotations

import sqlite3
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from sqlalchemy import create_engine, inspect
from sqlalchemy.exc import OperationalError

from scope_ptz.errors import OutputError, StoreError
from scope_ptz.store.database import Database
from scope_ptz.store.migrations import MIGRATIONS
from scope_ptz.store.run_store import RunStore
from scope_ptz.store.schema import metadata

INDEX = "import sys; from pathlib import Path; from scope_ptz.store.run_store import RunStore\n"


def test_migrations_make_the_tables_that_queries_expect(tmp_path: Path) -> None:
    Database(tmp_path / "store.sqlite").close()
    made = inspect(create_engine(f"sqlite:///{tmp_path / 'store.sqlite'}"))
    for table in metadata.sorted_tables:
        columns = {column["name"]: column["nullable"] for column in made.get_columns(table.name)}
        expected = {column.name: bool(column.nullable) for column in table.columns}
        keys = set(table.primary_key.columns.keys())
        assert {name: null for name, null in columns.items() if name not in keys} == {
            name: null for name, null in expected.items() if name not in keys
        }
        assert columns.keys() == expected.keys()


def test_the_journal_is_a_write_ahead_log(tmp_path: Path) -> None:
    database = Database(tmp_path / "store.sqlite")
    with database.read_transaction() as connection:
        assert connection.exec_driver_sql("PRAGMA journal_mode").scalar_one() == "wal"
        assert connection.exec_driver_sql("PRAGMA foreign_keys").scalar_one() == 1
        assert connection.exec_driver_sql("PRAGMA user_version").scalar_one() == len(MIGRATIONS)
    database.close()


def test_a_store_of_a_newer_version_is_refused_and_not_changed(tmp_path: Path) -> None:
    path = tmp_path / "store.sqlite"
    with sqlite3.connect(path) as raw:
        raw.execute("PRAGMA user_version = 99")
    with pytest.raises(StoreError, match="newer scope-ptz"):
        Database(path)
    with sqlite3.connect(path) as raw:
        assert raw.execute("SELECT count(*) FROM sqlite_master").fetchone() == (0,)


def test_a_failed_migration_changes_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scope_ptz.store.migrations.MIGRATIONS", (*MIGRATIONS, "CREATE TABLE half (x INTEGER);\nNO SUCH WORD"))
    with pytest.raises(StoreError):
        Database(tmp_path / "store.sqlite")
    monkeypatch.undo()
    database = Database(tmp_path / "store.sqlite")
    with database.read_transaction() as connection:
        assert connection.exec_driver_sql("SELECT count(*) FROM sqlite_master WHERE name = 'half'").scalar_one() == 0
    database.close()


def test_a_locked_store_gives_a_clear_message_and_loses_no_run(root: Path, copies: Callable[[int], list[str]]) -> None:
    with RunStore(root, busy_s=0.05) as store:
        store.index()
        names = copies(2)
        other = sqlite3.connect(root / "store.sqlite", isolation_level=None)
        other.execute("BEGIN IMMEDIATE")
        with pytest.raises(StoreError, match="Another program is writing"):
            store.index()
        assert store.count() == 3, "readers do not wait for a writer"
        other.execute("ROLLBACK")
        other.close()
        assert store.index().added == 2
        assert {store.run(name).run.outcome for name in names} == {"answered"}


def test_a_full_disk_gives_a_clear_message_and_loses_no_run(root: Path, copies: Callable[[int], list[str]]) -> None:
    with RunStore(root) as store:
        store.index()
        with store.database.read_transaction() as connection:
            pages = connection.exec_driver_sql("PRAGMA page_count").scalar_one()
        store.close()
        copies(30)
        engine = store.database._engine
        limit = f"PRAGMA max_page_count = {pages}"  # beyond it, SQLite reports the same error as on a full disk
        with engine.connect() as connection:
            connection.exec_driver_sql(limit)
            connection.rollback()
        with pytest.raises(OutputError, match="disk is full"):
            store.index()
        assert store.count() == 3
    with RunStore(root) as store:
        assert store.index().added == 30


@pytest.mark.parametrize("content", [b"this is not a database" * 100, b"SQLite format 3\0" + b"\xff" * 4000])
def test_a_damaged_store_gives_a_clear_message_and_is_not_changed(root: Path, content: bytes) -> None:
    path = root / "store.sqlite"
    path.write_bytes(content)
    with pytest.raises(StoreError, match=r"damaged.*scope runs index"):
        RunStore(root)
    assert path.read_bytes() == content
    path.unlink()
    with RunStore(root) as store:
        assert store.index().added == 3


def test_a_folder_that_cannot_be_created_gives_a_clear_message(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError):
        RunStore(tmp_path / "file" / "runs")
    with pytest.raises((OutputError, StoreError), match="unable to open"):
        (tmp_path / "folder" / "store.sqlite").mkdir(parents=True)
        RunStore(tmp_path / "folder")


def test_database_errors_contain_no_values(tmp_path: Path) -> None:
    database = Database(tmp_path / "store.sqlite")
    with pytest.raises(StoreError) as caught, database.write_transaction():
        raise OperationalError("INSERT", {"token": "secret"}, sqlite3.OperationalError("no such table: x"))
    assert "secret" not in str(caught.value)
    database.close()


@pytest.mark.full
def test_several_processes_index_the_same_folder(root: Path, copies: Callable[[int], list[str]]) -> None:
    copies(40)
    programs = [
        subprocess.Popen([sys.executable, "-c", INDEX + "RunStore(Path(sys.argv[1])).index()", str(root)], stderr=subprocess.PIPE)
        for _ in range(3)
    ]
    for program in programs:
        _, errors = program.communicate()
        assert program.returncode == 0, errors.decode()
    with RunStore(root) as store:
        assert store.count() == 43
        assert store.index().added == 0


@pytest.mark.full
def test_a_plain_ask_imports_no_database() -> None:
    code = """
import sys, tempfile
import scope_ptz, scope_ptz.cli, scope_ptz.cli.app, scope_ptz.cli.ask
with tempfile.TemporaryDirectory() as folder, scope_ptz.open("highway-works", runs_dir=folder) as scope:
    scope.ask("pan right 5")
found = {"sqlalchemy", "sqlite3", "fastapi", "starlette", "uvicorn", "websockets"} & set(sys.modules)
assert not found, found
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
