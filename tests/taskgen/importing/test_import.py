"""Rows in the paper's format are mapped to tools, scenes and categories, and doubtful ones are reported."""

from __future__ import annotations

import csv
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from typer.testing import CliRunner

from scope_ptz.bench.scoring.imported_check import check_imported_calls
from scope_ptz.bench.tasks.imported import ImportedTask, dump_imported, is_imported_file, load_imported
from scope_ptz.bench.tasks.task import Argument
from scope_ptz.cli.app import app
from scope_ptz.errors import InputError
from scope_ptz.taskgen.importing.import_report import ImportedFile, import_file, report_lines
from scope_ptz.taskgen.importing.paper_names import category_of, scope_of
from scope_ptz.taskgen.importing.row_checks import answer_in_question
from scope_ptz.taskgen.importing.scene_names import SceneNameMap, SceneNames, ScenePresets, read_scene_names
from tests.bench.sample_runs import count_step, play

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


def test_a_typical_row(tmp_path: Path) -> None:
    result = import_rows(tmp_path, {"answer_view": "full_scene", "difficulty": "Hard", "evaluation_notes": "Any wording."})
    (task,) = result.tasks
    facts = task.facts
    assert (facts.id, facts.dataset, facts.stratum) == ("imported-paper-tasks-1", "imported-paper-tasks", "imported")
    assert (facts.scene, facts.preset, facts.viewpoint) == ("parking-lot", "gate", "mast")
    assert (facts.category, facts.scope, facts.difficulty) == ("counting", "full", "hard")
    assert facts.expected == "There are 5 cones."
    assert facts.demands == ("All of these calls are expected: count_objects().", "Notes of the author of the task: Any wording.")
    assert task.start_s == 12.0
    assert task.raw["eval_category"] == "counting"
    assert task.line == 2
    assert task.findings == ()


MAPPED: list[tuple[str, Any, str, dict[str, Argument]]] = [
    ("ptz_adjust", {"pan_deg": 20, "tilt_deg": "-5"}, "adjust_ptz",
     {"pan_deg": Argument(equals=20.0, within=0.5), "tilt_deg": Argument(equals=-5.0, within=0.5)}),
    ("ptz_adjust", {"zoom_factor": 2}, "adjust_ptz", {"zoom_factor": Argument(equals=2.0, within=0.06)}),
    ("ptz_adjust", {"zoom_percent": -50}, "adjust_ptz", {"zoom_factor": Argument(equals=0.5, within=0.015)}),
    ("ptz_adjust", {"zoom_full": "in"}, "adjust_ptz", {"zoom_limit": Argument(equals="in")}),
    ("ptz_adjust", {"zoom_full": "-1"}, "adjust_ptz", {"zoom_limit": Argument(equals="out")}),
    ("go_to_preset", {"name": "Preset Highway"}, "go_to_preset", {"name": Argument(equals="highway")}),
    ("home_action", {}, "go_home", {}),
    ("get_presets", {}, "get_presets", {}),
    ("take_image", {}, "take_image", {}),
    ("count_pointing", {"object_of_interest": "the red cars", "view_type": "Full Scene"}, "count_objects",
     {"description": Argument(mentions=("red cars", "cars")), "view": Argument(equals="full")}),
    ("query_answer", {"instruction": "what is there?", "view_type": "current"}, "query_answer",
     {"view": Argument(equals="current")}),
    ("zoom_bounding", {"object_of_interest": "stop sign"}, "zoom_to_object",
     {"description": Argument(mentions=("stop sign", "sign"))}),
    ("track_object", {"object_of_interest": "van", "duration": 0.5, "unit": "minutes"}, "track_object",
     {"description": Argument(mentions=("van",)), "duration_s": Argument(equals=30.0, within=0.5)}),
]  # fmt: skip


