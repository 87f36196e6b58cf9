"""End-to-end evaluation with tiny checkpoints as planners, perception and judge behind `transformers serve`. A
sweep of two pairs is killed and goes on, is judged twice and reported; another one has a server that misbehaves as scripted."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from statistics import fmean
from typing import Any

import pytest

from scope_ptz.bench.engine.logs import read_evaluation, uuids_in
from scope_ptz.bench.engine.runs import SUPERSEDED
from tests.cli.conftest import Scope
from tests.full.evaluation_sweep import (
    ADEPT,
    COUNTED,
    COUNTING,
    FINISHED_BEFORE_THE_KILL,
    NOVICE,
    SHORT,
    TASKS,
    TURNING,
    Judged,
    SweepRun,
    gullible,
    judged,
    planners,
    swept,
)
from tests.full.figures import Marks, by_category, by_run, kappa, marks
from tests.full.scripted import BEHAVIOURS, BROKEN, LIMIT, SCRIPT, Scripted, mentions
from tests.full.test_served_models import perception_server
from tests.support.misbehaving import Misbehaving

__all__ = ["judged", "perception_server", "planners", "swept"]

pytestmark = [
    pytest.mark.full,
    pytest.mark.timeout(1800),  # the first test trains and serves the models of all
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
    pytest.mark.filterwarnings("ignore::FutureWarning"),
    pytest.mark.filterwarnings("ignore::UserWarning"),
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
]


def test_a_killed_sweep_resumes_and_keeps_finished_runs(swept: SweepRun) -> None:
    assert FINISHED_BEFORE_THE_KILL <= len(swept.finished) < len(TASKS)
    assert swept.again.code == 0, swept.again.err
    assert f"{len(swept.finished)} of {len(TASKS)} runs are finished" in swept.again.out
    assert set(swept.logs) == {NOVICE, ADEPT}
    for path in swept.logs.values():
        evaluation = read_evaluation(path)
        assert evaluation.finished
        assert evaluation.card.ranked and evaluation.card.planner.reported and evaluation.card.perception.reported
        assert sorted(trial.task.id for trial in evaluation.trials) == sorted(task.id for task in TASKS)
        assert len({*uuids_in(path).values()}) == len(TASKS)
        assert "infrastructure" not in {trial.headline for trial in evaluation.trials}
        assert all(trial.input_tokens > 0 and trial.output_tokens > 0 for trial in evaluation.trials)
    # What was finished when the kill came is what stands in the log at the end, and was not run again.
    runs = uuids_in(swept.logs[NOVICE])
    assert {run: runs[run] for run in swept.finished} == swept.finished
    (left,) = (path for path in (swept.program.logs / SUPERSEDED).glob("*.eval") if path.name != swept.killed.name)
    now = {trial.sample: trial for trial in read_evaluation(swept.logs[NOVICE]).trials}
    kept = [trial for trial in read_evaluation(left).trials if (trial.task.id, trial.epoch) in swept.finished]
    assert len(kept) == len(swept.finished)
    assert kept == [now[trial.sample] for trial in kept]


def test_the_pairs_act_as_trained(swept: SweepRun) -> None:
    for pair, learned in ((NOVICE, (TURNING,)), (ADEPT, (TURNING, *SHORT))):
        trials = read_evaluation(swept.logs[pair]).trials
        assert {t.task.id for t in trials if t.headline == "correct"} - {COUNTING.id} == {task.id for task in learned}
        (counted,) = (trial for trial in trials if trial.task.id == COUNTING.id)
        assert (counted.tool_calls, counted.perception_failures, counted.answer) == ({"count_objects": 1}, 0, COUNTED)
        assert [look.view for look in counted.looks] == ["current"]
    novice, adept = (str(swept.logs[pair]) for pair in (NOVICE, ADEPT))
    assert swept.program.run("bench", "gate", adept, "--baseline", novice).code == 0
    assert swept.program.run("bench", "gate", novice, "--baseline", adept).code == 1


def test_judged_twice_by_a_checkpoint(judged: Judged) -> None:
    for done in judged.rounds:
        assert done.code == 0, done.err
        assert done.out.count(f"{len(TASKS)} with a verdict, 0 unparseable, 0 failed") == 2
    assert len(judged.logs) == 2
    for path in judged.logs.values():
        trials = read_evaluation(path).trials
        assert len(trials) == len(TASKS)
        for trial in trials:
            said = [(j.judge, j.repeat, j.verdict, j.error_mode, j.reason, j.attempts) for j in trial.judgements]
            verdict, mode = gullible(trial.task.category, trial.answer)
            assert said == [(judged.judge, number, verdict, mode, "So it seems.", 1) for number in range(2)]
            assert all(j.input_tokens > 0 and j.output_tokens > 0 for j in trial.judgements)


def test_how_far_the_judge_agrees_with_itself_and_with_the_checks(swept: SweepRun, judged: Judged) -> None:
    done = swept.program.run("bench", "agree", "--json", *map(str, judged.logs.values()))
    assert done.code == 0, done.err
    told = json.loads(done.out)
    names = {rater["kind"]: rater["name"] for rater in reversed(told["raters"])}
    pairs = {(pair["first"], pair["second"]): pair["verdicts"] for pair in told["pairs"]}
    rows = [row for path in judged.logs.values() for row in marks(path)]
    clear = [(row.checks, row.judge[0]) for row in rows if row.checks in ("correct", "incorrect")]
    beside = pairs[names["checks"], names["judge"]]
    assert beside["runs"] == len(clear)
    assert beside["raw"] == pytest.approx(fmean(one == two for one, two in clear))
    assert beside["kappa"] == pytest.approx(kappa(clear))
    assert 0 < beside["kappa"] < 1
    itself = pairs[names["judge"], f"{names['judge']} #2"]
    assert (itself["runs"], itself["raw"], itself["kappa"]) == (len(rows), 1.0, 1.0)
    (repeats,) = told["groups"]
    assert (repeats["runs"], repeats["raw"], repeats["kappa"], repeats["left_out"]) == (len(rows), 1.0, 1.0, 0)


def test_the_figures_of_the_report_are_those_of_the_logs(swept: SweepRun, judged: Judged, tmp_path: Path) -> None:
    done = swept.program.run("bench", "report", *map(str, judged.logs.values()), "--out", str(tmp_path / "report"))
    assert done.code == 0, done.err
    tables = {path.stem: by_run(path) for path in (tmp_path / "report" / "tables").glob("*.csv")}
    page = (tmp_path / "report" / "index.html").read_text("utf-8")
    for pair, path in judged.logs.items():
        rows, trials = marks(path), read_evaluation(path).trials
        assert pair in page
        accuracy = by_category(rows, [row.checks == "correct" for row in rows])
        shown = tables["accuracy"][pair]
        assert {name: float(shown[name]) for name in accuracy} == pytest.approx(accuracy)
        assert float(shown["macro"]) == pytest.approx(fmean(accuracy.values()))
        assert float(shown["micro"]) == pytest.approx(fmean(row.checks == "correct" for row in rows))
        outcomes, counted = tables["outcomes"][pair], Counter(row.checks for row in rows)
        for name in ("correct", "incorrect", "unscored", "infrastructure"):
            assert int(outcomes[name]) == counted[name]
        assert (int(outcomes["trials"]), int(shown["tasks"])) == (len(TASKS), len(TASKS))
        assert_judged(tables, pair, rows)
        modes = Counter(row.mode for row in rows if row.checks == "incorrect")
        shown = tables["error_modes"][pair]
        assert {name: int(shown[str(name)]) for name in modes} == modes
        assert int(shown["failed"]) == modes.total()
        costs = tables["costs"][pair]
        assert int(costs["input_tokens"]) == sum(trial.input_tokens for trial in trials)
        assert int(costs["output_tokens"]) == sum(trial.output_tokens for trial in trials)


def assert_judged(tables: dict[str, dict[str, dict[str, str]]], pair: str, rows: Sequence[Marks]) -> None:
    """Check the judge's results in a report: its verdicts and its error modes."""
    told = tables["judge"][pair]
    assert [int(told[name]) for name in ("judged", "unparseable", "failed")] == [len(TASKS), 0, 0]
    believed = by_category(rows, [row.judge[0] == "correct" for row in rows])
    assert float(told["macro_judge"]) == pytest.approx(fmean(believed.values()))
    alike = [row.judge[0] == row.checks for row in rows if row.checks in ("correct", "incorrect")]
    assert float(told["agreement"]) == pytest.approx(fmean(alike))
    named = Counter(row.judge_mode for row in rows if row.judge[0] == "incorrect")
    shown = tables["error_modes_judge"][pair]
    assert {name: int(shown[str(name)]) for name in named} == named
    assert int(shown["failed"]) == named.total()


