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

pytestmark = pytest.mark.skipif(os.name == "nt", reason="signals, pipes and devices of POSIX")

SCOPE = [sys.executable, "-m", "scope_ptz.cli"]


@pytest.fixture
def environment(scenes: Path, tmp_path: Path) -> dict[str, str]:
    """The small scene, and run folders in ``tmp_path/runs``."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith("SCOPE_")}
    return {**kept, "SCOPE_SCENES_DIR": str(scenes), "SCOPE_RUNS_DIR": str(tmp_path / "runs"), "COLUMNS": "80"}


def run(environment: dict[str, str], *command: str, **options: Any) -> subprocess.CompletedProcess[str]:
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False, timeout=300, **options)
    assert "Traceback" not in done.stderr + done.stdout, done.stderr
    return done


def shell(environment: dict[str, str], line: str) -> subprocess.CompletedProcess[str]:
    """Run a shell command line in which ``$SCOPE`` is the program."""
    return run({**environment, "SCOPE": " ".join(SCOPE)}, "sh", "-c", line)


# Ctrl-C ----------------------------------------------------------------------------------------------------------------
# Presses Ctrl-C at an exact place: after a function of the program has been called.
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
    done = run(environment, sys.executable, "-c", PRESS, place, str(presses), "ask", "pan right 5", "--scene", SCENE)
    ended = [json.loads(trace.read_text().splitlines()[-1]) for trace in tmp_path.glob("runs/*/trace.jsonl")]
    assert len(ended) == len(list(tmp_path.glob("runs/*"))), "a folder without a trace"
    if "filmstrip" in place:  # The run was over by then
        assert (done.returncode, [end["outcome"] for end in ended]) == (0, ["answered"])
    else:
        assert done.returncode == 130
        assert all(end["outcome"] == "cancelled" for end in ended)
    assert "Known" not in done.stderr and len(done.stderr.splitlines()) <= 1


# Standard streams ------------------------------------------------------------------------------------------------------
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full")
@pytest.mark.parametrize("command", ["plan 'pan right 5'", "tools", "--help", "scene list --json"])
def test_a_full_disk_behind_stdout_is_one_line_and_exit_code_1(environment: dict[str, str], command: str) -> None:
    done = shell(environment, f"$SCOPE {command} > /dev/full")
    assert done.returncode == 1
    assert done.stderr == "scope: the output could not be written: No space left on device.\n"


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


def test_chat_without_standard_input_says_what_to_use_instead(environment: dict[str, str]) -> None:
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
    there = {**environment, **encoding}
    done = run(there, *SCOPE, "ask", "go to board, then go home", "--scene", SCENE, encoding=encoding.get("PYTHONIOENCODING"))
    assert done.returncode == 0
    assert "> go to board" in done.stdout or "› go to board" in done.stdout
    planned = run(there, *SCOPE, "plan", "florp “é”", "--json")
    assert "é" in json.loads(planned.stdout)["instruction"]
    spoken = run(there, *SCOPE, "chat", "--scene", SCENE, input="/pose\nflorp\n", encoding=encoding.get("PYTHONIOENCODING"))
    assert spoken.returncode == 0
    assert "pan 0" in spoken.stdout
    assert run(there, *SCOPE, "--help").returncode == 0


# Folders of scenes -----------------------------------------------------------------------------------------------------
@pytest.fixture
def copied(scenes: Path, tmp_path: Path, environment: dict[str, str]) -> Path:
    """Return a copy of the scenes folder that the test may damage."""
    copy = tmp_path / "scenes"
    shutil.copytree(scenes, copy)
    environment["SCOPE_SCENES_DIR"] = str(copy)
    return copy


@pytest.mark.parametrize("file", ["scene.json", "mast/manifest.json", "mast/base.png"])
def test_a_pipe_instead_of_a_file_is_an_immediate_error(environment: dict[str, str], copied: Path, file: str) -> None:
    (path,) = (copied / SCENE).glob(file.replace(".png", ".*"))
    path.unlink()
    os.mkfifo(path)
    done = run(environment, *SCOPE, "ask", "count the balls", "--scene", SCENE)
    assert done.returncode == 2
    assert str(path) in done.stderr and "not a regular file" in done.stderr


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
    done = run(environment, *SCOPE, *command, str(path))
    assert done.returncode == 2
    assert str(path) in done.stderr and "not a regular file" in done.stderr


def test_a_bad_folder_hides_no_other_scene(environment: dict[str, str], copied: Path) -> None:
    for name, content in (("broken", "{"), ("empty", "{}"), ("deep", "[" * 100_000), ("renamed", "")):
        (copied / name).mkdir()
        (copied / name / "scene.json").write_text(content)
    (copied / "dangling").mkdir()
    (copied / "dangling" / "scene.json").symlink_to("nowhere")
    bad = {"broken", "empty", "deep", "renamed", "dangling"}
    done = run({**environment, "COLUMNS": "200"}, *SCOPE, "scene", "list")
    assert done.returncode == 0
    assert SCENE in done.stdout and "highway-works" in done.stdout
    assert all(f"{name} cannot be loaded: " in done.stdout for name in bad)
    listed = json.loads(run(environment, *SCOPE, "scene", "list", "--json").stdout)
    assert {scene["name"] for scene in listed if "error" in scene} == bad
    examined = run(environment, *SCOPE, "doctor", "--json")
    assert examined.returncode == 1
    assert {f"scene {name}" for name in bad} <= {f["what"] for f in json.loads(examined.stdout) if f["verdict"] == "missing"}


@pytest.mark.parametrize("command", [("scene", "list"), ("ask", "go home"), ("scene", "show", "highway-works")])
def test_a_missing_scenes_folder_is_reported(environment: dict[str, str], command: tuple[str, ...]) -> None:
    done = run({**environment, "SCOPE_SCENES_DIR": "/nowhere"}, *SCOPE, *command)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert "SCOPE_SCENES_DIR is /nowhere" in done.stderr


# Replays, plans, models ------------------------------------------------------------------------------------------------
def test_a_replay_that_repeats_nothing_does_not_succeed(scope: Scope, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    unclear = scope("ask", "florp the wibble", "--scene", SCENE, "--json").json
    done = scope("replay", unclear["run_dir"])
    assert done.code == 2
    assert "no calls" in done.out
    made = scope("ask", "pan right 15", "--scene", SCENE, "--json").json
    monkeypatch.setenv("SCOPE_SCENES_DIR", str(tmp_path))
    assert scope("replay", made["run_dir"]).code == 2


def test_a_long_instruction_is_not_printed_in_full(scope: Scope) -> None:
    for words in ("pan right 5 and " * 200, "florp wibble " * 300):
        done = scope("plan", words)
        assert len(done.out) < 1000
        assert "characters)" in done.out
    done = scope("plan", "pan right 5 and " * 6000)
    assert (done.code, done.out) == (2, "")
    assert len(done.err) < 200


def test_models_fit_into_the_memory_that_was_named(scope: Scope) -> None:
    for size in (8, 16, 24):
        fitting = json.loads(scope("models", "--memory", str(size), "--json").out)
        assert fitting and all(model["memory_gb"] <= size for model in fitting)
    table, _, rest = scope("models", "--memory", "16").out.partition("With smaller weights")
    assert "qwen3.5-9b" not in table and "qwen3.5-9b (7.8 GB)" in rest
