"""``scope ask`` from end to end on a small scene: output, exit codes, run folders."""

from __future__ import annotations

import json
import shutil
import sys
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from scope_ptz.agent.loop import MAX_CALLS_PER_STEP, MAX_REPEATED_BAD_CALLS
from scope_ptz.cli.exit import run_until_interrupted
from scope_ptz.planner.base import Finish
from tests.agent.scripted import ScriptedPlanner, Step, answer, calls
from tests.cli.conftest import SCENE, Scope

COUNT = "how many balls are visible right now?"


def runs(root: Path) -> list[Path]:
    folder = root / "runs"
    return sorted(folder.iterdir()) if folder.is_dir() else []


def use_script(monkeypatch: pytest.MonkeyPatch, *script: Step) -> None:
    """Replace the grammar planner with a scripted one."""
    monkeypatch.setattr("scope_ptz.cli.ask.make_planner", lambda _: ScriptedPlanner(*script))


def test_json_is_one_object_with_the_documented_fields(scope: Scope, tmp_path: Path) -> None:
    result = scope("ask", COUNT, "--scene", SCENE, "--json")
    assert (result.code, result.err) == (0, "")
    output = result.json
    assert set(output) == {"answer", "outcome", "tool_calls", "pose", "timings", "run_dir"}
    assert output["outcome"] == "answered"
    assert "3" in output["answer"] or "three" in output["answer"].lower()
    (call,) = output["tool_calls"]
    assert set(call) == {"name", "arguments", "result", "error"}
    assert call["name"] == "count_objects"
    assert call["result"]["count"] == 3
    assert call["error"] is None
    assert set(output["pose"]) == {"pan_deg", "tilt_deg", "zoom"}
    assert set(output["timings"]) == {"planner_s", "perception_s", "camera_s", "render_s", "total_s", "first_token_s"}
    assert [Path(output["run_dir"])] == runs(tmp_path)


def test_text_output_has_steps_answer_source_note_and_folder(scope: Scope, tmp_path: Path) -> None:
    result = scope("ask", "go to board, then go home", "--scene", SCENE)
    assert result.code == 0
    (folder,) = runs(tmp_path)
    assert "go_to_preset" in result.out
    assert "name=board" in result.out
    assert "go_home" in result.out
    assert "not a model" in result.out
    assert str(folder) in result.out
    assert {p.name for p in folder.iterdir()} == {"trace.jsonl", "frames", "filmstrip.png"}
    with Image.open(folder / "filmstrip.png") as strip:
        assert strip.width == 1600
    header = json.loads((folder / "trace.jsonl").read_text().splitlines()[0])
    assert (header["scene"], header["viewpoint"], header["planner"]) == (SCENE, "mast", "grammar")
    assert "not a model" in header["labels"]["perception_note"]


def test_the_start_pose_follows_the_options(scope: Scope) -> None:
    def pose(*options: str) -> Any:
        result = scope("ask", "take a picture", "--scene", SCENE, "--json", *options)
        return result.json["pose"]

    assert pose() == {"pan_deg": 0.0, "tilt_deg": -8.0, "zoom": 1.0}
    assert pose("--preset", "board") == {"pan_deg": -16.0, "tilt_deg": -2.0, "zoom": 4.0}
    assert pose("--viewpoint", "roof") == {"pan_deg": 10.0, "tilt_deg": -20.0, "zoom": 1.5}


def test_the_same_seed_gives_the_same_run(scope: Scope) -> None:
    def results() -> Any:
        result = scope(
            "ask", "count the balls, pan right 15 and count the blocks", "--scene", SCENE, "--perception", "noisy", "--json"
        )
        calls_made = result.json["tool_calls"]
        return [(c["name"], c["arguments"], c["result"]) for c in calls_made]

    assert results() == results()


BAD_INPUT = {
    "empty instruction": ("ask", "", "--scene", SCENE),
    "blank instruction": ("ask", "  ", "--scene", SCENE),
    "unknown scene": ("ask", "go home", "--scene", "mars"),
    "a path instead of a scene": ("ask", "go home", "--scene", "../../etc"),
    "unknown viewpoint": ("ask", "go home", "--scene", SCENE, "--viewpoint", "moon"),
    "unknown preset": ("ask", "go home", "--scene", SCENE, "--preset", "moon"),
    "viewpoint and preset": ("ask", "go home", "--scene", SCENE, "--preset", "yard", "--viewpoint", "mast"),
    "unknown planner": ("ask", "go home", "--scene", SCENE, "--planner", "oracle"),
    "unknown perception": ("ask", "go home", "--scene", SCENE, "--perception", "oracle"),
}


