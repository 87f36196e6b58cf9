"""Scenes are opened once for all examples of a module, and the evaluation engine's own warnings are no failures."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path

import pytest

from scope_ptz.factory import scenes
from tests.support.fixtures import one_search_for_packages

__all__ = ["one_search_for_packages"]

HERE = Path(__file__).parent
WITH_EVALUATIONS = ("test_evaluations.py", "test_examples.py", "test_public_names.py")
ENGINE_WARNINGS = ("ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning", "ignore::DeprecationWarning")
"""Inspect AI leaves streams to the garbage collector, and uses what its dependencies deprecate."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if item.path.parent == HERE and item.path.name in WITH_EVALUATIONS:
            for warning in ENGINE_WARNINGS:
                item.add_marker(pytest.mark.filterwarnings(warning))


@pytest.fixture(scope="module")
def opened_once() -> Iterator[None]:
    """Open each scene once in the tests of a module, because decoding its pictures takes most of an example's time."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(scenes, "open_scene", lru_cache(scenes.open_scene))
        yield
    gc.collect()
