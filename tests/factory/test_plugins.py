"""Commands list, check and use plug-ins from separately installed packages, including broken ones."""

from __future__ import annotations

import io
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

import scope_ptz
from scope_ptz.cli import main
from tests.cli.conftest import CommandResult

SOURCES = Path(scope_ptz.__file__).parents[1]
PLUGINS = Path(__file__).parents[1] / "plugins"
EXAMPLES = ("scope-still-camera", "scope-nudge-planner", "scope-bright-perception")


@pytest.fixture(scope="module")
def plugin_site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with the three example packages, built and installed offline with the build backend of uv."""
    uv = shutil.which("uv") or shutil.which("uv", path=str(Path(sys.executable).parent))
    assert uv is not None, "uv is missing; `make test` installs it"
    sources = tmp_path_factory.mktemp("sources") / "plugins"
    shutil.copytree(PLUGINS, sources, ignore=shutil.ignore_patterns("__pycache__"))
    target = tmp_path_factory.mktemp("site")
    paths = [str(sources / name) for name in EXAMPLES]
    install = [uv, "pip", "install", "--quiet", "--offline", "--no-deps", "--target", str(target), "--python", sys.executable]
    subprocess.run([*install, *paths], check=True, capture_output=True, text=True)
    return target


def separate_process(site: Path, folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run a command in a separate process that can import the packages in ``site``."""
    paths = [str(site), *filter(None, [os.environ.get("PYTHONPATH")])]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(paths), "SCOPE_RUNS_DIR": str(folder), "COLUMNS": "200"}
    command = [sys.executable, "-m", "scope_ptz.cli", *arguments]
    return subprocess.run(command, env=environment, capture_output=True, text=True, cwd=folder, check=False, timeout=300)


Scope = Callable[..., CommandResult]


