"""Splits: their tasks, the representative lite split, and detection of changed files."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.bench.tasks.splits import lite, lite1, load_split, read_manifest, write_manifest, write_splits
from scope_ptz.bench.tasks.stratified import SampledTask, balanced_sample
from scope_ptz.bench.tasks.task import Task
from scope_ptz.errors import InputError, UnknownNameError
from scope_ptz.simulator.pack import load_scene
from tests.bench.sample_runs import samples

SAMPLES = [task for task, _ in samples()]


def make_tasks(number: int = 536) -> list[Task]:
    """Return core tasks of several scenes and difficulties."""
    tasks = []
    for n in range(number):
        template = SAMPLES[n * 7 % len(SAMPLES)]
        scene = ("north", "south", "east")[n % 3]
        facts = {"id": f"scope1-{scene}-{template.category.replace('_', '-')}-{n:03d}", "scene": scene}
        tasks.append(template.model_copy(update={**facts, "difficulty": ("easy", "medium", "hard")[n % 5 % 3], "pair": None}))
    return tasks


def test_lite_is_a_tenth_of_every_category_scene_and_difficulty() -> None:
    tasks = make_tasks()
    selected = lite(tasks, 1)
    assert len(selected) == 54
    for key in ("category", "scene", "difficulty"):
        whole, part = (Counter(getattr(task, key) for task in rows) for rows in (tasks, selected))
        assert all(abs(part[name] - number / 10) <= 1 for name, number in whole.items()), key


def test_lite_depends_on_the_seed_and_not_on_the_order() -> None:
    tasks = make_tasks()
    ids = {task.id for task in lite(tasks, 1)}
    assert ids == {task.id for task in lite(tasks[::-1], 1)}
    assert ids != {task.id for task in lite(tasks, 2)}


@pytest.fixture
def dataset(tmp_path: Path) -> Path:
    core = make_tasks(40)
    extra = [
        core[0].model_copy(update={"id": "scope1-north-wording-001", "stratum": "paraphrase", "paraphrase_of": core[0].id}),
        core[1].model_copy(update={"id": "scope1-north-reaction-001", "stratum": "reaction"}),
    ]
    unseen = [core[2].model_copy(update={"id": "scope1-north-v7-counting-001", "variation": 7})]
    paths = write_splits([*core, *extra], unseen, tmp_path, seed=1)
    write_manifest(tmp_path, paths, [load_scene("highway-works")], seed=1)
    return tmp_path


def test_every_split_is_read_back(dataset: Path) -> None:
    sizes = {name: len(load_split(name, dataset)) for name in ("core", "lite", "lite1", "paraphrase", "reaction", "unseen", "all")}
    assert sizes == {"core": 40, "lite": 4, "lite1": 4, "paraphrase": 1, "reaction": 1, "unseen": 1, "all": 42}
    (unseen,) = load_split("unseen", dataset)
    assert unseen.world == f"{unseen.scene}-v7"
    assert load_split(dataset / "tasks.jsonl") == load_split("core", dataset)


def test_a_changed_dataset_is_reported(dataset: Path) -> None:
    assert read_manifest(dataset)["made_with"] == {"seed": 1}
    (dataset / "lite2.txt").write_text("scope1-nowhere-001\n")
    with pytest.raises(InputError, match=r"lite2\.txt has changed since it was built"):
        read_manifest(dataset)
    with pytest.raises(InputError, match="scope1-nowhere-001"):
        load_split("lite", dataset)


def test_unknown_splits_are_reported(tmp_path: Path) -> None:
    with pytest.raises(UnknownNameError, match="paraphrase"):
        load_split("paraphrases", tmp_path)
    with pytest.raises(InputError, match="scope bench build"):
        load_split("core", tmp_path)
    with pytest.raises(InputError, match="cannot be read"):
        load_split("none.jsonl")


def test_the_published_lite_split_is_balanced_and_its_first_version_is_readable() -> None:
    core, ids = load_split("core"), {task.id for task in load_split("lite")}
    assert [task.id for task in lite(core, 1)] == [task.id for task in load_split("lite")]
    assert [task.id for task in lite1(core, 1)] == [task.id for task in load_split("lite1")]
    paired = [task for task in core if task.id in ids and task.pair is not None]
    assert len(paired) >= 10
    assert all(task.pair in ids for task in paired)


def test_a_dataset_without_the_current_lite_list_has_its_first_version(dataset: Path) -> None:
    (dataset / "lite2.txt").unlink()
    assert load_split("lite", dataset) == load_split("lite1", dataset)


TRAITS = st.tuples(st.sampled_from("abc"), st.sampled_from("xy"), st.sampled_from(["", "no", "1", "2"]), st.booleans())


@given(st.lists(TRAITS, max_size=40), st.integers(0, 45))
def test_a_balanced_sample_has_its_size_and_whole_pairs(rows: list[tuple[str, str, str, bool]], number: int) -> None:
    tasks = list[SampledTask]()
    for index, (category, scene, answer, paired) in enumerate(rows):
        name, twin = f"{index:03}", f"{index:03}t"
        tasks.append(SampledTask(name, (category, scene), "no" if paired else answer, twin if paired else None))
        tasks += [SampledTask(twin, (category, scene), answer, name)] if paired else []
    selected = balanced_sample(tasks, number)
    assert len(selected) == min(number, len(tasks))
    assert selected == balanced_sample(tasks[::-1], number)
    divided_pairs = [task.id for task in tasks if task.id in selected and task.twin is not None and task.twin not in selected]
    assert len(divided_pairs) <= 1