@pytest.mark.parametrize(("theirs", "arguments", "ours", "required"), MAPPED)
@pytest.mark.parametrize("form", ["list", "by tool", "inside", "python"])
def test_tools_and_arguments(
    tmp_path: Path, form: str, theirs: str, arguments: dict[str, Any], ours: str, required: dict[str, Argument]
) -> None:
    cells = {
        "list": (json.dumps([theirs]), json.dumps([arguments])),
        "by tool": (json.dumps([theirs]), json.dumps({theirs: arguments})),
        "inside": (json.dumps([{"tool": theirs, "args": arguments}]), ""),
        "python": (repr([theirs]), repr([{"tool": theirs, "args": arguments}])),
    }
    order, args = cells[form]
    result = import_rows(tmp_path, {"expected_tool_order_json": order, "expected_tool_args_json": args})
    ((call,),) = (task.calls for task in result.tasks)
    assert (call.tool, call.arguments) == (ours, required)
    assert not kinds(result) & {"wrong-arguments", "unknown-tool", "unreadable-cell"}


@pytest.mark.parametrize(
    ("tool", "arguments"),
    [
        ("ptz_adjust", {"pan_deg": "far"}),
        ("ptz_adjust", {"speed": 3}),
        ("ptz_adjust", {"zoom_percent": -100}),
        ("ptz_adjust", {"zoom_factor": 2, "zoom_full": "in"}),
        ("ptz_adjust", {"zoom_factor": 2, "zoom_percent": 50}),
        ("go_to_preset", {"name": "moon"}),
        ("count_pointing", {"object_of_interest": "cars", "view_type": "sideways"}),
        ("track_object", {"object_of_interest": "van", "duration": 3, "unit": "fortnights"}),
        ("track_object", {"object_of_interest": "van", "duration": -3}),
        ("take_image", {"name": "x"}),
    ],
)
def test_wrong_arguments_are_reported_and_the_row_still_runs(tmp_path: Path, tool: str, arguments: dict[str, Any]) -> None:
    result = import_rows(
        tmp_path, {"expected_tool_order_json": json.dumps([tool]), "expected_tool_args_json": json.dumps([arguments])}
    )
    assert "wrong-arguments" in kinds(result)
    assert len(result.tasks) == 1


def test_one_tool_is_expected_several_times(tmp_path: Path) -> None:
    result = import_rows(
        tmp_path,
        {
            "expected_tool_order_json": '["ptz_adjust", "ptz_adjust"]',
            "expected_tool_args_json": '{"ptz_adjust": [{"pan_deg": 5}, {"pan_deg": 6}]}',
        },
    )
    assert [call.arguments["pan_deg"].equals for call in result.tasks[0].calls] == [5, 6]


@pytest.mark.parametrize("zoom", [{"zoom_percent": 0}, {"zoom_factor": 1}, {}])
def test_an_expected_zoom_of_zero_is_met_by_a_call_without_zoom(tmp_path: Path, zoom: dict[str, Any]) -> None:
    arguments = json.dumps([{"pan_deg": 20, "tilt_deg": 0, **zoom}])
    result = import_rows(tmp_path, {"expected_tool_order_json": '["ptz_adjust"]', "expected_tool_args_json": arguments})
    (task,) = result.tasks
    for extra, passed in (
        ({}, True),
        ({"zoom_percent": 0.0}, True),
        ({"zoom_factor": 2.0}, not zoom),
        ({"zoom_limit": "in"}, not zoom),
    ):
        check = check_imported_calls(task, play([("adjust_ptz", {"pan_deg": 20.0, **extra})], "Done."))
        assert check.passed is passed, (extra, check.reason)


