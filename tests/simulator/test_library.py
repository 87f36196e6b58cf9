"""The scene library: each scene is opened once, and the number of loaded viewpoints is limited."""

from __future__ import annotations

import gc
import weakref
from pathlib import Path

import pytest

from scope_ptz.errors import UnknownNameError
from scope_ptz.geometry import Perspective
from scope_ptz.simulator.library import Library
from scope_ptz.simulator.views import picture


@pytest.fixture
def root(analytic_folder: Path) -> Path:
    return analytic_folder.parent


def test_a_scene_is_opened_once_and_its_variations_share_its_viewpoints(root: Path) -> None:
    library = Library([root])
    scene, varied = library("analytic-yard"), library("analytic-yard-v3")
    assert library("analytic-yard") is scene
    assert library("analytic-yard-v3") is varied
    assert varied.variation == 3
    name = scene.file.viewpoints[0].name
    assert varied.viewpoint(name) is scene.viewpoint(name)


def test_the_least_recently_used_viewpoint_is_released(root: Path) -> None:
    library = Library([root], open_viewpoints=1)
    scene = library("analytic-yard")
    first, second = (viewpoint.name for viewpoint in scene.file.viewpoints[:2])
    held = scene.viewpoint(first)
    assert scene.viewpoint(first) is held
    scene.viewpoint(second)
    again = scene.viewpoint(first)
    assert again is not held
    assert again.manifest == held.manifest


def test_released_memory_is_freed_immediately(root: Path) -> None:
    scene = Library([root], open_viewpoints=1)("analytic-yard")
    first, second = (viewpoint.name for viewpoint in scene.file.viewpoints[:2])
    picture(scene, first, Perspective(0.0, -8.0, 71.0, 64, 36), 0.0)
    still_there = weakref.ref(scene.viewpoint(first))
    gc.disable()  # large arrays in a cycle would wait for a collection that small objects alone seldom cause
    try:
        scene.viewpoint(second)
        assert still_there() is None
    finally:
        gc.enable()


def test_an_unknown_scene(root: Path) -> None:
    for name in ("analytic-yrad", "analytic-yrad-v3"):
        with pytest.raises(UnknownNameError, match="analytic-yard"):
            Library([root])(name)
