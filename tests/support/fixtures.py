"""Fixtures that tests of several packages share. A conftest module imports the fixtures that its tests need."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from scope_ptz.simulator.pack import Scene
from tests.support.shared import create_once, root_of_all_workers
from tests.support.synthetic_pack import write_scene


@pytest.fixture(scope="session")
def analytic_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a scene folder of the analytic world. Tests must not write to it."""
    return next(create_once(tmp_path_factory, "scenes", write_scene).iterdir())


@pytest.fixture(scope="session")
def analytic_scene(analytic_folder: Path) -> Scene:
    return Scene(analytic_folder)


@pytest.fixture(scope="session")
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture(scope="session", autouse=True)
def package_search_cache() -> Iterator[None]:
    """Cache the search for the installed package of a task, so that each evaluation does not repeat it.

    In a checkout, the search reads the file lists of all installed packages. In an installed wheel, it is fast.
    """
    from inspect_ai._eval.task import log
    from inspect_ai._util.package import get_distribution_for_object as search

    cache = dict[object, Any]()

    def cached_search(target: Any) -> Any:
        module = getattr(target, "__module__", None)
        if module not in cache:
            cache[module] = search(target)
        return cache[module]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(log, "get_distribution_for_object", cached_search)
        yield


@pytest.fixture(scope="session", autouse=True)
def pictures_dir(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Return the cache folder of decoded pictures, which the tests of all workers and the programs that they start share."""
    folder = root_of_all_workers(tmp_path_factory) / "pictures"
    before = os.environ.get("SCOPE_PICTURES_DIR")
    os.environ["SCOPE_PICTURES_DIR"] = str(folder)
    yield folder
    if before is None:
        del os.environ["SCOPE_PICTURES_DIR"]
    else:
        os.environ["SCOPE_PICTURES_DIR"] = before
