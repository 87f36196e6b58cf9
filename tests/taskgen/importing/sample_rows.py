"""Sample rows in the paper's format, and their import."""

from __future__ import annotations

import csv
from pathlib import Path

from scope_ptz.taskgen.importing.import_report import ImportedFile, import_file
from scope_ptz.taskgen.importing.scene_names import SceneNames, ScenePresets

COLUMNS = (
    "question_id", "file_location", "preset_start", "presets_available", "question", "expected_answer", "question_type",
    "eval_category", "multi_step_mode", "required_tools_policy", "expected_tool_order_json", "args_check",
    "expected_tool_args_json", "answer_view", "evaluation_notes", "difficulty",
)  # fmt: skip
NAMES = SceneNames({"parking-lot": ScenePresets({"gate": "mast", "highway": "mast", "bridge": "roof"}, "gate", 12.0)})
TYPICAL = {
    "file_location": "worlds/Parking_Lot.blend", "preset_start": "Gate", "question": "How many cones are there?",
    "expected_answer": "There are 5 cones.", "eval_category": "counting", "expected_tool_order_json": '["count_pointing"]',
}  # fmt: skip


def import_rows(tmp_path: Path, *rows: dict[str, str], names: SceneNames = NAMES) -> ImportedFile:
    path = tmp_path / "Paper Tasks.csv"
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS)
        writer.writeheader()
        writer.writerows({"question_id": str(n), **TYPICAL, **row} for n, row in enumerate(rows, 1))
    return import_file(path, names)


def kinds(result: ImportedFile, index: int = 0) -> set[str]:
    return {finding.kind for finding in result.findings[result.rows[index].line]}
