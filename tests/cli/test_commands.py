"""The commands plan, tools, replay, chat, scene and doctor."""

from __future__ import annotations

import json
import shutil
from io import StringIO
from pathlib import Path

import pytest
from PIL import Image

from tests.cli.conftest import SCENE, Scope


def test_plan_prints_the_steps(scope: Scope) -> None:
    result = scope("plan", "pan right 20, then tilt down 10", "--json")
    assert (result.code, result.json) == (
        0,
        {
            "instruction": "pan right 20, then tilt down 10",
            "understood": True,
            "calls": [
                {"name": "adjust_ptz", "arguments": {"pan_deg": 20}},
                {"name": "adjust_ptz", "arguments": {"tilt_deg": -10}},
            ],
            "clarification": None,
        },
    )
    assert "adjust_ptz(pan_deg=20" in scope("plan", "pan right 20").out


def test_plan_uses_the_given_presets(scope: Scope) -> None:
    result = scope("plan", "go to gate", "--presets", "gate, highway", "--json")
    assert result.json["calls"] == [{"name": "go_to_preset", "arguments": {"name": "gate"}}]


def test_plan_asks_for_clarification_if_it_does_not_understand(scope: Scope) -> None:
    result = scope("plan", "florp the wibble sideways", "--json")
    assert result.code == 0
    assert (result.json["understood"], result.json["calls"]) == (False, [])
    assert result.json["clarification"]


def test_plan_of_a_file_prints_one_line_per_instruction(scope: Scope, tmp_path: Path) -> None:
    file = tmp_path / "instructions.jsonl"
    lines = [{"instruction": "go to gate", "presets": ["gate"]}, {"instruction": "go home", "expected": "ignored"}]
    file.write_text("\n".join(map(json.dumps, lines)) + "\n\n")
    result = scope("plan", "--from", str(file), "--json")
    plans = [json.loads(line) for line in result.out.splitlines()]
    assert result.code == 0
    assert [p["instruction"] for p in plans] == ["go to gate", "go home"]
    assert [p["calls"][0]["name"] for p in plans] == ["go_to_preset", "go_home"]


@pytest.mark.parametrize(
    "bad", ["{", "[]", '{"presets": []}', '{"instruction": 3}', '{"instruction": ""}', '{"instruction": "x", "presets": "gate"}']
)
def test_a_bad_line_is_reported_by_its_number_and_the_others_are_planned(scope: Scope, tmp_path: Path, bad: str) -> None:
    file = tmp_path / "instructions.jsonl"
    file.write_text(f'{{"instruction": "go home"}}\n{bad}\n{{"instruction": "take a picture"}}\n')
    result = scope("plan", "--from", str(file), "--json")
    assert result.code == 2
    assert "line 2" in result.err
    assert len(result.err.splitlines()) == 1
    assert len(result.out.splitlines()) == 2


@pytest.mark.parametrize(
    "arguments", [(), ("x", "--from", "y"), ("--from", "/nowhere/file.jsonl"), ("",), ("--from", "y", "--presets", "a")]
)
def test_plan_needs_one_source(scope: Scope, arguments: tuple[str, ...]) -> None:
    result = scope("plan", *arguments)
    assert (result.code, len(result.err.splitlines())) == (2, 1)


def test_tools_prints_nine_schemas(scope: Scope) -> None:
    for options in ((), ("--json",)):
        schemas = json.loads(scope("tools", *options).out)
        assert len(schemas) == 9
        assert {s["type"] for s in schemas} == {"function"}


def test_replay_repeats_a_run(scope: Scope, tmp_path: Path) -> None:
    run = scope("ask", "go to from-the-roof, pan right 15 and count the balls, then go home", "--scene", SCENE, "--json").json
    assert run["outcome"] == "answered"
    result = scope("replay", run["run_dir"])
    assert result.code == 0
    assert "all" in result.out
    assert "the same results" in result.out
    replay = scope("replay", run["run_dir"], "--json").json
    assert (replay["repeated"], replay["equal"]) == (True, True)
    assert replay["recorded"]["tool_calls"] == run["tool_calls"]


def test_replay_detects_a_changed_trace(scope: Scope) -> None:
    run = scope("ask", "pan right 15", "--scene", SCENE, "--json").json
    trace = Path(run["run_dir"]) / "trace.jsonl"
    records = [json.loads(line) for line in trace.read_text().splitlines()]
    records[2]["outcome"]["result"]["pose"]["pan_deg"] = 25.0
    trace.write_text("".join(f"{json.dumps(record)}\n" for record in records))
    result = scope("replay", run["run_dir"])
    assert result.code == 1
    assert "differs: pose was" in result.out


