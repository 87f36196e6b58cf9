"""Locks on files, with and without ``fcntl``."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from scope_ptz.bench.engine import file_lock


def test_a_file_is_locked_once(tmp_path: Path) -> None:
    path = tmp_path / "lock"
    with path.open("w") as first, path.open("w") as second:
        assert file_lock.lock_file(first)
        assert not file_lock.lock_file(second)
    with path.open("w") as third:
        assert file_lock.lock_file(third)


def test_without_fcntl_the_windows_lock_is_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    lock_calls: list[tuple[int, int]] = []
    windows = SimpleNamespace(LK_NBLCK=2, locking=lambda _, mode, size: lock_calls.append((mode, size)))
    monkeypatch.setitem(sys.modules, "fcntl", None)
    monkeypatch.setitem(sys.modules, "msvcrt", windows)
    try:
        importlib.reload(file_lock)
        with (tmp_path / "lock").open("w") as file:
            assert file_lock.lock_file(file)
    finally:
        monkeypatch.undo()
        importlib.reload(file_lock)
    assert lock_calls == [(2, 1)]
