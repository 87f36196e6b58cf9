"""Fixtures for evaluations of a few small tasks in the analytic scene, run through the command line."""

from __future__ import annotations

import gc
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from scope_ptz.bench.tasks.files import dump_tasks
from scope_ptz.cli import main
from tests.bench.engine.yard_tasks import TASKS
from tests.cli.conftest import scenes, scope
from tests.support.fixtures import package_search_cache
from tests.support.shared import create_once

__all__ = ["package_search_cache", "scenes", "scope"]

HERE = Path(__file__).parent
ENGINE_WARNINGS = ("ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning", "ignore::DeprecationWarning")
"""Ignored, because Inspect AI leaves open streams to the garbage collector."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if HERE in item.path.parents:
            for warning in ENGINE_WARNINGS:
                item.add_marker(pytest.mark.filterwarnings(warning))


@pytest.fixture(autouse=True, scope="module")
def collect_garbage() -> Iterator[None]:
    """Collect the engine's garbage while its warnings are ignored, and not during another module's tests."""
    yield
    gc.collect()


@pytest.fixture(scope="session")
def tasks_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return create_once(tmp_path_factory, "engine-tasks", lambda folder: dump_tasks(TASKS, folder / "tasks.jsonl")) / "tasks.jsonl"


@pytest.fixture(scope="session")
def shared_log(scenes: Path, tasks_file: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the log of all tasks with the built-in planner and ground truth, with pictures. Tests must not modify it."""

    def evaluate(out: Path) -> None:
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("SCOPE_SCENES_DIR", str(scenes))
            patch.setattr("sys.argv", ["scope", "bench", "run", "--tasks", str(tasks_file), "--out", str(out)])
            with pytest.raises(SystemExit) as excinfo:
                main()
            assert excinfo.value.code in (0, None)

    (log,) = create_once(tmp_path_factory, "engine-logs", evaluate).glob("*.eval")
    return log


@pytest.fixture
def log_copy(shared_log: Path, tmp_path: Path) -> Path:
    """Return a copy of the shared log that the test may modify."""
    return Path(shutil.copy2(shared_log, tmp_path))
