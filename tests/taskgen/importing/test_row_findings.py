"""Rows that are doubtful, contradict themselves or repeat others are reported, and sound rows are not."""

from __future__ import annotations

from pathlib import Path

import pytest

from scope_ptz.taskgen.importing.import_report import report_lines
from scope_ptz.taskgen.importing.row_checks import answer_in_question
from scope_ptz.taskgen.importing.scene_names import SceneNameMap, SceneNames
from tests.taskgen.importing.sample_rows import NAMES, import_rows, kinds

FINDINGS: list[tuple[str, list[dict[str, str]]]] = [
    ("empty-question", [{"question": ""}]),
    ("nothing-expected", [{"expected_answer": "", "expected_tool_order_json": ""}]),
    ("unknown-category", [{"eval_category": "poetry"}]),
    ("missing-scene", [{"file_location": "moon.blend"}]),
    ("missing-preset", [{"preset_start": "crater"}]),
    ("duplicate", [{}, {"question": "how many cones are there", "expected_answer": "5"}]),
    ("contradiction", [{}, {"expected_answer": "six"}]),
    ("same-at-every-preset", [{}, {"preset_start": "bridge"}]),
    ("now-but-full", [{"question": "How many cones are visible right now?", "answer_view": "full"}]),
    ("answer-in-question", [{"question": "Are there 5 cones?", "expected_answer": "five"}]),
    ("empty-assertion", [{"expected_answer": "I have followed the steps."}]),
    ("then-unordered", [{"question": "Go to gate, then take a picture", "multi_step_mode": "unordered",
                         "expected_tool_order_json": '["go_to_preset", "take_image"]'}]),
    ("no-viewpoint-change", [{"answer_view": "current"}]),
    ("unknown-tool", [{"expected_tool_order_json": '["teleport"]'}]),
    ("unchecked-argument", [{"expected_tool_order_json": '["ptz_adjust"]', "expected_tool_args_json": '[{"zoom_full": true}]'}]),
    ("unreadable-cell", [{"expected_tool_args_json": "[broken"}]),
    ("unknown-value", [{"required_tools_policy": "sometimes"}]),
    ("id-repeated", [{"question_id": "7"}, {"question_id": "7", "question": "What else?"}]),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "rows"), FINDINGS)
def test_findings_are_reported_for_every_affected_row(tmp_path: Path, kind: str, rows: list[dict[str, str]]) -> None:
    result = import_rows(tmp_path, *rows)
    assert all(kind in kinds(result, index) for index in range(len(rows)))
    assert kind in "\n".join(report_lines(result))
    blocked = any(finding.blocks for finding in result.findings[result.rows[0].line])
    assert len(result.tasks) == (0 if blocked else len(rows))
    assert len(result.as_dict()["each"]) == len(rows), "no row is dropped"


COUNT_FULL = '[{"tool": "count_pointing", "args": {"object_of_interest": "cones", "view_type": "full_panorama"}}]'
GO_GATE = {"question": "Go to preset gate and count", "expected_tool_order_json": '["go_to_preset", "count_pointing"]'}
CONTRADICTIONS: list[tuple[dict[str, str], str]] = [
    ({"expected_tool_order_json": COUNT_FULL.replace("full_panorama", "full"),
      "expected_tool_args_json": '[{"view_type": "current"}]'}, "the expected tools say view 'full', the arguments say 'current'"),
    ({"expected_tool_order_json": '[{"tool": "track_object", "args": {"duration": 5}}]',
      "expected_tool_args_json": '[{"duration_s": "6"}]'}, "duration"),
    ({"expected_tool_order_json": '[{"tool": "ptz_adjust", "args": {"pan_deg": 20}}]',
      "expected_tool_args_json": '{"ptz_adjust": {"pan_deg": -20}}'}, "pan_deg"),
    ({"expected_tool_args_json": '[{"view_type": "full", "view": "current"}]'}, "the arguments give view as 'full' and 'current'"),
    ({"answer_view": "full", "expected_tool_args_json": '[{"view_type": "current"}]'}, "answer_view says full"),
    ({"answer_view": "current", "expected_tool_args_json": '[{"view_type": "full"}]'}, "answer_view says current"),
    ({"question": "Take a full panorama and count the cones", "expected_tool_args_json": '[{"view_type": "current"}]'},
     "the question asks for the full view"),
    ({"question": "How many cones are in the whole scene?", "answer_view": "current"}, "answer_view says current"),
    ({"question": "Count the cones in the current view", "expected_tool_args_json": '[{"view_type": "360"}]'},
     "the question asks for the current view"),
    ({"question_type": "ocr"}, "eval_category says counting; question_type says ocr"),
    ({"multi_step_mode": "single", "expected_tool_order_json": '["get_presets", "count_pointing"]'}, "2 calls are expected"),
    ({**GO_GATE, "expected_tool_args_json": '{"go_to_preset": {"name": "bridge"}}'}, "the question names the preset gate"),
]  # fmt: skip


@pytest.mark.parametrize(("row", "detail"), CONTRADICTIONS)
def test_fields_that_contradict_each_other_are_reported(tmp_path: Path, row: dict[str, str], detail: str) -> None:
    result = import_rows(tmp_path, row)
    found = [finding.detail for finding in result.findings[result.rows[0].line] if finding.kind == "fields-disagree"]
    assert any(detail in text for text in found), (found, result.findings)
    assert result.tasks, "a contradiction is reported, and the row can still be run"


