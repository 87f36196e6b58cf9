"""Fixtures of the environments' tests: a small scene for searches, and tasks of a shipped scene."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gymnasium
import pytest

import scope_ptz.gym as scope_gym
from scope_ptz.gym.shared_scenes import shared_scene

COUNTING, TURNING = "scope1-highway-works-counting-002", "scope1-highway-works-single-call-001"
"""Tasks: "Zoom in 2.5x and have a look: what's the count of workers in white helmets?" and "rotate the camera 8 degrees ..."."""
YARD = "analytic-yard"


@pytest.fixture(scope="session")
def shipped() -> Iterator[object]:
    """Keep the scene of the tasks open, so that not every test reads it."""
    yield shared_scene("highway-works")


@pytest.fixture
def yard(analytic_folder: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """Name of the small scene, which the environments find in this test."""
    monkeypatch.setenv("SCOPE_SCENES_DIR", str(analytic_folder.parent))
    return YARD


@pytest.fixture
def make() -> Iterator[Any]:
    """Create environments without wrappers, and close them after the test."""
    made = []

    def make_env(name: str, **options: Any) -> Any:
        assert name in scope_gym.ENVIRONMENTS
        made.append(gymnasium.make(name, **options).unwrapped)
        return made[-1]

    yield make_env
    for env in made:
        env.close()
