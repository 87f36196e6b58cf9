"""The steps and the end of a run as the sidebar shows them, parsed from the records that the server streams."""

from __future__ import annotations

from typing import Any, NamedTuple

MAX_TEXT_CHARS = 300  # longer text is truncated in the sidebar

OUTCOME_LABELS = {
    "answered": "Answered",
    "clarification": "Needs clarification",
    "refused": "Refused",
    "step_limit": "Too many steps",
    "budget": "Out of time or tokens",
    "planner_error": "The planner failed",
    "camera_error": "The camera failed",
    "cancelled": "Cancelled",
}


class Step(NamedTuple):
    """A finished tool call: the call, its result or error, its duration in seconds, and the name of its picture, if any."""

    call: str
    text: str
    failed: bool
    duration_s: float
    picture: str


class Timing(NamedTuple):
    """One part of the duration of a run, in seconds."""

    part: str
    duration_s: float


class End(NamedTuple):
    """The end of a run: the outcome, the answer, and the duration of each part."""

    outcome: str
    text: str
    timings: tuple[Timing, ...]


def parse_step(record: dict[str, Any]) -> Step:
    """Parse a ``call`` record."""
    outcome = record["outcome"]
    call, result = outcome["call"], outcome.get("result") or {}
    arguments = ", ".join(f"{name}={_format_value(value)}" for name, value in call["arguments"].items() if value is not None)
    error = outcome.get("error")
    text = str(error) if error else str(result.get("message", "done"))
    pictures = result.get("frames") or ([record["frame"]] if record.get("frame") else [])
    return Step(
        f"{call['name']}({arguments})"[:MAX_TEXT_CHARS],
        text[:MAX_TEXT_CHARS],
        bool(error),
        float(record["timings"]["total_s"]),
        str(pictures[-1]) if pictures else "",
    )


def parse_end(record: dict[str, Any]) -> End:
    """Parse an ``end`` record."""
    timings = record["timings"]
    parts = [
        Timing(label, float(timings[name]))
        for name, label in (
            ("planner_s", "planner"),
            ("perception_s", "perception"),
            ("camera_s", "camera"),
            ("render_s", "pictures"),
        )
        if name in timings
    ]
    outcome = str(record["outcome"])
    return End(
        OUTCOME_LABELS.get(outcome, outcome), str(record["text"])[:4000], (*parts, Timing("total", float(timings["total_s"])))
    )


def _format_value(value: object) -> str:
    if isinstance(value, float):
        return f"{value:g}"
    return repr(value) if isinstance(value, str) else str(value)
