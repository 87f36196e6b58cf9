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

from scope_ptz.cli import prepare_help
from tests.cli.conftest import SCENE, Scope
from tests.support.programs import start_program

SCOPE = [sys.executable, "-m", "scope_ptz.cli"]


# Packages that `scope --help` may load: the command parser and the libraries that render help.
LIGHT = {"typer", "click", "shellingham", "rich", "pygments", "markdown_it", "linkify_it", "mdurl", "uc_micro", "attr"}
LIGHT |= {"annotated_doc", "typing_extensions", "scope_ptz"}


def modules_of(*arguments: str, folder: Path) -> set[str]:
    """Return the names of the modules that a command loads, beyond those of a bare Python."""
    program = "import sys; from scope_ptz.cli import main\ntry: main()\nfinally: print(*sys.modules, file=sys.stderr)"
    result = subprocess.run([sys.executable, "-c", program, *arguments], capture_output=True, text=True, check=True, cwd=folder)
    bare = subprocess.run([sys.executable, "-c", "import sys; print(*sys.modules)"], capture_output=True, text=True, check=True)
    assert result.stdout
    return set(result.stderr.split()) - set(bare.stdout.split())


def packages_of(modules: set[str]) -> set[str]:
    names = {name.partition(".")[0] for name in modules} - sys.stdlib_module_names
    return {name for name in names if not name.startswith("_sysconfigdata")}


def test_help_loads_only_what_it_needs(tmp_path: Path) -> None:
    """Few imports make help fast. Its duration depends on the machine, so it is not tested."""
    modules = modules_of("--help", folder=tmp_path)
    assert packages_of(modules) <= LIGHT
    assert not modules & {"rich.markdown", "markdown_it", "rich.traceback", "pygments.lexer"}
    own_modules = [name for name in modules if name.startswith("scope_ptz")]
    assert "scope_ptz.cli.app" in own_modules
    assert len(own_modules) <= 31


def test_modules_that_help_skips_are_imported_on_first_use(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [name for name in sys.modules if name.startswith(("typer.rich_utils", "rich.markdown", "rich.traceback"))]:
        monkeypatch.delitem(sys.modules, name)
    prepare_help(["ask", "pan right 5"])
    assert "typer.rich_utils" not in sys.modules
    prepare_help(["ask", "--help"])
    assert not {"rich.markdown", "rich.traceback"} & set(sys.modules)
    markdown = sys.modules["typer.rich_utils"].Markdown("*text*")
    assert type(markdown) is sys.modules["rich.markdown"].Markdown
    monkeypatch.delitem(sys.modules, "typer.rich_utils")


def test_tools_loads_the_bundled_schemas_and_no_models(tmp_path: Path) -> None:
    modules = modules_of("tools", folder=tmp_path)
    assert packages_of(modules) <= LIGHT - {"rich", "pygments", "markdown_it"}
    assert "scope_ptz.tools.registry" not in modules


def test_plan_loads_no_models_no_images_and_no_grammar_compiler(tmp_path: Path) -> None:
    modules = modules_of("plan", "pan right 5, then count the cars", folder=tmp_path)
    assert packages_of(modules) <= LIGHT
    assert not modules & {"scope_ptz.planner.base", "scope_ptz.agent.records", "scope_ptz.tools.registry", "scope_ptz.cli.ask"}


@pytest.mark.full
def test_a_run_without_perception_calls_loads_no_ground_truth_answers(
    scenes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SCOPE_SCENES_DIR", str(scenes))
    modules = modules_of("ask", "pan right 5", "--scene", SCENE, folder=tmp_path)
    assert packages_of(modules) <= LIGHT | {
        "PIL", "annotated_types", "anyio", "cv2", "idna", "numpy", "platformdirs", "pydantic", "pydantic_core", "sniffio",
        "typing_inspection",
    }  # fmt: skip
    answering = ("scope_ptz.english.grammar.questions.question_builder", "scope_ptz.perception.ground_truth.answers")
    assert not {name for name in modules if name.startswith(answering)}
    assert "PIL.PdfImagePlugin" not in modules


def test_the_entry_point_is_installed() -> None:
    from importlib.metadata import entry_points

    (entry,) = entry_points(group="console_scripts", name="scope")
    assert entry.value == "scope_ptz.cli:main"


def test_version(scope: Scope) -> None:
    from scope_ptz.version import __version__

    result = scope("--version")
    assert (result.code, result.out) == (0, f"scope-ptz {__version__}\n")


@pytest.mark.skipif(os.name == "nt", reason="requires POSIX signals")
def test_ctrl_c_ends_a_run_cleanly(scenes: Path, tmp_path: Path) -> None:
    environment = {**os.environ, "SCOPE_SCENES_DIR": str(scenes), "SCOPE_RUNS_DIR": str(tmp_path)}
    command = [*SCOPE, "ask", "count the zebras in the whole scene", "--scene", SCENE, "--realtime", "--json"]

    def enable_sigint() -> None:
        """Enable Ctrl-C in the child process: background processes ignore it, and their children inherit that."""
        signal.signal(signal.SIGINT, signal.default_int_handler)

    with start_program(
        command, env=environment, preexec_fn=enable_sigint, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:
        deadline = time.monotonic() + 30
        while not (list(tmp_path.glob("*/trace.jsonl")) and next(tmp_path.glob("*/trace.jsonl")).read_text().count("\n") >= 2):
            assert time.monotonic() < deadline, "the run did not start"
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=30)
    assert process.returncode == 130
    assert "Traceback" not in err
    assert json.loads(out)["outcome"] == "cancelled"
    records = [json.loads(line) for line in next(tmp_path.glob("*/trace.jsonl")).read_text().splitlines()]
    assert (records[-1]["event"], records[-1]["outcome"]) == ("end", "cancelled")


@pytest.mark.skipif(os.name == "nt", reason="requires POSIX pipes")
@pytest.mark.parametrize(
    ("command", "code"),
    [
        (["tools"], 0),
        (["scene", "list"], 0),
        (["bench", "submission", "validate", "invalid.jsonl"], 1),  # short output
        (["bench", "submission", "validate", "invalid.jsonl", "--json"], 1),  # more than the pipe's buffer
        (["bench", "submission", "validate", "missing.jsonl", "--json"], 2),
    ],
)
def test_a_closed_output_pipe_changes_no_exit_code(command: list[str], code: int, tmp_path: Path) -> None:
    (tmp_path / "invalid.jsonl").write_text("no JSON\n" * 2000)
    reader, writer = os.pipe()
    os.close(reader)
    try:
        result = subprocess.run([*SCOPE, *command], stdout=writer, stderr=subprocess.PIPE, text=True, cwd=tmp_path, check=False)
    finally:
        os.close(writer)
    assert result.returncode == code
    assert "Traceback" not in result.stderr and "BrokenPipe" not in result.stderr
