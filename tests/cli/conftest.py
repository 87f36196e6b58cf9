"""Fixtures that run the command line in the test process, on a small generated scene."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from scope_ptz.cli import main
from scope_ptz.simulator.pack import Scene
from tests.cli.served_camera import PASSWORD, ServedCamera, serve_camera

SCENE = "analytic-yard"


@dataclass(frozen=True)
class CommandResult:
    """The exit code and the output of a command."""

    code: int
    out: str
    err: str

    @property
    def json(self) -> Any:
        """The line of JSON on stdout."""
        (line,) = self.out.splitlines()
        return json.loads(line)


Scope = Callable[..., CommandResult]


@pytest.fixture(scope="session")
def scenes(analytic_folder: Path) -> Path:
    """A folder with the analytic scene. Tests must not change it."""
    return analytic_folder.parent


@pytest.fixture
def scope(scenes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Scope:
    """Run ``scope`` with arguments; run folders go to ``tmp_path/runs``."""
    monkeypatch.setenv("SCOPE_SCENES_DIR", str(scenes))
    monkeypatch.setenv("SCOPE_RUNS_DIR", str(tmp_path / "runs"))
    monkeypatch.setenv("COLUMNS", "200")

    def run(*arguments: str) -> CommandResult:
        monkeypatch.setattr("sys.argv", ["scope", *arguments])
        capsys.readouterr()
        with pytest.raises(SystemExit) as excinfo:
            main()
        code = excinfo.value.code
        assert code is None or isinstance(code, int)
        return CommandResult(code or 0, *capsys.readouterr())

    return run


@pytest.fixture
def served_camera(analytic_scene: Scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[ServedCamera]:
    """A virtual camera on this machine. Its password is in the environment."""
    monkeypatch.setenv("SCOPE_CAMERA_PASSWORD", PASSWORD)
    monkeypatch.setenv("SCOPE_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setenv("SCOPE_CAMERA_PROFILES_DIR", str(tmp_path / "profiles"))
    with serve_camera(analytic_scene) as camera:
        yield camera
