"""A small dataset of the synthetic scene, built and validated once."""

from __future__ import annotations

import json
from pathlib import Path

import anyio
import pytest

from scope_ptz.bench.tasks.files import dump_tasks, load_tasks
from scope_ptz.bench.tasks.task import Category
from scope_ptz.factory.validation_perception import ground_truth_tools, is_answerable
from scope_ptz.simulator.pack import Scene
from scope_ptz.taskgen.authoring.assembly import BuiltTasks, build
from scope_ptz.taskgen.validation.validate import validate
from scope_ptz.taskgen.validation.validation_report import ValidationReport
from tests.support.shared import create_once

QUOTAS: dict[Category, int] = {
    "counting": 8,
    "descriptor": 4,
    "location": 6,
    "ocr": 1,
    "single_call": 8,
    "multi_step_command": 6,
    "multi_step_reasoning": 4,
    "comparative": 4,
}


@pytest.fixture(scope="session")
def built_tasks(analytic_scene: Scene, tmp_path_factory: pytest.TempPathFactory) -> BuiltTasks:
    def make(folder: Path) -> None:
        tasks = build([analytic_scene], 1, QUOTAS, None, is_answerable)
        dump_tasks(tasks.tasks, folder / "tasks.jsonl")
        (folder / "short.json").write_text(json.dumps(tasks.missing))

    folder = create_once(tmp_path_factory, "built-tasks", make)
    return BuiltTasks(list(load_tasks(folder / "tasks.jsonl")), json.loads((folder / "short.json").read_text()))


@pytest.fixture(scope="session")
def report(built_tasks: BuiltTasks, analytic_scene: Scene) -> ValidationReport:
    scenes = {analytic_scene.name: analytic_scene}
    return anyio.run(lambda: validate(built_tasks.tasks, scenes, ground_truth_tools(scenes)))


@pytest.fixture(scope="session")
def scenes_root(analytic_folder: Path) -> Path:
    return analytic_folder.parent
