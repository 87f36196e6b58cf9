"""Fixtures of the API tests: scenes are opened once per module, and warnings of the evaluation engine are ignored."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path

import pytest

from scope_ptz.factory import scenes
from tests.support.fixtures import package_search_cache

__all__ = ["package_search_cache"]

HERE = Path(__file__).parent
WITH_EVALUATIONS = ("test_evaluations.py", "test_examples.py", "test_public_names.py")
ENGINE_WARNINGS = ("ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning", "ignore::DeprecationWarning")
"""Ignored, because Inspect AI leaves open streams to the garbage collector and uses deprecated functions."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if item.path.parent == HERE and item.path.name in WITH_EVALUATIONS:
            for warning in ENGINE_WARNINGS:
                item.add_marker(pytest.mark.filterwarnings(warning))


@pytest.fixture(scope="module")
def scenes_cache() -> Iterator[None]:
    """Open each scene once in the tests of a module, because decoding its pictures takes most of an example's time."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(scenes, "open_scene", lru_cache(scenes.open_scene))
        yield
    gc.collect()
