"""One command builds the dataset of a synthetic scene: all files exist, are reproducible, and can be read."""

from __future__ import annotations

from pathlib import Path

import pytest

from scope_ptz.bench.tasks.splits import load_split, read_manifest
from scope_ptz.cli.bench.build import variation_numbers
from scope_ptz.errors import InputError
from tests.cli.conftest import Scope, scenes, scope

__all__ = ["scenes", "scope"]

FILES = {
    "gold.jsonl.gz", "lite.txt", "lite2.txt", "manifest.json", "paraphrase.jsonl", "proof.json", "reaction.jsonl", "tasks.jsonl",
    "unseen.jsonl",
}  # fmt: skip


@pytest.mark.full
def test_one_command_builds_all_files(scope: Scope, tmp_path: Path) -> None:
    folder, page = tmp_path / "data", tmp_path / "dataset.md"
    run_result = scope(
        "bench", "build", "--all", "--scene", "analytic-yard", "--share", "0.02", "--seeds", "2", "--out", str(folder),
        "--card", str(page),
    )  # fmt: skip
    assert (run_result.code == 1) == ("too few" in run_result.err or "NOT SOUND" in run_result.out), run_result.err
    assert {path.name for path in folder.iterdir()} == FILES
    assert read_manifest(folder)["made_with"]["unseen"] == [2]
    assert read_manifest(folder)["scenes"]["analytic-yard"]["version"] == "1"
    unseen = load_split("unseen", folder)
    assert {task.variation for task in unseen} == {2} and {task.scene for task in unseen} == {"analytic-yard"}
    assert all("-v2-" in task.id for task in unseen)
    assert not {task.preset for task in unseen} & {"yard", "board", "from-the-roof"}
    assert page.read_text() == scope("bench", "card", "--data", str(folder)).out

    check = scope("bench", "gold", "check", "--gold", str(folder / "gold.jsonl.gz"), "--tasks", str(folder / "tasks.jsonl"))
    assert check.code == 0 and "this result is not worse" in check.out, check.out
    browsed = scope("bench", "browse", unseen[0].id, "--tasks", str(folder / "unseen.jsonl"))
    assert "analytic-yard-v" in browsed.out and "verdict    correct" in browsed.out
    tasks_list = scope("bench", "browse", "--category", "single_call", "--tasks", str(folder / "tasks.jsonl"))
    assert len(tasks_list.out.splitlines()) == sum(task.category == "single_call" for task in load_split("core", folder))
    one = scope("bench", "browse", "--random", "--seed", "1", "--tasks", str(folder / "tasks.jsonl"))
    assert one.out == scope("bench", "browse", "--random", "--seed", "1", "--tasks", str(folder / "tasks.jsonl")).out


def test_variation_numbers_are_merged() -> None:
    assert variation_numbers([7], [8, 9, 8]) == (7, 8, 9)
    assert variation_numbers(None, None) == ()
    with pytest.raises(InputError, match="Unexpected argument"):
        variation_numbers(None, [8])


def test_incompatible_options_are_reported(scope: Scope, tmp_path: Path) -> None:
    out = str(tmp_path / "tasks.jsonl")
    assert "after --seeds" in scope("bench", "build", "--out", out, "7").err
    assert "--all" in scope("bench", "build", "--out", out, "--card", out).err
    assert "no complete dataset" in scope("bench", "card", "--data", str(tmp_path)).err
    assert scope("bench", "build", "--out", out, "--seeds", "0").code == 2


@pytest.mark.full
def test_an_audit_contains_pictures_and_no_ground_truth(scope: Scope, tmp_path: Path) -> None:
    tasks = tmp_path / "tasks.jsonl"
    build = scope("bench", "build", "--scene", "analytic-yard", "--share", "0.02", "--out", str(tasks))
    assert tasks.is_file(), build.err
    folder = tmp_path / "audit"
    run_result = scope("bench", "audit", "make", "--tasks", str(tasks), "--n", "3", "--seed", "5", "--out", str(folder))
    assert run_result.code == 0, run_result.err
    text = "".join(path.read_text() for path in folder.iterdir() if path.suffix != ".jpg")
    assert not [task.id for task in load_split(tasks) if task.id in text]
    assert "expected" not in text and len(list(folder.glob("q00*.jpg"))) >= 3
    assert "already exists" in scope("bench", "audit", "make", "--tasks", str(tasks), "--out", str(folder)).err
    (folder / "answers.jsonl").write_text('{"q": "q001", "answer": "I cannot tell."}\n')
    scored = scope("bench", "audit", "score", str(folder), "--tasks", str(tasks), "--out", str(tmp_path / "audit.json"))
    assert scored.code == 0 and "0 of 1 answers agree" in scored.out and "nobody answered" in scored.out
    assert (tmp_path / "audit.json").is_file()
