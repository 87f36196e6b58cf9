"""The published dataset is complete, uses the bundled scenes, and has the paper's number of tasks per category."""

from __future__ import annotations

import hashlib
import json
from collections import Counter

from scope_ptz.bench.tasks.expected import NoneThere
from scope_ptz.bench.tasks.splits import load_split, published_folder, read_manifest
from scope_ptz.factory.worlds import open_scenes
from scope_ptz.taskgen.authoring.assembly import QUOTAS

FOLDER = published_folder()
CORE = load_split("core")
EVERYTHING = load_split("all")


def test_every_file_is_unchanged() -> None:
    files = read_manifest(FOLDER)["files"]
    assert {"tasks.jsonl", "paraphrase.jsonl", "reaction.jsonl", "unseen.jsonl", "lite.txt", "gold.jsonl.gz", "proof.json"} <= set(
        files
    )
    assert {name: hashlib.sha256((FOLDER / name).read_bytes()).hexdigest() for name in files} == files


def test_it_was_built_from_the_bundled_scenes() -> None:
    bundled = open_scenes(None)
    source_scenes = read_manifest(FOLDER)["scenes"]
    assert source_scenes.keys() <= bundled.keys()
    assert {name: scene["version"] for name, scene in source_scenes.items()} == {
        name: bundled[name].file.version for name in source_scenes
    }


def test_numbers_of_tasks_match_the_paper() -> None:
    assert Counter(task.category for task in CORE) == QUOTAS
    assert len(CORE) == 536
    assert sum(isinstance(task.expected, NoneThere) for task in CORE) >= 60
    assert len({task.paraphrase_of for task in load_split("paraphrase")}) >= 60
    assert len(load_split("reaction")) >= 40
    assert 50 <= len(load_split("lite")) <= 60


def test_each_absence_has_a_presence_as_its_twin() -> None:
    by_id = {task.id: task for task in CORE}
    for task in CORE:
        if isinstance(task.expected, NoneThere):
            assert task.pair is not None and not isinstance(by_id[task.pair].expected, NoneThere)


def test_tasks_and_wordings_are_unique() -> None:
    assert len({task.id for task in EVERYTHING}) == len(EVERYTHING)
    assert len({(task.scene, task.variation, task.preset, task.instruction) for task in EVERYTHING}) == len(EVERYTHING)


def test_every_scene_and_viewpoint_is_used() -> None:
    scenes = open_scenes(list(read_manifest(FOLDER)["scenes"]))
    used = {
        (task.scene, preset.viewpoint) for task in CORE for preset in scenes[task.scene].file.presets if preset.name == task.preset
    }
    assert used == {(name, viewpoint.name) for name, scene in scenes.items() for viewpoint in scene.file.viewpoints}


def test_the_stored_validation_covers_these_tasks() -> None:
    proof = json.loads((FOLDER / "proof.json").read_text("utf-8"))
    assert proof["published"]["sound"] and proof["unseen"]["sound"]
