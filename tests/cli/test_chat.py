"""``scope chat``: commands, history, and omitted output."""

from __future__ import annotations

import os
import sys
from io import StringIO
from pathlib import Path

import pytest

from tests.cli.conftest import SCENE, CommandResult, Scope
from tests.support.programs import start_program


def chat(scope: Scope, monkeypatch: pytest.MonkeyPatch, *lines: str) -> CommandResult:
    monkeypatch.setattr("sys.stdin", StringIO("\n".join(lines) + "\n"))
    return scope("chat", "--scene", SCENE)


def test_help_lists_the_commands(scope: Scope, monkeypatch: pytest.MonkeyPatch) -> None:
    result = chat(scope, monkeypatch, "/help")
    assert all(f"{command} " in result.out for command in ("/pose", "/save", "/help", "/quit"))
    assert "/help" in chat(scope, monkeypatch, "/dance").err


def test_the_note_about_perception_appears_once(scope: Scope, monkeypatch: pytest.MonkeyPatch) -> None:
    result = chat(scope, monkeypatch, "pan right 5", "pan right 5", "count the balls")
    assert result.out.count("not a model") == 1
    assert result.out.index("not a model") < result.out.index("pan right 5")
    assert "Source:" not in result.out


def test_a_turn_is_one_line_for_each_step_the_answer_and_the_run_folder(scope: Scope, monkeypatch: pytest.MonkeyPatch) -> None:
    welcome, note, *turn = chat(scope, monkeypatch, "count the balls").out.splitlines()
    assert "/help" in welcome and "not a model" in note
    instruction, step, answer, folder, end = turn
    assert instruction == "› count the balls"
    assert step.startswith("  1  count_objects  description=balls, view=current: ")
    assert answer.startswith("Answer: I can see ")
    assert " · " in folder and "count-the-balls" in folder and not end


def test_a_question_that_is_not_understood_is_explained_once(scope: Scope, monkeypatch: pytest.MonkeyPatch) -> None:
    out = " ".join(chat(scope, monkeypatch, "is the ball of a sort to go with?").out.split())
    assert "view=current: not understood Answer: I did not understand that question. I can answer, for example: " in out
    assert out.count("understand") == 1


def test_a_clarification_has_a_question_and_no_filmstrip(scope: Scope, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    result = chat(scope, monkeypatch, "florp the wibble")
    assert "Question: " in result.out
    assert "florp-the-wibble" not in result.out
    assert not list(tmp_path.glob("runs/*/filmstrip.png"))


@pytest.mark.skipif(os.name == "nt", reason="requires a POSIX terminal")
def test_lines_are_kept_in_a_private_history(scenes: Path, tmp_path: Path) -> None:
    import pty

    pytest.importorskip("readline")
    environment = {
        **os.environ, "SCOPE_SCENES_DIR": str(scenes), "SCOPE_RUNS_DIR": str(tmp_path / "runs"), "TERM": "dumb",
        "XDG_STATE_HOME": str(tmp_path), "HOME": str(tmp_path),
    }  # fmt: skip
    user_end, terminal = pty.openpty()
    try:
        with start_program(
            [sys.executable, "-m", "scope_ptz.cli", "chat", "--scene", SCENE],
            env=environment, stdin=terminal, stdout=terminal, stderr=terminal,
        ) as process:  # fmt: skip
            os.close(terminal)
            os.write(user_end, b"/pose\n/quit\n")
            output = b""
            try:
                while chunk := os.read(user_end, 4096):
                    output += chunk
            except OSError:  # The program has closed its side
                pass
            assert process.wait(timeout=120) == 0, output.decode()
    finally:
        os.close(user_end)
    (history,) = tmp_path.rglob("chat_history")
    assert history.stat().st_mode & 0o777 == 0o600
    assert "/pose" in history.read_text().splitlines()