def test_replay_without_the_scene_shows_the_trace_with_a_note(
    scope: Scope, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = scope("ask", "pan right 15", "--scene", SCENE, "--json").json
    monkeypatch.setenv("SCOPE_SCENES_DIR", str(tmp_path))
    result = scope("replay", run["run_dir"])
    assert result.code == 2
    assert "from the trace only" in result.out
    assert "adjust_ptz" in result.out


@pytest.mark.parametrize("content", [None, "", "not json\n", '{"event":"end"}\n'])
def test_replay_without_a_trace(scope: Scope, tmp_path: Path, content: str | None) -> None:
    if content is not None:
        (tmp_path / "trace.jsonl").write_text(content)
    result = scope("replay", str(tmp_path))
    assert (result.code, len(result.err.splitlines())) == (2, 1)


def test_chat_keeps_the_camera_and_accepts_slash_commands(scope: Scope, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stdin", StringIO("pan right 15\n/pose\n/save\n/dance\n\npan right 15\n/pose\n/quit\nnever reached\n"))
    result = scope("chat", "--scene", SCENE)
    assert result.code == 0
    assert "pan 15°" in result.out
    assert "pan 30°" in result.out
    assert "/dance" in result.err
    assert "never" not in result.out
    assert len(list((tmp_path / "runs").glob("*/trace.jsonl"))) == 2
    assert len(list((tmp_path / "runs").glob("*/pictures/001.png"))) == 1
    second = max((tmp_path / "runs").glob("*/trace.jsonl"), key=lambda p: p.stat().st_mtime_ns)
    header = json.loads(second.read_text().splitlines()[0])
    assert [turn["instruction"] for turn in header["conversation"]] == ["pan right 15"]


def test_chat_ends_at_the_end_of_its_input(scope: Scope, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stdin", StringIO(""))
    assert scope("chat", "--scene", SCENE).code == 0


def test_scene_list(scope: Scope) -> None:
    scenes = {s["name"]: s for s in scope("scene", "list", "--json").json}
    scene = scenes[SCENE]
    assert set(scene) == {"name", "viewpoints", "instances", "texts", "bytes"}
    assert {v["name"]: v["presets"] for v in scene["viewpoints"]} == {"mast": ["yard", "board"], "roof": ["from-the-roof"]}
    assert SCENE in scope("scene", "list").out


def test_scene_show(scope: Scope, tmp_path: Path) -> None:
    sheet = tmp_path / "sheet.png"
    result = scope("scene", "show", SCENE, "--all", "--contact-sheet", str(sheet))
    assert result.code == 0
    for text in ("from-the-roof", "NO ENTRY", "white roller", "zebra", "5 ball", "samples per pixel", "SHA-256"):
        assert text in result.out
    with Image.open(sheet) as image:
        assert image.width == 1600


def test_scene_show_opens_its_contact_sheet_on_request(scope: Scope, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    opened_files: list[str] = []
    monkeypatch.setattr("typer.launch", opened_files.append)
    monkeypatch.setenv("SCOPE_CACHE_DIR", str(tmp_path / "cache"))
    assert scope("scene", "show", SCENE).code == 0
    assert opened_files == [], "no terminal is attached"
    assert scope("scene", "show", SCENE, "--open").code == 0
    assert len(opened_files) == 1 and Path(opened_files[0]).is_file() and Path(opened_files[0]).is_relative_to(tmp_path / "cache")


@pytest.mark.parametrize("name", ["freight-yard", "high-street", "highway-works", "station-square"])
def test_the_short_card_fits_a_screen(scope: Scope, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, name: str) -> None:
    async def draw_nothing(*_: object) -> None: ...

    monkeypatch.setattr("scope_ptz.cli.scenes._write_contact_sheet", draw_nothing)
    monkeypatch.setenv("COLUMNS", "80")
    result = scope("scene", "show", name, "--contact-sheet", "sheet.png")
    assert result.code == 0
    assert len(result.out.splitlines()) <= 26
    assert "--all" in result.out


def test_scene_card_as_markdown(scope: Scope) -> None:
    result = scope("scene", "show", SCENE, "--markdown", "--contact-sheet", "yard.jpg")
    assert result.code == 0
    assert result.out.startswith("# ") and "](yard.jpg)" in result.out and "## Deliberately absent" in result.out
    assert not Path("yard.jpg").exists(), "the page only links to the picture"


def test_scene_view(scope: Scope, tmp_path: Path) -> None:
    picture = tmp_path / "view.png"
    result = scope("scene", "view", SCENE, "--pan", "30", "--zoom", "9", "--out", str(picture))
    assert result.code == 0
    assert "pan 30, tilt -8, zoom 5x (stopped by the zoom limit)" in result.out
    with Image.open(picture) as image:
        assert image.size == (1280, 720)


@pytest.mark.parametrize(
    "arguments",
    [
        ("show", "mars"),
        ("view", "mars", "--out", "x.png"),
        ("view", SCENE, "--pan", "nan", "--out", "x.png"),
        ("view", SCENE, "--zoom", "0", "--out", "x.png"),
        ("view", SCENE, "--out", "/nowhere/at/all.png"),
        ("view", SCENE, "--out", "picture.unknown"),
        ("build", "mars"),
        ("bake", "mars"),
        ("bake", "highway-works", "--quality", "divine"),
    ],
)
def test_bad_scene_commands(scope: Scope, arguments: tuple[str, ...]) -> None:
    result = scope("scene", *arguments)
    assert (result.code, len(result.err.splitlines())) == (2, 1)


def test_doctor_lists_components_and_how_to_install_missing_ones(scope: Scope) -> None:
    findings = {f["what"]: f for f in scope("doctor", "--json").json}
    assert findings[f"scene {SCENE}"]["verdict"] == "ok"
    assert findings["Python"]["verdict"] == "ok"
    assert "Blender" in findings
    assert all(f["remedy"] for f in findings.values() if f["verdict"] != "ok")


def test_doctor_finds_a_damaged_file(scope: Scope, scenes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shutil.copytree(scenes, tmp_path / "scenes")
    (tmp_path / "scenes" / SCENE / "mast" / "ids.png").write_bytes(b"oops")
    monkeypatch.setenv("SCOPE_SCENES_DIR", str(tmp_path / "scenes"))
    result = scope("doctor")
    assert result.code == 1
    assert "damaged" in result.out
