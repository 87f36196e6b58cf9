"""Unavailable servers are reported at the end of an evaluation, with their addresses and advice."""

from __future__ import annotations

from pathlib import Path

import pytest
from rich.console import Console

from scope_ptz.bench.engine.failure_summary import failure_summary
from scope_ptz.bench.scoring.trials import Evaluation
from scope_ptz.bench.tasks.files import dump_tasks
from scope_ptz.cli.bench.sweep import sweep_tables
from tests.bench.engine.making import TASKS, many
from tests.bench.reports.making import card, facts, trial
from tests.cli.conftest import Scope

AWAY = "http://127.0.0.1:1/v1"


def made() -> Evaluation:
    """Six trials: three failures of the planner's server, two failures of perception, and one correct run."""
    about = card("qwen3-4b", "moondream2")
    about = about.model_copy(
        update={
            "planner": about.planner.model_copy(update={"provider": "http://10.0.0.7/v1"}),
            "perception": about.perception.model_copy(update={"provider": "http://10.0.0.8/v1"}),
        }
    )
    tasks = facts(1)
    broken = [
        trial(task, "infrastructure", reason=f"the planner's server failed: {kind}", outcome="planner_error")
        for task, kind in zip(tasks, ("refused", "circuit-open", "circuit-open"), strict=False)
    ]
    events = {"refused": 1, "circuit-open": 3}
    blind = [trial(task, "incorrect", perception_failures=2, server_events=events) for task in tasks[3:5]]
    rows = (*broken, *blind, trial(tasks[5]))
    return Evaluation(card=about, trials=rows, wanted=len(rows))


def test_server_failures_are_reported_with_address_and_advice() -> None:
    evaluation = made()
    planner, eyes = failure_summary(evaluation.trials, evaluation.card)
    assert planner == (
        "3 of 6 runs broken: the planner's server failed (circuit-open 2, refused 1). The model server at http://10.0.0.7/v1 "
        "cannot be reached. Start it, or check the address."
    )
    assert eyes == (
        "4 perception calls failed in 2 of 6 runs, which were scored nevertheless (circuit-open 6, refused 2). The model server at "
        "http://10.0.0.8/v1 cannot be reached. Start it, or check the address."
    )
    assert failure_summary(evaluation.trials[5:], evaluation.card) == []
    console = Console(width=400)
    with console.capture() as told:
        for table in sweep_tables({"qwen3-4b+moondream2": evaluation}, 400):
            console.print(table)
    assert "Server failures" in told.get() and planner in told.get() and eyes in told.get()


def test_unavailable_perception_is_reported_by_the_command(scope: Scope, tmp_path: Path) -> None:
    dump_tasks(TASKS, tmp_path / "tasks.jsonl")
    run = ("bench", "run", "--tasks", str(tmp_path / "tasks.jsonl"), "--perception", "moondream2", "--perception-url", AWAY)
    done = scope(*run, "--out", str(tmp_path / "logs"))
    assert f"The model server at {AWAY} cannot be reached. Start it, or check the address." in done.err
    assert "servers    failed:" in done.out and "refused" in done.out
    again = scope(*run, "--out", str(tmp_path / "logs"), "--json").json
    assert again["server_events"]["refused"] and any(AWAY in line for line in again["failure_summary"])


@pytest.mark.full
def test_a_sweep_reports_unavailable_servers(scope: Scope, tmp_path: Path) -> None:
    dump_tasks(many(1), tmp_path / "tasks.jsonl")
    where = (
        "--tasks",
        str(tmp_path / "tasks.jsonl"),
        "--out",
        str(tmp_path / "logs"),
        "--planner-url",
        AWAY,
        "--perception-url",
        AWAY,
    )
    single = scope("bench", "run", "--pair", "qwen3-4b+moondream2", *where)
    assert single.code == 1 and "1 run failed because of infrastructure; running the same command again repeats it." in single.err
    done = scope("bench", "sweep", "--pairs", "qwen3-4b+moondream2", *where)
    assert done.code == 1
    assert "1 of 1 run broken: the planner's server failed" in done.err and AWAY in done.err
    assert "Server failures" in done.out