@pytest.fixture
def scope(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Iterator[Scope]:
    """Return a function that runs a command in this process, with the packages in ``site`` importable during the test."""
    monkeypatch.setenv("SCOPE_RUNS_DIR", str(tmp_path))
    monkeypatch.setenv("COLUMNS", "200")
    monkeypatch.chdir(tmp_path)
    before = set(sys.modules)

    def run(site: Path, *arguments: str, stdin: str = "") -> CommandResult:
        if str(site) not in sys.path:
            monkeypatch.syspath_prepend(site)
        monkeypatch.setattr("sys.argv", ["scope", *arguments])
        monkeypatch.setattr("sys.stdin", io.StringIO(stdin))
        capsys.readouterr()
        with pytest.raises(SystemExit) as excinfo:
            main()
        code = excinfo.value.code
        assert code is None or isinstance(code, int)
        return CommandResult(code or 0, *capsys.readouterr())

    yield run
    for name in set(sys.modules) - before:
        path = getattr(sys.modules[name], "__file__", None) or ""
        if not path.startswith((sys.prefix, sys.base_prefix, str(SOURCES))):
            del sys.modules[name]  # a plug-in


def write_package(site: Path, module: str, code: str, group: str, name: str, target: str | None = None) -> None:
    """Write a package with one module to a folder, as an installer would."""
    (site / f"{module}.py").write_text(code)
    info = site / f"{module}-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {module}\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(f"[scope_ptz.{group}]\n{name} = {target or f'{module}:make'}\n")


def test_plugins_are_listed(scope: Scope, plugin_site: Path) -> None:
    run_result = scope(plugin_site, "models", "plugins", "--json")
    listed = {(row["kind"], row["name"], row["package"], row["problem"]) for row in json.loads(run_result.out)}
    assert listed == {
        ("camera", "still", "scope-still-camera 1.0", ""),
        ("planner", "nudge", "scope-nudge-planner 1.0", ""),
        ("perception", "bright", "scope-bright-perception 1.0", ""),
    }
    models = scope(plugin_site, "models").out
    assert "nudge (scope-nudge-planner 1.0)" in models
    assert "bright (scope-bright-perception 1.0)" in models


@pytest.mark.full
def test_doctor_checks_plugins(scope: Scope, plugin_site: Path) -> None:
    run_result = scope(plugin_site, "doctor", "--json")
    findings = {finding["what"]: finding for finding in json.loads(run_result.out)}
    assert findings["camera still"]["verdict"] == "ok"
    assert findings["camera still"]["detail"].endswith("still camera, 320 x 180")
    assert findings["planner nudge"]["verdict"] == "ok"
    assert findings["perception bright"]["verdict"] == "ok"
    assert findings["perception bright"]["detail"].endswith("skills: detect")


def test_ask_uses_all_three_plugins(plugin_site: Path, tmp_path: Path) -> None:
    run_result = separate_process(
        plugin_site, tmp_path, "ask", "look for the lamp", "--camera", "still:lamp", "--planner", "nudge", "--planner-option",
        "pan_deg=20", "--perception", "bright", "--json",
    )  # fmt: skip
    assert run_result.returncode == 0, run_result.stderr
    run = json.loads(run_result.stdout)
    assert run["answer"] == "Nudged. 1 of 'lamp' in the current view (seen by bright)."
    assert run["pose"]["pan_deg"] == 20.0


def test_chat_uses_a_camera_of_a_plugin(scope: Scope, plugin_site: Path) -> None:
    run_result = scope(
        plugin_site, "chat", "--camera", "still:lamp", "--perception", "bright", stdin="pan right 10\n/pose\n/quit\n"
    )
    assert run_result.code == 0, run_result.err
    assert "pan 10°" in run_result.out


@pytest.mark.full
def test_a_benchmark_runs_with_a_planner_and_perception_of_plugins(plugin_site: Path, tmp_path: Path) -> None:
    run_result = separate_process(
        plugin_site,
        tmp_path,
        "bench",
        "run",
        "--limit",
        "2",
        "--planner",
        "nudge",
        "--perception",
        "bright",
        "--out",
        "logs",
        "--json",
    )
    assert run_result.returncode == 0, run_result.stderr
    result: dict[str, Any] = json.loads(run_result.stdout)
    assert result["pair"] == "nudge + bright"
    assert result["runs"] == 2


def test_ground_truth_is_refused_for_a_camera_without_it(scope: Scope, plugin_site: Path) -> None:
    run_result = scope(plugin_site, "ask", "pan right 10", "--camera", "still:lamp", "--perception", "ground-truth")
    assert run_result.code == 2
    assert "this camera has none. Choose a vision model with --perception" in run_result.err


def test_a_camera_without_ground_truth_moves_without_perception(scope: Scope, plugin_site: Path) -> None:
    run_result = scope(plugin_site, "ask", "pan right 10", "--camera", "still:lamp")
    assert run_result.code == 0, run_result.err
    assert "perception none" in run_result.out
    run_result = scope(plugin_site, "ask", "how many cones are there?", "--camera", "still:lamp")
    assert "Name a vision model with --perception" in " ".join(run_result.out.split())


def test_a_camera_that_does_not_open_gives_one_line(scope: Scope, plugin_site: Path) -> None:
    run_result = scope(plugin_site, "ask", "pan right 10", "--camera", "still:candle", "--perception", "bright")
    assert run_result.code == 1
    assert run_result.err == "scope: There is no still camera 'candle'. Known: lamp.\n"


BROKEN = {
    "import error": ("import no_such_package", "cannot be loaded: ModuleNotFoundError"),
    "syntax error": ("def make(:", "cannot be loaded: SyntaxError"),
    "no factory": ("make = 3", "but that is not callable: it is of type int"),
    "wrong product": (
        "def make(spec):\n    return 'camera'",
        "returned an object of type str; it must be an instance of scope_ptz.camera.base.Camera",
    ),
    "crash": ("def make(spec):\n    raise RuntimeError('no\\nlight')", "failed: RuntimeError: no light"),
}


@pytest.mark.parametrize("case", BROKEN)
def test_a_broken_plugin_gives_one_line_and_breaks_nothing_else(scope: Scope, case: str, tmp_path: Path) -> None:
    code, message = BROKEN[case]
    site = tmp_path / "site"
    site.mkdir()
    write_package(site, "third_party_camera", f"{code}\n", "cameras", "odd")
    run_result = scope(site, "ask", "pan right 5", "--camera", "odd:x")
    assert run_result.code == 2
    assert message in run_result.err
    assert run_result.err.count("\n") == 1
    assert scope(site, "models", "plugins").code == 0


@pytest.mark.full
def test_doctor_reports_broken_plugins(scope: Scope, tmp_path: Path) -> None:
    site = tmp_path / "site"
    site.mkdir()
    write_package(site, "third_party_camera", "import no_such_package\n", "cameras", "odd")
    write_package(site, "third_party_planner", "def make(spec):\n    return object()\n", "planners", "strange")
    write_package(site, "third_party_perception", "make = 1\n", "perception", "blurred")
    write_package(site, "third_party_grammar", "make = print\n", "planners", "grammar")
    write_package(site, "third_party_ocr", "make = print\n", "perception", "ocr")
    run_result = scope(site, "doctor", "--json")
    assert run_result.code == 1
    findings = {finding["what"]: finding for finding in json.loads(run_result.out)}
    assert {findings[name]["verdict"] for name in ("camera odd", "perception blurred", "planner grammar", "perception ocr")} == {
        "missing"
    }
    assert "ModuleNotFoundError" in findings["camera odd"]["detail"]
    assert "it must be an instance of scope_ptz.planner.base.Planner" in findings["planner strange"]["detail"]
    assert "a built-in planner has the same name and is used instead" in findings["planner grammar"]["detail"]
    assert all("\n" not in finding["detail"] for finding in findings.values())


def test_a_plugin_cannot_replace_a_built_in_name(scope: Scope, tmp_path: Path) -> None:
    site = tmp_path / "site"
    site.mkdir()
    write_package(site, "third_party_grammar", "import no_such_package\n", "planners", "grammar")
    write_package(site, "third_party_sim", "import no_such_package\n", "cameras", "sim")
    run_result = scope(site, "ask", "pan right 5", "--camera", "sim:highway-works", "--planner", "grammar", "--json")
    assert run_result.code == 0, run_result.err


def test_two_packages_with_the_same_plugin_name(scope: Scope, tmp_path: Path) -> None:
    site = tmp_path / "site"
    site.mkdir()
    write_package(site, "first_camera", "make = print\n", "cameras", "odd")
    write_package(site, "second_camera", "make = print\n", "cameras", "odd")
    run_result = scope(site, "ask", "pan right 5", "--camera", "odd:x")
    assert run_result.code == 2
    assert "Several packages provide 'odd': first_camera 1.0 and second_camera 1.0" in run_result.err
