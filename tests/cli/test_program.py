"""The program as a process: instant help, the entry point, Ctrl-C."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.cli.conftest import SCENE, Scope

SCOPE = [sys.executable, "-m", "scope_ptz.cli"]


# What `scope --help` needs: the command parser and what draws its pages, nothing that does work.
LIGHT = {"typer", "click", "shellingham", "rich", "pygments", "markdown_it", "linkify_it", "mdurl", "uc_micro", "attr"}
LIGHT |= {"annotated_doc", "typing_extensions", "scope_ptz"}


def test_help_loads_only_the_modules_that_it_needs() -> None:
    """Help is fast because few modules are loaded. Its duration depends on the machine and is not tested."""
    loaded = "import sys; from scope_ptz.cli import main\ntry: main()\nfinally: print(*sys.modules, file=sys.stderr)"
    done = subprocess.run([sys.executable, "-c", loaded, "--help"], capture_output=True, text=True, check=True)
    assert "ask" in done.stdout
    bare = subprocess.run([sys.executable, "-c", "import sys; print(*sys.modules)"], capture_output=True, text=True, check=True)
    packages = {name.partition(".")[0] for name in done.stderr.split()} - {name.partition(".")[0] for name in bare.stdout.split()}
    assert packages - sys.stdlib_module_names <= LIGHT
    ours = [name for name in done.stderr.split() if name.startswith("scope_ptz")]
    assert "scope_ptz.cli.app" in ours
    assert len(ours) <= 31


def test_the_entry_point_is_installed() -> None:
    from importlib.metadata import entry_points

    (entry,) = entry_points(group="console_scripts", name="scope")
    assert entry.value == "scope_ptz.cli:main"


def test_version(scope: Scope) -> None:
    from scope_ptz.version import __version__

    done = scope("--version")
    assert (done.code, done.out) == (0, f"scope-ptz {__version__}\n")


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_ctrl_c_ends_a_run_cleanly(scenes: Path, tmp_path: Path) -> None:
    environment = {**os.environ, "SCOPE_SCENES_DIR": str(scenes), "SCOPE_RUNS_DIR": str(tmp_path)}
    command = [*SCOPE, "ask", "count the zebras in the whole scene", "--scene", SCENE, "--realtime", "--json"]

    def hear() -> None:
        """Enable Ctrl-C in the child process: background processes ignore it, and their children inherit that."""
        signal.signal(signal.SIGINT, signal.default_int_handler)

    with subprocess.Popen(
        command, env=environment, preexec_fn=hear, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        deadline = time.monotonic() + 30
        while not (list(tmp_path.glob("*/trace.jsonl")) and next(tmp_path.glob("*/trace.jsonl")).read_text().count("\n") >= 2):
            assert time.monotonic() < deadline, "the run did not begin"
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=30)
    assert process.returncode == 130
    assert "Traceback" not in err
    assert json.loads(out)["outcome"] == "cancelled"
    records = [json.loads(line) for line in next(tmp_path.glob("*/trace.jsonl")).read_text().splitlines()]
    assert (records[-1]["event"], records[-1]["outcome"]) == ("end", "cancelled")


@pytest.mark.skipif(os.name == "nt", reason="pipes of POSIX")
@pytest.mark.parametrize(
    ("command", "code"),
    [
        (["tools"], 0),
        (["scene", "list"], 0),
        (["bench", "submission", "validate", "spoiled.jsonl"], 1),  # a few words
        (["bench", "submission", "validate", "spoiled.jsonl", "--json"], 1),  # more than a buffer holds
        (["bench", "submission", "validate", "missing.jsonl", "--json"], 2),
    ],
)
def test_a_closed_output_pipe_changes_no_exit_code(command: list[str], code: int, tmp_path: Path) -> None:
    (tmp_path / "spoiled.jsonl").write_text("no JSON\n" * 2000)
    reader, writer = os.pipe()
    os.close(reader)
    try:
        done = subprocess.run([*SCOPE, *command], stdout=writer, stderr=subprocess.PIPE, text=True, cwd=tmp_path, check=False)
    finally:
        os.close(writer)
    assert done.returncode == code
    assert "Traceback" not in done.stderr and "BrokenPipe" not in done.stderr
