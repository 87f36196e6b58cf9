"""Evaluations of a few small tasks in the analytic scene, run by the very commands that people type."""

from __future__ import annotations

import gc
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from scope_ptz.bench.tasks.files import dump_tasks
from scope_ptz.cli import main
from tests.bench.engine.making import TASKS
from tests.cli.conftest import scenes, scope
from tests.support.fixtures import one_search_for_packages
from tests.support.shared import made_once

__all__ = ["one_search_for_packages", "scenes", "scope"]

HERE = Path(__file__).parent
ENGINES_OWN = ("ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning", "ignore::DeprecationWarning")
"""Inspect AI leaves streams of its own to the garbage collector."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if HERE in item.path.parents:
            for warning in ENGINES_OWN:
                item.add_marker(pytest.mark.filterwarnings(warning))


@pytest.fixture(autouse=True, scope="module")
def nothing_left_behind() -> Iterator[None]:
    """What the engine left is collected while its warnings are let pass, and not in the middle of somebody else's test."""
    yield
    gc.collect()


@pytest.fixture(scope="session")
def tasks_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return made_once(tmp_path_factory, "engine-tasks", lambda folder: dump_tasks(TASKS, folder / "tasks.jsonl")) / "tasks.jsonl"


@pytest.fixture(scope="session")
def a_log(scenes: Path, tasks_file: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The log of all tasks with the built-in planner and ground truth, pictures included. Not to be written to."""

    def evaluate(out: Path) -> None:
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("SCOPE_SCENES_DIR", str(scenes))
            patch.setattr("sys.argv", ["scope", "bench", "run", "--tasks", str(tasks_file), "--out", str(out)])
            with pytest.raises(SystemExit) as ended:
                main()
            assert ended.value.code in (0, None)

    (log,) = made_once(tmp_path_factory, "engine-logs", evaluate).glob("*.eval")
    return log


@pytest.fixture
def evaluated(a_log: Path, tmp_path: Path) -> Path:
    """That log in a folder of the test's own."""
    return Path(shutil.copy2(a_log, tmp_path))
