"""What models and people are given: prompts, schemas, results in words, plans and files of data, byte for byte those of 0.1.0."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest

from tests.frozen import adapter, cases

EVERY = 20
"""Of so many instructions one is planned in the fast tier."""


def tiers(names: Iterable[str], fast: str) -> list[Any]:
    """Parameters of which only one belongs to the fast tier."""
    return [name if name == fast else pytest.param(name, marks=pytest.mark.full) for name in names]


@pytest.mark.parametrize("name", tiers(cases.CONVERSATIONS, "every-tool"))
def test_a_chat_model_is_told_what_it_was_told_before(name: str, tmp_path: Path) -> None:
    expected, found = cases.stored(f"conversations/{name}.json"), cases.conversation(name, tmp_path)
    assert sorted(found) == sorted(expected)
    assert found["calls"] == expected["calls"]
    for key, value in expected.items():
        assert found[key] == value, key


@pytest.mark.parametrize("name", tiers(cases.LOOKS, "detect"))
def test_a_vision_model_is_asked_what_it_was_asked_before(name: str, tmp_path: Path) -> None:
    assert cases.looks(name, tmp_path) == cases.stored("looks.json")[name]


def test_schemas_of_tools() -> None:
    assert adapter.tool_schemas() == cases.stored("tools.json")


@pytest.mark.parametrize("group", cases.stored("digests.json"))
def test_bytes_of_files(group: str) -> None:
    expected, found = cases.stored("digests.json")[group], adapter.digests()[group]
    # A further file, such as the next version of a prompt, changes nothing that was released.
    assert {name: found.get(name) for name in expected} == expected


def test_plans_of_some_instructions(tmp_path: Path) -> None:
    rows = cases.plan_inputs()[::EVERY]
    assert cases.plans(rows, tmp_path / "instructions.jsonl") == [row["plan"] for row in rows]


def test_every_task_has_a_plan() -> None:
    published = [(task["id"], task["instruction"]) for task in adapter.published_tasks()]
    assert [(row["task"], row["plan"]["instruction"]) for row in cases.plan_inputs()] == published


@pytest.mark.full
def test_plans_of_all_instructions(tmp_path: Path) -> None:
    rows = cases.plan_inputs()
    assert cases.plans(rows, tmp_path / "instructions.jsonl") == [row["plan"] for row in rows]


@pytest.mark.full
def test_the_tasks_are_proved_as_before() -> None:
    code, report = adapter.validate_tasks()
    assert {"code": code, "report": report} == cases.stored("validate.json")


@pytest.mark.full
def test_the_gold_runs_are_named_as_before() -> None:
    code, report = adapter.check_gold()
    assert {"code": code, "report": report} == cases.stored("gold.json")
