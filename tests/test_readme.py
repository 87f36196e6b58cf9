"""The commands and the Python example of the README run as printed, and its transcript and links are correct."""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import httpx2
import pytest

from tests.support.programs import start_program

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
CONSOLE = re.findall(r"```console\n(.*?)```", README, flags=re.DOTALL)
TRANSCRIPTS = [block for block in CONSOLE if block.startswith("$ ")]
COMMANDS = [block for block in CONSOLE if not block.startswith("$ ")]
PYTHON = re.findall(r"```python\n(.*?)```", README, flags=re.DOTALL)
MAKE = sorted(set(re.findall(r"`(make [a-z-]+)`", README)))


MANY_VIEWS = ("scope scene show", 'scope ask "sweep', 'scope ask "zoom')
"""Commands that render many views of a large scene."""


def run(script: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run shell commands in a folder, with the programs of this environment first in the search path."""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
    environment = os.environ | {"PATH": path, "COLUMNS": "84"}
    return subprocess.run(
        ["/bin/sh", "-ec", script], cwd=folder, env=environment, capture_output=True, text=True, timeout=600, check=False
    )


def scope_commands(block: str) -> list[str]:
    """Return the `scope` commands of a block. The tests do not install anything."""
    return [line for line in block.splitlines() if line.startswith("scope ")]


@pytest.mark.parametrize(
    "command",
    [
        pytest.param(c, marks=pytest.mark.full if c.startswith(MANY_VIEWS) else ())
        for block in COMMANDS
        for c in scope_commands(block)
        if not c.startswith("scope bench")
    ],
)
def test_commands_run(command: str, tmp_path: Path) -> None:
    result = run(command, tmp_path)
    assert result.returncode == 0, result.stderr
    assert result.stdout.strip()


@pytest.mark.full
def test_benchmark_commands_run_one_after_the_other(tmp_path: Path) -> None:
    [block] = [block for block in COMMANDS if "scope bench" in block]
    result = run("\n".join(scope_commands(block)), tmp_path)
    assert result.returncode == 0, result.stderr
    assert "rule-based" in result.stdout
    assert (tmp_path / "report" / "index.html").is_file()


@pytest.mark.full
def test_the_transcript_matches_the_output(tmp_path: Path) -> None:
    [transcript] = TRANSCRIPTS
    command, transcript_output = transcript.removeprefix("$ ").split("\n", 1)
    result = run(command, tmp_path)
    assert result.returncode == 0, result.stderr
    for excerpt in re.findall(
        r"^ +\d+  \w+ +\S+|\b\d+ of '\w+' in the \w+ view|pan -?\d+, tilt -?\d+", transcript_output, flags=re.MULTILINE
    ):
        assert plain(excerpt) in plain(result.stdout)
    answer = re.search(r"Answer:.*ground truth\.\)", transcript_output, flags=re.DOTALL)
    assert answer is not None
    assert plain(answer[0]) in plain(result.stdout)
    [folder] = (tmp_path / "runs").iterdir()
    assert (folder / "trace.jsonl").is_file()
    assert (folder / "filmstrip.png").is_file()


def test_python_example_runs(tmp_path: Path) -> None:
    [program] = PYTHON
    (tmp_path / "example.py").write_text(program, encoding="utf-8")
    result = run(shlex.join([sys.executable, "example.py"]), tmp_path)
    assert result.returncode == 0, result.stderr
    expected_start = re.search(r"# (I can see \d+ cones)", program)
    assert expected_start is not None
    assert result.stdout.startswith(expected_start[1])
    assert (tmp_path / "filmstrip.png").is_file()


@pytest.mark.parametrize("command", MAKE)
def test_make_targets_exist(command: str) -> None:
    make = shutil.which("make")
    assert make is not None
    result = subprocess.run([make, "--dry-run", *shlex.split(command)[1:]], cwd=ROOT, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr


def test_the_demo_is_the_transcript() -> None:
    demo = re.search(r"^DEMO := (.+)$", (ROOT / "Makefile").read_text(encoding="utf-8"), flags=re.MULTILINE)
    assert demo is not None
    assert f'scope ask "{demo[1]}"' in TRANSCRIPTS[0]


@pytest.mark.parametrize("target", re.findall(r"\]\(([^)#:]+)\)", README))
def test_linked_files_and_pictures_exist(target: str) -> None:
    assert (ROOT / target).exists()


def plain(text: str) -> str:
    """Return a text with every run of white space replaced by one space, so that line breaks do not matter."""
    return " ".join(text.split())


@pytest.mark.full
def test_network_camera_commands_run(tmp_path: Path) -> None:
    section = README[README.index("## Use a camera on the network") :]
    block = re.findall(r"```sh\n(.*?)```", section, flags=re.DOTALL)[0]
    commands = [line for line in scope_commands(block) if not line.startswith("scope camera discover")]  # searches the network
    assert len(commands) == 2
    serve = [sys.executable, "-m", "scope_ptz.cli", "camera", "serve", "--scene", "highway-works", "--port", "0", "--json"]
    serve += ["--rtsp-port", "0", "--user", "operator:operator", "--no-prefetch"]
    with start_program(serve, stdout=subprocess.PIPE) as server:
        assert server.stdout is not None
        description = json.loads(server.stdout.readline())
        address = description["cameras"][0]["url"].removeprefix("http://")
        password = description["passwords"]["operator"]
        picture = f"http://{address}/axis-cgi/jpg/image.cgi"  # the first one takes long, because the scene is read
        httpx2.get(picture, auth=httpx2.DigestAuth("operator", password), timeout=300).raise_for_status()
        for command in commands:
            script = f"export SCOPE_CAMERA_PASSWORD={password}\n{command}".replace("10.0.0.7", address)
            result = run(script, tmp_path)
            assert result.returncode == 0, result.stderr
