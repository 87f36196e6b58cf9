"""Texts for models and users (prompts, schemas, tool results, plans, data files) are identical to those of version 0.1.0."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest

from tests.frozen import adapter, cases

SAMPLING_STEP = 20
"""The fast tier plans every n-th instruction."""


def tiers(names: Iterable[str], fast: str) -> list[Any]:
    """Return ``names`` as parameters, of which only ``fast`` belongs to the fast tier."""
    return [name if name == fast else pytest.param(name, marks=pytest.mark.full) for name in names]


@pytest.mark.parametrize("name", tiers(cases.CONVERSATIONS, "written"))
def test_a_chat_model_gets_the_stored_messages(name: str, tmp_path: Path) -> None:
    expected, found = cases.stored_result(f"conversations/{name}.json"), cases.conversation(name, tmp_path)
    assert sorted(found) == sorted(expected)
    assert found["calls"] == expected["calls"]
    for key, value in expected.items():
        assert found[key] == value, key


@pytest.mark.parametrize("name", tiers(cases.VISION_INSTRUCTIONS, "detect"))
def test_a_vision_model_gets_the_stored_requests(name: str, tmp_path: Path) -> None:
    assert cases.vision_requests(name, tmp_path) == cases.stored_result("looks.json")[name]


def test_tool_schemas_are_unchanged() -> None:
    assert adapter.tool_schemas() == cases.stored_result("tools.json")


@pytest.mark.parametrize("group", cases.stored_result("digests.json"))
def test_files_are_unchanged(group: str) -> None:
    expected, found = cases.stored_result("digests.json")[group], adapter.digests()[group]
    # Additional files, such as a new version of a prompt, are allowed.
    assert {name: found.get(name) for name in expected} == expected


def test_some_instructions_have_the_stored_plans(tmp_path: Path) -> None:
    rows = cases.plan_inputs()[::SAMPLING_STEP]
    assert cases.plans(rows, tmp_path / "instructions.jsonl") == [row["plan"] for row in rows]


def test_every_published_task_has_a_stored_plan() -> None:
    published = [(task["id"], task["instruction"]) for task in adapter.published_tasks()]
    assert [(row["task"], row["plan"]["instruction"]) for row in cases.plan_inputs()] == published


@pytest.mark.full
def test_all_instructions_have_the_stored_plans(tmp_path: Path) -> None:
    rows = cases.plan_inputs()
    assert cases.plans(rows, tmp_path / "instructions.jsonl") == [row["plan"] for row in rows]


@pytest.mark.full
def test_validating_tasks_gives_the_stored_report() -> None:
    code, report = adapter.validate_tasks()
    assert code == 0 and report["sound"]
    assert {"code": code, "report": report} == cases.stored_result("validate.json")


@pytest.mark.full
def test_checking_gold_runs_gives_the_stored_report() -> None:
    code, report = adapter.check_gold()
    assert {"code": code, "report": report} == cases.stored_result("gold.json")
