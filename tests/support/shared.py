"""Create expensive folders once per test run. The first worker that needs a folder creates it, and the others wait."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from filelock import FileLock


def root_of_all_workers(factory: pytest.TempPathFactory) -> Path:
    """Return the temporary folder of the whole test run, which contains the folder of each worker."""
    base = factory.getbasetemp()
    return base.parent if "PYTEST_XDIST_WORKER" in os.environ else base


def create_once(factory: pytest.TempPathFactory, name: str, make: Callable[[Path], object]) -> Path:
    """Return the shared folder ``name``. ``make`` fills it on first use in a test run. Tests must not write to it."""
    folder = root_of_all_workers(factory) / "shared" / name
    folder.parent.mkdir(exist_ok=True)
    complete = folder.with_name(f"{name}.complete")
    with FileLock(f"{folder}.lock"):
        if not complete.exists():
            shutil.rmtree(folder, ignore_errors=True)  # remove the files of a failed attempt
            folder.mkdir()
            make(folder)
            complete.touch()
    return folder
