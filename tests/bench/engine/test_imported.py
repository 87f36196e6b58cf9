"""Tasks of another file's format run through the same engine; without a checked answer the judge decides."""

from __future__ import annotations

import json
from pathlib import Path

from scope_ptz.bench.engine.logs import read_evaluation
from scope_ptz.bench.importing.tasks import ImportedTask
from scope_ptz.bench.tasks import RequiredCall
from scope_ptz.bench.trials import TaskFacts
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
    log = Path(done.json["log"])
    (trial,) = read_evaluation(log).trials
    assert (trial.headline, trial.scored_by) == ("unscored", "judge")
    assert [(check.name, check.passed) for check in trial.checks] == [("calls", True)]
    said = {"reason": "It turned.", "verdict": "correct", "error_mode": None}
    with Misbehaving(then=good(Say(json.dumps(said)))) as server:
        assert scope("bench", "rescore", str(log), "--judge-url", server.url, "--judge-model", "j").code == 0
    (trial,) = read_evaluation(log).trials
    assert (trial.headline, trial.scored_by, trial.reason) == ("correct", "judge", "It turned.")