@pytest.mark.parametrize(
    ("order", "arguments", "kind", "detail"),
    [
        (["ptz_adjust", 5], None, "unknown-tool", "5 names no tool"),
        (["ptz_adjust", None], None, "unknown-tool", "null names no tool"),
        (["ptz_adjust", True], None, "unknown-tool", "true names no tool"),
        (["ptz_adjust", {"tool": 7}], None, "unknown-tool", '{"tool": 7} names no tool'),
        (["count_pointing"], {"object_of_interest": ["a", "b"]}, "wrong-arguments", '["a", "b"], which is not text'),
        (["count_pointing"], [{"object_of_interest": 5}], "wrong-arguments", "object_of_interest is 5, which is not text"),
        (["count_pointing"], {"object_of_interest": "a", "name": "b"}, "unchecked-argument", 'name is "b", but object_of_interest'),
        (["count_pointing"], {"ptz_adjust": {"pan_deg": 5}}, "unchecked-argument", "ptz_adjust: "),
        (["count_pointing"], [{}, {"pan_deg": 5}], "unchecked-argument", '{"pan_deg": 5} (number 2)'),
        (["count_pointing"], ["cars"], "unchecked-argument", '"cars" (number 1)'),
        (["count_pointing"], {"count_pointing": [{}, {"view": "full"}]}, "unchecked-argument", 'count_pointing: {"view": "full"}'),
        (["count_pointing", "take_image"], {"count_pointing": {}, "take_image": 3}, "unchecked-argument", "3 is not a set"),
        (None, {"pan_deg": 5}, "unchecked-argument", '{"pan_deg": 5}: the row expects no call'),
        (["count_pointing"], 7, "unchecked-argument", '"7" (number 1)'),
    ],
)
def test_unused_parts_are_reported(tmp_path: Path, order: Any, arguments: Any, kind: str, detail: str) -> None:
    cells = {"expected_tool_order_json": json.dumps(order), "expected_tool_args_json": json.dumps(arguments)}
    result = import_rows(tmp_path, cells)
    found = [finding for finding in result.findings[result.rows[0].line] if detail in finding.detail]
    assert [finding.kind for finding in found] == [kind], result.findings
    assert len(result.tasks) == 1


def test_used_parts_are_not_reported(tmp_path: Path) -> None:
    """Arguments may be given by position, by tool, by number, and without a name for a single call."""
    both = '["count_pointing", "ptz_adjust"]'
    for order, arguments in (
        (both, [{"object_of_interest": "cars"}, {"pan_deg": 5}]),
        (both, [{"object_of_interest": "cars"}, None]),
        (both, {"count_pointing": {"object_of_interest": "cars"}, "ptz_adjust": [{"pan_deg": 5}]}),
        (both, {"0": {"object_of_interest": "cars"}, "1": {"pan_deg": 5}}),
        ('["count_pointing"]', {"object_of_interest": "cars", "view_type": "full"}),
        ('["query_answer"]', {"instruction": "what?", "object_of_interest": "van"}),
    ):
        result = import_rows(tmp_path, {"expected_tool_order_json": order, "expected_tool_args_json": json.dumps(arguments)})
        assert not kinds(result) & {"wrong-arguments", "unknown-tool", "unchecked-argument"}, (arguments, result.findings)


def test_a_file_without_rows_is_reported(tmp_path: Path) -> None:
    path = tmp_path / "empty.csv"
    path.write_text("question,expected_answer\n", "utf-8")
    result = CliRunner().invoke(app, ["bench", "import", str(path), "--out", str(tmp_path / "x.jsonl")])
    assert result.exit_code == 1
    assert "contains a header but no rows" in result.stderr and "--map" not in result.stderr


@pytest.mark.parametrize(
    ("spelling", "category"),
    [
        ("Counting", "counting"), ("Descriptor", "descriptor"), ("Location / Spatial", "location"), ("OCR Identification", "ocr"),
        ("Single-Call", "single_call"), ("multistep command", "multi_step_command"),
        ("Multi-step Reasoning", "multi_step_reasoning"),
        ("Comparative Relational", "comparative"), ("comparative_relational", "comparative"), ("poetry", None), ("", None),
    ],
)  # fmt: skip
def test_categories_by_their_spellings(spelling: str, category: str | None) -> None:
    assert category_of(spelling) == category


def test_views_by_their_spellings() -> None:
    assert [scope_of(name) for name in ("current_view", "FULL", "360", "full-scene", "", "upstairs")] == [
        "current", "full", "full", "full", None, None,
    ]  # fmt: skip


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


def test_ids_are_unique_whatever_the_file_contains(tmp_path: Path) -> None:
    result = import_rows(
        tmp_path, *({"question_id": name, "question": f"{n}?"} for n, name in enumerate(["a b", "A-B", "a-b-x2", "", "../x"]))
    )
    ids = [task.facts.id for task in result.tasks]
    assert len(set(ids)) == 5
    assert all("/" not in name and "." not in name for name in ids)


