"""The program as a process under adverse conditions: interrupts, broken streams, encodings, damaged folders."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.cli.conftest import SCENE, Scope

pytestmark = pytest.mark.skipif(os.name == "nt", reason="requires POSIX signals, pipes and devices")

SCOPE = [sys.executable, "-m", "scope_ptz.cli"]


@pytest.fixture
def environment(scenes: Path, tmp_path: Path) -> dict[str, str]:
    """Return an environment with the small scene, and with run folders in ``tmp_path/runs``."""
    inherited = {name: value for name, value in os.environ.items() if not name.startswith("SCOPE_")}
    return {**inherited, "SCOPE_SCENES_DIR": str(scenes), "SCOPE_RUNS_DIR": str(tmp_path / "runs"), "COLUMNS": "80"}


def run(environment: dict[str, str], *command: str, **options: Any) -> subprocess.CompletedProcess[str]:
    run_result = subprocess.run(command, env=environment, capture_output=True, text=True, check=False, timeout=300, **options)
    assert "Traceback" not in run_result.stderr + run_result.stdout, run_result.stderr
    return run_result


def shell(environment: dict[str, str], line: str) -> subprocess.CompletedProcess[str]:
    """Run a shell command line in which ``$SCOPE`` is the program."""
    return run({**environment, "SCOPE": " ".join(SCOPE)}, "sh", "-c", line)


# Ctrl-C ----------------------------------------------------------------------------------------------------------------
# Send SIGINT at an exact place: after a given function of the program has returned.
PRESS = """
import importlib, os, signal, sys
place, presses, sys.argv = sys.argv[1], int(sys.argv[2]), ["scope", *sys.argv[3:]]
signal.signal(signal.SIGINT, signal.default_int_handler)
module, _, path = place.partition(":")
*outer, name = path.split(".")
owner = importlib.import_module(module)
for part in outer:
    owner = getattr(owner, part)
real = getattr(owner, name)

def pressed(*arguments, **options):
    result = real(*arguments, **options)
    for _ in range(presses):
        os.kill(os.getpid(), signal.SIGINT)
    return result

