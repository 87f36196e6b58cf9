"""Tasks of another file's format run through the same engine; without a checked answer the judge decides."""

from __future__ import annotations

import json
from pathlib import Path

from scope_ptz.bench.engine.gate import gate
from scope_ptz.bench.engine.logs import read_evaluation
from scope_ptz.bench.importing.tasks import ImportedTask
from scope_ptz.bench.tasks import RequiredCall
from scope_ptz.bench.trials import Judgement, TaskFacts
from scope_ptz.cli.bench_live import accuracy, waiting
from tests.bench.engine.making import SCENE
from tests.cli.conftest import Scope
from tests.support.misbehaving import Misbehaving, Say, good


def test_imported_tasks_run_and_are_judged(scope: Scope, tmp_path: Path) -> None:
    facts = TaskFacts(
        id="q-1", dataset="theirs", stratum="imported", scene=SCENE, viewpoint="mast", preset="yard",
        instruction="pan right 20 degrees",
        category="single_call", scope="current", difficulty="easy", expected="The camera has turned.",
    )  # fmt: skip
    task = ImportedTask(facts=facts, line=2, raw={}, calls=(RequiredCall(tool="adjust_ptz"),))
    (tmp_path / "theirs.jsonl").write_text(task.model_dump_json() + "\n")
    run = ("bench", "run", "--tasks", str(tmp_path / "theirs.jsonl"), "--no-pictures", "--out", str(tmp_path / "logs"), "--json")
    done = scope(*run)
    assert done.code == 0, done.err
    # Nothing was scored yet, and that is no share of nothing.
    assert (done.json["not_judged"], done.json["macro"], done.json["micro"], done.json["by_category"]) == (
        1, None, None, {"single_call": None},
    )  # fmt: skip
    plain = scope(*run[:-1]).out
    assert "not scored 1 not judged yet: scope bench rescore" in plain
    assert "%" not in plain.partition("not scored")[0]
    log = Path(done.json["log"])
    (trial,) = read_evaluation(log).trials
    assert (trial.headline, trial.scored_by) == ("unscored", "judge")
    assert [(check.name, check.passed) for check in trial.checks] == [("calls", True)]
    said = {"reason": "It turned.", "verdict": "correct", "error_mode": None}
    with Misbehaving(then=good(Say(json.dumps(said)))) as server:
        assert scope("bench", "rescore", str(log), "--judge-url", server.url, "--judge-model", "j").code == 0
    (trial,) = read_evaluation(log).trials
    assert (trial.headline, trial.scored_by, trial.reason) == ("correct", "judge", "It turned.")
    again = scope(*run).json
    assert (again["not_judged"], again["macro"]) == (0, 1.0)
    # Another judge whose server is away takes nothing back.
    assert scope("bench", "rescore", str(log), "--judge-url", "http://127.0.0.1:1/v1", "--judge-model", "k").code == 1
    (trial,) = read_evaluation(log).trials
    assert (trial.headline, [j.verdict for j in trial.judgements]) == ("correct", ["correct", "failed"])


def test_replies_without_a_verdict_are_in_no_share_and_in_no_gate(scope: Scope, evaluated: Path) -> None:
    evaluation = read_evaluation(evaluated)
    said = Judgement(judge="j", prompt="p", verdict="unparseable")
    mute = evaluation.trials[0].model_copy(update={"scored_by": "judge", "headline": "unscored", "judgements": (said,)})
    trials = (mute, *evaluation.trials[1:])
    assert accuracy(trials) == 2 / 3
    assert waiting(trials) == ["not scored 1 without a verdict: the judge's replies were unparseable"]
    found = gate(evaluation.model_copy(update={"trials": trials}), evaluation)
    assert (found.left_out, found.overall.tasks, found.overall.worse) == ((mute.task.id,), 3, ())
