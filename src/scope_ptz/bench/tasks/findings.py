"""Findings about rows in imported files: reasons why a row cannot be run, and doubts about its content."""

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
    "fields-disagree",
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
"""Kinds of findings that prevent a row from being run."""

FINDING_DESCRIPTIONS: dict[FindingKind, str] = {
    "empty-question": "the question is empty",
    "nothing-expected": "the row expects neither an answer nor a tool call, so a run cannot be judged",
    "unknown-category": "the category is not one of the eight categories",
    "missing-scene": "the scene does not exist",
    "missing-preset": "the scene has no preset of this name",
    "duplicate": "another row asks the same question about the same view",
    "contradiction": "another row asks the same question about the same view and expects a different answer",
    "same-at-every-preset": "the question has the same answer at several presets, so the start position does not matter",
    "now-but-full": "the question is about what is visible now, but the row expects a sweep of the full scene",
    "answer-in-question": "the question contains its answer",
    "empty-assertion": "the expected answer states nothing about the scene",
    "then-unordered": "the question says 'then', but the row does not require an order of calls",
    "fields-disagree": "two fields of the row contradict each other",
    "no-viewpoint-change": "the row expects neither a camera move nor a sweep",
    "unknown-tool": "an expected tool does not exist",
    "wrong-arguments": "an expected call has arguments that its tool does not accept",
    "unchecked-argument": "an expected argument cannot be compared, so it is not checked",
    "unreadable-cell": "the content of a cell has the wrong format",
    "unknown-value": "a value is unknown, so the default value or the value of another column is used",
    "ragged-row": "the row has more or fewer cells than the header",
    "id-repeated": "another row has the same id",
}
"""Descriptions of the kinds of findings, for reports."""


class RowFinding(BaseModel):
    """A finding about a row. ``detail`` names the cells, values or lines concerned."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    kind: FindingKind
    detail: str = ""

    @property
    def blocks(self) -> bool:
        """Whether the row cannot be run."""
        return self.kind in BLOCKING
