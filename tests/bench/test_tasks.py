"""Task data: validation, writing and reading, and the published schema."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
import yaml
from pydantic import ValidationError
from typer.testing import CliRunner

import scope_ptz
from scope_ptz.bench.tasks.expected import ActionOnly, Choice, Number, Ordering
from scope_ptz.bench.tasks.files import dump_tasks, load_tasks
from scope_ptz.bench.tasks.task import CANARY, TASK, Argument, schema
from scope_ptz.cli.app import app
from scope_ptz.errors import InputError
from tests.bench.sample_runs import samples

PUBLISHED = Path(scope_ptz.__file__).parent / "data" / "tasks.schema.json"
TASKS = tuple(task for task, _ in samples())


def content(**changes: Any) -> dict[str, Any]:
    return {**TASKS[0].model_dump(mode="json"), **changes}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"id": "counting-1"}, "pattern"),
        ({"id": "scope2-test-counting-001"}, "dataset version"),
        ({"stratum": "paraphrase"}, "paraphrase_of must be set"),
        ({"paraphrase_of": "scope1-test-counting-002"}, "paraphrase_of must be set"),
        ({"expected": {"kind": "action_only"}, "behaviour": {}}, "nothing is checked"),
        ({"evidence": []}, "must have an evidence view"),
        ({"answer": "five"}, "Extra inputs"),
        ({"expected": {"kind": "number", "value": float("nan")}}, "finite"),
        ({"canary": "another"}, "Input should be"),
        ({"category": "juggling"}, "Input should be"),
    ],
)
def test_an_invalid_task_is_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        TASK.validate_python(content(**changes))


def test_a_reaction_needs_neither_an_answer_nor_evidence() -> None:
    reaction = content(
        stratum="reaction", expected=ActionOnly().model_dump(), evidence=[], behaviour={"outcomes": ["refused", "clarification"]}
    )
    assert TASK.validate_python(reaction).behaviour.outcomes == ("refused", "clarification")


def test_expected_values_must_be_among_their_options() -> None:
    with pytest.raises(ValidationError, match="must be one of the options"):
        Choice(value="mauve", options={"red": ()})
    with pytest.raises(ValidationError, match="exactly once"):
        Ordering(value=("a", "b"), options={"a": (), "b": (), "c": ()})
    with pytest.raises(ValidationError, match="exactly one of equals"):
        Argument(equals=1.0, mentions=("one",))
    with pytest.raises(ValidationError):
        Number(value=1, tolerance=-1)


@pytest.mark.parametrize("suffix", [".jsonl", ".yaml"])
def test_tasks_survive_writing_and_reading(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"tasks{suffix}"
    if suffix == ".jsonl":
        dump_tasks(TASKS, path)
        rows = path.read_text("utf-8").splitlines()
        assert all(CANARY in row for row in rows)
        assert all('"kind"' in row for row in rows)
    else:
        path.write_text(yaml.safe_dump([task.model_dump(mode="json") for task in TASKS]), "utf-8")
    assert load_tasks(path) == TASKS


def test_a_damaged_file_is_reported_with_file_and_task(tmp_path: Path) -> None:
    path = tmp_path / "tasks.jsonl"
    with pytest.raises(InputError, match="cannot be read"):
        load_tasks(path)
    path.write_text("{", "utf-8")
    with pytest.raises(InputError, match="neither valid JSONL"):
        load_tasks(path)
    path.write_text(json.dumps(content(scene=3)), "utf-8")
    with pytest.raises(InputError, match=r"scope1-test-counting-001: scene"):
        load_tasks(path)
    dump_tasks((TASKS[0], TASKS[0]), path)
    with pytest.raises(InputError, match="more than once"):
        load_tasks(path)


def test_the_published_schema_is_current() -> None:
    """Regenerate it with ``scope bench schema``."""
    assert json.loads(PUBLISHED.read_text("utf-8")) == schema()
    output = CliRunner().invoke(app, ["bench", "schema"])
    assert output.exit_code == 0
    assert json.loads(output.stdout) == schema()