@pytest.mark.parametrize(
    "row",
    [
        {"answer_view": "full_scene", "expected_tool_args_json": '[{"view_type": "panorama"}]'},
        {"expected_tool_order_json": COUNT_FULL.replace("full_panorama", "360"),
         "expected_tool_args_json": '[{"view_type": "Full Scene", "object_of_interest": "Cones"}]'},
        {"question": "Compare the current view with the full panorama", "expected_tool_args_json": '[{"view_type": "current"}]'},
        {**GO_GATE, "expected_tool_args_json": '{"go_to_preset": {"name": "Preset Gate"}}', "multi_step_mode": "ordered"},
        {"question_type": "single"},
        {"expected_tool_order_json": '[{"tool": "ptz_adjust", "args": {"pan_deg": "20"}}]',
         "expected_tool_args_json": '{"ptz_adjust": {"pan_deg": 20.0}}'},
    ],
)  # fmt: skip
def test_equivalent_fields_are_no_contradiction(tmp_path: Path, row: dict[str, str]) -> None:
    assert "fields-disagree" not in kinds(import_rows(tmp_path, row))


MERGED_NAMES = SceneNames(
    NAMES.scenes, SceneNameMap(presets={"parking-lot": {"Preset 1": "gate", "Preset 2": "gate", "Entrance": "gate", "*": "bridge"}})
)


@pytest.mark.parametrize(
    ("first", "second"), [("Preset 1", "Preset 2"), ("Gate", "Preset 1"), ("Preset 8", "Preset 9"), ("Entrance", "gate")]
)
def test_presets_mapped_to_the_same_preset_are_not_duplicates(tmp_path: Path, first: str, second: str) -> None:
    same = import_rows(tmp_path, {"preset_start": first}, {"preset_start": second}, names=MERGED_NAMES)
    assert same.tasks[0].facts.preset == same.tasks[1].facts.preset
    assert "duplicate" not in kinds(same, 0) | kinds(same, 1)
    assert any("2 presets in the file are mapped to the preset" in note for note in same.notes), same.notes
    other = import_rows(tmp_path, {"preset_start": first}, {"preset_start": second, "expected_answer": "six"}, names=MERGED_NAMES)
    assert "contradiction" not in kinds(other, 0) | kinds(other, 1)


@pytest.mark.parametrize(
    ("first", "second"), [("Preset 1", "preset-1"), ("Gate", "preset gate"), ("", "home"), ("gate", ""), ("Preset 8", "PRESET_8")]
)
def test_other_spellings_of_the_same_preset_are_duplicates(tmp_path: Path, first: str, second: str) -> None:
    spellings = MERGED_NAMES.mapping.presets["parking-lot"] | {"preset-1": "gate"}
    names = SceneNames(NAMES.scenes, SceneNameMap(presets={"parking-lot": spellings}))
    result = import_rows(tmp_path, {"preset_start": first}, {"preset_start": second}, names=names)
    assert "duplicate" in kinds(result, 0) & kinds(result, 1)
    assert not any("are mapped to the preset" in note for note in result.notes)


def test_scenes_mapped_to_the_same_scene_are_not_duplicates(tmp_path: Path) -> None:
    names = SceneNames(NAMES.scenes, SceneNameMap(scenes={"*": "parking-lot"}))
    result = import_rows(
        tmp_path, {"file_location": "a.blend"}, {"file_location": "b.blend"}, {"file_location": "x/a.blend"}, names=names
    )
    assert "duplicate" not in kinds(result, 1)
    assert "duplicate" in kinds(import_rows(tmp_path, {"file_location": "a.blend"}, {"file_location": "a.blend"}, names=names), 0)


def test_an_unknown_category_is_reported_when_another_column_replaces_it(tmp_path: Path) -> None:
    result = import_rows(tmp_path, {"eval_category": "Telepathy", "question_type": "location"}, {"question_type": "location"})
    (task, usual) = result.tasks
    assert (task.facts.category, usual.facts.category) == ("location", "counting")
    (finding,) = [f for f in result.findings[result.rows[0].line] if f.kind == "unknown-value"]
    assert finding.detail == "eval_category: Telepathy; read as location, based on question_type: location"
    assert "unknown-value" not in kinds(result, 1)


CLEAN = {"answer_view": "full"}


@pytest.mark.parametrize(
    "row",
    [
        CLEAN,
        {**CLEAN, "question": "Which has more cars, gate or highway?", "expected_answer": "gate"},
        {**CLEAN, "question": "Is there a van?", "expected_answer": "Yes, there is."},
        {**CLEAN, "question": "Sweep and then count the cones", "multi_step_mode": "ordered"},
        {"question": "How many cones do you see right now?", "answer_view": "current",
         "expected_tool_order_json": '["go_to_preset", "count_pointing"]'},
    ],
)  # fmt: skip
def test_sound_rows_have_no_findings(tmp_path: Path, row: dict[str, str]) -> None:
    result = import_rows(tmp_path, row)
    assert kinds(result) == set()


def test_answers_in_the_question_are_found() -> None:
    assert answer_in_question("Zoom in on the STOP sign and read it", 'The sign says "STOP"') == "STOP"
    assert answer_in_question("Zoom in on the sign and read it", 'The sign says "STOP"') is None
    assert answer_in_question("Where is the red car?", "to the left of the van") is None
