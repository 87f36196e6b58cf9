"""The command line in the tests' own process, on a small scene that is written for the purpose."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from scope_ptz.cli import main

SCENE = "analytic-yard"


@dataclass(frozen=True)
class Done:
    """How a command ended and what it printed."""

    code: int
    out: str
    err: str

    @property
    def json(self) -> Any:
        """The one line of JSON on stdout."""
        (line,) = self.out.splitlines()
        return json.loads(line)


Scope = Callable[..., Done]


@pytest.fixture(scope="session")
def scenes(analytic_folder: Path) -> Path:
    """A folder with the analytic scene. Read-only: damage a copy."""
    return analytic_folder.parent


@pytest.fixture
def scope(scenes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Scope:
    """Run ``scope`` with arguments; run folders go to ``tmp_path/runs``."""
    monkeypatch.setenv("SCOPE_SCENES_DIR", str(scenes))
    monkeypatch.setenv("SCOPE_RUNS_DIR", str(tmp_path / "runs"))
    monkeypatch.setenv("COLUMNS", "200")

    def run(*arguments: str) -> Done:
        monkeypatch.setattr("sys.argv", ["scope", *arguments])
        capsys.readouterr()
        with pytest.raises(SystemExit) as ended:
            main()
        code = ended.value.code
        assert code is None or isinstance(code, int)
        return Done(code or 0, *capsys.readouterr())

    return run
