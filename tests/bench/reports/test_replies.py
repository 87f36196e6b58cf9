"""Perception replies as text on the page of a failed task."""

from __future__ import annotations

from typing import Any

import pytest

from scope_ptz.bench.reports.task_pages import _message, _reply_text, evidence_lines
from scope_ptz.endpoints.failures import Attempt
from scope_ptz.perception.base import Answer, Box, Detections, Point, Points
from tests.bench.sample_runs import samples

ATTEMPT = Attempt(seconds=0.04647572699468583)
BOX = Box(x_min=0.1, y_min=0.4, x_max=0.25, y_max=0.6)


def as_json(reply: Any) -> dict[str, Any]:
    found: dict[str, Any] = reply.model_dump(mode="json")
    return found


@pytest.mark.parametrize(
    ("reply", "expected"),
    [
        (Detections(source="e", raw="{}", latency_s=0.04663581700879149, attempts=(ATTEMPT,), boxes=()), "no box"),
        (Detections(source="e", attempts=(ATTEMPT,), boxes=(BOX,)), "1 box: at 10–25% from the left, 40–60% from the top"),
        (
            Detections(source="e", boxes=(BOX.model_copy(update={"label": "cone", "score": 0.9123456789}), BOX), complete=False),
            "2 boxes (the list is incomplete): cone score 0.91 at 10–25% from the left, 40–60% from the top; "
            "at 10–25% from the left, 40–60% from the top",
        ),
        (
            Points(source="e", points=(Point(x=0.123456789, y=0.5),), notes=("one point was outside",)),
            "1 point: at 12% from the left, 50% from the top (one point was outside)",
        ),
        (Answer(source="e", text="It is red.", attempts=(ATTEMPT,), latency_s=0.123456789012345), "It is red."),
    ],
)
def test_replies_as_text(reply: Any, expected: str) -> None:
    assert _reply_text(as_json(reply)) == expected


def test_replies_without_a_sentence_are_listed_by_name_with_rounded_values() -> None:
    result = {
        "pose": {"pan_deg": 12.3456789012345678, "tilt_deg": -1.0},
        "clamped": [],
        "file": None,
        "attempts": [1, 2],
        "ok": True,
    }
    assert _message(result) == "pose: pan deg: 12.35; tilt deg: -1; attempts: 1, 2; ok: yes"
    assert _message(None) == _reply_text(None) == "nothing"


@pytest.mark.parametrize(
    "result", [{"boxes": ["left"]}, {"boxes": [{"somewhere": 1}]}, {"points": [{"x": "1", "y": None}]}, {"boxes": 3}]
)
def test_a_reply_in_another_format_is_shown_unchanged(result: dict[str, Any]) -> None:
    assert _reply_text(result)


def test_a_task_without_evidence_differs_from_a_task_that_is_not_available() -> None:
    tasks = [task for task, _ in samples()]
    assert next(evidence_lines(task) for task in tasks if not task.evidence) == ("none: the answer does not depend on any view",)
    assert all("pan" in line for task in tasks if task.evidence for line in evidence_lines(task))
    assert evidence_lines(None) == ()
