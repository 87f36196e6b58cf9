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


def test_help_is_instant() -> None:
    def once() -> float:
        began = time.perf_counter()
        done = subprocess.run([*SCOPE, "--help"], capture_output=True, text=True, check=True)
        assert "ask" in done.stdout
        return time.perf_counter() - began

    bare = subprocess.run(
        [sys.executable, "-X", "importtime", "-m", "scope_ptz.cli", "--help"], capture_output=True, text=True, check=True
    )
    heavy = [name for name in ("numpy", "cv2", "pydantic", "PIL", "lark", "anyio") if f" {name}\n" in bare.stderr]
    assert heavy == []
    assert min(once() for _ in range(3)) < 0.6  # A third of a second on an idle machine.


def test_the_entry_point_is_installed() -> None:
    from importlib.metadata import entry_points

    (entry,) = entry_points(group="console_scripts", name="scope")
    assert entry.value == "scope_ptz.cli:main"


def test_version(scope: Scope) -> None:
    from scope_ptz import __version__

    done = scope("--version")
    assert (done.code, done.out) == (0, f"scope-ptz {__version__}\n")


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_ctrl_c_ends_a_run_cleanly(scenes: Path, tmp_path: Path) -> None:
    environment = {**os.environ, "SCOPE_SCENES_DIR": str(scenes), "SCOPE_RUNS_DIR": str(tmp_path)}
    command = [*SCOPE, "ask", "count the zebras in the whole scene", "--scene", SCENE, "--realtime", "--json"]

    def hear() -> None:
        """A test run in the background ignores Ctrl-C, and children inherit that."""
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
