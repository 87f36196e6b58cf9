"""Findings about rows of imported files: why a row cannot be run, or what is doubtful about it."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict

FindingKind = Literal[
    "empty-question",
    "nothing-expected",
    "unknown-category",
    "missing-scene",
    "missing-preset",
    "duplicate",
    "contradiction",
    "same-at-every-preset",
    "now-but-full",
    "answer-in-question",
    "empty-assertion",
    "then-unordered",
    "no-viewpoint-change",
    "unknown-tool",
    "wrong-arguments",
    "unchecked-argument",
    "unreadable-cell",
    "unknown-value",
    "ragged-row",
    "id-repeated",
]
BLOCKING: frozenset[FindingKind] = frozenset(
    {"empty-question", "nothing-expected", "unknown-category", "missing-scene", "missing-preset"}
)
"""Findings with which a row cannot be run."""

MEANINGS: dict[FindingKind, str] = {
    "empty-question": "there is no question",
    "nothing-expected": "neither an answer nor a tool call is expected, so that nothing could be judged",
    "unknown-category": "the category is none of the eight",
    "missing-scene": "its scene is not there",
    "missing-preset": "its scene has no such preset",
    "duplicate": "the same question about the same view as another row",
    "contradiction": "the same question about the same view with another answer",
    "same-at-every-preset": "asked from several presets with one answer: where the camera starts makes no difference",
    "now-but-full": "asks what shows right now and wants the whole scene swept",
    "answer-in-question": "the question contains its answer",
    "empty-assertion": "the expected answer asserts nothing about the scene",
    "then-unordered": "says 'then' and leaves the order open",
    "no-viewpoint-change": "expects neither a camera move nor a sweep",
    "unknown-tool": "expects a tool that does not exist",
    "wrong-arguments": "expects arguments that its tool does not take",
    "unchecked-argument": "an expected argument that cannot be compared",
    "unreadable-cell": "a cell that cannot be read as what it should be",
    "unknown-value": "a value that is not known: the usual one was read, or that of another column",
    "ragged-row": "more or fewer cells than the header has",
    "id-repeated": "an id that another row has too",
}


class RowFinding(BaseModel):
    """A finding about one row. ``detail`` says what it concerns."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    kind: FindingKind
    detail: str = ""

    @property
    def blocks(self) -> bool:
        """Whether the row cannot be run."""
        return self.kind in BLOCKING
