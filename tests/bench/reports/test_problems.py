"""A report states failed and unfinished evaluations and lost trials at the top, with bounds."""

from __future__ import annotations

import json
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile

import pytest

from scope_ptz.bench.engine.logs import read_evaluation
from scope_ptz.bench.reports.assemble import EvaluationReport, build_report
from scope_ptz.bench.reports.terminal import terminal_lines
from scope_ptz.bench.reports.writer import render_html, render_markdown
from scope_ptz.bench.scoring.trials import Evaluation
from scope_ptz.registry import load_registry
from tests.bench.reports.sample_evaluations import card, facts, trial

TASKS = facts(20)  # 160 tasks, 20 of each category
LOG = Path(__file__).parents[2] / "frozen" / "v0_1_0" / "logs" / "truth.eval"


def run(lost: int, incorrect: int = 40, cut: int = 0, failure: str = "") -> Evaluation:
    """Return an evaluation: the first trials of each category are lost, the next incorrect, and the last ``cut`` missing."""
    headlines = ["infrastructure"] * lost + ["incorrect"] * incorrect + ["correct"] * (160 - lost - incorrect)
    order = sorted(range(160), key=lambda n: (n % 20, n // 20))
    by_task = {TASKS[n].id: headline for n, headline in zip(order, headlines, strict=True)}
    trials = tuple(trial(t, by_task[t.id]) for t in TASKS)[: 160 - cut]
    return Evaluation(card=card("qwen3-4b", "moondream2"), trials=trials, wanted=160, failure=failure)


def build(evaluation: Evaluation) -> EvaluationReport:
    return build_report([evaluation], load_registry())


def test_few_lost_trials_are_no_problem() -> None:
    assert build(run(3)).problems == ()
    assert "Incomplete evaluations" not in render_html(build(run(3)))


def test_many_lost_trials_are_stated_with_bounds() -> None:
    (line,) = build(run(8)).problems
    # One of 20 trials of each category was lost, 5 were incorrect, and 14 were correct.
    assert line.startswith("qwen3-4b + moondream2: 8 of 160 trials (5.0%) were lost to infrastructure failures.")
    assert (
        f"Macro accuracy is {100 * 14 / 19:.1f}% without the lost and missing trials, 70.0% if all of them were incorrect" in line
    )
    assert "and 75.0% if all of them were correct." in line


def test_an_error_and_missing_trials_are_stated_with_bounds() -> None:
    (line,) = build(run(0, cut=16, failure="Server\n  gone " + 300 * "x")).problems
    assert "the log ended in an error (Server gone xxx" in line and "…)" in line and len(line) < 600
    assert "it is unfinished: 144 of 160 trials were run" in line
    correct = sum(t.headline == "correct" for t in run(0, cut=16).trials)
    assert f"Micro accuracy is {100 * correct / 144:.1f}% without the lost and missing trials" in line
    assert f"{100 * correct / 160:.1f}% if all of them were incorrect, and {100 * (correct + 16) / 160:.1f}%" in line
    (line,) = build(run(0, failure="late")).problems
    assert line == "qwen3-4b + moondream2: the log ended in an error (late). No trials were lost."


def test_problems_come_before_everything_else() -> None:
    report = build(run(8))
    (line,) = report.problems
    page, text = render_html(report), render_markdown(report)
    assert page.index("Incomplete evaluations") < page.index('id="choice"')
    assert text.index("lost to infrastructure") < text.index("Which pair to choose")
    assert next(iter(terminal_lines(report))) == line


def test_a_run_in_which_everything_was_lost() -> None:
    (line,) = build(run(160, incorrect=0)).problems
    assert line.endswith("No trial can be scored, so the accuracy is unknown (0.0% to 100.0%).")


@pytest.mark.parametrize(("status", "error", "failure"), [
    ("error", {"message": "the server ended", "traceback": "t", "traceback_ansi": "t"}, "the server ended"),
    ("error", None, "some of its runs failed"),
    ("success", None, ""),
])  # fmt: skip
def test_the_error_of_a_log_is_read(status: str, error: dict[str, str] | None, failure: str, tmp_path: Path) -> None:
    log = tmp_path / "log.eval"
    with ZipFile(LOG) as old, ZipFile(log, "w", ZIP_DEFLATED) as new:
        for info in old.infolist():
            content = old.read(info)
            if info.filename == "header.json":
                header = json.loads(content) | {"status": status}
                header.pop("error", None)
                content = json.dumps(header | ({"error": error} if error else {})).encode()
            new.writestr(info.filename, content)
    evaluation = read_evaluation(log)
    assert evaluation.failure == failure and ("failure" in evaluation.model_dump()) is bool(failure)
    assert bool([line for line in build(evaluation).problems if failure and failure in line]) is bool(failure)