def test_scenes_and_presets_by_mapping(tmp_path: Path) -> None:
    path = tmp_path / "map.yaml"
    path.write_text("scenes: {'moon.blend': parking-lot, '*': parking-lot}\npresets: {parking-lot: {crater: bridge, '*': gate}}\n")
    names = SceneNames(NAMES.scenes, read_scene_names(path))
    rows = [{"file_location": "x/moon.blend", "preset_start": "crater"}, {"file_location": "mars.blend", "preset_start": "rim"}]
    result = import_rows(tmp_path, *rows, names=names)
    assert [task.facts.preset for task in result.tasks] == ["bridge", "gate"]
    without_mapping = import_rows(tmp_path, *rows, {"preset_start": "rim"})
    assert without_mapping.mapping_template() == {
        "scenes": {"mars.blend": "", "x/moon.blend": ""},
        "presets": {"parking-lot": {"rim": ""}},
    }
    assert SceneNameMap.model_validate(without_mapping.mapping_template())
    wrong = SceneNames(NAMES.scenes, SceneNameMap(scenes={"moon.blend": "nowhere"}))
    assert "missing-scene" in kinds(import_rows(tmp_path, rows[0], names=wrong))


@pytest.mark.parametrize("content", ["[1]", "scenes: 3", "worlds: {}", "a: [", "\0"])
def test_wrong_mappings_are_rejected(tmp_path: Path, content: str) -> None:
    path = tmp_path / "map.yaml"
    path.write_text(content)
    with pytest.raises(InputError):
        read_scene_names(path)


def test_imported_tasks_are_stored_without_loss(tmp_path: Path) -> None:
    result = import_rows(
        tmp_path,
        {"expected_tool_args_json": "[{'object_of_interest': 'cones'}]"},
        {"question": "Another?", "multi_step_mode": "ordered"},
    )
    path = tmp_path / "tasks.jsonl"
    dump_imported(result.tasks, path)
    assert is_imported_file(path)
    assert load_imported(path) == result.tasks
    assert not is_imported_file(tmp_path / "none")
    assert not is_imported_file(tmp_path / "Paper Tasks.csv")
    path.write_text(path.read_text() + '{"imported": 1}\n')
    with pytest.raises(InputError, match="line 3"):
        load_imported(path)


ODD_CELLS = st.sampled_from(
    [
        '[{"tool": 5}]', '{"ptz_adjust": 7}', '[[["a"]]]', "[null, 1, 2.5, true]", '{"ptz_adjust": {"pan_deg": {"x": 1}}}',
        '[{"pan_deg": 1e400}]', "[" * 3000, '{"go_to_preset": {"name": ["a"]}}', "{1: 2}", 'b"x"', '{"count_pointing": []}',
        '[{"name": "ptz_adjust", "arguments": {"zoom_percent": "NaN"}}]', '[{"duration": "inf", "unit": 5}]', "\u2028", "\x1b[2J",
        '[{"object_of_interest": "°"}]', '[{"object_of_interest": "the ² of"}]', '{"0": {"object_of_interest": "!!"}}',
        '["count_pointing"]', '["ptz_adjust", "go_to_preset"]', '["track_object"]', "unordered", "exact", "full", "counting",
    ]
) | st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0\r"), max_size=12)  # fmt: skip


@given(st.lists(st.fixed_dictionaries({}, optional=dict.fromkeys(COLUMNS, ODD_CELLS)), min_size=1, max_size=4))
@settings(deadline=None, max_examples=60)
def test_arbitrary_rows_are_kept_and_do_not_break_the_import(
    tmp_path_factory: pytest.TempPathFactory, rows: list[dict[str, str]]
) -> None:
    folder = tmp_path_factory.mktemp("odd")
    result = import_rows(folder, *rows)
    assert len(result.rows) == len(rows)
    assert len(result.tasks) + len(result.not_runnable) == len(rows)
    assert all(character.isprintable() for line in report_lines(result) for character in line)
    dump_imported(result.tasks, folder / "tasks.jsonl")
    assert load_imported(folder / "tasks.jsonl") == result.tasks
    json.dumps(result.as_dict(), allow_nan=False)


