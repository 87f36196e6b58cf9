"""Run folders of 0.1.0, of every outcome: replayed as 0.1.0 replayed them."""

from __future__ import annotations

import pytest

from tests.frozen import cases

FAST = ("altered-result", "answered", "damaged", "newer-format", "real-camera", "unknown-scene")
SLOW = sorted(set(cases.RUN_NAMES) - set(FAST))


@pytest.mark.parametrize("name", [*FAST, *(pytest.param(name, marks=pytest.mark.full) for name in SLOW)])
def test_a_run_is_replayed_as_before(name: str) -> None:
    assert cases.replays([name])[name] == cases.stored("replays.json")[name]


def test_every_outcome_is_there() -> None:
    assert cases.outcomes() == [
        "answered", "budget", "camera_error", "cancelled", "clarification", "planner_error", "refused", "step_limit",
    ]  # fmt: skip


def test_pictures_of_a_run_are_named_in_its_trace() -> None:
    folder = cases.RUNS / "answered"
    trace = (folder / "trace.jsonl").read_text("utf-8")
    pictures = sorted((folder / "frames").iterdir())
    assert pictures and all(f"frames/{picture.name}" in trace for picture in pictures)
