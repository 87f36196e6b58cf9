"""Run folders that the agent creates in a small scene."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

import scope_ptz
from scope_ptz.store.run_store import RunStore

INSTRUCTIONS = ("count the balls", "pan right 20 degrees and take a picture", "what colour is the sky?")


@pytest.fixture(scope="session")
def recorded(analytic_folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A runs folder with one run per instruction. Tests must not change it."""
    root = tmp_path_factory.mktemp("recorded")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SCOPE_SCENES_DIR", str(analytic_folder.parent))
        with scope_ptz.open("analytic-yard", runs_dir=root) as scope:
            for instruction in INSTRUCTIONS:
                scope.ask(instruction)
    return root


@pytest.fixture
def root(recorded: Path, tmp_path: Path) -> Path:
    """A copy of the runs folder that the test may change, without a database."""
    return Path(shutil.copytree(recorded, tmp_path / "runs"))


@pytest.fixture
def store(root: Path) -> Iterator[RunStore]:
    """A store whose runs are indexed."""
    with RunStore(root) as opened:
        opened.index()
        yield opened


@pytest.fixture
def copies(root: Path) -> Callable[[int], list[str]]:
    """Return a function that copies a run folder and returns the names of the copies."""
    first = sorted(root.iterdir())[0]

    def make(count: int) -> list[str]:
        names = [f"{first.name}-{number}" for number in range(count)]
        for name in names:
            shutil.copytree(first, root / name)
        return names

    return make