# The check of calls


def task_with(tmp_path: Path, tools: Sequence[str], arguments: object = "", **cells: str) -> ImportedTask:
    defaults = {
        "expected_tool_order_json": json.dumps(tools),
        "expected_tool_args_json": json.dumps(arguments) if arguments else "",
    }
    return import_rows(tmp_path, {**defaults, **cells}).tasks[0]


PRESET_CALL, COUNT_CALL = ("go_to_preset", {"name": "highway"}), count_step(5)


@pytest.mark.parametrize(
    ("cells", "steps", "passed"),
    [
        ({}, [PRESET_CALL, COUNT_CALL], True),
        ({}, [COUNT_CALL, PRESET_CALL], True),
        ({"multi_step_mode": "ordered"}, [PRESET_CALL, COUNT_CALL], True),
        ({"multi_step_mode": "ordered"}, [COUNT_CALL, PRESET_CALL], False),
        ({}, [PRESET_CALL], False),
        ({}, [], False),
        ({}, [PRESET_CALL, COUNT_CALL, ("take_image", {})], True),
        ({"required_tools_policy": "exact"}, [PRESET_CALL, COUNT_CALL, ("take_image", {})], False),
        ({"required_tools_policy": "exact"}, [PRESET_CALL, COUNT_CALL], True),
        ({"required_tools_policy": "any_of"}, [COUNT_CALL], True),
        ({"required_tools_policy": "any_of"}, [("take_image", {})], False),
        ({"required_tools_policy": "optional"}, [], None),
        ({}, [("go_to_preset", {"name": "gate"}), COUNT_CALL], False),
        ({"args_check": "off"}, [("go_to_preset", {"name": "gate"}), COUNT_CALL], True),
        ({}, [("go_to_preset", {"name": "highway"}, {"error": "no"}), COUNT_CALL], False),
    ],
)
def test_check_of_required_calls(tmp_path: Path, cells: dict[str, str], steps: list[Any], passed: bool | None) -> None:
    task = task_with(tmp_path, ["go_to_preset", "count_pointing"], {"go_to_preset": {"name": "Highway"}}, **cells)
    check = check_imported_calls(task, play(steps, "5"))
    assert (check.name, check.passed) == ("calls", passed)
    assert check.reason


def test_without_expected_calls_the_check_has_no_result(tmp_path: Path) -> None:
    assert check_imported_calls(task_with(tmp_path, []), play([COUNT_CALL], "5")).passed is None


# The command


@pytest.mark.full
def test_the_command_writes_tasks_and_a_report(tmp_path: Path, analytic_folder: Path) -> None:
    import_rows(tmp_path, {"file_location": "analytic_yard.blend", "preset_start": ""}, {"file_location": "moon.blend"})
    out = tmp_path / "new" / "tasks.jsonl"
    command = ["bench", "import", str(tmp_path / "Paper Tasks.csv"), "--scenes", str(analytic_folder.parent), "--out", str(out)]
    result = CliRunner().invoke(app, command)
    assert result.exit_code == 0, result.output
    assert "2 rows in" in result.output
    assert "1 can be run, 1 cannot" in result.output
    (task,) = load_imported(out)
    assert task.facts.scene == "analytic-yard"
    report = json.loads((tmp_path / "new" / "tasks.report.json").read_text())
    assert [row["runs"] for row in report["each"]] == [True, False]
    assert json.loads(CliRunner().invoke(app, [*command, "--json"]).stdout) == report


def test_the_command_fails_when_no_row_can_be_run(tmp_path: Path) -> None:
    import_rows(tmp_path, {})
    result = CliRunner().invoke(app, ["bench", "import", str(tmp_path / "Paper Tasks.csv"), "--out", str(tmp_path / "x.jsonl")])
    assert result.exit_code == 1
    assert "no row can be run" in result.output
    assert (tmp_path / "x.report.json").is_file()
    for options in (["--scenes", str(tmp_path / "none")], ["--map", str(tmp_path / "none")]):
        wrong = CliRunner().invoke(app, ["bench", "import", str(tmp_path / "Paper Tasks.csv"), *options])
        assert wrong.exit_code == 2
