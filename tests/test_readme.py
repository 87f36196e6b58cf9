"""The README's commands work as they stand there, and its picture is there."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```console\n(.*?)```", README, flags=re.DOTALL)
COMMANDS = [line.split("  #")[0].strip() for block in BLOCKS for line in block.splitlines()]
SCOPE = Path(sys.executable).with_name("scope")


@pytest.mark.parametrize("command", [c for c in COMMANDS if c.startswith("scope ")])
def test_scope_commands(command: str, tmp_path: Path) -> None:
    done = subprocess.run(
        [SCOPE, *shlex.split(command)[1:]], cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip()


@pytest.mark.parametrize("command", [c for c in COMMANDS if c.startswith("make ")])
def test_make_targets_exist(command: str) -> None:
    make = shutil.which("make")
    assert make is not None
    done = subprocess.run([make, "--dry-run", *shlex.split(command)[1:]], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_the_readme_shows_both_kinds_of_command() -> None:
    assert {c.split()[0] for c in COMMANDS} == {"scope", "make"}


def test_the_demo_finds_its_seven_cones(tmp_path: Path) -> None:
    instruction = re.search(r'scope ask "(.+)"|^DEMO := (.+)$', (ROOT / "Makefile").read_text(encoding="utf-8"), flags=re.MULTILINE)
    assert instruction is not None
    asked = instruction.group(2) or instruction.group(1)
    done = subprocess.run([SCOPE, "ask", asked], cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    assert re.search(r"\b(7|seven)\b", done.stdout.split("Answer")[-1])
    run = next((tmp_path / "runs").iterdir())
    assert (run / "trace.jsonl").is_file()
    assert (run / "filmstrip.png").is_file()


@pytest.mark.parametrize("target", re.findall(r"\]\(([^)#:]+)\)", README))
def test_links_and_pictures_are_there(target: str) -> None:
    assert (ROOT / target).is_file()
