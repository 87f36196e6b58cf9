"""Files in the paper's format are imported: facts, scenes and categories are mapped, tasks are stored, and the command reports."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from typer.testing import CliRunner

from scope_ptz.bench.tasks.imported import dump_imported, is_imported_file, load_imported
from scope_ptz.cli.app import app
from scope_ptz.errors import InputError
from scope_ptz.taskgen.importing.import_report import report_lines
from scope_ptz.taskgen.importing.paper_names import category_of, scope_of
from scope_ptz.taskgen.importing.scene_names import SceneNameMap, SceneNames, read_scene_names
from tests.taskgen.importing.sample_rows import COLUMNS, NAMES, import_rows, kinds


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


def test_a_file_without_rows_is_reported(tmp_path: Path) -> None:
    path = tmp_path / "empty.csv"
    path.write_text("question,expected_answer\n", "utf-8")
    result = CliRunner().invoke(app, ["bench", "import", str(path), "--out", str(tmp_path / "x.jsonl")])
    assert result.exit_code == 1
    assert "contains a header but no rows" in result.stderr and "--map" not in result.stderr
