"""The published dataset: whole, of the scenes that are shipped, and as many tasks of each category as the paper's."""

from __future__ import annotations

import hashlib
import json
from collections import Counter

import pytest

from scope_ptz.bench.tasks.expected import NoneThere
from scope_ptz.bench.tasks.splits import load_split, published_folder, read_manifest
from scope_ptz.factory.worlds import scenes_named
from scope_ptz.taskgen.authoring.assembly import QUOTAS
from tests.cli.conftest import Scope, scenes, scope

__all__ = ["scenes", "scope"]

FOLDER = published_folder()
CORE = load_split("core")
EVERYTHING = load_split("all")


def test_every_file_is_what_was_published() -> None:
    files = read_manifest(FOLDER)["files"]
    assert {"tasks.jsonl", "paraphrase.jsonl", "reaction.jsonl", "unseen.jsonl", "lite.txt", "gold.jsonl.gz", "proof.json"} <= set(
        files
    )
    assert {name: hashlib.sha256((FOLDER / name).read_bytes()).hexdigest() for name in files} == files


def test_it_was_made_of_the_scenes_that_are_shipped() -> None:
    shipped = scenes_named(None)
    made_of = read_manifest(FOLDER)["scenes"]
    assert made_of.keys() <= shipped.keys()
    assert {name: scene["version"] for name, scene in made_of.items()} == {name: shipped[name].file.version for name in made_of}


def test_the_numbers_are_the_papers() -> None:
    assert Counter(task.category for task in CORE) == QUOTAS
    assert len(CORE) == 536
    assert sum(isinstance(task.expected, NoneThere) for task in CORE) >= 60
    assert len({task.paraphrase_of for task in load_split("paraphrase")}) >= 60
    assert len(load_split("reaction")) >= 40
    assert 50 <= len(load_split("lite")) <= 60


def test_each_absence_has_a_twin_that_is_there() -> None:
    by_id = {task.id: task for task in CORE}
    for task in CORE:
        if isinstance(task.expected, NoneThere):
            assert task.pair is not None and not isinstance(by_id[task.pair].expected, NoneThere)


def test_no_task_and_no_wording_comes_twice() -> None:
    assert len({task.id for task in EVERYTHING}) == len(EVERYTHING)
    assert len({(task.scene, task.variation, task.preset, task.instruction) for task in EVERYTHING}) == len(EVERYTHING)


def test_every_scene_and_viewpoint_is_used() -> None:
    here = scenes_named(list(read_manifest(FOLDER)["scenes"]))
    used = {
        (task.scene, preset.viewpoint) for task in CORE for preset in here[task.scene].file.presets if preset.name == task.preset
    }
    assert used == {(name, viewpoint.name) for name, scene in here.items() for viewpoint in scene.file.viewpoints}


def test_it_was_proved_and_by_these_very_tasks() -> None:
    proof = json.loads((FOLDER / "proof.json").read_text("utf-8"))
    assert proof["published"]["sound"] and proof["unseen"]["sound"]


@pytest.mark.full
def test_it_is_still_proved(scope: Scope) -> None:
    done = scope("bench", "validate")
    assert done.code == 0, done.out
    assert "reference               " in done.out and done.out.rstrip().endswith("sound")