@pytest.mark.parametrize("case", BAD_INPUT)
@pytest.mark.parametrize("as_json", [False, True])
def test_bad_input_is_one_line_and_exit_code_2(scope: Scope, tmp_path: Path, case: str, as_json: bool) -> None:
    result = scope(*BAD_INPUT[case], *(["--json"] if as_json else []))
    assert result.code == 2
    assert result.err.startswith("scope: ")
    assert result.err.count("\n") == 1
    if as_json:
        assert set(result.json) == {"error"}
    else:
        assert result.out == ""
    assert runs(tmp_path) == []


@pytest.mark.parametrize(
    "arguments", [("ask",), ("ask", "x", "--max-steps", "0"), ("ask", "x", "--time-budget", "soon"), ("dance",)]
)
def test_wrong_usage_is_exit_code_2(scope: Scope, arguments: tuple[str, ...]) -> None:
    assert scope(*arguments).code == 2


def test_a_runs_folder_that_cannot_be_written(scope: Scope, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    result = scope("ask", "go home", "--scene", SCENE, "--runs-dir", str(tmp_path / "file"))
    assert (result.code, result.err.count("\n")) == (2, 1)
    assert "--runs-dir" in result.err


@pytest.mark.parametrize("pattern", ["scene.json", "manifest.json", "base.*"])
@pytest.mark.parametrize("damage", ["changed", "missing"])
def test_damaged_packs_are_reported(
    scope: Scope, scenes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, pattern: str, damage: str
) -> None:
    copy = tmp_path / "scenes"
    shutil.copytree(scenes, copy)
    monkeypatch.setenv("SCOPE_SCENES_DIR", str(copy))
    (file,) = (*(copy / SCENE).glob(pattern), *(copy / SCENE / "mast").glob(pattern))
    if damage == "changed":
        file.write_bytes(file.read_bytes()[:-7] + b"damaged")
    else:
        file.unlink()
    result = scope("ask", COUNT, "--scene", SCENE)
    assert (result.code, result.err.count("\n")) == (2, 1)
    assert result.err.startswith("scope: ")


@pytest.mark.parametrize(
    ("script", "options", "outcome", "code"),
    [
        ((calls(("adjust_ptz", {"pan_deg": 1.0})),), ("--max-steps", "2"), "step_limit", 1),
        ((RuntimeError("a bug"),), (), "planner_error", 1),
        ((answer("Fine."),), (), "answered", 0),
    ],
)
def test_exit_codes_depend_on_the_outcome(
    scope: Scope, monkeypatch: pytest.MonkeyPatch, script: tuple[Step, ...], options: tuple[str, ...], outcome: str, code: int
) -> None:
    use_script(monkeypatch, *script)
    result = scope("ask", "do it", "--scene", SCENE, "--json", *options)
    assert (result.code, result.json["outcome"]) == (code, outcome)


def test_a_clarification_has_its_own_exit_code_and_no_filmstrip(scope: Scope, tmp_path: Path) -> None:
    result = scope("ask", "florp the wibble sideways", "--scene", SCENE, "--json")
    assert (result.code, result.json["outcome"], result.json["tool_calls"]) == (3, "clarification", [])
    assert {p.name for p in runs(tmp_path)[0].iterdir()} == {"trace.jsonl", "frames"}


def test_a_refusal_has_its_own_exit_code(scope: Scope, monkeypatch: pytest.MonkeyPatch) -> None:
    use_script(monkeypatch, Finish(kind="refused", text="No."))
    result = scope("ask", "do it", "--scene", SCENE, "--json")
    assert (result.code, result.json["outcome"]) == (4, "refused")


def test_a_planner_that_repeats_a_wrong_call_is_stopped(scope: Scope, monkeypatch: pytest.MonkeyPatch) -> None:
    use_script(monkeypatch, calls(("adjust_ptz", {"pan_deg": "far"})))
    result = scope("ask", "do it", "--scene", SCENE, "--json")
    assert (result.code, result.json["outcome"]) == (1, "planner_error")
    assert len(result.json["tool_calls"]) == MAX_REPEATED_BAD_CALLS
    assert "same wrong call" in result.json["answer"]


def test_calls_beyond_the_limit_of_a_step_are_dropped_and_reported(scope: Scope, monkeypatch: pytest.MonkeyPatch) -> None:
    use_script(monkeypatch, calls(*[("take_image", {})] * 10_000), answer("Done."))
    result = scope("ask", "do it", "--scene", SCENE, "--json")
    tool_calls = result.json["tool_calls"]
    assert len(tool_calls) == MAX_CALLS_PER_STEP + 1
    assert "this one had 10000" in tool_calls[-1]["error"]
    assert [call["error"] for call in tool_calls[:-1]] == [None] * MAX_CALLS_PER_STEP
    assert Path(result.json["run_dir"], "trace.jsonl").stat().st_size < 100_000


def test_control_characters_do_not_reach_the_terminal(scope: Scope, monkeypatch: pytest.MonkeyPatch) -> None:
    use_script(monkeypatch, calls(("go_to_preset", {"name": "\x1b[2Jgate"})), answer("\x1b]0;owned\x07 [bold]done[/bold]"))
    result = scope("ask", "do it", "--scene", SCENE)
    assert "\x1b" not in result.out
    assert "\x07" not in result.out
    assert "[bold]done[/bold]" in result.out


@pytest.mark.parametrize(
    ("on_path", "program", "command"),
    [
        (True, "/usr/bin/scope", "scope"),
        (False, "my env/bin/scope", "'my env/bin/scope'"),
        (False, "/src/scope_ptz/cli/__main__.py", f"{sys.executable} -m scope_ptz.cli"),
    ],
)
def test_next_steps_can_be_typed(on_path: bool, program: str, command: str, scope: Scope, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("shutil.which", lambda _: "/usr/bin/scope" if on_path else None)
    monkeypatch.setattr("scope_ptz.cli.ask.run_until_interrupted", lambda work: _run_as_program(program, monkeypatch, work))
    result = scope("ask", "pan right 5", "--scene", SCENE, "--next-steps")
    assert result.code == 0
    assert f'\n  {command} ask "count the workers"' in result.out


def _run_as_program(program: str, monkeypatch: pytest.MonkeyPatch, work: Any) -> bool:
    monkeypatch.setattr("sys.argv", [program])
    return run_until_interrupted(work)


def test_an_unknown_object_is_an_error_and_an_absent_one_is_counted(scope: Scope) -> None:
    unknown = scope("ask", "count the gizmotrons", "--scene", SCENE, "--json")
    assert unknown.code == 1
    for call in unknown.json["tool_calls"]:
        assert "'gizmotrons'" in call["error"] and call["result"] is None
    absent = scope("ask", "count the giraffes", "--scene", SCENE, "--json")
    assert absent.code == 0
    assert absent.json["tool_calls"][0]["result"]["count"] == 0


def test_a_successful_perception_call_after_a_failed_one_is_an_answer(scope: Scope, monkeypatch: pytest.MonkeyPatch) -> None:
    first, second = calls(("count_objects", {"description": "gizmotrons"})), calls(("count_objects", {"description": "balls"}))
    use_script(monkeypatch, first, second, answer("There are three balls."))
    assert scope("ask", COUNT, "--scene", SCENE, "--json").code == 0


def test_the_answer_names_the_rule_that_held_a_move_back(scope: Scope, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    rules = "{keep_out: [{name: windows, pan_deg: [15, 45], tilt_deg: [-60, 30]}]}"
    (tmp_path / "scope.yaml").write_text(f"cameras: {{yard: {{camera: 'sim:{SCENE}?width=160&height=90', rules: {rules}}}}}")
    result = scope("ask", "pan right 30", "--camera", "yard", "--json").json
    (call,) = result["tool_calls"]
    assert call["result"]["held_back_by"] == "the keep-out region 'windows'"
    assert "held back by the keep-out region 'windows'" in result["answer"]
    assert "limit" not in result["answer"]