setattr(owner, name, pressed)
from scope_ptz.cli import main
main()
"""


PLACES = (
    "scope_ptz.settings:load_settings",
    "scope_ptz.simulator.pack:load_scene",
    "scope_ptz.agent.store:slug",
    "scope_ptz.agent.store:RunFolder.save_frame",
    "scope_ptz.agent.filmstrip:draw_filmstrip",
)


@pytest.mark.parametrize(
    ("place", "presses"),
    [pytest.param(place, 1, marks=pytest.mark.full if "slug" in place or "settings" in place else ()) for place in PLACES]
    + [pytest.param(place, 2, marks=() if "save_frame" in place else pytest.mark.full) for place in PLACES],
)
def test_ctrl_c_at_any_time_leaves_no_incomplete_run_folder(
    environment: dict[str, str], tmp_path: Path, place: str, presses: int
) -> None:
    run_result = run(environment, sys.executable, "-c", PRESS, place, str(presses), "ask", "pan right 5", "--scene", SCENE)
    ended = [json.loads(trace.read_text().splitlines()[-1]) for trace in tmp_path.glob("runs/*/trace.jsonl")]
    assert len(ended) == len(list(tmp_path.glob("runs/*"))), "a folder without a trace"
    if "filmstrip" in place:  # The run was over by then
        assert (run_result.returncode, [end["outcome"] for end in ended]) == (0, ["answered"])
    else:
        assert run_result.returncode == 130
        assert all(end["outcome"] == "cancelled" for end in ended)
    assert "Known" not in run_result.stderr and len(run_result.stderr.splitlines()) <= 1


# Standard streams ------------------------------------------------------------------------------------------------------
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full")
@pytest.mark.parametrize(
    "command",
    ["plan 'pan right 5'", *(pytest.param(line, marks=pytest.mark.full) for line in ("tools", "--help", "scene list --json"))],
)
def test_a_full_disk_behind_stdout_is_one_line_and_exit_code_1(environment: dict[str, str], command: str) -> None:
    run_result = shell(environment, f"$SCOPE {command} > /dev/full")
    assert run_result.returncode == 1
    assert run_result.stderr == "scope: the output could not be written: No space left on device.\n"


@pytest.mark.parametrize(
    ("line", "code"),
    [
        ("plan 'pan right 5' >&-", 0),
        ("plan '' >&-", 2),
        ("plan '' 2>&-", 2),
        ("plan '' 2>/dev/full", 2),
        ("plan 'pan right 5' <&- >&- 2>&-", 0),
        ("plan --from - <&-", 0),
        ("chat <&-", 2),
        ("chat </dev/null", 0),
    ],
)
def test_closed_streams_change_no_exit_code(environment: dict[str, str], line: str, code: int) -> None:
    assert shell(environment, f"$SCOPE {line}").returncode == code


def test_chat_without_standard_input_suggests_another_command(environment: dict[str, str]) -> None:
    assert "scope ask" in shell(environment, "$SCOPE chat <&-").stderr


@pytest.mark.parametrize(
    "encoding",
    [
        {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
        pytest.param({"PYTHONIOENCODING": "ascii"}, marks=pytest.mark.full),
        pytest.param({"PYTHONIOENCODING": "latin-1"}, marks=pytest.mark.full),
    ],
)
def test_output_is_readable_in_every_encoding(environment: dict[str, str], encoding: dict[str, str]) -> None:
    encoded = {**environment, **encoding}
    run_result = run(
        encoded, *SCOPE, "ask", "go to board, then go home", "--scene", SCENE, encoding=encoding.get("PYTHONIOENCODING")
    )
    assert run_result.returncode == 0
    assert "> go to board" in run_result.stdout or "› go to board" in run_result.stdout
    plan = run(encoded, *SCOPE, "plan", "florp “é”", "--json")
    assert "é" in json.loads(plan.stdout)["instruction"]
    chat = run(encoded, *SCOPE, "chat", "--scene", SCENE, input="/pose\nflorp\n", encoding=encoding.get("PYTHONIOENCODING"))
    assert chat.returncode == 0
    assert "pan 0" in chat.stdout
    assert run(encoded, *SCOPE, "--help").returncode == 0


# Folders of scenes -----------------------------------------------------------------------------------------------------
@pytest.fixture
def scenes_copy(scenes: Path, tmp_path: Path, environment: dict[str, str]) -> Path:
    """Return a copy of the scenes folder that the test may damage."""
    copy = tmp_path / "scenes"
    shutil.copytree(scenes, copy)
    environment["SCOPE_SCENES_DIR"] = str(copy)
    return copy


@pytest.mark.parametrize(
    "file", ["scene.json", *(pytest.param(name, marks=pytest.mark.full) for name in ("mast/manifest.json", "mast/base.png"))]
)
def test_a_pipe_instead_of_a_file_is_an_immediate_error(environment: dict[str, str], scenes_copy: Path, file: str) -> None:
    (path,) = (scenes_copy / SCENE).glob(file.replace(".png", ".*"))
    path.unlink()
    os.mkfifo(path)
    run_result = run(environment, *SCOPE, "ask", "count the balls", "--scene", SCENE)
    assert run_result.returncode == 2
    assert str(path) in run_result.stderr and "not a regular file" in run_result.stderr


@pytest.mark.parametrize(
    "command",
    [
        ("replay",),
        ("bench", "run", "--no-pictures", "--tasks"),
        pytest.param(("bench", "verify"), marks=pytest.mark.full),
        pytest.param(("bench", "submission", "validate"), marks=pytest.mark.full),
    ],
)
def test_a_pipe_instead_of_an_argument_is_an_immediate_error(
    environment: dict[str, str], tmp_path: Path, command: tuple[str, ...]
) -> None:
    path = tmp_path / "pipe.eval"
    os.mkfifo(path)
    run_result = run(environment, *SCOPE, *command, str(path))
    assert run_result.returncode == 2
    assert str(path) in run_result.stderr and "not a regular file" in run_result.stderr


@pytest.mark.full
def test_a_bad_folder_does_not_hide_other_scenes(environment: dict[str, str], scenes_copy: Path) -> None:
    for name, content in (("broken", "{"), ("empty", "{}"), ("deep", "[" * 100_000), ("renamed", "")):
        (scenes_copy / name).mkdir()
        (scenes_copy / name / "scene.json").write_text(content)
    (scenes_copy / "dangling").mkdir()
    (scenes_copy / "dangling" / "scene.json").symlink_to("nowhere")
    bad = {"broken", "empty", "deep", "renamed", "dangling"}
    run_result = run({**environment, "COLUMNS": "200"}, *SCOPE, "scene", "list")
    assert run_result.returncode == 0
    assert SCENE in run_result.stdout and "highway-works" in run_result.stdout
    assert all(f"{name} cannot be loaded: " in run_result.stdout for name in bad)
    listed = json.loads(run(environment, *SCOPE, "scene", "list", "--json").stdout)
    assert {scene["name"] for scene in listed if "error" in scene} == bad
    examined = run(environment, *SCOPE, "doctor", "--json")
    assert examined.returncode == 1
    assert {f"scene {name}" for name in bad} <= {f["what"] for f in json.loads(examined.stdout) if f["verdict"] == "missing"}


@pytest.mark.parametrize("command", [("scene", "list"), ("ask", "go home"), ("scene", "show", "highway-works")])
def test_a_missing_scenes_folder_is_reported(environment: dict[str, str], command: tuple[str, ...]) -> None:
    run_result = run({**environment, "SCOPE_SCENES_DIR": "/nowhere"}, *SCOPE, *command)
    assert (run_result.returncode, run_result.stderr.count("\n")) == (2, 1)
    assert "SCOPE_SCENES_DIR is /nowhere" in run_result.stderr


# Replays, plans, models ------------------------------------------------------------------------------------------------
def test_a_replay_that_repeats_nothing_does_not_succeed(scope: Scope, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    unclear = scope("ask", "florp the wibble", "--scene", SCENE, "--json").json
    run_result = scope("replay", unclear["run_dir"])
    assert run_result.code == 2
    assert "no calls" in run_result.out
    turn = scope("ask", "pan right 15", "--scene", SCENE, "--json").json
    monkeypatch.setenv("SCOPE_SCENES_DIR", str(tmp_path))
    assert scope("replay", turn["run_dir"]).code == 2


def test_a_long_instruction_is_not_printed_in_full(scope: Scope) -> None:
    for instruction in ("pan right 5 and " * 200, "florp wibble " * 300):
        run_result = scope("plan", instruction)
        assert len(run_result.out) < 1000
        assert "characters)" in run_result.out
    run_result = scope("plan", "pan right 5 and " * 6000)
    assert (run_result.code, run_result.out) == (2, "")
    assert len(run_result.err) < 200


def test_models_fit_into_the_given_memory(scope: Scope) -> None:
    for size in (8, 16, 24):
        fitting = json.loads(scope("models", "--memory", str(size), "--json").out)
        assert fitting and all(model["memory_gb"] <= size for model in fitting)
    table, _, rest = scope("models", "--memory", "16").out.partition("With smaller weights")
    assert "qwen3.5-9b" not in table and "qwen3.5-9b (7.8 GB)" in rest
