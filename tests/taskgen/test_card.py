"""The dataset card agrees with the data, and the documentation page is the card of the published dataset."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from scope_ptz.bench.tasks.files import digest_of
from scope_ptz.bench.tasks.splits import published_folder, write_manifest, write_splits
from scope_ptz.bench.tasks.task import CANARY
from scope_ptz.errors import InputError
from scope_ptz.simulator.pack import load_scene
from scope_ptz.taskgen.dataset.card import AUDIT, GOLD, PROOF, Dataset, render_card
from scope_ptz.taskgen.facts.answer_phrasing import correct_answers
from scope_ptz.taskgen.gold.gold_runs import create_gold_runs, write_gold
from scope_ptz.taskgen.gold.mutations import FaultContext
from scope_ptz.taskgen.picture_audit import DRAW, QuestionDraw, draw_questions, score_answers
from scope_ptz.taskgen.validation.validation_report import ValidationReport
from tests.bench.sample_runs import FRAME, PRESETS, samples

SAMPLES = samples()
TASKS = [task for task, _ in SAMPLES]
PAGE = Path(__file__).parents[2] / "docs" / "dataset.md"


@pytest.fixture
def dataset(tmp_path: Path) -> Path:
    folder = tmp_path / "data"
    paths = write_splits(TASKS, TASKS[:2], folder, seed=1)
    report = ValidationReport(tasks=len(TASKS))
    report.tried["reference"] = report.passed["reference"] = len(TASKS)
    report.tried["stay"] = 7
    (folder / PROOF).write_text(json.dumps({"published": report.as_dict(), "unseen": ValidationReport().as_dict()}))
    write_gold(create_gold_runs(SAMPLES, {"test": FaultContext(PRESETS, FRAME)}, seed=1, per_mode=3), folder / GOLD)
    write_manifest(folder, [*paths, folder / PROOF, folder / GOLD], [load_scene("highway-works")], seed=1, unseen=[7])
    return folder


def test_card_contains_counts_validation_gold_runs_and_canary(dataset: Path) -> None:
    text = render_card(Dataset.read(dataset))
    assert f"| core | {len(TASKS)} |" in text
    assert f"| descriptor | {sum(t.category == 'descriptor' for t in TASKS)} |" in text
    assert f"| reference | correct | {len(TASKS)} of {len(TASKS)} |" in text and "| stay | adversarial | 0 of 7 |" in text
    assert "24 reference runs have one known fault" in text and "false-accept rate 0.0%" in text
    assert CANARY in text and "Apache-2.0" in text
    assert "No audit of this version has been made" in text


def test_card_lists_every_answer_that_does_not_agree(dataset: Path, tmp_path: Path) -> None:
    audit = tmp_path / "audit"
    audit.mkdir()
    questions = draw_questions(TASKS, 6, seed=2)
    (audit / DRAW).write_text(QuestionDraw(number=6, seed=2, tasks=digest_of(TASKS)).model_dump_json())
    rows = [{"q": q, "answer": correct_answers(task.expected)[0]} for q, task in questions]
    rows[0]["answer"], wrong = "I cannot tell.", questions[0][1]
    (audit / "answers.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows[:-1]))
    (audit / "findings.jsonl").write_text(json.dumps({"q": rows[0]["q"], "finding": "Too small to see."}))
    result = score_answers(audit, TASKS)
    assert result.agreement_counts() == (4, 5)  # the sixth question has no answer
    (dataset / AUDIT).write_text(json.dumps(result.as_dict()))
    text = render_card(Dataset.read(dataset))
    assert "4 of 5 answers agree with the expected value (80.0%). Sampled tasks without an answer: 1." in text
    line = next(line for line in text.splitlines() if wrong.id in line)
    assert "I cannot tell." in line and "disagrees" in line and line.endswith("Too small to see. |")
    assert "not answered" in text and "(corrected)" not in text

    (dataset / AUDIT).write_text(json.dumps(result.as_dict()).replace(result.rows[0].digest, "0" * 16))
    assert "Too small to see. (corrected)" in render_card(Dataset.read(dataset))


def test_answers_to_unknown_questions_are_rejected(tmp_path: Path) -> None:
    (tmp_path / DRAW).write_text(QuestionDraw(number=3, seed=2, tasks=digest_of(TASKS)).model_dump_json())
    (tmp_path / "answers.jsonl").write_text('{"q": "q999", "answer": "yes"}')
    with pytest.raises(InputError, match="q999, which is not one of its questions"):
        score_answers(tmp_path, TASKS)
    (tmp_path / "answers.jsonl").write_text('{"q": "../x", "answer": "yes"}')
    with pytest.raises(InputError, match="line 1: q"):
        score_answers(tmp_path, TASKS)
    with pytest.raises(InputError, match="sampled from other tasks"):
        score_answers(tmp_path, TASKS[1:])


def test_a_folder_without_a_dataset_has_no_card(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="scope bench build --all"):
        Dataset.read(tmp_path)


def test_documentation_page_is_the_card_of_the_published_dataset() -> None:
    published = (published_folder() / "manifest.json").is_file()
    assert PAGE.is_file() == published, "scope bench card --out docs/dataset.md"
    assert not published or PAGE.read_text("utf-8") == render_card(Dataset.read(published_folder()))
