"""Commands with a statement beside them: some statements are harmless, others mean that the command must not be carried out.

The statements of the two kinds are alike in form, and each command occurs in both, so that only the meaning tells them apart.
Rows of the split ``held-out`` are never used to develop the grammar or to train its models, and are reported apart.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from scope_ptz.planner.grammar.parsing.remark_detection.segments import Segment
from scope_ptz.planner.plan import plan

FILES: dict[str, Path] = {path.stem: path for path in sorted((Path(__file__).parent / "statements").glob("*.jsonl"))}
PRESETS = ("main-gate", "yard", "silos", "car-park", "roof")
_MOVES = frozenset({"adjust_ptz", "go_home", "go_to_preset", "zoom_to_object", "track_object"})
_MIN_SHARE = 0.6  # a segment of which more than this share is part of the statement belongs to it


@dataclass(frozen=True, slots=True)
class Row:
    """An instruction with a statement.

    Attributes:
        source: The name of the file.
        split: "dev" or "held-out".
        instruction: The whole text.
        statement: The part that is no command.
        carried_out: Whether the command must be carried out as it stands.
    """

    source: str
    split: str
    instruction: str
    statement: str
    carried_out: bool

    def moves_the_camera(self) -> bool:
        """Return whether the plan of the instruction moves the camera."""
        return any(call.name in _MOVES for call in plan(self.instruction, PRESETS).calls)


def rows(split: str) -> Iterator[Row]:
    """Return the rows of a split of all files."""
    for source, path in FILES.items():
        for line in path.read_text(encoding="utf-8").splitlines():
            data = json.loads(line)
            if data["split"] == split:
                yield Row(source, split, data["instruction"], data["statement"], data["carried_out"])


def statement_indices(text: str, statement: str, segments: Sequence[Segment]) -> list[int]:
    """Return the indices of the segments that belong to a statement; empty if the text does not contain it."""
    statement = statement.strip(" .,!?").lower()
    start = text.lower().find(statement)
    if start < 0:
        return []
    end = start + len(statement)
    shares = [(min(each.end, end) - max(each.start, start)) / (each.end - each.start) for each in segments]
    return [index for index, share in enumerate(shares) if share > _MIN_SHARE]
