"""End-to-end evaluation with tiny checkpoints as planners, perception and judge behind ``transformers serve``.

A sweep of two pairs is killed, resumed, judged twice and reported. In another sweep, a server misbehaves as scripted.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from statistics import fmean
from typing import Any

import pytest

from scope_ptz.bench.engine.logs import read_evaluation, uuids_in
from scope_ptz.bench.engine.runs import SUPERSEDED_FOLDER
from tests.cli.conftest import Scope
from tests.full.evaluation_sweep import (
    ADEPT,
    COUNT_REPLY,
    COUNTING,
    NOVICE,
    RUNS_BEFORE_THE_KILL,
    SHORT_COMMANDS,
    TASKS,
    TURNING,
    JudgedLogs,
    SweepRun,
    judged_logs,
    planners,
    sweep_run,
    trusting_verdict,
)
from tests.full.figures import RunScores, by_category, by_run, kappa, read_scores
from tests.full.scripted import BEHAVIOURS, FAILING_ROWS, LIMIT, SCRIPT, ScriptedBehaviour, failures_by_kind
from tests.full.test_served_models import perception_server
from tests.support.misbehaving import Misbehaving

__all__ = ["judged_logs", "perception_server", "planners", "sweep_run"]

pytestmark = [
    pytest.mark.full,
    pytest.mark.timeout(1800),  # the first test trains and serves the models of all tests
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
    pytest.mark.filterwarnings("ignore::FutureWarning"),
    pytest.mark.filterwarnings("ignore::UserWarning"),
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
]


def test_a_killed_sweep_resumes_and_keeps_finished_runs(sweep_run: SweepRun) -> None:
    assert RUNS_BEFORE_THE_KILL <= len(sweep_run.finished) < len(TASKS)
    assert sweep_run.resumed.code == 0, sweep_run.resumed.err
    assert f"{len(sweep_run.finished)} of {len(TASKS)} runs are finished" in " ".join(
        sweep_run.resumed.out.split()
    )  # the line may be wrapped
    assert set(sweep_run.logs) == {NOVICE, ADEPT}
    for path in sweep_run.logs.values():
        evaluation = read_evaluation(path)
        assert evaluation.finished
        assert evaluation.card.ranked and evaluation.card.planner.reported and evaluation.card.perception.reported
        assert sorted(trial.task.id for trial in evaluation.trials) == sorted(task.id for task in TASKS)
        assert len({*uuids_in(path).values()}) == len(TASKS)
        assert "infrastructure" not in {trial.headline for trial in evaluation.trials}
        assert all(trial.input_tokens > 0 and trial.output_tokens > 0 for trial in evaluation.trials)
    # Runs that were finished before the kill are in the final log and were not repeated.
    runs = uuids_in(sweep_run.logs[NOVICE])
    assert {run: runs[run] for run in sweep_run.finished} == sweep_run.finished
    (superseded,) = (
        path for path in (sweep_run.program.logs / SUPERSEDED_FOLDER).glob("*.eval") if path.name != sweep_run.killed_log.name
    )
    now = {trial.sample: trial for trial in read_evaluation(sweep_run.logs[NOVICE]).trials}
    reused = [trial for trial in read_evaluation(superseded).trials if (trial.task.id, trial.epoch) in sweep_run.finished]
    assert len(reused) == len(sweep_run.finished)
    assert reused == [now[trial.sample] for trial in reused]


def test_the_pairs_act_as_trained(sweep_run: SweepRun) -> None:
    for pair, learned in ((NOVICE, (TURNING,)), (ADEPT, (TURNING, *SHORT_COMMANDS))):
        trials = read_evaluation(sweep_run.logs[pair]).trials
        assert {t.task.id for t in trials if t.headline == "correct"} - {COUNTING.id} == {task.id for task in learned}
        (count_trial,) = (trial for trial in trials if trial.task.id == COUNTING.id)
        assert (count_trial.tool_calls, count_trial.perception_failures, count_trial.answer) == (
            {"count_objects": 1},
            0,
            COUNT_REPLY,
        )
        assert [observation.view for observation in count_trial.looks] == ["current"]
    novice, adept = (str(sweep_run.logs[pair]) for pair in (NOVICE, ADEPT))
    assert sweep_run.program.run("bench", "gate", adept, "--baseline", novice).code == 0
    assert sweep_run.program.run("bench", "gate", novice, "--baseline", adept).code == 1


def test_a_checkpoint_judges_every_run_twice(judged_logs: JudgedLogs) -> None:
    for result in judged_logs.rounds:
        assert result.code == 0, result.err
        assert result.out.count(f"{len(TASKS)} with a verdict, 0 unparseable, 0 failed") == 2
    assert len(judged_logs.logs) == 2
    for path in judged_logs.logs.values():
        trials = read_evaluation(path).trials
        assert len(trials) == len(TASKS)
        for trial in trials:
            judgements = [(j.judge, j.repeat, j.verdict, j.error_mode, j.reason, j.attempts) for j in trial.judgements]
            verdict, mode = trusting_verdict(trial.task.category, trial.answer)
            assert judgements == [(judged_logs.judge, number, verdict, mode, "So it seems.", 1) for number in range(2)]
            assert all(j.input_tokens > 0 and j.output_tokens > 0 for j in trial.judgements)


def test_agreement_of_the_judge_with_itself_and_with_the_checks(sweep_run: SweepRun, judged_logs: JudgedLogs) -> None:
    result = sweep_run.program.run("bench", "agree", "--json", *map(str, judged_logs.logs.values()))
    assert result.code == 0, result.err
    agreement = json.loads(result.out)
    names = {rater["kind"]: rater["name"] for rater in reversed(agreement["raters"])}
    pairs = {(pair["first"], pair["second"]): pair["verdicts"] for pair in agreement["pairs"]}
    rows = [row for path in judged_logs.logs.values() for row in read_scores(path)]
    clear = [(row.checks, row.judge[0]) for row in rows if row.checks in ("correct", "incorrect")]
    with_checks = pairs[names["checks"], names["judge"]]
    assert with_checks["runs"] == len(clear)
    assert with_checks["raw"] == pytest.approx(fmean(one == two for one, two in clear))
    assert with_checks["kappa"] == pytest.approx(kappa(clear))
    assert 0 < with_checks["kappa"] < 1
    with_itself = pairs[names["judge"], f"{names['judge']} #2"]
    assert (with_itself["runs"], with_itself["raw"], with_itself["kappa"]) == (len(rows), 1.0, 1.0)
    (repeats,) = agreement["groups"]
    assert (repeats["runs"], repeats["raw"], repeats["kappa"], repeats["left_out"]) == (len(rows), 1.0, 1.0, 0)


def test_the_figures_of_the_report_match_the_logs(sweep_run: SweepRun, judged_logs: JudgedLogs, tmp_path: Path) -> None:
    result = sweep_run.program.run("bench", "report", *map(str, judged_logs.logs.values()), "--out", str(tmp_path / "report"))
    assert result.code == 0, result.err
    tables = {path.stem: by_run(path) for path in (tmp_path / "report" / "tables").glob("*.csv")}
    page = (tmp_path / "report" / "index.html").read_text("utf-8")
    for pair, path in judged_logs.logs.items():
        rows, trials = read_scores(path), read_evaluation(path).trials
        assert pair in page
        accuracy = by_category(rows, [row.checks == "correct" for row in rows])
        shown = tables["accuracy"][pair]
        assert {name: float(shown[name]) for name in accuracy} == pytest.approx(accuracy)
        assert float(shown["macro"]) == pytest.approx(fmean(accuracy.values()))
        assert float(shown["micro"]) == pytest.approx(fmean(row.checks == "correct" for row in rows))
        outcomes, headlines = tables["outcomes"][pair], Counter(row.checks for row in rows)
        for name in ("correct", "incorrect", "unscored", "infrastructure"):
            assert int(outcomes[name]) == headlines[name]
        assert (int(outcomes["trials"]), int(shown["tasks"])) == (len(TASKS), len(TASKS))
        assert_judged(tables, pair, rows)
        modes = Counter(row.mode for row in rows if row.checks == "incorrect")
        shown = tables["error_modes"][pair]
        assert {name: int(shown[str(name)]) for name in modes} == modes
        assert int(shown["failed"]) == modes.total()
        costs = tables["costs"][pair]
        assert int(costs["input_tokens"]) == sum(trial.input_tokens for trial in trials)
        assert int(costs["output_tokens"]) == sum(trial.output_tokens for trial in trials)


def assert_judged(tables: dict[str, dict[str, dict[str, str]]], pair: str, rows: Sequence[RunScores]) -> None:
    """Check the judge's results in a report: its verdicts and its error modes."""
    judge_row = tables["judge"][pair]
    assert [int(judge_row[name]) for name in ("judged", "unparseable", "failed")] == [len(TASKS), 0, 0]
    accuracy = by_category(rows, [row.judge[0] == "correct" for row in rows])
    assert float(judge_row["macro_judge"]) == pytest.approx(fmean(accuracy.values()))
    agreements = [row.judge[0] == row.checks for row in rows if row.checks in ("correct", "incorrect")]
    assert float(judge_row["agreement"]) == pytest.approx(fmean(agreements))
    modes = Counter(row.judge_mode for row in rows if row.judge[0] == "incorrect")
    shown = tables["error_modes_judge"][pair]
    assert {name: int(shown[str(name)]) for name in modes} == modes
    assert int(shown["failed"]) == modes.total()


