"""A small dataset of a bundled scene and the synthetic scene is well worded and valid."""

from __future__ import annotations

import re
from collections import Counter

import anyio
import pytest

from scope_ptz.bench.tasks.expected import NoneThere
from scope_ptz.bench.tasks.task import Category
from scope_ptz.factory.validation_perception import TruthCache, ground_truth_tools
from scope_ptz.simulator.pack import Scene, load_scene
from scope_ptz.taskgen.authoring.assembly import QUOTAS, BuiltTasks, build
from scope_ptz.taskgen.validation.report_text import report_lines
from scope_ptz.taskgen.validation.validate import validate

pytestmark = pytest.mark.full

FEW_TASKS: dict[Category, int] = {**dict.fromkeys(QUOTAS, 2), "counting": 6, "descriptor": 4, "ocr": 1}


@pytest.fixture(scope="module")
def two_scenes(analytic_scene: Scene) -> dict[str, Scene]:
    return {"highway-works": load_scene("highway-works"), analytic_scene.name: analytic_scene}


@pytest.fixture(scope="module")
def two_scene_tasks(two_scenes: dict[str, Scene]) -> BuiltTasks:
    return build(list(two_scenes.values()), 3, FEW_TASKS)


def test_tasks_are_spread_over_both_scenes(two_scene_tasks: BuiltTasks, two_scenes: dict[str, Scene]) -> None:
    assert not two_scene_tasks.missing
    per_scene = Counter(task.scene for task in two_scene_tasks.tasks if task.stratum == "core" and task.category == "counting")
    assert set(per_scene) == set(two_scenes)
    assert max(per_scene.values()) - min(per_scene.values()) <= 2


def test_the_dataset_is_sound(two_scene_tasks: BuiltTasks, two_scenes: dict[str, Scene]) -> None:
    truth = TruthCache()
    report = anyio.run(
        lambda: validate(two_scene_tasks.tasks, two_scenes, ground_truth_tools(two_scenes, truth), read_truth=truth.read)
    )
    assert report.sound, "\n".join(report_lines(report))
    assert not report.disagreements
    assert report.absences == sum(isinstance(t.expected, NoneThere) for t in two_scene_tasks.tasks if t.stratum == "core")


def test_instructions_have_no_formatting_faults(two_scene_tasks: BuiltTasks) -> None:
    assert two_scene_tasks.tasks
    for task in two_scene_tasks.tasks:
        text = task.instruction
        assert text[0].isupper() or text[0] == '"'
        assert text[-1] in ".?"
        assert not re.search(r"  |\{|\}|\ba [aeio]\w*|\ban [bcdfgjklpqrtvwxyz]\w*|\.\.|,\.", text), text
        assert not any(thing in text for thing in ("-01", "-02", "scope1"))
