"""Fixtures that several rooms' tests share; a room's conftest imports those it needs."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from scope_ptz.simulator.pack import Scene
from tests.support.synthetic_pack import write_scene


@pytest.fixture(scope="session")
def analytic_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A scene folder of the analytic world; not to be written to."""
    return write_scene(tmp_path_factory.mktemp("scenes"))


@pytest.fixture(scope="session")
def analytic_scene(analytic_folder: Path) -> Scene:
    return Scene(analytic_folder)


@pytest.fixture(scope="session")
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture(scope="session", autouse=True)
def pictures_dir(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """The folder in which the tests of all workers, and the programs that they start, keep decoded pictures."""
    root = tmp_path_factory.getbasetemp()
    folder = (root.parent if "PYTEST_XDIST_WORKER" in os.environ else root) / "pictures"
    before = os.environ.get("SCOPE_PICTURES_DIR")
    os.environ["SCOPE_PICTURES_DIR"] = str(folder)
    yield folder
    if before is None:
        del os.environ["SCOPE_PICTURES_DIR"]
    else:
        os.environ["SCOPE_PICTURES_DIR"] = before
