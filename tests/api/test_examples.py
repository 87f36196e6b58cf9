"""The programs in ``examples/`` and the notebook run and print the expected output."""

from __future__ import annotations

import json
import re
import runpy
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

EXAMPLES = Path(__file__).parents[2] / "examples"
EXPECTED = {
    "ask.py": "I can see 7 cones after two pans of 15 degrees to the right.",
    "batch_over_views.py": "Most workers are in view at 'overview'.",
    "evaluate.py": "Why runs of the grammar failed:",
    "own_camera.py": "Contract violations: none",
    "own_perception.py": "Contract violations: none",
    "own_planner.py": "Most cars are at bridge-south: 8.",
    "train_search.py": "score before and after training:",
}
ARGUMENTS = {
    "train_search.py": ["--minutes", "0", "--population", "2", "--episodes", "1", "--held-out", "1"],
}
FUNCTION_CALLING = ("function_calling_chat.py", "function_calling_responses.py", "pydantic_ai_agent.py")
"""Programs that need a model server: see ``test_function_calling_examples.py``."""
HOSTED = ("hosted_agent.py", "hosted_agent_mcp.py")
"""Programs that connect to a hosted evaluation: see ``tests/full/test_hosting_recipe.py``."""

SLOW = {"ask.py", "evaluate.py", "batch_over_views.py", "own_planner.py", "train_search.py"}  # 1 to 10 s each


def test_every_example_is_run() -> None:
    assert {path.name for path in EXAMPLES.glob("*.py")} == {*EXPECTED, *FUNCTION_CALLING, *HOSTED}


@pytest.mark.usefixtures("scenes_cache")
@pytest.mark.parametrize("name", [pytest.param(name, marks=[pytest.mark.full] if name in SLOW else []) for name in EXPECTED])
def test_programs(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sys.argv", [name, *ARGUMENTS.get(name, [])])
    runpy.run_path(str(EXAMPLES / name), run_name="__main__")
    assert EXPECTED[name] in capsys.readouterr().out


@pytest.mark.usefixtures("scenes_cache")
def test_the_program_on_the_page_about_function_calling(capsys: pytest.CaptureFixture[str]) -> None:
    page = (EXAMPLES.parent / "docs" / "how-to" / "function-calling.md").read_text(encoding="utf-8")
    (program,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    exec(compile(program, "function-calling.md", "exec"), {})  # noqa: S102 - our own documentation
    text, count = capsys.readouterr().out.splitlines()
    assert json.loads(text)["count"] == int(count) == 7


@pytest.mark.full
def test_the_notebook(tmp_path: Path) -> None:
    notebook = nbformat.read(EXAMPLES / "tutorial.ipynb", as_version=4)  # type: ignore[no-untyped-call]
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert not any(cell.outputs for cell in cells), "outputs must not be stored: the documentation runs the notebook"
    NotebookClient(notebook, timeout=300, kernel_name="python3", resources={"metadata": {"path": str(tmp_path)}}).execute()
    outputs = [output.data for cell in cells for output in cell.outputs if output.output_type == "execute_result"]
    pictures = [data["text/html"] for data in outputs if "data:image/jpeg" in data.get("text/html", "")]
    assert len(pictures) == 3  # the scene, the run, and the frame
