"""``scope bench report`` from the command line."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from scope_ptz.bench.engine import logs
from scope_ptz.bench.scoring.trials import Evaluation
from scope_ptz.cli.app import app
from tests.bench.reports.sample_evaluations import evaluation, facts


def test_the_command_writes_everything(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    evaluations = {name: evaluation(name, "moondream2", facts(2), 0.6) for name in ("qwen3-4b", "qwen3-30b-a3b")}

    def read(path: Path, progress: object) -> Evaluation:
        assert callable(progress)
        return evaluations[path.stem]

    monkeypatch.setattr(logs, "read_evaluation", read)
    files = [str(tmp_path / f"{name}.eval") for name in evaluations]
    out = tmp_path / "report"
    result = CliRunner().invoke(app, ["bench", "report", *files, files[0], "--out", str(out), "--no-pages"])
    assert result.exit_code == 0, result.output
    assert "2 runs with 32 trials" in result.stdout and str(out / "index.html") in result.stdout
    assert (out / "report.md").is_file() and (out / "tables" / "accuracy.csv").is_file()
    assert not list((out / "tasks").iterdir()) and "Each has a page" not in (out / "report.md").read_text("utf-8")
    second = CliRunner().invoke(app, ["bench", "report", *files, "--out", str(tmp_path), "--no-pages"])
    assert second.exit_code == 2 and "contains no report" in second.stderr


def test_a_file_that_is_not_a_log_is_reported(tmp_path: Path) -> None:
    path = tmp_path / "x.eval"
    path.write_text("nothing")
    for log, message in ((path, "damaged"), (tmp_path / "none.eval", "does not exist")):
        result = CliRunner().invoke(app, ["bench", "report", str(log), "--out", str(tmp_path / "r")])
        assert result.exit_code == 2 and message in result.stderr, result.output


def test_a_human_result_is_a_baseline(tmp_path: Path) -> None:
    human = evaluation("ann", "ann", facts(2), 0.9, judged=False)
    person = human.card.planner.model_copy(update={"provider": "person", "registry": None})
    card = human.card.model_copy(update={"planner": person, "perception": person})
    path = tmp_path / "evaluation.json"
    path.write_text(human.model_copy(update={"card": card}).model_dump_json(), "utf-8")
    result = CliRunner().invoke(app, ["bench", "report", str(path), "--out", str(tmp_path / "report")])
    assert result.exit_code == 0 and "nothing is ranked" in result.stdout
    assert (tmp_path / "report" / "tables" / "baselines.csv").read_text().splitlines()[1].startswith("person ann,a person")