def test_a_sweep_on_a_misbehaving_server_loses_nothing_and_counts_everything(
    scope: Scope, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    monkeypatch.setenv("SCOPE_MODELS", str(tmp_path / "models.yaml"))
    moody, calm = Scripted([act for row in SCRIPT for act in row]), Scripted()
    with Misbehaving(then=moody) as one, Misbehaving(then=calm) as other:
        facts = {"repo": "loopback-model", "roles": ["planner"], "size_b": 1, "active_b": 1, "precision": "fp32", "context": 9999}
        models = {name: {**facts, "url": server.url, "licence": "none"} for name, server in (("moody", one), ("calm", other))}
        (tmp_path / "models.yaml").write_text(json.dumps({"models": models}))
        sweep = (
            "bench", "sweep", "--pairs", "moody+ground-truth,calm+ground-truth", "--tasks", "lite", "--limit", str(LIMIT),
            "--concurrency", "1", "--timeout", "4", "--out", str(tmp_path / "logs"),
        )  # fmt: skip
        first = scope(*sweep)
        assert first.code == 1
        assert "some pairs are incomplete" in first.err
        logs = logs_by_planner(tmp_path / "logs")
        before = read_evaluation(logs["moody"])
        assert_each_task_once(before.trials)
        broken = [trial for trial in before.trials if trial.headline == "infrastructure"]
        assert len(broken) == len(BROKEN)
        # Each failure of the server is counted in the run that it befell, made good or not.
        for trial in before.trials:
            assert mentions(trial.server_events) == moody.failures(trial.task.instruction)
        assert len(moody.did) == sum(map(len, SCRIPT)) + 2 * (LIMIT - len(SCRIPT))
        # The run ended by what the server did to it last, and that is all that a broken run says.
        for trial in broken:
            last = [act for words, act in moody.did if words == trial.task.instruction][-1]
            assert BEHAVIOURS[last][0] in trial.reason
        # The other pair was run all the same.
        assert not [t for t in read_evaluation(logs["calm"]).trials if t.headline == "infrastructure" or t.server_events]

        so_far, uuids = {"moody": len(moody.did), "calm": len(calm.did)}, uuids_in(logs["moody"])
        second = scope(*sweep)
        assert second.code == 0, second.err
    # Only what was broken has been run again.
    assert (len(moody.did) - so_far["moody"], len(calm.did) - so_far["calm"]) == (2 * len(broken), 0)
    again = {trial.task.instruction for trial in broken}
    assert {instruction for instruction, _ in moody.did[so_far["moody"] :]} == again
    log = logs_by_planner(tmp_path / "logs")["moody"]
    after = read_evaluation(log)
    assert_each_task_once(after.trials)
    assert [t.task.id for t in after.trials] == [t.task.id for t in before.trials]
    kept = {(t.task.id, t.epoch) for t in before.trials if t.headline != "infrastructure"}
    now = uuids_in(log)
    assert {run: now[run] for run in kept} == {run: uuids[run] for run in kept}
    assert not [t for t in after.trials if t.headline == "infrastructure"]


def logs_by_planner(folder: Path) -> dict[str, Path]:
    return {read_evaluation(path).card.planner.name: path for path in folder.glob("*.eval")}


def assert_each_task_once(trials: Sequence[Any]) -> None:
    ids = [trial.task.id for trial in trials]
    assert len(ids) == len(set(ids)) == LIMIT
