"""``scope chat``: commands, history, and omitted output."""

from __future__ import annotations

import os
import sys
from io import StringIO
from pathlib import Path

import pytest

from tests.cli.conftest import SCENE, CommandResult, Scope
from tests.support.programs import started


def say(scope: Scope, monkeypatch: pytest.MonkeyPatch, *lines: str) -> CommandResult:
    monkeypatch.setattr("sys.stdin", StringIO("\n".join(lines) + "\n"))
    return scope("chat", "--scene", SCENE)


def test_help_lists_the_commands(scope: Scope, monkeypatch: pytest.MonkeyPatch) -> None:
    done = say(scope, monkeypatch, "/help")
    assert all(f"{command} " in done.out for command in ("/pose", "/save", "/help", "/quit"))
    assert "/help" in say(scope, monkeypatch, "/dance").err


def test_the_note_about_perception_appears_once(scope: Scope, monkeypatch: pytest.MonkeyPatch) -> None:
    done = say(scope, monkeypatch, "pan right 5", "pan right 5", "count the balls")
    assert done.out.count("not a model") == 1


def test_a_clarification_has_a_question_and_no_filmstrip(scope: Scope, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    done = say(scope, monkeypatch, "florp the wibble")
    assert "Question: " in done.out
    assert "Filmstrip" not in done.out and "not a model" not in done.out
    assert not list(tmp_path.glob("runs/*/filmstrip.png"))


@pytest.mark.skipif(os.name == "nt", reason="a terminal of POSIX")
def test_lines_are_kept_in_a_private_history(scenes: Path, tmp_path: Path) -> None:
    import pty

    pytest.importorskip("readline")
    environment = {
        **os.environ, "SCOPE_SCENES_DIR": str(scenes), "SCOPE_RUNS_DIR": str(tmp_path / "runs"), "TERM": "dumb",
        "XDG_STATE_HOME": str(tmp_path), "HOME": str(tmp_path),
    }  # fmt: skip
    person, terminal = pty.openpty()
    try:
        with started(
            [sys.executable, "-m", "scope_ptz.cli", "chat", "--scene", SCENE],
            env=environment, stdin=terminal, stdout=terminal, stderr=terminal,
        ) as process:  # fmt: skip
            os.close(terminal)
            os.write(person, b"/pose\n/quit\n")
            seen = b""
            try:
                while chunk := os.read(person, 4096):
                    seen += chunk
            except OSError:  # The program has closed its side
                pass
            assert process.wait(timeout=120) == 0, seen.decode()
    finally:
        os.close(person)
    (history,) = tmp_path.rglob("chat_history")
    assert history.stat().st_mode & 0o777 == 0o600
    assert "/pose" in history.read_text().splitlines()
