"""Unavailable servers are reported at the end of an evaluation, with their addresses and advice."""

from __future__ import annotations

from pathlib import Path

import pytest
from rich.console import Console

from scope_ptz.bench.engine.failure_summary import failure_summary
from scope_ptz.bench.scoring.trials import Evaluation
from scope_ptz.bench.tasks.files import dump_tasks
from scope_ptz.cli.bench.run import sweep_tables
from tests.bench.engine.yard_tasks import TASKS, turning_tasks
from tests.bench.reports.sample_evaluations import card, facts, trial
from tests.cli.conftest import Scope

UNREACHABLE_URL = "http://127.0.0.1:1/v1"


def evaluation_with_failures() -> Evaluation:
    """Return six trials: three failures of the planner's server, two failures of perception, and one correct run."""
    run_card = card("qwen3-4b", "moondream2")
    run_card = run_card.model_copy(
        update={
            "planner": run_card.planner.model_copy(update={"provider": "http://10.0.0.7/v1"}),
            "perception": run_card.perception.model_copy(update={"provider": "http://10.0.0.8/v1"}),
        }
    )
    tasks = facts(1)
    broken = [
        trial(task, "infrastructure", reason=f"the planner's server failed: {kind}", outcome="planner_error")
        for task, kind in zip(tasks, ("refused", "circuit-open", "circuit-open"), strict=False)
    ]
    events = {"refused": 1, "circuit-open": 3}
    without_perception = [trial(task, "incorrect", perception_failures=2, server_events=events) for task in tasks[3:5]]
    rows = (*broken, *without_perception, trial(tasks[5]))
    return Evaluation(card=run_card, trials=rows, wanted=len(rows))


def test_server_failures_are_reported_with_address_and_advice() -> None:
    evaluation = evaluation_with_failures()
    planner, perception = failure_summary(evaluation.trials, evaluation.card)
    assert planner == (
        "3 of 6 runs broken: the planner's server failed (circuit-open 2, refused 1). The model server at http://10.0.0.7/v1 "
        "cannot be reached. Start it, or check its URL."
    )
    assert perception == (
        "4 perception calls failed in 2 of 6 runs, which were scored nevertheless (circuit-open 6, refused 2). The model server at "
        "http://10.0.0.8/v1 cannot be reached. Start it, or check its URL."
    )
    assert failure_summary(evaluation.trials[5:], evaluation.card) == []
    console = Console(width=400)
    with console.capture() as output:
        for table in sweep_tables({"qwen3-4b+moondream2": evaluation}, console):
            console.print(table)
    assert "Server failures" in output.get() and planner in output.get() and perception in output.get()


@pytest.mark.full
def test_unavailable_perception_is_reported_by_the_command(scope: Scope, tmp_path: Path) -> None:
    dump_tasks(TASKS, tmp_path / "tasks.jsonl")
    run = (
        "bench",
        "run",
        "--tasks",
        str(tmp_path / "tasks.jsonl"),
        "--perception",
        "moondream2",
        "--perception-url",
        UNREACHABLE_URL,
    )
    result = scope(*run, "--out", str(tmp_path / "logs"))
    assert f"The model server at {UNREACHABLE_URL} cannot be reached. Start it, or check its URL." in result.err
    assert "servers    failed:" in result.out and "refused" in result.out
    second = scope(*run, "--out", str(tmp_path / "logs"), "--json").json
    assert second["server_events"]["refused"] and any(UNREACHABLE_URL in line for line in second["failure_summary"])


@pytest.mark.full
def test_a_sweep_reports_unavailable_servers(scope: Scope, tmp_path: Path) -> None:
    dump_tasks(turning_tasks(1), tmp_path / "tasks.jsonl")
    options = (
        "--tasks",
        str(tmp_path / "tasks.jsonl"),
        "--out",
        str(tmp_path / "logs"),
        "--planner-url",
        UNREACHABLE_URL,
        "--perception-url",
        UNREACHABLE_URL,
    )
    single = scope("bench", "run", "--pair", "qwen3-4b+moondream2", *options)
    assert single.code == 1 and "1 run failed because of infrastructure; running the same command again repeats it." in single.err
    result = scope("bench", "sweep", "--pairs", "qwen3-4b+moondream2", *options)
    assert result.code == 1
    assert "1 of 1 run broken: the planner's server failed" in result.err and UNREACHABLE_URL in result.err
    assert "Server failures" in result.out
