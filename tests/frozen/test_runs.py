"""Replaying run folders of version 0.1.0, one or more for each outcome, gives the results of version 0.1.0."""

from __future__ import annotations

import pytest

from tests.frozen import cases

FAST = ("answered", "damaged", "newer-format", "real-camera", "unknown-scene")
SLOW = sorted(set(cases.RUN_NAMES) - set(FAST))


@pytest.mark.parametrize("name", [*FAST, *(pytest.param(name, marks=pytest.mark.full) for name in SLOW)])
def test_replaying_a_run_gives_the_stored_result(name: str) -> None:
    assert cases.replays([name])[name] == cases.stored_result("replays.json")[name]


def test_stored_runs_have_every_outcome() -> None:
    assert cases.outcomes() == [
        "answered", "budget", "camera_error", "cancelled", "clarification", "planner_error", "refused", "step_limit",
    ]  # fmt: skip


def test_images_of_a_run_are_named_in_its_trace() -> None:
    folder = cases.RUNS / "answered"
    trace = (folder / "trace.jsonl").read_text("utf-8")
    pictures = sorted((folder / "frames").iterdir())
    assert pictures and all(f"frames/{picture.name}" in trace for picture in pictures)
