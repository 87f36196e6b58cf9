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

from scope_ptz.cli.startup import prepare_help
from tests.cli.conftest import SCENE, Scope
from tests.support.programs import started

SCOPE = [sys.executable, "-m", "scope_ptz.cli"]


# What `scope --help` needs: the command parser and what draws its pages, nothing that does work.
LIGHT = {"typer", "click", "shellingham", "rich", "pygments", "markdown_it", "linkify_it", "mdurl", "uc_micro", "attr"}
LIGHT |= {"annotated_doc", "typing_extensions", "scope_ptz"}


def modules_of(*words: str, folder: Path) -> set[str]:
    """Return the names of the modules that a command loads, beyond those of a bare Python."""
    loaded = "import sys; from scope_ptz.cli import main\ntry: main()\nfinally: print(*sys.modules, file=sys.stderr)"
    done = subprocess.run([sys.executable, "-c", loaded, *words], capture_output=True, text=True, check=True, cwd=folder)
    bare = subprocess.run([sys.executable, "-c", "import sys; print(*sys.modules)"], capture_output=True, text=True, check=True)
    assert done.stdout
    return set(done.stderr.split()) - set(bare.stdout.split())


def packages_of(modules: set[str]) -> set[str]:
    names = {name.partition(".")[0] for name in modules} - sys.stdlib_module_names
    return {name for name in names if not name.startswith("_sysconfigdata")}


def test_help_loads_only_what_draws_help(tmp_path: Path) -> None:
    """This is what makes it instant; how long it takes depends on the machine, and is not for a test."""
    modules = modules_of("--help", folder=tmp_path)
    assert packages_of(modules) <= LIGHT
    assert not modules & {"rich.markdown", "markdown_it", "rich.traceback", "pygments.lexer"}
    ours = [name for name in modules if name.startswith("scope_ptz")]
    assert "scope_ptz.cli.app" in ours
    assert len(ours) <= 31


def test_what_help_leaves_out_is_imported_on_first_use(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [name for name in sys.modules if name.startswith(("typer.rich_utils", "rich.markdown", "rich.traceback"))]:
        monkeypatch.delitem(sys.modules, name)
    prepare_help(["ask", "pan right 5"])
    assert "typer.rich_utils" not in sys.modules
    prepare_help(["ask", "--help"])
    assert not {"rich.markdown", "rich.traceback"} & set(sys.modules)
    made = sys.modules["typer.rich_utils"].Markdown("*text*")
    assert type(made) is sys.modules["rich.markdown"].Markdown
    monkeypatch.delitem(sys.modules, "typer.rich_utils")


def test_tools_loads_the_shipped_schemas_and_no_models(tmp_path: Path) -> None:
    modules = modules_of("tools", folder=tmp_path)
    assert packages_of(modules) <= LIGHT - {"rich", "pygments", "markdown_it"}
    assert "scope_ptz.tools.registry" not in modules


def test_plan_loads_no_models_no_images_and_no_grammar_compiler(tmp_path: Path) -> None:
    modules = modules_of("plan", "pan right 5, then count the cars", folder=tmp_path)
    assert packages_of(modules) <= LIGHT
    assert not modules & {"scope_ptz.planner.base", "scope_ptz.agent.records", "scope_ptz.tools.registry", "scope_ptz.cli.display"}


def test_a_run_that_asks_nothing_loads_no_language_of_perception(
    scenes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SCOPE_SCENES_DIR", str(scenes))
    modules = modules_of("ask", "pan right 5", "--scene", SCENE, folder=tmp_path)
    assert packages_of(modules) <= LIGHT | {
        "PIL", "annotated_types", "anyio", "cv2", "idna", "numpy", "platformdirs", "pydantic", "pydantic_core", "sniffio",
        "typing_inspection",
    }  # fmt: skip
    assert not {name for name in modules if name.startswith("scope_ptz.perception.ground_truth.language")}
    assert "PIL.PdfImagePlugin" not in modules


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

    with started(command, env=environment, preexec_fn=hear, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
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