def test_a_sweep_on_a_misbehaving_server_loses_no_run_and_counts_every_failure(
    scope: Scope, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    monkeypatch.setenv("SCOPE_MODELS", str(tmp_path / "models.yaml"))
    failing, healthy = ScriptedBehaviour([act for row in SCRIPT for act in row]), ScriptedBehaviour()
    with Misbehaving(then=failing) as one, Misbehaving(then=healthy) as other:
        facts = {"repo": "loopback-model", "roles": ["planner"], "size_b": 1, "active_b": 1, "precision": "fp32", "context": 9999}
        models = {name: {**facts, "url": server.url, "licence": "none"} for name, server in (("failing", one), ("healthy", other))}
        (tmp_path / "models.yaml").write_text(json.dumps({"models": models}))
        sweep = (
            "bench", "sweep", "--pairs", "failing+ground-truth,healthy+ground-truth", "--tasks", "lite", "--limit", str(LIMIT),
            "--concurrency", "1", "--timeout", "4", "--out", str(tmp_path / "logs"),
        )  # fmt: skip
        first = scope(*sweep)
        assert first.code == 1
        assert "some pairs are incomplete" in first.err
        logs = logs_by_planner(tmp_path / "logs")
        before = read_evaluation(logs["failing"])
        assert_each_task_once(before.trials)
        broken = [trial for trial in before.trials if trial.headline == "infrastructure"]
        assert len(broken) == len(FAILING_ROWS)
        # Each server failure is counted in its run, whether or not a retry succeeded.
        for trial in before.trials:
            assert failures_by_kind(trial.server_events) == failing.failures(trial.task.instruction)
        assert len(failing.record) == sum(map(len, SCRIPT)) + 2 * (LIMIT - len(SCRIPT))
        # The reason of a broken run is the last failure of the server.
        for trial in broken:
            last = [act for instruction, act in failing.record if instruction == trial.task.instruction][-1]
            assert BEHAVIOURS[last][0] in trial.reason
        # The other pair was still evaluated.
        assert not [t for t in read_evaluation(logs["healthy"]).trials if t.headline == "infrastructure" or t.server_events]

        earlier_requests, uuids = {"failing": len(failing.record), "healthy": len(healthy.record)}, uuids_in(logs["failing"])
        second = scope(*sweep)
        assert second.code == 0, second.err
    # Only broken runs were repeated.
    assert (len(failing.record) - earlier_requests["failing"], len(healthy.record) - earlier_requests["healthy"]) == (
        2 * len(broken),
        0,
    )
    repeated = {trial.task.instruction for trial in broken}
    assert {instruction for instruction, _ in failing.record[earlier_requests["failing"] :]} == repeated
    log = logs_by_planner(tmp_path / "logs")["failing"]
    after = read_evaluation(log)
    assert_each_task_once(after.trials)
    assert [t.task.id for t in after.trials] == [t.task.id for t in before.trials]
    finished = {(t.task.id, t.epoch) for t in before.trials if t.headline != "infrastructure"}
    now = uuids_in(log)
    assert {run: now[run] for run in finished} == {run: uuids[run] for run in finished}
    assert not [t for t in after.trials if t.headline == "infrastructure"]


def logs_by_planner(folder: Path) -> dict[str, Path]:
    return {read_evaluation(path).card.planner.name: path for path in folder.glob("*.eval")}


def assert_each_task_once(trials: Sequence[Any]) -> None:
    ids = [trial.task.id for trial in trials]
    assert len(ids) == len(set(ids)) == LIMIT
